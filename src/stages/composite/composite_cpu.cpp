// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/composite/composite.h"

#include <tbb/parallel_for.h>

namespace isophote {

namespace {

struct Layers {
  Image& colour;
  Image& direct;
  Image& indirect;
};

void sizeFilm(const ViewSamples& view, Film& film) {
  if (film.colour.width == view.width && film.colour.height == view.height) return;
  film.colour = Image(view.width, view.height);
  for (const char* layer : {"direct", "indirect", "emitted", "albedo", "normal", "depth"})
    film.layers[layer] = Image(view.width, view.height);
}

void addTile(const Composite::In& in, std::size_t index, Layers layers) {
  const ViewTile& tile = in.view.tiles[index];
  const RadianceTile& direct = in.direct[index];
  const RadianceTile& indirect = in.indirect[index];
  for (int lane = 0; lane < kTileLanes; ++lane) {
    const std::uint32_t pixel = tile.pixel[lane];
    if (pixel == kNoPixel) continue;
    const vec3 weight =
        vec3(tile.throughputR[lane], tile.throughputG[lane], tile.throughputB[lane]) * in.weight;
    const vec3 d = weight * vec3(direct.r[lane], direct.g[lane], direct.b[lane]);
    const vec3 i = weight * vec3(indirect.r[lane], indirect.g[lane], indirect.b[lane]);
    layers.direct.pixels[pixel] += d;
    layers.indirect.pixels[pixel] += i;
    layers.colour.pixels[pixel] += d + i;
  }
}

void addImage(const Image& source, float weight, Image& target) {
  tbb::parallel_for(std::size_t(0), source.pixels.size(),
                    [&](std::size_t i) { target.pixels[i] += source.pixels[i] * weight; });
}

}  // namespace

void Composite::run(const In& in, Film& film, Stats& stats, const Job& job) const {
  const auto scope = stats.scope("composite");
  sizeFilm(in.view, film);
  const Layers layers{film.colour, film.layers["direct"], film.layers["indirect"]};
  // Primary tiles own their pixels; what mirrors and glass add to a pixel comes from many tiles, so in their
  // order.
  tbb::parallel_for(std::size_t(0), in.view.primaryTiles, [&](std::size_t i) { addTile(in, i, layers); });
  for (std::size_t i = in.view.primaryTiles; i < in.view.tiles.size(); ++i) addTile(in, i, layers);
  addImage(in.view.emitted, in.weight, film.colour);
  addImage(in.view.emitted, in.weight, film.layers["emitted"]);
  addImage(in.view.albedo, in.weight, film.layers["albedo"]);
  addImage(in.view.normal, in.weight, film.layers["normal"]);
  addImage(in.view.depth, in.weight, film.layers["depth"]);
  job.throwIfStopped();
}

}  // namespace isophote
