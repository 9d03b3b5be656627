// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf_document.h"

#include "base/files.h"
#include "base/json_keys.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace isophote {

static_assert(std::endian::native == std::endian::little, "glTF's buffers are read as they are");

namespace {

/// Most memory that a byte of JSON takes once it is read: of "[[[", a value and its array for each.
constexpr std::uint64_t kJsonExpansion = 48;
constexpr std::uint32_t kGlbMagic = 0x46546C67;   // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kBinChunk = 0x004E4942;   // "BIN"

constexpr std::array<std::string_view, 12> kArrays{"accessors", "bufferViews", "buffers",  "cameras",
                                                   "images",    "materials",   "meshes",   "nodes",
                                                   "samplers",  "scenes",      "textures", "skins"};

std::uint32_t word(const std::string& bytes, std::size_t offset) {
  std::uint32_t value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

std::span<const std::byte> bytesOf(std::string_view text) { return std::as_bytes(std::span(text)); }

/// Value of a base64 digit, -1 for anything else; takes the URL-safe alphabet too.
int base64Digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;
  if (c == '/' || c == '_') return 63;
  return -1;
}

std::optional<std::string> decodeBase64(std::string_view text) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  std::size_t count = 0;
  for (const char c : text) {
    const int digit = base64Digit(c);
    if (digit < 0) return std::nullopt;
    bits = (bits << 6) | std::uint32_t(digit);
    // Every digit after a group's first completes a byte.
    const int place = int(count++ % 4);
    if (place > 0) bytes.push_back(char((bits >> (6 - 2 * place)) & 0xFF));
  }
  if (count % 4 == 1) return std::nullopt;
  return bytes;
}

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// Turns "a%20b" into "a b"; a % that starts no code stays.
std::string decodePercent(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool isCode =
        text[i] == '%' && i + 2 < text.size() && hexDigit(text[i + 1]) >= 0 && hexDigit(text[i + 2]) >= 0;
    decoded += isCode ? char(hexDigit(text[i + 1]) * 16 + hexDigit(text[i + 2])) : text[i];
    if (isCode) i += 2;
  }
  return decoded;
}

std::string decodeDataUri(const JsonValue& uri) {
  const std::string text = uri.string();
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos || text.substr(0, comma).find(";base64") == std::string::npos)
    uri.fail("is a data URI, but not of the form data:...;base64,...");
  std::optional<std::string> bytes = decodeBase64(std::string_view(text).substr(comma + 1));
  if (!bytes) uri.fail("is not valid base64");
  return std::move(*bytes);
}

nlohmann::json parse(std::string_view text, const std::string& file, std::uint64_t budgetBytes) {
  if (text.size() * kJsonExpansion > budgetBytes)
    fail(ErrorKind::kResources, file, "its {} bytes of JSON need more than the memory budget of {} MiB",
         text.size(), budgetBytes >> 20);
  try {
    nlohmann::json json = nlohmann::json::parse(text);
    requireUniqueKeys(text, file);
    return json;
  } catch (const nlohmann::json::parse_error& error) {
    failInput(file, "its JSON is broken or cut off at byte {} of {}", error.byte, text.size());
  } catch (const nlohmann::json::exception&) {
    failInput(file, "its JSON holds a number that is out of range");
  }
}

void requireVersion2(const JsonValue& root) {
  const std::string version = root.at("asset").at("version").string();
  if (version.rfind("2.", 0) != 0)
    root.fail("is glTF version \"{}\", but only version 2 can be read; export the model as glTF 2.0",
              version);
}

}  // namespace

bool isDataUri(std::string_view uri) { return uri.substr(0, 5) == "data:"; }

GltfDocument::GltfDocument(const std::filesystem::path& path, std::uint64_t budgetBytes)
    : path_(path), file_(path.string()) {
  splitContainer(budgetBytes);
  if (!json_.is_object()) failInput(file_, "is not a glTF file: its JSON is no object");
  requireVersion2(root());
  for (const std::string_view name : kArrays) {
    const std::optional<JsonValue> found = root().find(name);
    arrays_.emplace_back(name, found ? found->elements() : std::vector<JsonValue>());
  }
  const std::vector<JsonValue>& buffers = array("buffers");
  for (std::size_t i = 0; i < buffers.size(); ++i) loadBuffer(buffers[i], i, budgetBytes);
}

void GltfDocument::splitContainer(std::uint64_t budgetBytes) {
  const std::string& bytes = blobs_.emplace_back(readFile(path_, budgetBytes));
  if (bytes.size() >= 4 && word(bytes, 0) == kGlbMagic) {
    std::string_view json;
    splitGlb(bytes, json);
    json_ = parse(json, file_, budgetBytes);
    return;
  }
  std::string extension = path_.extension().string();
  if (extension == ".glb" || extension == ".GLB")
    failInput(file_, "is not a .glb file: it does not begin with \"glTF\"");
  // A byte order mark is skipped by the parser.
  json_ = parse(bytes, file_, budgetBytes);
  blobs_.pop_back();
}

