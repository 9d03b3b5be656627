// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/files.h"

#include "base/error.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

namespace isophote {
namespace {

namespace fs = std::filesystem;

/// A folder of its own for each test, removed at its end.
class FilmFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / fmt::format("isophote_films_{}", getpid());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::size_t filesLeft() const {
    return std::size_t(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  static ErrorKind kindOf(const auto& call) {
    try {
      call();
    } catch (const Error& error) {
      return error.kind();
    }
    ADD_FAILURE() << "no error";
    return ErrorKind::kInternal;
  }

  fs::path folder_;
};

Film gradient() {
  Film film;
  film.colour = Image(17, 5);
  for (std::size_t i = 0; i < film.colour.pixels.size(); ++i) {
    film.colour.pixels[i] = vec3(linearFromSrgb8()[i], linearFromSrgb8()[255 - i], linearFromSrgb8()[2 * i]);
  }
  film.layers["direct"] = Image(17, 5, vec3(3.0f));
  film.metadata = {{"seed", "1"}};
  return film;
}

TEST_F(FilmFiles, ExrHoldsEverything) {
  const Film film = gradient();
  writeFilm(folder_ / "film.EXR", film);
  const Film read = readFilm(folder_ / "film.EXR");
  EXPECT_EQ(read.colour.pixels, film.colour.pixels);
  EXPECT_EQ(read.layers.at("direct").pixels, film.layers.at("direct").pixels);
  EXPECT_EQ(read.metadata, film.metadata);
  EXPECT_EQ(filesLeft(), 1u);
}

TEST_F(FilmFiles, PngHoldsThePictureAsShown) {
  // The gradient's values are those of the 8-bit codes, so that they come back exactly.
  writeFilm(folder_ / "film.png", gradient());
  const Film read = readFilm(folder_ / "film.png");
  EXPECT_EQ(read.colour.pixels, gradient().colour.pixels);
  EXPECT_TRUE(read.layers.empty());

  Film grey;
  grey.colour = Image(1, 1, vec3(0.125f));
  writeFilm(folder_ / "film.png", grey, {.exposureEv = 2.0f});
  EXPECT_EQ(readFilm(folder_ / "film.png").colour.at(0, 0).x,
            linearFromSrgb8()[188]);  // 255 * 0.735357 = 187.5
  EXPECT_EQ(filesLeft(), 1u);
}

TEST_F(FilmFiles, OtherEndingsAreRefusedWithoutATrace) {
  EXPECT_EQ(kindOf([&] { writeFilm(folder_ / "film.jpg", gradient()); }), ErrorKind::kBadUsage);
  EXPECT_EQ(kindOf([&] { requireFilmFormat(folder_ / "film"); }), ErrorKind::kBadUsage);
  EXPECT_EQ(kindOf([&] { writeFilm(folder_ / "film.exr", Film()); }), ErrorKind::kInternal);
  EXPECT_EQ(kindOf([&] { writeFilm(folder_ / "missing" / "film.exr", gradient()); }), ErrorKind::kBadInput);
  EXPECT_EQ(filesLeft(), 0u);
}

TEST_F(FilmFiles, UnreadableFilesAreNamed) {
  EXPECT_EQ(kindOf([&] { readFilm(folder_ / "missing.exr"); }), ErrorKind::kBadInput);
  std::ofstream(folder_ / "text.png") << "not a picture at all";
  try {
    readFilm(folder_ / "text.png");
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.subject(), (folder_ / "text.png").string());
  }
}

}  // namespace
}  // namespace isophote
