// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/description.h"

#include "base/files.h"
#include "image/radiance.h"
#include "scene/builtin/builtin.h"
#include "scene/description_parts.h"
#include "scene/file_lookup.h"
#include "scene/gltf.h"
#include "scene/merge.h"
#include "scene/obj.h"
#include "settings/suggest.h"

#include <algorithm>
#include <map>
#include <set>

namespace isophote {

namespace {

namespace fs = std::filesystem;

std::string lowerExtension(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return extension;
}

/// The materials of a model that the description names.
struct MaterialScope {
  std::string model;
  std::size_t first = 0;
  std::size_t count = 0;
};

class DescriptionLoader {
 public:
  DescriptionLoader(const fs::path& file, const SceneOptions& options, const Job& job)
      : file_(file), subject_(file.string()), options_(options), job_(job) {}

  Scene load() {
    const nlohmann::json document = readJsonFile(file_);
    const JsonValue root(document, subject_);
    root.expectKeys({"isophote", "models", "camera", "cameras", "lights", "materials", "settings"});
    const JsonValue version = root.at("isophote");
    if (!version.json().is_number_integer() || version.json() != 1) {
      version.fail("is {}, but this program reads version 1 of the format", version.json().dump());
    }
    scene_.name = file_.stem().string();
    loadModels(root.at("models"));
    if (const auto materials = root.find("materials")) overrideMaterials(*materials);
    addCameras(root);
    addLights(root);
    if (const auto settings = root.find("settings")) readSettings(*settings);
    return std::move(scene_);
  }

 private:
  void loadModels(const JsonValue& models) {
    const std::vector<JsonValue> elements = models.elements();
    if (elements.empty()) models.fail("at least one model is needed");
    for (std::size_t i = 0; i < elements.size(); ++i) {
      job_.report("loading models", double(i) / double(elements.size()));
      loadModel(elements[i]);
    }
  }

  void loadModel(const JsonValue& model) {
    model.expectKeys({"file", "name", "source", "translation", "rotation", "scale"});
    const mat4x3 worldFromModel = readTransform(model);
    const std::string name = model.has("name") ? model.at("name").string() : std::string();
    const std::string file = model.at("file").string();
    const BuiltinScene* builtin = findBuiltinScene(file);
    const fs::path path = builtin ? fs::path() : findNamed(model, "model");
    std::error_code error;
    const fs::path canonical = fs::weakly_canonical(path, error);
    const std::string key = builtin ? file : (error ? path : canonical).string();
    const auto known = models_.find(key);
    if (known != models_.end()) {
      // Another copy shares meshes and materials. Cameras and lights stay those of the first.
      placeModel(scene_, known->second, worldFromModel, name);
      return;
    }
    MergedModel merged =
        appendModel(scene_, builtin ? builtin->make() : loadFile(model.at("file"), path), worldFromModel);
    placeModel(scene_, merged, worldFromModel, name);
    if (!name.empty()) materialScopes_.push_back({name, merged.firstMaterial, merged.materialCount});
    models_.emplace(key, std::move(merged));
  }

  Scene loadFile(const JsonValue& file, const fs::path& path) {
    const std::string extension = lowerExtension(path);
    if (extension == ".obj") return loadObj(path, job_);
    if (extension == ".gltf" || extension == ".glb") return loadGltf(path, job_);
    file.fail("\"{}\" is no model: a .gltf, .glb or .obj file or a built-in scene is expected",
              file.string());
  }

  /// The file that owner["file"] names, a `kind`.
  fs::path findNamed(const JsonValue& owner, const char* kind) {
    const JsonValue value = owner.at("file");
    const std::string file = value.string();
    if (file.empty()) value.fail("must not be empty");
    if (const auto found = findFileBeside(file_.parent_path(), file)) return *found;
    for (const fs::path& folder : options_.assetFolders) {
      if (const auto found = findFileBeside(folder, file)) return *found;
    }
    std::string where =
        fmt::format("\"{}\"", file_.parent_path().empty() ? "." : file_.parent_path().string());
    for (const fs::path& folder : options_.assetFolders) where += fmt::format(", \"{}\"", folder.string());
    const std::string source = owner.has("source")
                                   ? fmt::format("; it can be had here: {}", owner.at("source").string())
                                   : std::string();
    value.fail(
        "there is no {} \"{}\" in {}{} (--assets DIR or ISOPHOTE_ASSETS name more folders to search){}", kind,
        file, where, std::string_view(kind) == "model" ? " and no built-in scene of that name" : "", source);
  }