void GltfDocument::splitGlb(const std::string& bytes, std::string_view& json) {
  if (bytes.size() < 20)
    failInput(file_, "is cut off: a .glb file has at least 20 bytes, this one {}", bytes.size());
  if (word(bytes, 4) != 2)
    failInput(file_, "is a .glb file of version {}, but only version 2 can be read", word(bytes, 4));
  const std::uint64_t total = word(bytes, 8);
  if (total > bytes.size())
    failInput(file_, "is cut off: its header says {} bytes, but it has {}", total, bytes.size());
  std::uint64_t offset = 12;
  for (int chunk = 0; offset + 8 <= total; ++chunk) {
    const std::uint64_t length = word(bytes, offset);
    const std::uint32_t type = word(bytes, offset + 4);
    if (length > total - offset - 8)
      failInput(file_, "chunk {} says {} bytes, but only {} follow", chunk, length, total - offset - 8);
    const std::string_view content = std::string_view(bytes).substr(offset + 8, length);
    if (chunk == 0 && type != kJsonChunk) failInput(file_, "its first chunk is not JSON");
    if (chunk == 0) json = content;
    if (chunk == 1 && type == kBinChunk) binaryChunk_ = bytesOf(content);
    offset += 8 + length;
  }
}

void GltfDocument::loadBuffer(const JsonValue& buffer, std::size_t index, std::uint64_t budgetBytes) {
  const std::uint64_t byteLength = wholeNumber(buffer, "byteLength");
  std::span<const std::byte> bytes;
  std::string source = "the binary chunk";
  if (const std::optional<JsonValue> uri = buffer.find("uri")) {
    const std::string text = uri->string();
    if (isDataUri(text)) {
      bytes = dataUriBytes(*uri);
      source = "its data URI";
    } else {
      const std::filesystem::path file = fileOf(*uri);
      std::error_code ignored;
      if (!std::filesystem::exists(file, ignored))
        uri->fail("the file {} is missing; put it there", file.string());
      bytes = bytesOf(blobs_.emplace_back(readFile(file, budgetBytes)));
      source = file.string();
    }
  } else {
    if (index != 0 || !binaryChunk_) buffer.fail("has no uri, and there is no binary chunk for it");
    bytes = *binaryChunk_;
  }
  if (bytes.size() < byteLength)
    buffer.fail("says {} bytes, but {} has {}: it is cut off or of another version", byteLength, source,
                bytes.size());
  buffers_.push_back(bytes.first(byteLength));
}

const std::vector<JsonValue>& GltfDocument::array(std::string_view name) const {
  for (const auto& [key, elements] : arrays_)
    if (key == name) return elements;
  fail(ErrorKind::kInternal, file_, "no top-level array is called {}", name);
}

std::span<const std::byte> GltfDocument::viewBytes(const JsonValue& view) const {
  const std::optional<std::size_t> buffer = findIndex(*this, view, "buffer", "buffers");
  if (!buffer) view.fail("names no buffer");
  const std::uint64_t offset = wholeNumber(view, "byteOffset", 0);
  const std::uint64_t length = wholeNumber(view, "byteLength");
  const std::span<const std::byte> bytes = buffers_[*buffer];
  if (offset > bytes.size() || length > bytes.size() - offset)
    view.fail("reaches from byte {} to {}, but buffer {} ends at {}", offset, offset + length, *buffer,
              bytes.size());
  return bytes.subspan(offset, length);
}

std::span<const std::byte> GltfDocument::dataUriBytes(const JsonValue& uri) {
  return bytesOf(blobs_.emplace_back(decodeDataUri(uri)));
}

std::filesystem::path GltfDocument::fileOf(const JsonValue& uri) const {
  const std::string decoded = decodePercent(uri.string());
  if (decoded.empty() || decoded.find('\0') != std::string::npos) uri.fail("names no file");
  return path_.parent_path() / decoded;
}

std::uint64_t wholeNumber(const JsonValue& object, std::string_view key,
                          std::optional<std::uint64_t> fallback) {
  if (fallback && !object.has(key)) return *fallback;
  constexpr double kLargest = 9007199254740992.0;  // 2^53: beyond, JSON's numbers skip some
  const JsonValue value = object.at(key);
  const nlohmann::json& json = value.json();
  const double number = json.is_number() ? json.get<double>() : -1.0;
  if (!(number >= 0.0 && number <= kLargest && number == std::floor(number)))
    value.fail("must be a whole number from 0 on{}",
               json.is_number() ? fmt::format(", but is {}", number) : "");
  return std::uint64_t(number);
}

std::optional<std::size_t> findIndex(const GltfDocument& document, const JsonValue& object,
                                     std::string_view key, std::string_view array) {
  if (!object.has(key)) return std::nullopt;
  const std::uint64_t index = wholeNumber(object, key);
  const std::size_t count = document.array(array).size();
  if (index >= count) object.at(key).fail("names {}[{}], but there are only {}", array, index, count);
  return std::size_t(index);
}

std::optional<JsonValue> findExtension(const JsonValue& object, std::string_view name) {
  const std::optional<JsonValue> extensions = object.find("extensions");
  return extensions ? extensions->find(name) : std::nullopt;
}

std::string nameOf(const JsonValue& object, std::string fallback) {
  const std::optional<JsonValue> member = object.find("name");
  std::string name = member ? member->string() : "";
  for (char& c : name)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  return name.empty() ? std::move(fallback) : name;
}

float numberOr(const JsonValue& object, std::string_view key, float fallback, double least, double most) {
  const std::optional<JsonValue> member = object.find(key);
  return member ? member->number(least, most) : fallback;
}

}  // namespace isophote
