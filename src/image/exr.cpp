// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/exr.h"

#include "base/error.h"
#include "image/decode.h"
#include "image/exr_header.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>

namespace isophote {

namespace {

namespace imf = OPENEXR_IMF_NAMESPACE;
using Box = IMATH_NAMESPACE::Box2i;

constexpr std::string_view kMetadataPrefix = "isophote.";
/// No threads but the caller's: the library's pool is global to the process and not ours to set up.
constexpr int kThreads = 0;
/// ZIP compresses this many lines as one chunk; a band, the work of one task, is a few chunks.
constexpr int kChunkLines = 16;
constexpr int kBandLines = 4 * kChunkLines;

class MemoryOutput : public imf::OStream {
 public:
  MemoryOutput() : imf::OStream("film") {}
  void write(const char from[], int count) override {
    const std::size_t end = position_ + std::size_t(count);
    if (end > bytes.size()) bytes.resize(end);
    std::memcpy(bytes.data() + position_, from, std::size_t(count));
    position_ = end;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = std::size_t(position); }

  std::vector<std::uint8_t> bytes;

 private:
  std::size_t position_ = 0;
};

class MemoryInput : public imf::IStream {
 public:
  explicit MemoryInput(std::span<const std::byte> bytes) : imf::IStream("film"), bytes_(bytes) {}
  bool read(char to[], int count) override {
    if (count < 0 || position_ > bytes_.size() || std::size_t(count) > bytes_.size() - position_) {
      throw std::runtime_error("it is truncated");
    }
    std::memcpy(to, bytes_.data() + position_, std::size_t(count));
    position_ += std::size_t(count);
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override { position_ = std::size_t(position); }

 private:
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
};

/// Names of the channels that hold a layer's x, y and z; a layer of one number a pixel has one name.
std::string_view componentNames(std::string_view layer) {
  if (layer == "normal") return "XYZ";
  if (layer == "depth") return "Z";
  if (layer == "density" || layer == "flip") return "Y";
  return "RGB";
}

/// Describes one image to the library, which only reads it in spite of the type that it takes.
void addChannels(const std::string& layer, const Image& image, imf::Header& header, imf::FrameBuffer& frame) {
  const std::string_view names = componentNames(layer);
  auto* base = const_cast<char*>(reinterpret_cast<const char*>(image.pixels.data()));
  for (std::size_t c = 0; c < names.size(); ++c) {
    const std::string name = layer.empty() ? std::string(1, names[c]) : layer + "." + names[c];
    header.channels().insert(name, imf::Channel(imf::FLOAT));
    frame.insert(name, imf::Slice(imf::FLOAT, base + c * sizeof(float), sizeof(vec3),
                                  sizeof(vec3) * std::size_t(image.width)));
  }
}

/// A file of the lines [y0, y1) as the library writes it; with no lines, a header and a table of zeros.
std::vector<std::uint8_t> encodeLines(const imf::Header& header, const imf::FrameBuffer& frame, int y0,
                                      int y1) {
  imf::Header band = header;
  if (y1 > y0) {
    band.dataWindow().min.y = y0;
    band.dataWindow().max.y = y1 - 1;
  }
  MemoryOutput output;
  {
    imf::OutputFile file(output, band, kThreads);
    if (y1 > y0) {
      file.setFrameBuffer(frame);
      file.writePixels(y1 - y0);
    }
  }  // The table of chunks is written now.
  return std::move(output.bytes);
}

std::uint64_t readOffset(const std::uint8_t* from) {
  std::uint64_t value = 0;
  for (int i = 7; i >= 0; --i) value = value << 8 | from[i];
  return value;
}

void writeOffset(std::uint8_t* to, std::uint64_t value) {
  for (int i = 0; i < 8; ++i) to[i] = std::uint8_t(value >> (8 * i));
}

/// Compresses bands of lines in parallel, each as a small file, and joins them. A file is a header, whose
/// length does not depend on the lines, a table with the 8-byte offset of each chunk, and the chunks, which
/// know their lines.
std::vector<std::uint8_t> encodeInBands(const imf::Header& header, const imf::FrameBuffer& frame) {
  const int height = header.dataWindow().max.y + 1;
  std::vector<std::vector<std::uint8_t>> bands(std::size_t((height + kBandLines - 1) / kBandLines));
  tbb::parallel_for(std::size_t(0), bands.size(), [&](std::size_t i) {
    const int y0 = int(i) * kBandLines;
    bands[i] = encodeLines(header, frame, y0, std::min(y0 + kBandLines, height));
  });
  std::vector<std::uint8_t> file = encodeLines(header, frame, 0, 0);
  const auto chunksOf = [](int lines) { return std::size_t((lines + kChunkLines - 1) / kChunkLines); };
  const std::size_t headerBytes = file.size() - 8 * chunksOf(height);
  std::size_t entry = headerBytes;
  for (std::size_t i = 0; i < bands.size(); ++i) {
    const std::size_t chunks = chunksOf(std::min(kBandLines, height - int(i) * kBandLines));
    const std::size_t start = headerBytes + 8 * chunks;
    for (std::size_t chunk = 0; chunk < chunks; ++chunk, entry += 8) {
      writeOffset(&file[entry], readOffset(&bands[i][headerBytes + 8 * chunk]) - start + file.size());
    }
    file.insert(file.end(), bands[i].begin() + std::ptrdiff_t(start), bands[i].end());
    std::vector<std::uint8_t>().swap(bands[i]);
  }
  return file;
}

}  // namespace

std::vector<std::uint8_t> encodeExr(const Film& film) {
  const Image& colour = film.colour;
  if (colour.width <= 0 || colour.height <= 0)
    fail(ErrorKind::kInternal, "", "a film without pixels cannot be saved");
  try {
    imf::Header header(colour.width, colour.height);
    header.compression() = imf::ZIP_COMPRESSION;
    for (const auto& [key, value] : film.metadata) {
      header.insert(std::string(kMetadataPrefix) + key, imf::StringAttribute(value));
    }
    imf::FrameBuffer frame;
    addChannels("", colour, header, frame);
    for (const auto& [name, image] : film.layers) {
      if (name.empty() || image.width != colour.width || image.height != colour.height) {
        fail(ErrorKind::kInternal, name, "a layer needs a name and the size of the picture");
      }
      addChannels(name, image, header, frame);
    }
    return encodeInBands(header, frame);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    fail(ErrorKind::kResources, "", "memory does not suffice to encode the film as OpenEXR");
  } catch (const std::exception& problem) {
    fail(ErrorKind::kInternal, "", "the film could not be encoded as OpenEXR: {}", problem.what());
  }
}

namespace {

constexpr int kEveryComponent = -1;

/// One channel of the file and the component of the layer that it fills.
struct Source {
  std::string channel;
  int component = 0;
};

using Plan = std::map<std::string, std::vector<Source>>;

struct Leaf {
  std::string name;  ///< The channel's name after its last dot, in upper case.
  std::string channel;
};

/// Sorts channels by layer; alpha is left out, and a top-level Z is the layer "depth".
std::map<std::string, std::vector<Leaf>> groupByLayer(const imf::ChannelList& channels) {
  std::map<std::string, std::vector<Leaf>> groups;
  for (auto it = channels.begin(); it != channels.end(); ++it) {
    const std::string channel = it.name();
    const std::size_t dot = channel.rfind('.');
    std::string layer = dot == std::string::npos ? "" : channel.substr(0, dot);
    std::string leaf = dot == std::string::npos ? channel : channel.substr(dot + 1);
    std::transform(leaf.begin(), leaf.end(), leaf.begin(),
                   [](unsigned char c) { return char(std::toupper(c)); });
    if (leaf == "A") continue;
    if (layer.empty() && leaf == "Z") layer = "depth";
    groups[layer].push_back({leaf, channel});
  }
  return groups;
}

/// Decides which layers the film gets. A channel that is neither a colour, a coordinate nor alone in its
/// layer becomes a layer of its own, under its full name.
Plan planLayers(const imf::ChannelList& channels) {
  Plan plan;
  for (const auto& [layer, leaves] : groupByLayer(channels)) {
    const auto isColour = [](const Leaf& leaf) {
      return leaf.name == "R" || leaf.name == "G" || leaf.name == "B";
    };
    const bool coloured = std::any_of(leaves.begin(), leaves.end(), isColour);
    const bool alone = leaves.size() == 1 && !coloured && (!layer.empty() || leaves[0].name == "Y");
    const std::string_view names = coloured ? "RGB" : layer.empty() ? "Y" : "XYZ";
    for (const Leaf& leaf : leaves) {
      const std::size_t component = leaf.name.size() == 1 ? names.find(leaf.name[0]) : std::string_view::npos;
      if (alone || (names == "Y" && component == 0)) {
        plan[layer].push_back({leaf.channel, kEveryComponent});
      } else if (component != std::string_view::npos) {
        plan[layer].push_back({leaf.channel, int(component)});
      } else {
        plan[leaf.channel].push_back({leaf.channel, kEveryComponent});
      }
    }
  }
  return plan;
}

/// Reads the planned layers, each as large as the data window.
std::map<std::string, Image> readLayers(imf::InputFile& file, const Plan& plan) {
  const Box window = file.header().dataWindow();
  const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
  std::map<std::string, Image> layers;
  imf::FrameBuffer frame;
  for (const auto& [layer, sources] : plan) {
    Image& image = layers.emplace(layer, Image(width, height)).first->second;
    for (const Source& source : sources) {
      float* base = &image.pixels[0].x + std::max(source.component, 0);
      frame.insert(source.channel, imf::Slice::Make(imf::FLOAT, base, window, sizeof(vec3),
                                                    sizeof(vec3) * std::size_t(width)));
    }
  }
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  for (const auto& [layer, sources] : plan) {
    const auto repeats = [](const Source& source) { return source.component == kEveryComponent; };
    if (!std::any_of(sources.begin(), sources.end(), repeats)) continue;
    for (vec3& pixel : layers.at(layer).pixels) pixel = vec3(pixel.x);
  }
  return layers;
}

/// What of the data window lies in the display window, in an image of the display window's size.
Image placed(Image&& image, const Box& data, const Box& display) {
  if (data == display) return std::move(image);
  Image result(display.max.x - display.min.x + 1, display.max.y - display.min.y + 1);
  const int x0 = std::max(data.min.x, display.min.x), x1 = std::min(data.max.x, display.max.x);
  const int y0 = std::max(data.min.y, display.min.y), y1 = std::min(data.max.y, display.max.y);
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      result.at(x - display.min.x, y - display.min.y) = image.at(x - data.min.x, y - data.min.y);
    }
  }
  return result;
}

/// The layer that is the picture: the one without a name, else the first with colours, else the first.
std::string pictureLayer(const Plan& plan) {
  if (plan.contains("")) return "";
  for (const auto& [layer, sources] : plan) {
    if (sources.size() == 3) return layer;
  }
  return plan.begin()->first;
}

void requireBudget(const Plan& plan, const Box& data, const Box& display, std::string_view subject,
                   std::uint64_t budgetBytes) {
  const auto pixels = [](const Box& box) {
    return (double(box.max.x) - double(box.min.x) + 1.0) * (double(box.max.y) - double(box.min.y) + 1.0);
  };
  // The picture may be a copy of a named layer.
  const double layers = double(plan.size() + 1);
  const double needed =
      layers * double(sizeof(vec3)) * (pixels(data) + (data == display ? 0.0 : pixels(display)));
  if (needed <= double(budgetBytes)) return;
  fail(ErrorKind::kResources, subject, "takes {:.0f} bytes to read where {} are allowed", needed,
       budgetBytes);
}

Film readFilmFrom(imf::InputFile& file, std::string_view subject, std::uint64_t budgetBytes) {
  const imf::Header& header = file.header();
  const Box data = header.dataWindow(), display = header.displayWindow();
  const Plan plan = planLayers(header.channels());
  if (plan.empty()) failInput(subject, "holds no channel but alpha; a picture needs R, G, B or Y");
  requireBudget(plan, data, display, subject, budgetBytes);

  Film film;
  film.layers = readLayers(file, plan);
  for (auto& [name, image] : film.layers) image = placed(std::move(image), data, display);
  const std::string picture = pictureLayer(plan);
  if (picture.empty()) {
    film.colour = std::move(film.layers.extract("").mapped());
  } else {
    film.colour = film.layers.at(picture);
  }
  for (auto it = header.begin(); it != header.end(); ++it) {
    const std::string_view name = it.name();
    const auto* text = dynamic_cast<const imf::StringAttribute*>(&it.attribute());
    if (!text || !name.starts_with(kMetadataPrefix)) continue;
    film.metadata.emplace_back(name.substr(kMetadataPrefix.size()), text->value());
  }
  return film;
}

}  // namespace

Film decodeExr(std::span<const std::byte> bytes, std::string_view subject, std::uint64_t budgetBytes) {
  if (formatOf(bytes) != "OpenEXR") failInput(subject, "is not an OpenEXR file");
  requireSaneExrHeader(bytes, subject, budgetBytes);
  try {
    MemoryInput input(bytes);
    imf::InputFile file(input, kThreads);
    return readFilmFrom(file, subject, budgetBytes);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    fail(ErrorKind::kResources, subject, "memory does not suffice to read it");
  } catch (const std::exception& problem) {
    failInput(subject, "is not a readable OpenEXR file: {}", problem.what());
  }
}

}  // namespace isophote
