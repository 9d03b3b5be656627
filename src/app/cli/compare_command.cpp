// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/cli/command.h"
#include "base/error.h"
#include "base/files.h"
#include "image/compare.h"
#include "image/files.h"

#include <cstdio>
#include <filesystem>
#include <memory>

namespace isophote::cli {
namespace {

struct CompareOptions {
  std::filesystem::path a;
  std::filesystem::path b;
  std::string layer;
  std::filesystem::path difference;
  bool json = false;
};

Film differenceOf(const Image& a, const Image& b) {
  Film film;
  film.colour = Image(a.width, a.height);
  for (std::size_t i = 0; i < a.pixels.size(); ++i) film.colour.pixels[i] = abs(a.pixels[i] - b.pixels[i]);
  return film;
}

void compare(const CompareOptions& options, Host& host) {
  if (!options.difference.empty()) {
    requireFilmFormat(options.difference);
    requireWritable(options.difference);
  }
  const Film filmA = readFilm(options.a), filmB = readFilm(options.b);
  const Image& a = selectLayer(filmA, options.layer, options.a.string());
  const Image& b = selectLayer(filmB, options.layer, options.b.string());
  const Comparison comparison = compareImages(a, b);
  if (!options.difference.empty()) writeFilm(options.difference, differenceOf(a, b));
  if (options.json) {
    fmt::print("{}\n", toJson(comparison));
    return;
  }
  fmt::print("psnr       {:.2f} dB\nssim       {:.4f}\nrelMse     {:.4g}\nmeanRatio  {:.5f}\n",
             comparison.psnr, comparison.ssim, comparison.relMse, comparison.meanRatio);
  if (comparison.nonFiniteA + comparison.nonFiniteB > 0)
    host.console.warn(fmt::format("{} pixels of {} and {} of {} are not finite", comparison.nonFiniteA,
                                  options.a.string(), comparison.nonFiniteB, options.b.string()));
}

}  // namespace

Command addCompare(CLI::App& program) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App& parser = *program.add_subcommand("compare", "Tell how close a picture is to another one");
  parser.add_option("A", options->a, "Picture: .exr, .png or .jpg")->required();
  parser.add_option("B", options->b, "Picture that it is compared with")->required();
  parser.add_flag("--json", options->json, "Print JSON");
  parser.add_option("--layer", options->layer, "Compare this layer of two .exr files, for example indirect")
      ->type_name("NAME");
  parser
      .add_option("--diff", options->difference,
                  "Write the absolute difference of linear values: .exr or .png")
      ->type_name("FILE");
  parser.footer(
      "\npsnr and ssim judge the pictures as shown (no exposure, no tone map, clamped, sRGB); relMse and "
      "meanRatio, the\n"
      "mean of A over the mean of B, judge linear values.\n"
      "\nExamples:\n"
      "  isophote compare photons.exr reference.exr\n"
      "  isophote compare photons.exr reference.exr --layer indirect --json");
  return {&parser, [options](Host& host) { compare(*options, host); }};
}

}  // namespace isophote::cli
