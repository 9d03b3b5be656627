// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "gpu/spirv_layout.h"

#include "base/error.h"

#include <algorithm>
#include <cstring>
#include <unordered_map>

namespace isophote {

namespace {
// The few numbers of the SPIR-V specification that matter here.
constexpr std::uint32_t kMagic = 0x07230203;
constexpr std::size_t kHeaderWords = 5;

enum Op : std::uint32_t {
  kOpName = 5,
  kOpMemberName = 6,
  kOpExecutionMode = 16,
  kOpTypeArray = 28,
  kOpTypeRuntimeArray = 29,
  kOpTypePointer = 32,
  kOpConstant = 43,
  kOpVariable = 59,
  kOpDecorate = 71,
  kOpMemberDecorate = 72,
  kOpExecutionModeId = 331
};
enum Decoration : std::uint32_t {
  kBuiltIn = 11,
  kArrayStride = 6,
  kBinding = 33,
  kDescriptorSet = 34,
  kOffset = 35
};
enum StorageClass : std::uint32_t { kUniform = 2, kPushConstant = 9, kStorageBuffer = 12 };
enum ExecutionMode : std::uint32_t { kLocalSize = 17, kLocalSizeId = 38 };
constexpr std::uint32_t kBuiltInWorkgroupSize = 25;

/// One instruction: its operands without the leading word.
struct Instruction {
  std::uint32_t op;
  std::span<const std::uint32_t> operands;
};

/// A literal string: NUL-terminated bytes packed into words.
std::string text(std::span<const std::uint32_t> words) {
  const auto* bytes = reinterpret_cast<const char*>(words.data());
  return std::string(bytes, strnlen(bytes, words.size_bytes()));
}

/// Collects what the instructions say by result id, since names and decorations come before what they belong
/// to.
class Reader {
 public:
  void take(const Instruction& in) {
    const auto& w = in.operands;
    switch (in.op) {
      case kOpName:
        names_[w[0]] = text(w.subspan(1));
        break;
      case kOpMemberName:
        members_[w[0]][w[1]].name = text(w.subspan(2));
        break;
      case kOpDecorate:
        if (w.size() == 3) decorations_[w[0]][w[1]] = w[2];
        break;
      case kOpMemberDecorate:
        if (w.size() == 4 && w[2] == kOffset) {
          members_[w[0]][w[1]].offset = w[3];
          members_[w[0]][w[1]].hasOffset = true;
        }
        break;
      case kOpTypeArray:
      case kOpTypeRuntimeArray:
        elements_[w[0]] = w[1];
        break;
      case kOpTypePointer:
        pointees_[w[0]] = w[2];
        break;
      case kOpConstant:
        constants_[w[1]] = w[2];
        break;
      case kOpVariable:
        variables_.push_back({.type = w[0], .id = w[1], .storage = w[2]});
        break;
      case kOpExecutionMode:
      case kOpExecutionModeId:
        if (w.size() == 5 && (w[1] == kLocalSize || w[1] == kLocalSizeId)) {
          std::copy_n(w.begin() + 2, 3, workgroup_.begin());
          workgroupIsIds_ = w[1] == kLocalSizeId;
        }
        break;
      default:
        break;
    }
  }

  SpirvInterface result() const {
    SpirvInterface found;
    addStructs(found);
    for (const Variable& variable : variables_) addVariable(found, variable);
    std::ranges::sort(found.bindings, {}, &SpirvBinding::binding);
    found.workgroupSize = workgroupSize();
    return found;
  }

 private:
  struct Member {
    std::string name;
    std::uint32_t offset = 0;
    bool hasOffset = false;
  };
  struct Variable {
    std::uint32_t type;
    std::uint32_t id;
    std::uint32_t storage;
  };

  void addStructs(SpirvInterface& found) const {
    for (const auto& [id, members] : members_) {
      if (!std::ranges::all_of(members, [](const auto& m) { return m.second.hasOffset; })) continue;
      SpirvStruct& layout = found.structs.emplace_back();
      layout.name = nameOf(id);
      for (const auto& [index, member] : members) layout.offsets[member.name] = member.offset;
      for (const auto& [array, element] : elements_)
        if (element == id) layout.arrayStride = decoration(array, kArrayStride, 0);
    }
  }