  /// A key names a material, or "model/material" for that of one model only.
  void overrideMaterials(const JsonValue& materials) {
    for (const auto& [name, overrides] : materials.members()) {
      bool found = false;
      for (NamedMaterial& material : scene_.materials) {
        if (material.name != name) continue;
        overrideMaterial(material, overrides);
        found = true;
      }
      for (const MaterialScope& scope : materialScopes_) {
        for (std::size_t i = 0; i < scope.count; ++i) {
          NamedMaterial& material = scene_.materials[scope.first + i];
          if (scope.model + "/" + material.name != name) continue;
          overrideMaterial(material, overrides);
          found = true;
        }
      }
      if (!found) failUnknownMaterial(overrides, name);
    }
  }

  [[noreturn]] void failUnknownMaterial(const JsonValue& overrides, const std::string& name) {
    std::set<std::string> distinct;
    for (const NamedMaterial& material : scene_.materials) distinct.insert(material.name);
    const std::vector<std::string> names(distinct.begin(), distinct.end());
    const std::string nearest = suggestion(name, std::span<const std::string>(names));
    if (!nearest.empty()) overrides.fail("no model has a material \"{}\"{}", name, nearest);
    overrides.fail("no model has a material \"{}\"; there are \"{}\"", name, fmt::join(names, "\", \""));
  }

  /// The description's cameras come first: the first one is what renders unless another is asked for.
  void addCameras(const JsonValue& root) {
    std::vector<Camera> cameras;
    if (const auto camera = root.find("camera")) cameras.push_back(readCamera(*camera));
    if (const auto list = root.find("cameras")) {
      for (const JsonValue& value : list->elements()) {
        value.at("name");
        cameras.push_back(readCamera(value));
        const auto sameName = [&](const Camera& c) { return c.name == cameras.back().name; };
        if (std::any_of(cameras.begin(), cameras.end() - 1, sameName)) {
          value.at("name").fail("a camera above has the name \"{}\" too", cameras.back().name);
        }
      }
    }
    scene_.cameras.insert(scene_.cameras.begin(), cameras.begin(), cameras.end());
  }

  /// The description's lights take the place of the models' punctual ones; emissive materials stay.
  void addLights(const JsonValue& root) {
    const auto lights = root.find("lights");
    if (!lights) return;
    scene_.lights.clear();
    for (const JsonValue& value : lights->elements()) {
      scene_.lights.push_back(readLight(value));
      if (scene_.lights.back().mapped != 0u) loadEnvironment(value);
    }
    const auto environments =
        std::count_if(scene_.lights.begin(), scene_.lights.end(),
                      [](const Light& light) { return light.type == kLightEnvironment; });
    if (environments > 1) lights->fail("has {} environment lights: one at most is possible", environments);
  }

  void loadEnvironment(const JsonValue& light) {
    const fs::path path = findNamed(light, "environment map");
    job_.report("environment map", 0.0);
    const std::string bytes = readFile(path, job_.memoryBudgetBytes);
    // Its distributions take two numbers a texel besides the three of its colour.
    const std::uint64_t budget = job_.memoryBudgetBytes / 5 * 3;
    scene_.environment.radiance = decodeRadiance(std::as_bytes(std::span(bytes)),
                                                 fmt::format("{}: {}", subject_, path.string()), budget);
  }

  void readSettings(const JsonValue& settings) {
    for (const auto& [key, value] : settings.members()) {
      const bool plain = value.json().is_number() || value.json().is_string() || value.json().is_boolean();
      if (!plain) value.fail("expected a number, a string, true or false");
      scene_.settings.emplace_back(key, value.json().dump());
    }
  }

  const fs::path& file_;
  std::string subject_;
  const SceneOptions& options_;
  const Job& job_;
  Scene scene_;
  std::map<std::string, MergedModel> models_;  ///< By path or built-in name.
  std::vector<MaterialScope> materialScopes_;
};

}  // namespace

Scene loadDescription(const fs::path& file, const SceneOptions& options, const Job& job) {
  return DescriptionLoader(file, options, job).load();
}

}  // namespace isophote
