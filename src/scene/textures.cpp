// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/textures.h"

#include "base/error.h"
#include "base/files.h"
#include "image/decode.h"
#include "image/radiance.h"
#include "image/tonemap.h"
#include "scene/texture_convert.h"

#include <tbb/parallel_for.h>

#include <atomic>
#include <exception>

namespace isophote {

namespace {

/// What a source holds, and how errors name it.
struct Encoded {
  std::string file;  ///< Its bytes where it was read from a file.
  std::span<const std::byte> bytes;
  std::string subject;
};

Encoded readEncoded(const std::filesystem::path& file, const std::string& model, std::uint64_t budgetBytes) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored))
    failInput(model, "the texture {} is missing; put it there, or take it out of the model", file.string());
  Encoded encoded;
  encoded.file = readFile(file, budgetBytes);
  encoded.subject = fmt::format("{}: texture {}", model, file.string());
  return encoded;
}

/// Linear values in 8 bits: sRGB-encoded where colours are meant, as other textures are.
DecodedImage in8Bits(const Image& image, bool srgb) {
  DecodedImage result;
  result.width = image.width;
  result.height = image.height;
  result.rgba.resize(image.pixels.size() * 4);
  std::uint8_t* to = result.rgba.data();
  for (const vec3 texel : image.pixels) {
    for (int k = 0; k < 3; ++k) {
      const float value = min(texel[k], 1.0f);
      *to++ = std::uint8_t((srgb ? srgbFromLinear(value) : value) * 255.0f + 0.5f);
    }
    *to++ = 255;
  }
  return result;
}

DecodedImage decode8Bit(const Encoded& encoded, bool srgb, std::uint64_t budgetBytes) {
  const auto bytes = encoded.file.empty() ? encoded.bytes : std::as_bytes(std::span(encoded.file));
  if (!holdsRadiance(bytes)) return decodeImage(bytes, encoded.subject, budgetBytes);
  return in8Bits(decodeRadiance(bytes, encoded.subject, budgetBytes), srgb);
}

/// Writes the red channel of `alpha`, brought to the other's size by its nearest texels, into alpha.
void replaceAlpha(DecodedImage& image, const DecodedImage& alpha) {
  for (int y = 0; y < image.height; ++y) {
    const auto fromY = std::size_t(std::int64_t(y) * alpha.height / image.height);
    for (int x = 0; x < image.width; ++x) {
      const auto fromX = std::size_t(std::int64_t(x) * alpha.width / image.width);
      image.rgba[(std::size_t(y) * std::size_t(image.width) + std::size_t(x)) * 4 + 3] =
          alpha.rgba[(fromY * std::size_t(alpha.width) + fromX) * 4];
    }
  }
}

}  // namespace

int TextureSet::addFile(const std::filesystem::path& file, const TextureUse& use,
                        const std::filesystem::path& alphaFile) {
  std::error_code ignored;
  const auto key = [&](const std::filesystem::path& path) {
    const std::filesystem::path canonical = std::filesystem::weakly_canonical(path, ignored);
    return (canonical.empty() ? path : canonical).string();
  };
  Source source{};
  source.file = file;
  source.alphaFile = alphaFile;
  const std::string both = alphaFile.empty() ? key(file) : key(file) + "\n" + key(alphaFile);
  return add(std::move(source), both, file.filename().string(), use);
}

int TextureSet::addEncoded(std::span<const std::byte> bytes, const std::string& name, const TextureUse& use) {
  Source source{};
  source.bytes = bytes;
  return add(std::move(source), "\n" + name, name, use);
}

int TextureSet::add(Source source, const std::string& key, const std::string& name, const TextureUse& use) {
  const std::string keyOfUse =
      fmt::format("{}\n{}{}{}{}{} {} {}", key, use.srgb, int(use.wrapU), int(use.wrapV), use.nearest,
                  use.emission, int(use.meaning), use.meaningScale);
  const auto [entry, isNew] = known_.try_emplace(keyOfUse, int(scene_.textures.size()));
  if (isNew) {
    Texture texture;
    texture.name = name;
    texture.srgb = use.srgb;
    texture.wrapU = use.wrapU;
    texture.wrapV = use.wrapV;
    texture.nearest = use.nearest;
    scene_.textures.push_back(std::move(texture));
    source.texture = entry->second;
    source.use = use;
    sources_.push_back(std::move(source));
  }
  return entry->second;
}

Texture TextureSet::decodeOne(const Source& source, std::uint64_t budgetBytes) const {
  Texture texture = scene_.textures[std::size_t(source.texture)];
  Encoded encoded;
  if (source.file.empty()) {
    encoded.bytes = source.bytes;
    encoded.subject = fmt::format("{}: texture {}", model_, texture.name);
  } else {
    encoded = readEncoded(source.file, model_, budgetBytes);
  }
  const auto bytes = source.file.empty() ? encoded.bytes : std::as_bytes(std::span(encoded.file));
  if (source.use.emission && holdsRadiance(bytes)) {
    const Image image = decodeRadiance(bytes, encoded.subject, budgetBytes);
    texture.width = image.width;
    texture.height = image.height;
    texture.floats.assign(image.pixels.begin(), image.pixels.end());
    return texture;
  }
  DecodedImage image = decode8Bit(encoded, texture.srgb, budgetBytes);
  if (!source.alphaFile.empty())
    replaceAlpha(image, decode8Bit(readEncoded(source.alphaFile, model_, budgetBytes), false, budgetBytes));
  if (source.use.meaning == TextureMeaning::kHeights) normalsFromHeights(image, source.use.meaningScale);
  if (source.use.meaning == TextureMeaning::kExponents)
    roughnessFromExponents(image, source.use.meaningScale);
  texture.width = image.width;
  texture.height = image.height;
  texture.rgba = std::move(image.rgba);
  return texture;
}

void TextureSet::decode(const Job& job) {
  // The first image at fault is named whatever the number of threads: each keeps its own error.
  std::vector<std::exception_ptr> errors(sources_.size());
  std::atomic<std::uint64_t> usedBytes{0};
  std::atomic<std::size_t> done{0};
  tbb::parallel_for(std::size_t(0), sources_.size(), [&](std::size_t i) {
    try {
      job.throwIfStopped();
      const std::uint64_t used = usedBytes.load();
      const std::uint64_t left = job.memoryBudgetBytes > used ? job.memoryBudgetBytes - used : 0;
      Texture texture = decodeOne(sources_[i], left);
      usedBytes += texture.rgba.size() + texture.floats.size() * sizeof(vec3);
      scene_.textures[std::size_t(sources_[i].texture)] = std::move(texture);
      job.report("textures", double(++done) / double(sources_.size()));
    } catch (...) {
      errors[i] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
  sources_.clear();
}

}  // namespace isophote
