// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "settings/apply.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace isophote {
namespace {

enum class Fruit : std::uint32_t { kApple, kQuince };

}  // namespace

template <>
struct EnumNames<Fruit> {
  static constexpr std::array names{"apple", "quince"};
};

namespace {

struct KitchenSettings {
  bool open = false;
  int offset = 0;
  std::uint32_t plates = 4;
  std::uint64_t seed = 0;
  float radius = 0.05f;
  std::string label = "none";
  Fruit fruit = Fruit::kApple;

  void visit(auto&& v) {
    v("open", open, {.help = "Is it open?"});
    v("offset", offset, {.help = "Steps aside.", .min = -10, .max = 10});
    v("plates", plates, {.help = "Plates.", .min = 1, .max = 4e9});
    v("seed", seed, {.help = "Start of the numbers."});
    v("radius", radius, {.help = "Of a plate.", .unit = "m", .min = 0, .max = 1});
    v("label", label, {.help = "Written on the door."});
    v("fruit", fruit, {.help = "On the table."});
  }
};

struct HouseSettings {
  KitchenSettings kitchen, cellar;
  void visitGroups(auto&& v) {
    v("kitchen", kitchen);
    v("cellar", cellar);
  }
};

class Settings : public testing::Test {
 protected:
  HouseSettings house_;
  std::vector<Field> fields_ = fieldsOfGroups(house_);

  void set(std::string_view assignment) {
    setFromAssignment(fields_, assignment, {ErrorKind::kBadUsage, "--set"});
  }

  /// The sentence that refuses the assignment.
  std::string refusal(std::string_view assignment) {
    try {
      set(assignment);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadUsage);
      return error.what();
    }
    return "accepted";
  }
};

TEST_F(Settings, EveryTypeIsSetByItsKey) {
  set("kitchen.open=true");
  set("kitchen.offset=-3");
  set("kitchen.plates=2e5");
  set("cellar.seed=18446744073709551615");
  set("kitchen.radius=0.25");
  set("kitchen.label=42 = x");
  set("cellar.fruit=quince");
  set("kitchen.fruit=\"quince\"");
  EXPECT_TRUE(house_.kitchen.open);
  EXPECT_EQ(house_.kitchen.offset, -3);
  EXPECT_EQ(house_.kitchen.plates, 200000u);
  EXPECT_EQ(house_.cellar.seed, ~std::uint64_t(0));
  EXPECT_EQ(house_.kitchen.radius, 0.25f);
  EXPECT_EQ(house_.kitchen.label, "42 = x");
  EXPECT_EQ(house_.cellar.fruit, Fruit::kQuince);
  EXPECT_EQ(house_.kitchen.fruit, Fruit::kQuince);
  EXPECT_EQ(house_.cellar.plates, 4u);
}

TEST_F(Settings, UnknownKeysNameTheNearest) {
  EXPECT_EQ(refusal("kitchen.radiu=1"),
            "--set: there is no setting \"kitchen.radiu\" (did you mean \"kitchen.radius\"?)");
  EXPECT_EQ(refusal("plates=1"), "--set: there is no setting \"plates\" (did you mean \"kitchen.plates\"?)");
  EXPECT_EQ(refusal("zzz=1"), "--set: there is no setting \"zzz\"; `isophote info --settings` lists all");
  EXPECT_EQ(refusal("cellar.fruit=quinse"),
            "--set: cellar.fruit has no value \"quinse\" (did you mean \"quince\"?); there is apple, quince");
  EXPECT_EQ(refusal("kitchen.radius"), "--set: \"kitchen.radius\" should read stage.name=value");
}

TEST_F(Settings, NumbersMayBeWrittenAsPeopleWriteThem) {
  set("kitchen.radius=.5");
  set("kitchen.plates=+3");
  set("kitchen.offset=-2.");
  EXPECT_EQ(house_.kitchen.radius, 0.5f);
  EXPECT_EQ(house_.kitchen.plates, 3u);
  EXPECT_EQ(house_.kitchen.offset, -2);
  set("kitchen.radius=+.25");
  EXPECT_EQ(house_.kitchen.radius, 0.25f);
  for (const char* value : {"+-1", ".", "+", "1.2.3", "+nan", "-inf", "+1e999"})
    EXPECT_NE(refusal(std::string("kitchen.offset=") + value).find("a whole number from -10 to 10"),
              std::string::npos)
        << value;
}