  void addVariable(SpirvInterface& found, const Variable& variable) const {
    if (variable.storage == kPushConstant) found.pushConstants = true;
    if (!decorations_.contains(variable.id) || !decorations_.at(variable.id).contains(kBinding)) return;
    SpirvBinding& binding = found.bindings.emplace_back();
    binding.set = decoration(variable.id, kDescriptorSet, 0);
    binding.binding = decoration(variable.id, kBinding, 0);
    binding.kind = variable.storage == kStorageBuffer ? SpirvBindingKind::kStorageBuffer
                   : variable.storage == kUniform     ? SpirvBindingKind::kUniformBuffer
                                                      : SpirvBindingKind::kOther;
    binding.name = nameOf(variable.id);
    if (const auto block = pointees_.find(variable.type); binding.name.empty() && block != pointees_.end())
      binding.name = nameOf(block->second);
  }

  std::array<std::uint32_t, 3> workgroupSize() const {
    for (const auto& [id, decorations] : decorations_)
      if (const auto it = decorations.find(kBuiltIn);
          it != decorations.end() && it->second == kBuiltInWorkgroupSize)
        return {};
    if (!workgroupIsIds_) return workgroup_;
    std::array<std::uint32_t, 3> size{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto constant = constants_.find(workgroup_[axis]);
      if (constant == constants_.end()) return {};
      size[axis] = constant->second;
    }
    return size;
  }

  std::string nameOf(std::uint32_t id) const {
    const auto it = names_.find(id);
    return it == names_.end() ? std::string() : it->second;
  }

  std::uint32_t decoration(std::uint32_t id, Decoration which, std::uint32_t otherwise) const {
    const auto decorations = decorations_.find(id);
    if (decorations == decorations_.end()) return otherwise;
    const auto it = decorations->second.find(which);
    return it == decorations->second.end() ? otherwise : it->second;
  }

  std::unordered_map<std::uint32_t, std::string> names_;
  std::map<std::uint32_t, std::map<std::uint32_t, Member>> members_;
  std::unordered_map<std::uint32_t, std::unordered_map<std::uint32_t, std::uint32_t>> decorations_;
  std::unordered_map<std::uint32_t, std::uint32_t> elements_;
  std::unordered_map<std::uint32_t, std::uint32_t> pointees_;
  std::unordered_map<std::uint32_t, std::uint32_t> constants_;
  std::vector<Variable> variables_;
  std::array<std::uint32_t, 3> workgroup_{};
  bool workgroupIsIds_ = false;
};

/// The operands that take() reads without asking.
std::size_t minOperands(std::uint32_t op) {
  switch (op) {
    case kOpName:
    case kOpDecorate:
    case kOpTypeRuntimeArray:
      return 2;
    case kOpMemberName:
    case kOpMemberDecorate:
    case kOpTypeArray:
    case kOpTypePointer:
    case kOpConstant:
    case kOpVariable:
      return 3;
    default:
      return 0;
  }
}
}  // namespace

SpirvInterface readSpirv(std::string_view name, std::span<const std::uint32_t> words) {
  if (words.size() < kHeaderWords || words[0] != kMagic)
    fail(ErrorKind::kInternal, name, "is no SPIR-V module");
  Reader reader;
  for (auto rest = words.subspan(kHeaderWords); !rest.empty();) {
    const std::uint32_t op = rest[0] & 0xffffu;
    const std::uint32_t length = rest[0] >> 16;
    if (length == 0 || length > rest.size() || length - 1 < minOperands(op))
      fail(ErrorKind::kInternal, name, "has a broken SPIR-V instruction at word {}",
           words.size() - rest.size());
    reader.take({op, rest.subspan(1, length - 1)});
    rest = rest.subspan(length);
  }
  return reader.result();
}

}  // namespace isophote
