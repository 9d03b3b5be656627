// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/cli/command.h"
#include "base/error.h"
#include "base/files.h"
#include "image/compare.h"
#include "image/error_colour.h"
#include "image/files.h"
#include "settings/apply.h"

#include <cstdio>
#include <filesystem>
#include <memory>

namespace isophote::cli {
namespace {

struct CompareArguments {
  std::filesystem::path a;
  std::filesystem::path b;
  std::string layer;
  std::filesystem::path difference;
  std::string exposure;
  std::string toneMap;
  std::string pixelsPerDegree;
  bool json = false;
};

struct ViewSettings {
  float pixelsPerDegree = kDefaultPixelsPerDegree;
  void visit(auto&& v) {
    v("pixelsPerDegree", pixelsPerDegree,
      {.help = "Pixels in a degree of the viewer's field of view.", .unit = "px", .min = 1, .max = 1000});
  }
};

CompareOptions compareOptions(const CompareArguments& arguments) {
  CompareOptions options;
  ViewSettings view;
  if (!arguments.exposure.empty()) parseExposure(arguments.exposure, options.display);
  if (!arguments.toneMap.empty())
    setSetting(fieldsOf(options.display), "toneMap", arguments.toneMap, {ErrorKind::kBadUsage, "--tonemap"});
  if (!arguments.pixelsPerDegree.empty())
    setSetting(fieldsOf(view), "pixelsPerDegree", arguments.pixelsPerDegree, {ErrorKind::kBadUsage, "--ppd"});
  options.pixelsPerDegree = view.pixelsPerDegree;
  return options;
}

/// As a picture to look at, the FLIP map in colours; as numbers, the absolute difference of linear values
/// with the map as a layer.
Film differenceOf(const Image& a, const Image& b, const Comparison& comparison, bool asNumbers) {
  Film film;
  if (!asNumbers) {
    film.colour = errorPicture(a.width, a.height, comparison.flipErrors);
    return film;
  }
  film.colour = Image(a.width, a.height);
  for (std::size_t i = 0; i < a.pixels.size(); ++i) film.colour.pixels[i] = abs(a.pixels[i] - b.pixels[i]);
  Image& flip = film.layers["flip"] = Image(a.width, a.height);
  for (std::size_t i = 0; i < flip.pixels.size(); ++i) flip.pixels[i] = vec3(comparison.flipErrors[i]);
  return film;
}

void compare(const CompareArguments& arguments, Host& host) {
  const CompareOptions options = compareOptions(arguments);
  if (!arguments.difference.empty()) {
    requireFilmFormat(arguments.difference);
    requireWritable(arguments.difference);
  }
  const Film filmA = readFilm(arguments.a, host.job.memoryBudgetBytes);
  const Film filmB = readFilm(arguments.b, host.job.memoryBudgetBytes);
  const Image& a = selectLayer(filmA, arguments.layer, arguments.a.string());
  const Image& b = selectLayer(filmB, arguments.layer, arguments.b.string());
  const Comparison comparison = compareImages(a, b, options);
  if (!arguments.difference.empty()) {
    const bool asNumbers = filmFormat(arguments.difference) == FilmFormat::kExr;
    writeFilm(arguments.difference, differenceOf(a, b, comparison, asNumbers));
  }
  if (arguments.json) {
    fmt::print("{}\n", toJson(comparison));
    return;
  }
  fmt::print(
      "psnr       {:.2f} dB\nssim       {:.4f}\nflip       {:.4f}\nrelMse     {:.4g}\nmeanRatio  {:.5f}\n",
      comparison.psnr, comparison.ssim, comparison.flip, comparison.relMse, comparison.meanRatio);
  if (comparison.nonFiniteA + comparison.nonFiniteB > 0)
    host.console.warn(fmt::format("{} pixels of {} and {} of {} are not finite", comparison.nonFiniteA,
                                  arguments.a.string(), comparison.nonFiniteB, arguments.b.string()));
}

}  // namespace

Command addCompare(CLI::App& program) {
  auto arguments = std::make_shared<CompareArguments>();
  CLI::App& parser = *program.add_subcommand("compare", "Tell how close a picture is to another one");
  parser.add_option("A", arguments->a, "Picture: .exr, .png or .jpg")->required();
  parser.add_option("B", arguments->b, "Picture that it is compared with")->required();
  parser.add_flag("--json", arguments->json, "Print JSON");
  parser
      .add_option("--layer", arguments->layer, "Compare this layer of two .exr files, for example indirect")
      ->type_name("NAME");
  parser
      .add_option("--diff", arguments->difference,
                  "Write where they differ: .png, flip in colours; .exr, the absolute difference of linear "
                  "values and flip as a layer")
      ->type_name("FILE");
  parser
      .add_option("--exposure", arguments->exposure, "Judge them as shown 2^EV brighter, or auto for B [0]")
      ->type_name("EV")
      ->take_last();
  parser
      .add_option("--tonemap", arguments->toneMap,
                  "Judge them as shown with this curve: none, aces or reinhard [none]")
      ->type_name("NAME")
      ->take_last();
  parser
      .add_option("--ppd", arguments->pixelsPerDegree,
                  "Pixels in a degree of the viewer's field of view, for flip [67]")
      ->type_name("N")
      ->take_last();
  parser.footer(
      "\npsnr, ssim and flip judge the pictures as shown (no exposure, no tone map, clamped, sRGB, unless "
      "told);\n"
      "relMse and meanRatio, the mean of A over the mean of B, judge linear values. flip is how much a "
      "viewer who\n"
      "switches between the pictures sees change, 0 to 1 (Andersson et al. 2020).\n"
      "\nExamples:\n"
      "  isophote compare photons.exr reference.exr\n"
      "  isophote compare photons.exr reference.exr --layer indirect --json\n"
      "  isophote compare photons.exr reference.exr --diff where.png");
  return {&parser, [arguments](Host& host) { compare(*arguments, host); }};
}

}  // namespace isophote::cli
