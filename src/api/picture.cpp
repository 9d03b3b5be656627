// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "isophote/picture.h"

#include "api/content.h"
#include "image/files.h"
#include "settings/apply.h"

#include <fmt/ranges.h>

namespace isophote {

namespace {

static_assert(sizeof(vec3) == 3 * sizeof(float));

std::span<const float> numbersOf(const Image& image) {
  return {&image.pixels.data()->x, image.pixels.size() * 3};
}

DisplayOptions optionsOf(const Display& display) {
  DisplayOptions options;
  options.exposureEv = display.exposureEv;
  options.autoExposure = display.autoExposure;
  setSetting(fieldsOf(options), "toneMap", display.toneMap, {ErrorKind::kBadUsage, "toneMap"});
  return options;
}

}  // namespace

int Picture::width() const { return content_->film.colour.width; }
int Picture::height() const { return content_->film.colour.height; }
std::span<const float> Picture::pixels() const { return numbersOf(content_->film.colour); }

std::vector<std::string> Picture::layerNames() const {
  std::vector<std::string> names;
  for (const auto& [name, image] : content_->film.layers) names.push_back(name);
  return names;
}

std::span<const float> Picture::layer(std::string_view name) const {
  const auto found = content_->film.layers.find(std::string(name));
  if (found == content_->film.layers.end())
    failUsage("", "there is no layer \"{}\"; there is {}", name, fmt::join(layerNames(), ", "));
  return numbersOf(found->second);
}

const std::string& Picture::statsJson() const { return content_->statsJson; }

void Picture::save(const std::filesystem::path& file, const Display& display) const {
  api::guarded([&] {
    requireFilmFormat(file);
    writeFilm(file, content_->film, optionsOf(display));
  });
}

std::vector<unsigned char> Picture::bytes(const Display& display) const {
  return api::guarded([&] { return displayedBytes(content_->film.colour, optionsOf(display)); });
}

}  // namespace isophote
