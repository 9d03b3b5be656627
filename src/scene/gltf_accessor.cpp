// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf_accessor.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace isophote {

namespace {

/// An accessor without data is all zeros, whatever its count says: a few bytes of file must not ask for
/// gigabytes.
constexpr std::uint64_t kMostZeroElements = std::uint64_t(1) << 20;

constexpr std::array<std::string_view, 4> kTypeNames{"SCALAR", "VEC2", "VEC3", "VEC4"};

std::size_t componentBytes(GltfComponent component) {
  switch (component) {
    case GltfComponent::kInt8:
    case GltfComponent::kUint8:
      return 1;
    case GltfComponent::kInt16:
    case GltfComponent::kUint16:
      return 2;
    case GltfComponent::kUint32:
    case GltfComponent::kFloat:
      break;
  }
  return 4;
}

GltfComponent readComponent(const JsonValue& object) {
  const std::uint64_t number = wholeNumber(object, "componentType");
  for (const std::uint64_t known : {5120, 5121, 5122, 5123, 5125, 5126})
    if (number == known) return GltfComponent(int(number));
  object.at("componentType").fail("{} is none of glTF's component types (5120 to 5126)", number);
}

template <class T>
T load(const std::byte* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// `count` elements of `size` bytes, `stride` apart, from `offset` on must lie within `available`. No sum or
/// product of checked numbers can overflow: counts stay below 2^53, strides below 2^8.
void requireWithin(const JsonValue& user, std::uint64_t offset, std::uint64_t count, std::uint64_t stride,
                   std::uint64_t size, std::uint64_t available) {
  if (count == 0) return;
  const std::uint64_t end = offset + (count - 1) * stride + size;
  if (end > available)
    user.fail("reads {} elements up to byte {}, but its buffer view has {}", count, end, available);
}

std::uint64_t strideOf(const JsonValue& view, std::size_t elementBytes) {
  const std::uint64_t stride = wholeNumber(view, "byteStride", elementBytes);
  if (stride < elementBytes || stride > 252)
    view.at("byteStride")
        .fail("must lie between the element's size, {}, and 252, but is {}", elementBytes, stride);
  return stride;
}

}  // namespace

GltfAccessor::GltfAccessor(const GltfDocument& document, std::size_t index, const JsonValue& user,
                           int components)
    : components_(components) {
  const JsonValue& accessor = document.array("accessors")[index];
  const std::string type = accessor.at("type").string();
  const std::string_view wanted = kTypeNames[std::size_t(components - 1)];
  if (type != wanted) user.fail("accessor {} is of type \"{}\", but {} is wanted here", index, type, wanted);
  component_ = readComponent(accessor);
  const std::optional<JsonValue> normalised = accessor.find("normalized");
  normalised_ = normalised && normalised->boolean();
  count_ = wholeNumber(accessor, "count");
  openDense(document, accessor, user);
  if (const std::optional<JsonValue> sparse = accessor.find("sparse")) applySparse(document, *sparse);
}

std::size_t GltfAccessor::elementBytes() const {
  return componentBytes(component_) * std::size_t(components_);
}

void GltfAccessor::openDense(const GltfDocument& document, const JsonValue& accessor, const JsonValue& user) {
  const std::optional<std::size_t> viewIndex = findIndex(document, accessor, "bufferView", "bufferViews");
  if (!viewIndex) {
    if (count_ > kMostZeroElements)
      accessor.fail("has {} elements but no bufferView; at most {} can be without data", count_,
                    kMostZeroElements);
    owned_ = std::make_shared<std::vector<std::byte>>(count_ * elementBytes());
    data_ = owned_->data();
    stride_ = elementBytes();
    return;
  }
  const JsonValue& view = document.array("bufferViews")[*viewIndex];
  const std::span<const std::byte> bytes = document.viewBytes(view);
  const std::uint64_t offset = wholeNumber(accessor, "byteOffset", 0);
  stride_ = strideOf(view, elementBytes());
  requireWithin(user, offset, count_, stride_, elementBytes(), bytes.size());
  data_ = count_ > 0 ? bytes.data() + offset : nullptr;
}

void GltfAccessor::applySparse(const GltfDocument& document, const JsonValue& sparse) {
  const JsonValue indices = sparse.at("indices");
  const JsonValue values = sparse.at("values");
  const std::uint64_t count = wholeNumber(sparse, "count");
  const auto open = [&](const JsonValue& part, std::size_t elementSize) {
    const std::optional<std::size_t> view = findIndex(document, part, "bufferView", "bufferViews");
    if (!view) part.fail("names no bufferView");
    const std::span<const std::byte> bytes = document.viewBytes(document.array("bufferViews")[*view]);
    const std::uint64_t offset = wholeNumber(part, "byteOffset", 0);
    requireWithin(part, offset, count, elementSize, elementSize, bytes.size());
    return bytes.data() + offset;
  };
  GltfAccessor positions = *this;
  positions.component_ = readComponent(indices);
  positions.components_ = 1;
  if (positions.component_ != GltfComponent::kUint8 && positions.component_ != GltfComponent::kUint16 &&
      positions.component_ != GltfComponent::kUint32)
    indices.fail("must be unsigned integers");
  positions.stride_ = positions.elementBytes();
  if (count == 0) return;
  positions.data_ = open(indices, positions.stride_);
  const std::byte* replacement = open(values, elementBytes());

  auto dense = std::make_shared<std::vector<std::byte>>(count_ * elementBytes());
  for (std::size_t i = 0; i < count_; ++i)
    std::memcpy(dense->data() + i * elementBytes(), data_ + i * stride_, elementBytes());
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t target = positions.index(i);
    if (target >= count_) indices.fail("entry {} is {}, but there are only {} elements", i, target, count_);
    std::memcpy(dense->data() + target * elementBytes(), replacement + i * elementBytes(), elementBytes());
  }
  owned_ = std::move(dense);
  data_ = owned_->data();
  stride_ = elementBytes();
}

float GltfAccessor::number(std::size_t i, int k) const {
  const std::byte* at = data_ + i * stride_ + std::size_t(k) * componentBytes(component_);
  switch (component_) {
    case GltfComponent::kInt8: {
      const float value = float(load<std::int8_t>(at));
      return normalised_ ? std::max(value / 127.0f, -1.0f) : value;
    }
    case GltfComponent::kUint8: {
      const float value = float(load<std::uint8_t>(at));
      return normalised_ ? value / 255.0f : value;
    }
    case GltfComponent::kInt16: {
      const float value = float(load<std::int16_t>(at));
      return normalised_ ? std::max(value / 32767.0f, -1.0f) : value;
    }
    case GltfComponent::kUint16: {
      const float value = float(load<std::uint16_t>(at));
      return normalised_ ? value / 65535.0f : value;
    }
    case GltfComponent::kUint32:
      return float(load<std::uint32_t>(at));
    case GltfComponent::kFloat:
      break;
  }
  return load<float>(at);
}

std::uint32_t GltfAccessor::index(std::size_t i) const {
  const std::byte* at = data_ + i * stride_;
  switch (component_) {
    case GltfComponent::kUint8:
      return load<std::uint8_t>(at);
    case GltfComponent::kUint16:
      return load<std::uint16_t>(at);
    default:
      return load<std::uint32_t>(at);
  }
}

}  // namespace isophote