TEST_F(Settings, WrongValuesAreRefusedWithTheRangeAndChangeNothing) {
  EXPECT_EQ(refusal("kitchen.radius=2"), "--set: kitchen.radius must be a number from 0 to 1 m, not 2");
  for (const char* value : {"nan", "NaN", "1e999", "-1", "inf", "true", "[1]", "\"1\"", "1 m", ""})
    EXPECT_NE(refusal(std::string("kitchen.radius=") + value).find("must be a number from 0 to 1 m, not"),
              std::string::npos)
        << value;
  for (const char* value : {"0", "-1", "1.5", "4000000001", "1e30", "18446744073709551616", "many", "null"})
    EXPECT_NE(refusal(std::string("kitchen.plates=") + value).find("a whole number from 1 to 4000000000"),
              std::string::npos)
        << value;
  EXPECT_EQ(refusal("kitchen.seed=-1"), "--set: kitchen.seed must be a whole number of at least 0, not -1");
  EXPECT_EQ(refusal("kitchen.seed=18446744073709551616"),
            "--set: kitchen.seed must be a whole number of at least 0, not 18446744073709551616");
  EXPECT_EQ(refusal("kitchen.offset=11"),
            "--set: kitchen.offset must be a whole number from -10 to 10, not 11");
  EXPECT_EQ(refusal("kitchen.open=1"), "--set: kitchen.open must be true or false, not 1");
  EXPECT_EQ(house_.kitchen.radius, 0.05f);
  EXPECT_EQ(house_.kitchen.plates, 4u);
}

TEST_F(Settings, JsonMayBeNestedOrDotted) {
  setFromJson(fields_, R"({"kitchen": {"plates": 7, "fruit": "quince"}, "cellar.radius": 0.5})",
              {ErrorKind::kBadInput, "house.json"});
  EXPECT_EQ(house_.kitchen.plates, 7u);
  EXPECT_EQ(house_.kitchen.fruit, Fruit::kQuince);
  EXPECT_EQ(house_.cellar.radius, 0.5f);
}

TEST_F(Settings, BadJsonNamesTheFile) {
  for (const char* json :
       {"", "{", "[]", "3", R"({"kitchen": 3})", R"({"garage": {}})", R"({"kitchen": {"plate": 3}})",
        R"({"kitchen": {"plates": {"x": 3}}})", R"({"kitchen": {"plates": 3, "plates": 4}})"}) {
    try {
      setFromJson(fields_, json, {ErrorKind::kBadInput, "house.json"});
      ADD_FAILURE() << "accepted " << json;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
      EXPECT_EQ(std::string_view(error.what()).find("house.json: "), 0u) << error.what();
      EXPECT_EQ(std::string_view(error.what()).find("exception"), std::string_view::npos) << error.what();
    }
  }
}

TEST_F(Settings, WrittenJsonSetsTheSameValues) {
  set("kitchen.radius=0.1");
  set("cellar.fruit=quince");
  set("cellar.seed=18446744073709551615");
  const std::string written = settingsJson(fields_);
  EXPECT_EQ(nlohmann::json::parse(written)["kitchen"]["radius"].dump(), "0.1");
  HouseSettings other;
  const std::vector<Field> fields = fieldsOfGroups(other);
  setFromJson(fields, written, {});
  EXPECT_EQ(settingsJson(fields), written);
  EXPECT_EQ(other.cellar.seed, ~std::uint64_t(0));
}

TEST_F(Settings, TableShowsDefaultRangeAndUnit) {
  const std::string table = settingsTable(fields_);
  EXPECT_NE(table.find("| `kitchen.radius` | 0.05 | 0 to 1 m | Of a plate. |\n"), std::string::npos) << table;
  EXPECT_NE(table.find("| `cellar.fruit` | apple | apple, quince | On the table. |\n"), std::string::npos)
      << table;
}

}  // namespace
}  // namespace isophote
