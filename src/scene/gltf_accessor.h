// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/gltf_document.h"

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <vector>

namespace isophote {

/// glTF's numbers for the types of an accessor's components.
enum class GltfComponent {
  kInt8 = 5120,
  kUint8 = 5121,
  kInt16 = 5122,
  kUint16 = 5123,
  kUint32 = 5125,
  kFloat = 5126
};

/// Typed read access to an accessor whose every element was checked to lie within its buffer. Sparse
/// accessors are made dense in `owned`.
class GltfAccessor {
 public:
  /// Opens accessors[index]. `user` is the place that names it, for errors; `components` is 1 for SCALAR, 2
  /// for VEC2, ...
  GltfAccessor(const GltfDocument& document, std::size_t index, const JsonValue& user, int components);

  std::size_t size() const { return count_; }
  GltfComponent component() const { return component_; }
  int components() const { return components_; }
  bool normalised() const { return normalised_; }
  /// Component `k` of element `i`; integers as they are, or mapped to [0, 1] or [-1, 1] where the accessor
  /// says so.
  float number(std::size_t i, int k) const;
  /// Element `i` of an accessor of unsigned integers.
  std::uint32_t index(std::size_t i) const;
  vec2 vector2(std::size_t i) const { return vec2(number(i, 0), number(i, 1)); }
  vec3 vector3(std::size_t i) const { return vec3(number(i, 0), number(i, 1), number(i, 2)); }

 private:
  void openDense(const GltfDocument& document, const JsonValue& accessor, const JsonValue& user);
  void applySparse(const GltfDocument& document, const JsonValue& sparse);
  std::size_t elementBytes() const;

  const std::byte* data_ = nullptr;
  std::size_t stride_ = 0;
  std::size_t count_ = 0;
  int components_ = 1;
  GltfComponent component_ = GltfComponent::kFloat;
  bool normalised_ = false;
  std::shared_ptr<std::vector<std::byte>> owned_;
};

}  // namespace isophote
