// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/composite/composite.h"

#include <tbb/parallel_for.h>

#include <array>

namespace isophote {

namespace {

/// Where a pass goes; all but `colour` are null without layers.
struct Target {
  Image* colour;
  Image* direct = nullptr;
  Image* indirect = nullptr;
  Image* emitted = nullptr;
  std::array<Image*, 3> surface{};  ///< albedo, normal, depth
};

void size(Image& image, const ViewSamples& view) {
  image.width = view.width;
  image.height = view.height;
  image.pixels.resize(std::size_t(view.width) * std::size_t(view.height));
}

Target targetIn(const Composite::In& in, Film& film) {
  size(film.colour, in.view);
  Target target{&film.colour};
  if (!in.layers) {
    film.layers.clear();
    return target;
  }
  const auto layer = [&](const char* name) {
    Image& image = film.layers[name];
    size(image, in.view);
    return &image;
  };
  target.direct = layer("direct");
  target.indirect = layer("indirect");
  target.emitted = layer("emitted");
  target.surface = {layer("albedo"), layer("normal"), layer("depth")};
  return target;
}

struct Light {
  vec3 direct, indirect;
};

/// What a lane sends to the eye; 0 where it has no surface.
Light lightOf(const Composite::In& in, std::size_t index, int lane) {
  const ViewTile& tile = in.view.tiles[index];
  if (tile.pixel[lane] == kNoPixel) return {vec3(0.0f), vec3(0.0f)};
  const RadianceTile& direct = in.direct[index];
  const RadianceTile& indirect = in.indirect[index];
  const vec3 weight = throughputOf(tile, lane) * in.weight;
  return {weight * vec3(direct.r[lane], direct.g[lane], direct.b[lane]),
          weight * vec3(indirect.r[lane], indirect.g[lane], indirect.b[lane])};
}

/// A primary tile: it owns its pixels.
void putTile(const Composite::In& in, std::size_t index, const Target& target) {
  const ViewSamples& view = in.view;
  const int x0 = int(index % std::size_t(view.tilesX)) * kTileSide;
  const int y0 = int(index / std::size_t(view.tilesX)) * kTileSide;
  const int columns = std::min(kTileSide, view.width - x0);
  const int rows = std::min(kTileSide, view.height - y0);
  const bool emits = view.emits[index] != 0;
  const auto put = [&](vec3& pixel, vec3 value) { pixel = in.first ? value : pixel + value; };
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const std::size_t pixel = std::size_t(y0 + row) * std::size_t(view.width) + std::size_t(x0 + column);
      const Light light = lightOf(in, index, row * kTileSide + column);
      const vec3 emitted = emits ? view.emitted.pixels[pixel] * in.weight : vec3(0.0f);
      put(target.colour->pixels[pixel], light.direct + light.indirect + emitted);
      if (!target.direct) continue;
      put(target.direct->pixels[pixel], light.direct);
      put(target.indirect->pixels[pixel], light.indirect);
      put(target.emitted->pixels[pixel], emitted);
      put(target.surface[0]->pixels[pixel], view.albedo.pixels[pixel] * in.weight);
      put(target.surface[1]->pixels[pixel], view.normal.pixels[pixel] * in.weight);
      put(target.surface[2]->pixels[pixel], view.depth.pixels[pixel] * in.weight);
    }
}

/// What mirrors and glass add: to pixels all over the picture.
void addTile(const Composite::In& in, std::size_t index, const Target& target) {
  for (int lane = 0; lane < kTileLanes; ++lane) {
    const std::uint32_t pixel = in.view.tiles[index].pixel[lane];
    if (pixel == kNoPixel) continue;
    const Light light = lightOf(in, index, lane);
    target.colour->pixels[pixel] += light.direct + light.indirect;
    if (!target.direct) continue;
    target.direct->pixels[pixel] += light.direct;
    target.indirect->pixels[pixel] += light.indirect;
  }
}

}  // namespace

void Composite::run(const In& in, Film& film, Stats& stats, const Job& job) const {
  const auto scope = stats.scope("composite");
  const Target target = targetIn(in, film);
  tbb::parallel_for(std::size_t(0), in.view.primaryTiles, [&](std::size_t i) {
    if (i + 1 < in.view.primaryTiles) {
      want(in.view.tiles[i + 1].pixel, sizeof(ViewTile::pixel));
      want(&in.direct[i + 1], sizeof(RadianceTile));
      want(&in.indirect[i + 1], sizeof(RadianceTile));
    }
    putTile(in, i, target);
  });
  // In the order of the tiles, because several of them add to one pixel.
  for (std::size_t i = in.view.primaryTiles; i < in.view.tiles.size(); ++i) addTile(in, i, target);
  job.throwIfStopped();
}

}  // namespace isophote
