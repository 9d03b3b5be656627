// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/checkpoint.h"

#include "base/error.h"
#include "image/files.h"
#include "settings/apply.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

namespace isophote {

namespace {

constexpr const char* kPasses = "checkpoint.passes";
constexpr const char* kFirstRadius = "checkpoint.firstRadius";
constexpr const char* kScene = "checkpoint.scene";

/// 64-bit FNV-1a.
class Digest {
 public:
  void add(const void* data, std::size_t bytes) {
    const auto* next = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < bytes; ++i) hash_ = (hash_ ^ next[i]) * 0x100000001b3u;
  }
  template <class Item>
  void addAll(const std::vector<Item>& items) {
    static_assert(std::is_trivially_copyable_v<Item>);
    add(items.data(), items.size() * sizeof(Item));
  }
  void add(vec3 v) { add(&v, sizeof v); }
  void add(float v) { add(&v, sizeof v); }
  std::string text() const { return fmt::format("{:016x}", hash_); }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

std::string digestOf(const Scene& scene, const Camera& camera) {
  Digest digest;
  for (const Mesh& mesh : scene.meshes) {
    digest.addAll(mesh.positions);
    digest.addAll(mesh.normals);
    digest.addAll(mesh.uvs);
    digest.addAll(mesh.colours);
    digest.addAll(mesh.triangles);
    digest.add(&mesh.material, sizeof mesh.material);
  }
  for (const Instance& instance : scene.instances) {
    digest.add(&instance.mesh, sizeof instance.mesh);
    digest.add(&instance.worldFromObject, sizeof instance.worldFromObject);
  }
  for (const NamedMaterial& material : scene.materials)
    digest.add(static_cast<const Material*>(&material), sizeof(Material));
  for (const Texture& texture : scene.textures) {
    digest.add(&texture.width, sizeof texture.width);
    digest.add(&texture.height, sizeof texture.height);
  }
  digest.addAll(scene.lights);
  for (const vec3 v : {camera.eye, camera.target, camera.up}) digest.add(v);
  for (const float v : {camera.verticalFovDegrees, camera.orthographicHeight}) digest.add(v);
  return digest.text();
}

using Metadata = std::map<std::string, std::string>;

/// A number of the file's, not negative; anything else is refused.
template <class Number>
Number numberOf(const Metadata& metadata, const char* key, std::string_view subject) {
  const auto found = metadata.find(key);
  Number number{};
  if (found != metadata.end()) {
    const std::string& text = found->second;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (problem == std::errc() && end == text.data() + text.size() && number >= Number(0)) return number;
  }
  failInput(subject, "is not a checkpoint; name another file, or remove this one");
}

void requireSameSettings(const Metadata& saved, RenderSettings settings, std::string_view subject) {
  for (const Field& field : fieldsOfGroups(settings)) {
    if (field.key == "frame.passes" || field.key == "frame.seconds") continue;
    const auto found = saved.find(field.key);
    const std::string value = valueText(field);
    const std::string before = found == saved.end() ? "not known" : found->second;
    if (before != value)
      failInput(
          subject,
          "is of a picture with other settings ({} is {} there and {} now); name another file, or remove "
          "this one",
          field.key, before, value);
  }
}

}  // namespace

Checkpoint::Checkpoint(std::filesystem::path path, const Scene& scene, const Camera& camera)
    : path_(std::move(path)), scene_(digestOf(scene, camera)) {
  if (!holdsLayers(path_))
    failUsage(path_.string(), "cannot be a checkpoint; give it a name that ends in .exr");
}

bool Checkpoint::exists() const {
  std::error_code ignored;
  return std::filesystem::exists(path_, ignored);
}

void Checkpoint::load(ProgressiveRenderer& renderer, const RenderSettings& settings, const Job& job) const {
  Film film = readFilm(path_, job.memoryBudgetBytes);
  const Metadata saved(film.metadata.begin(), film.metadata.end());
  const std::string subject = path_.string();
  const auto passes = numberOf<std::uint32_t>(saved, kPasses, subject);
  const auto radius = numberOf<float>(saved, kFirstRadius, subject);
  requireSameSettings(saved, settings, subject);
  const auto scene = saved.find(kScene);
  if (scene == saved.end() || scene->second != scene_)
    failInput(subject, "is of another scene or camera; name another file, or remove this one");
  if (film.colour.width != int(settings.frame.width) || film.colour.height != int(settings.frame.height))
    failInput(subject, "is damaged: its picture has another size than its settings say");
  renderer.resume(std::move(film), passes, radius);
}

void Checkpoint::save(const ProgressiveRenderer& renderer) const {
  Film film = renderer.film();
  film.metadata.emplace_back(kPasses, fmt::format("{}", renderer.passes()));
  // The shortest text that is read as the same number.
  film.metadata.emplace_back(kFirstRadius, fmt::format("{}", renderer.firstRadius()));
  film.metadata.emplace_back(kScene, scene_);
  writeFilm(path_, film);
}

}  // namespace isophote
