// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
// The program as a person or a script meets it: exit codes, sentences, and which files are left.
#include "base/files.h"
#include "image/files.h"
#include "scene/builtin/builtin.h"
#include "support/program.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <random>

namespace isophote {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class Cli : public testing::Test {
 protected:
  TestFolder folder_;
  ProgramRun run(const std::string& arguments, const std::string& wrapper = "") {
    return runIsophote(folder_.path(), arguments, wrapper);
  }

  /// The program must end with that code, one sentence that holds those words, nothing on stdout and no file.
  void expectRefusal(const std::string& arguments, int code, const std::string& words) {
    SCOPED_TRACE("isophote " + arguments);
    const ProgramRun result = run(arguments);
    EXPECT_EQ(result.code, code);
    EXPECT_THAT(result.errors, AllOf(StartsWith("isophote: "), HasSubstr(words), EndsWith("\n")));
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
    EXPECT_THAT(result.output, IsEmpty());
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
  }
};

TEST_F(Cli, BadUsageExitsWith2) {
  expectRefusal("", 2, "give a command: render, reference, view, compare, info");
  expectRefusal("rendr cornell-box", 2, "did you mean \"render\"?");
  expectRefusal("--versoin", 2, "did you mean \"--version\"?");
  expectRefusal("render -o a.png", 2, "SCENE is required");
  expectRefusal("render cornell-box", 2, "--output is required");
  expectRefusal("render cornell-box -o", 2, "--output: takes one value");
  expectRefusal("render cornell-box -o a.png b.png", 2, "one argument too many: \"b.png\"");
  expectRefusal("render cornell-box -o a.png --photns 3", 2, "did you mean \"--photons\"?");
  expectRefusal("render cornell-box -o a.png --photns=3", 2, "there is no option --photns (did you mean");
  expectRefusal("render cornell-box -o a.png --spp 3", 2, "there is no option --spp");
  expectRefusal("render cornell-box -o a.jpg", 2, ".exr or .png");
  expectRefusal("info", 2, "one of SCENE, --devices, --builtin, --settings, --manual or --completion");
  expectRefusal("info cornell-box --builtin", 2, "one of SCENE");
}

TEST_F(Cli, BadSettingsExitWith2AndSayWhatIsAccepted) {
  const std::string render = "render cornell-box -o a.png ";
  expectRefusal(render + "--width abc", 2,
                "--width: frame.width must be a whole number from 1 to 16384 px, not abc");
  expectRefusal(render + "--width 0", 2, "not 0");
  expectRefusal(render + "--width 1e9", 2, "not 1e9");
  expectRefusal(render + "--radius nan", 2, "not nan");
  expectRefusal(render + "--radius -1", 2, "not -1");
  expectRefusal(render + "--threads 0", 2, "from 1 to 4096");
  expectRefusal(render + "--estimator kdtre", 2, "did you mean \"kdtree\"?");
  expectRefusal(render + "--engine cuda", 2, "there is auto, cpu, vulkan");
  expectRefusal(render + "--preset jenson", 2, "did you mean \"jensen\"?");
  expectRefusal(render + "--set photon_trace.photon=3", 2, "did you mean \"photon_trace.photons\"?");
  expectRefusal(render + "--set photons", 2, "stage.name=value");
  expectRefusal(render + "--exposure bright", 2, "--exposure");
  expectRefusal(render + "--tonemap aes", 2, "did you mean \"aces\"?");
  expectRefusal(render + "--layer indirec", 2, "did you mean \"indirect\"?");
  expectRefusal(render + "--camera nowhere", 2, "no camera \"nowhere\"");
  expectRefusal(render + "--height -5", 2, "not -5");
  expectRefusal(render + "--photons -1", 2, "not -1");
  expectRefusal(render + "--photons 1e30", 2, "not 1e30");
  expectRefusal(render + "--threads 100000", 2, "not 100000");
  expectRefusal(render + "--camera ''", 2, "--camera: is empty");
  expectRefusal(render + "--settings ''", 2, "--settings: is empty");
  expectRefusal(render + "--stats ./a.png", 2, "--stats: names the picture's own file");
  expectRefusal("reference cornell-box -o a.exr --time -1", 2, "not -1");
  expectRefusal("reference cornell-box -o a.exr --spp 0", 2, "--spp: spp must be a whole number from 1");
}

TEST_F(Cli, BadInputExitsWith1) {
  expectRefusal("render cornell-bx -o a.png", 1, "did you mean \"cornell-box\"?");
  expectRefusal("render none.glb -o a.png", 1, "none.glb");
  expectRefusal("render cornell-box -o none/a.png", 1, "the folder \"none\" does not exist");
  expectRefusal("render cornell-box -o a.png --stats none/s.json", 1, "the folder \"none\" does not exist");
  expectRefusal("render cornell-box -o a.png --settings none.json", 1, "none.json: does not exist");
  expectRefusal("reference cornell-box -o none/a.exr", 1, "the folder \"none\" does not exist");
  expectRefusal("compare none.exr none.exr", 1, "none.exr: does not exist");
  expectRefusal("info none.obj", 1, "none.obj");
}

TEST_F(Cli, PlacesThatTakeNoFileAreRefused) {
  const std::string render = "render furnace --width 8 --height 8 --photons 100 -o ";
  expectRefusal(render + "..", 2, ".exr or .png");
  expectRefusal(render + "/dev/null/a.png", 1, "Not a directory");
  expectRefusal(render + std::string(300, 'x') + ".png", 1, "File name too long");
  expectRefusal(render + "/dev/null --stats s.json", 2, ".exr or .png");
}

/// One sentence each, whatever is wrong with the file; made once, so that the folder of the output stays
/// empty.
TEST_F(Cli, DamagedFilesAreRefusedInOneSentence) {
  const TestFolder files;
  std::mt19937 random(7);
  std::string noise(5000, '\0');
  for (char& c : noise) c = char(random());
  const std::string glb("glTF\2\0\0\0\x40\0\0\0", 12);
  const struct {
    const char* name;
    std::string bytes;
    const char* words;
  } cases[] = {
      {"empty.glb", "", "empty.glb"},
      {"noise.glb", noise, "noise.glb"},
      {"cut.glb", glb, "cut.glb"},
      {"empty.gltf", "", "empty.gltf"},
      {"list.gltf", "[]", "list.gltf"},
      {"deep.gltf", std::string(1'000'000, '['), "deep.gltf"},
      {"empty.obj", "", "holds no faces"},
      {"noise.obj", noise, "is not a text file"},
      {"index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999\n", "line 4"},
      {"nan.obj", "v 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "line 1"},
      {"empty.json", "", "empty.json"},
      {"type.json", R"({"isophote": 1, "models": {"file": 3}})", "models"},
      {"key.json", R"({"isophote": 1, "modles": []})", "did you mean \"models\"?"},
      {"itself.json", R"({"isophote": 1, "models": [{"file": "itself.json"}]})", "itself.json"},
      {"noise.txt", noise, "noise.txt"},
  };
  for (const auto& [name, bytes, words] : cases)
    expectRefusal(fmt::format("render '{}' -o a.png", files.write(name, bytes).string()), 1, words);
  expectRefusal(fmt::format("render '{}' -o a.png", files.path().string()), 1, "is not a scene file");
  std::filesystem::create_symlink("/dev/zero", files.path() / "endless.glb");
  expectRefusal(fmt::format("render '{}/endless.glb' -o a.png", files.path().string()), 1, "device or pipe");
  ASSERT_EQ(::mkfifo((files.path() / "pipe.obj").c_str(), 0600), 0);
  expectRefusal(fmt::format("render '{}/pipe.obj' -o a.png", files.path().string()), 1, "device or pipe");
}

TEST_F(Cli, NamesCannotBreakTheLineOrSteerTheTerminal) {
  expectRefusal("info \"$(printf 'a\\nb\\033[2J.obj')\"", 1, "a?b?[2J.obj: does not exist");
  expectRefusal("info \"$(printf '\\377.obj')\"", 1, "\xff.obj: does not exist");
}

TEST_F(Cli, FullDisksAreNoticed) {
  for (const char* name : {"full.png", "full.exr"}) {
    const TestFolder links;
    std::filesystem::create_symlink("/dev/full", links.path() / name);
    expectRefusal(fmt::format("render furnace --width 8 --height 8 --photons 100 -o '{}/{}'",
                              links.path().string(), name),
                  1, "No space left on device");
  }
  for (const char* command : {"info --builtin", "info --settings", "--help",
                              "bench sspm --quick --scale 0.0002 --repeats 1 --budget 1 --quiet"}) {
    const ProgramRun result = run(command, R"(sh -c 'exec "$@" >/dev/full' sh)");
    EXPECT_EQ(result.code, 1) << command;
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
  }
}

TEST_F(Cli, BadSettingsFileIsNamed) {
  folder_.write("s.json", R"({"photon_trace": {"fotons": 3}})");
  const ProgramRun result = run("render cornell-box -o a.png --settings s.json");
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.errors, HasSubstr("s.json: there is no setting \"photon_trace.fotons\" (did you mean "
                                       "\"photon_trace.photons\"?)"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "a.png"));
}

TEST_F(Cli, HelpAndVersionGoToStdout) {
  for (const char* arguments :
       {"--help", "render --help", "reference --help", "compare --help", "info --help"}) {
    const ProgramRun result = run(arguments);
    EXPECT_EQ(result.code, 0) << arguments;
    EXPECT_THAT(result.output, HasSubstr("Examples:")) << arguments;
    EXPECT_THAT(result.errors, IsEmpty()) << arguments;
  }
  EXPECT_THAT(run("--version").output, StartsWith("isophote "));
}

TEST_F(Cli, InfoListsWhatThereIs) {
  EXPECT_THAT(run("info --builtin").output, AllOf(HasSubstr("cornell-box"), HasSubstr("furnace")));
  EXPECT_THAT(run("info --settings").output,
              AllOf(HasSubstr("| `photon_trace.photons` |"), HasSubstr("| `jensen` |")));
  EXPECT_THAT(run("info cornell-box").output, AllOf(HasSubstr("triangles"), HasSubstr("lights     1")));
  EXPECT_EQ(run("info --settings").output, readFile(ISOPHOTE_SOURCE_DIR "/docs/settings.md"))
      << "write it anew: ./isophote info --settings > docs/settings.md";
  const ProgramRun devices = run("info --devices");
  EXPECT_EQ(devices.code, 0);
  EXPECT_THAT(devices.output, AllOf(StartsWith("cpu "), HasSubstr("\nvulkan ")));
}

TEST_F(Cli, RenderWritesPictureAndStatistics) {
  const ProgramRun result =
      run("render cornell-box -o a.exr --width 40 --height 24 --photons 2000 --bounces 2 --set "
          "direct.areaSamples=1 "
          "--seed 5 --threads 2 --stats s.json");
  ASSERT_EQ(result.code, 0) << result.errors;
  EXPECT_THAT(result.errors, IsEmpty());
  EXPECT_THAT(result.output, IsEmpty());

  const Film film = readFilm(folder_.path() / "a.exr");
  EXPECT_EQ(film.colour.width, 40);
  EXPECT_EQ(film.colour.height, 24);
  EXPECT_TRUE(film.layers.contains("indirect"));
  const auto setTo = [&](std::string_view key, std::string_view value) {
    return std::find(film.metadata.begin(), film.metadata.end(),
                     std::pair<std::string, std::string>(key, value)) != film.metadata.end();
  };
  EXPECT_TRUE(setTo("photon_trace.photons", "2000"));
  EXPECT_TRUE(setTo("direct.areaSamples", "1"));
  EXPECT_TRUE(setTo("frame.seed", "5"));

  const auto stats = nlohmann::json::parse(readFile(folder_.path() / "s.json"));
  EXPECT_EQ(stats["engine"], "cpu");
  EXPECT_GT(stats["stages"].size(), 3u);
  EXPECT_GT(stats["peakMemoryBytes"], 1 << 20);
}

/// A PNG of each part of the light shows that layer of the EXR.
TEST_F(Cli, PicturesShowLayers) {
  const std::string settings = " --width 24 --photons 2000 --seed 5 ";
  ASSERT_EQ(run("render cornell-box -o all.exr" + settings).code, 0);
  const Film film = readFilm(folder_.path() / "all.exr");
  for (const std::string layer : {"direct", "indirect", "emitted"}) {
    ASSERT_EQ(run("render cornell-box -o " + layer + ".png --layer " + layer + settings).code, 0);
    const Image shown = readFilm(folder_.path() / (layer + ".png")).colour;
    const Image& expected = film.layers.at(layer);
    ASSERT_EQ(shown.pixels.size(), expected.pixels.size());
    for (std::size_t i = 0; i < shown.pixels.size(); ++i)
      EXPECT_LT(std::abs(shown.pixels[i].y - std::min(expected.pixels[i].y, 1.0f)), 0.01f)
          << layer << " " << i;
  }
  EXPECT_THAT(run("render cornell-box -o a.exr --layer direct" + settings).errors,
              HasSubstr("PNG pictures only"));
}

TEST_F(Cli, SameSeedGivesTheSameBytesForAnyNumberOfThreads) {
  const std::string render = "render cornell-box --width 64 --height 48 --photons 5000 -o ";
  ASSERT_EQ(run(render + "a.exr --threads 1").code, 0);
  ASSERT_EQ(run(render + "b.exr --threads 8").code, 0);
  EXPECT_TRUE(readFile(folder_.path() / "a.exr") == readFile(folder_.path() / "b.exr"));
}

TEST_F(Cli, EveryBuiltinSceneRenders) {
  for (const BuiltinScene& scene : builtinScenes()) {
    SCOPED_TRACE(scene.name);
    const std::string size = fmt::format("{} --width 40 --height 24 -o ", scene.name);
    const ProgramRun frame = run("render " + size + "a.png --photons 5000", "timeout -s KILL 60");
    EXPECT_EQ(frame.code, 0) << frame.errors;
    const ProgramRun traced = run("reference " + size + "b.png --spp 1", "timeout -s KILL 60");
    EXPECT_EQ(traced.code, 0) << traced.errors;
  }
}

TEST_F(Cli, SizeFollowsTheCamera) {
  ASSERT_EQ(run("render cornell-box -o a.exr --height 24 --photons 1000").code, 0);
  const Film film = readFilm(folder_.path() / "a.exr");
  EXPECT_EQ(film.colour.height, 24);
  EXPECT_EQ(film.colour.width, 24);  // The Cornell box is seen in a square.
}

TEST_F(Cli, LaterSourcesOfSettingsHold) {
  folder_.write("s.json", R"({"frame.width": 16, "frame.height": 8, "frame.bounces": 1})");
  const std::string render = "render cornell-box -o a.exr --photons 1000 --settings s.json ";
  ASSERT_EQ(run(render + "--width 24 --set frame.height=12").code, 0);
  const Film film = readFilm(folder_.path() / "a.exr");
  EXPECT_EQ(film.colour.width, 24);
  EXPECT_EQ(film.colour.height, 12);
}

TEST_F(Cli, CompareMeasuresAndWritesTheDifference) {
  const std::string reference = "reference cornell-box --width 24 --height 24 --bounces 1 --spp 4 ";
  ASSERT_EQ(run(reference + "-o a.exr").code, 0);
  ASSERT_EQ(run(reference + "--seed 1 -o b.exr").code, 0);

  const ProgramRun same = run("compare a.exr a.exr --json");
  ASSERT_EQ(same.code, 0) << same.errors;
  const auto equal = nlohmann::json::parse(same.output);
  EXPECT_TRUE(equal["psnr"].is_null());
  EXPECT_EQ(equal["ssim"], 1.0);
  EXPECT_EQ(equal["flip"], 0.0);
  EXPECT_EQ(equal["meanRatio"], 1.0);

  const ProgramRun different = run("compare a.exr b.exr --json --layer indirect --diff d.png");
  ASSERT_EQ(different.code, 0) << different.errors;
  EXPECT_GT(nlohmann::json::parse(different.output)["psnr"], 5.0);
  EXPECT_EQ(readFilm(folder_.path() / "d.png").colour.width, 24);
  for (const char* key : {"psnr", "ssim", "flip", "relMse", "meanRatio"}) {
    EXPECT_TRUE(nlohmann::json::parse(different.output).contains(key)) << key;
    EXPECT_THAT(run("compare a.exr b.exr").output, HasSubstr(key));
  }

  // As numbers, the difference has the errors as a layer, whose mean is flip.
  const ProgramRun numbers = run("compare a.exr b.exr --json --diff d.exr");
  const Film film = readFilm(folder_.path() / "d.exr");
  double sum = 0.0;
  for (const vec3& error : film.layers.at("flip").pixels) sum += error.x;
  EXPECT_NEAR(nlohmann::json::parse(numbers.output)["flip"], sum / (24.0 * 24.0), 1e-7);
  // Black pictures are alike; those too dim to see, nearly so.
  const auto dim = nlohmann::json::parse(run("compare a.exr b.exr --json --exposure -20").output);
  EXPECT_LT(dim["flip"], 0.01);
  // From further away, where a degree holds more pixels, noise averages out.
  const auto flipAt = [&](const char* pixelsPerDegree) {
    const std::string command = "compare a.exr b.exr --json --ppd ";
    return nlohmann::json::parse(run(command + pixelsPerDegree).output)["flip"].get<double>();
  };
  EXPECT_LT(flipAt("400"), flipAt("100"));
  EXPECT_LT(flipAt("100"), flipAt("20"));

  const ProgramRun noLayer = run("compare a.exr b.exr --layer indirct");
  EXPECT_EQ(noLayer.code, 1);
  EXPECT_THAT(noLayer.errors, HasSubstr("indirct"));
}

TEST_F(Cli, MemoryBudgetRefusesWhatIsTooLarge) {
  const std::string render = "render colour-bleed --width 64 --height 48 -o a.png ";
  const ProgramRun small = run(render + "--photons-stored 2000000 --memory 64M");
  EXPECT_EQ(small.code, 1);
  EXPECT_THAT(small.errors, HasSubstr("memory budget of 64 MiB"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
  for (const char* size : {"0", "x", "1T", "-4G", "4.5G", "99999999999999G", "G"})
    expectRefusal(render + "--memory " + size, 2, "is not a size such as 512M or 4G");
  EXPECT_EQ(run(render + "--photons 1000 --memory 1G").code, 0);
  // In batches.
  EXPECT_EQ(run(render + "--photons 1000000 --memory 64M").code, 0);
}

TEST_F(Cli, InterruptedWorkExitsWith130AndLeavesNoFile) {
  for (const char* command :
       {"render furnace-box --aa 60000 -o a.png", "reference furnace-box --spp 1000000 -o a.exr"}) {
    SCOPED_TRACE(command);
    const auto start = std::chrono::steady_clock::now();
    const ProgramRun result = run(command, "timeout --preserve-status --signal=INT 1");
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
    EXPECT_EQ(result.code, 130);
    EXPECT_EQ(result.errors, "isophote: stopped before the work was complete\n");
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
  }
}

TEST_F(Cli, PassesGoOnFromTheirCheckpoint) {
  const std::string render = "render colour-bleed --width 48 --height 36 --photons 3000 ";
  expectRefusal(render + "-o a.exr --checkpoint kept.exr", 2, "give --passes or --time");
  expectRefusal(render + "-o a.exr --progressive", 2, "give --passes or --time");
  expectRefusal(render + "-o a.exr --passes 2 --checkpoint kept.png", 2, "ends in .exr");
  expectRefusal(render + "-o a.exr --passes 2 --checkpoint ./a.exr", 2, "names the picture's own file");
  expectRefusal(render + "-o a.exr --passes 0", 2, "frame.passes must be");

  ASSERT_EQ(run(render + "--passes 4 -o whole.exr").code, 0);
  const std::string kept = render + "--checkpoint kept.exr -o a.exr ";
  ASSERT_EQ(run(kept + "--passes 2").code, 0);
  const ProgramRun second = run(kept + "--passes 4 --progressive --stats s.json");
  EXPECT_EQ(second.code, 0);
  EXPECT_EQ(nlohmann::json::parse(readFile(folder_.path() / "s.json"))["counters"]["passes"], 4);
  EXPECT_TRUE(readFile(folder_.path() / "a.exr") == readFile(folder_.path() / "whole.exr"));
  const ProgramRun other = run(kept + "--passes 8 --seed 3");
  EXPECT_EQ(other.code, 1);
  EXPECT_THAT(other.errors, HasSubstr("frame.seed is 0 there and 3 now"));
}

TEST_F(Cli, InterruptedPassesAreKept) {
  const std::string render = "render colour-bleed --width 48 --height 36 --photons 3000 ";
  const ProgramRun result = run(render + "--time 1000 --checkpoint kept.exr --progressive -o a.png",
                                "timeout --preserve-status --signal=INT 2");
  EXPECT_EQ(result.code, 130);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "kept.exr"));
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "a.png"));
  // Time is short, so nothing is added to the passes that were kept.
  ASSERT_EQ(run(render + "--time 0.001 --checkpoint kept.exr -o a.png --stats s.json").code, 0);
  const Film kept = readFilm(folder_.path() / "kept.exr");
  const auto passes = std::find_if(kept.metadata.begin(), kept.metadata.end(),
                                   [](const auto& entry) { return entry.first == "checkpoint.passes"; });
  ASSERT_NE(passes, kept.metadata.end());
  EXPECT_GT(std::stoi(passes->second), 1);
}

}  // namespace
}  // namespace isophote
