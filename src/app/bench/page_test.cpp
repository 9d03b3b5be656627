// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The page in a browser: its pictures are shown, and its slider cuts them where it stands.
#include "app/bench/suite.h"
#include "app/bench/writers.h"
#include "image/files.h"
#include "support/browser.h"
#include "support/files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

namespace isophote::bench {
namespace {

using testing::HasSubstr;

/// A red and a green picture beside a blue one.
Report colours() {
  const Image red(64, 32, {1, 0, 0}), green(64, 32, {0, 1, 0}), blue(64, 32, {0, 0, 1});
  Report report;
  report.suite = "colours";
  Section& section = report.sections.emplace_back();
  section.suite = "colours";
  section.description = "Red and green over blue";
  section.pictures = {{.id = "view",
                       .title = "A view",
                       .reference = shownPicture("blue", blue),
                       .pictures = {judgedPicture("red", red, blue), judgedPicture("green", green, blue)}}};
  return report;
}

class BenchPage : public testing::Test {
 protected:
  TestFolder folder_;
  void SetUp() override {
    if (!hasBrowser()) GTEST_SKIP() << kNoBrowser;
    writeFileAtomically(folder_.path() / "page.html", std::string_view(reportHtml(colours())));
  }
  std::string address(const std::string& fragment) const {
    return fmt::format("'file://{}/page.html#{}'", folder_.path().string(), fragment);
  }
  Image screenshot(const std::string& fragment) const {
    runBrowser(folder_.path(), "--window-size=1200,900 --screenshot=shot.png " + address(fragment));
    return readFilm(folder_.path() / "shot.png").colour;
  }
};

/// Pixels of the first channel's colour over those and the blue ones, in the first row that shows either.
std::optional<double> partOver(const Image& shot, int channel) {
  for (int y = 0; y < shot.height; ++y) {
    int over = 0, blue = 0;
    for (int x = 0; x < shot.width; ++x) {
      const vec3 pixel = shot.at(x, y);
      over += pixel[channel] > 0.9f && pixel[2] < 0.1f && pixel[1 - channel] < 0.1f;
      blue += pixel[2] > 0.9f && pixel[0] < 0.1f && pixel[1] < 0.1f;
    }
    if (over + blue > shot.width / 5) return double(over) / double(over + blue);
  }
  return std::nullopt;
}

TEST_F(BenchPage, ShowsAllItsPictures) {
  const std::string dom = runBrowser(folder_.path(), "--dump-dom " + address("cut=25"));
  // The reference, and of each picture: itself, its errors and three parts magnified.
  EXPECT_THAT(dom, HasSubstr("data-pictures=\"11 of 11\""));
  EXPECT_THAT(dom, HasSubstr("--cut: 25%"));
}

TEST_F(BenchPage, CutsThePictureWhereTheSliderStands) {
  // Rounding to pixels, and the bar, which is 2 pixels wide and has a soft edge.
  constexpr double kTolerance = 0.01;
  for (const double cut : {25.0, 80.0}) {
    const std::optional<double> part = partOver(screenshot(fmt::format("cut={}", cut)), 0);
    ASSERT_TRUE(part) << "no picture is shown";
    EXPECT_NEAR(*part, cut / 100, kTolerance);
  }
}

TEST_F(BenchPage, ShowsThePictureThatIsChosen) {
  const Image shot = screenshot("cut=60&picture=1");
  const std::optional<double> part = partOver(shot, 1);
  ASSERT_TRUE(part) << "no picture is shown";
  EXPECT_NEAR(*part, 0.6, 0.01);
  EXPECT_NEAR(partOver(shot, 0).value_or(1), 0.0, 0.01);
}

}  // namespace
}  // namespace isophote::bench
