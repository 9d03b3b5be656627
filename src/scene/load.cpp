// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/error.h"
#include "scene/builtin/builtin.h"
#include "scene/description.h"
#include "scene/gltf.h"
#include "scene/obj.h"
#include "scene/scene.h"
#include "settings/suggest.h"

#include <algorithm>
#include <cctype>

namespace isophote {

namespace {

std::string lowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

[[noreturn]] void failUnknownScene(const std::string& nameOrPath) {
  std::error_code ignored;
  if (std::filesystem::exists(nameOrPath, ignored))
    failInput(nameOrPath, "is not a scene file; .gltf, .glb, .obj and .json files can be opened");
  std::vector<std::string_view> names;
  for (const BuiltinScene& scene : builtinScenes()) names.push_back(scene.name);
  failInput(nameOrPath, "there is no such file or built-in scene{}; built in are {}",
            suggestion(nameOrPath, std::span<const std::string_view>(names)), fmt::join(names, ", "));
}

Scene loadUnfinished(const std::string& nameOrPath, const SceneOptions& options, const Job& job) {
  const std::filesystem::path file(nameOrPath);
  const std::string extension = lowerCase(file.extension().string());
  if (extension == ".gltf" || extension == ".glb") return loadGltf(file, job);
  if (extension == ".obj") return loadObj(file, job);
  if (extension == ".json") return loadDescription(file, options, job);
  if (const BuiltinScene* builtin = findBuiltinScene(nameOrPath)) return builtin->make();
  failUnknownScene(nameOrPath);
}

}  // namespace

Scene loadScene(const std::string& nameOrPath, const SceneOptions& options, const Job& job) {
  job.report("scene", 0.0);
  Scene scene = loadUnfinished(nameOrPath, options, job);
  if (scene.name.empty()) scene.name = std::filesystem::path(nameOrPath).stem().string();
  finishScene(scene, nameOrPath, job);
  job.report("scene", 1.0);
  return scene;
}

}  // namespace isophote
