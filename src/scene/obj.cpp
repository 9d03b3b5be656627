// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/obj.h"

#include "base/error.h"
#include "base/files.h"
#include "scene/file_lookup.h"
#include "scene/obj_geometry.h"
#include "scene/obj_material.h"
#include "scene/textures.h"

#include <tbb/parallel_for.h>

#include <list>
#include <map>
#include <span>

namespace isophote {

namespace {

namespace fs = std::filesystem;

/// All materials of the .mtl files that an .obj file names. Where two have one name, the first counts.
class MaterialLibrary {
 public:
  MaterialLibrary(const fs::path& objFile, const std::vector<std::string>& names, const Job& job) {
    for (const std::string& name : names) addNamed(objFile, name, job);
  }

  struct Entry {
    fs::path library;
    const MtlMaterial* mtl;
  };
  /// Null where no file has it.
  const Entry* find(const std::string& name) const {
    const auto found = entries_.find(name);
    return found == entries_.end() ? nullptr : &found->second;
  }
  bool isIncomplete() const { return incomplete_; }

 private:
  /// "mtllib a b.mtl" names two files, or one with a blank in its name.
  void addNamed(const fs::path& objFile, const std::string& names, const Job& job) {
    const fs::path folder = objFile.parent_path();
    if (const auto whole = findFileBeside(folder, names)) {
      addFile(*whole, job);
      return;
    }
    std::size_t begin = 0;
    while (begin < names.size()) {
      const std::size_t end = std::min(names.find_first_of(" \t", begin), names.size());
      const std::string name = names.substr(begin, end - begin);
      begin = end + 1;
      if (name.empty()) continue;
      if (const auto file = findFileBeside(folder, name)) {
        addFile(*file, job);
      } else {
        incomplete_ = true;
        job.warn(fmt::format("{}: the material file \"{}\" is not there; its materials become grey",
                             objFile.string(), name));
      }
    }
  }

  void addFile(const fs::path& file, const Job& job) {
    const std::string text = readFile(file, job.memoryBudgetBytes);
    files_.push_back(parseMtl(text, file.string(), job));
    for (const MtlMaterial& mtl : files_.back()) entries_.try_emplace(mtl.name, Entry{file, &mtl});
  }

  std::list<std::vector<MtlMaterial>> files_;
  std::map<std::string, Entry> entries_;
  bool incomplete_ = false;
};

void warnUnknown(const fs::path& file, const std::vector<std::string>& unknown, const Job& job) {
  constexpr std::size_t kMostNamed = 5;
  const std::span<const std::string> named(unknown.data(), std::min(unknown.size(), kMostNamed));
  job.warn(fmt::format(
      "{}: no material file has \"{}\"{}; grey takes their place", file.string(), fmt::join(named, "\", \""),
      unknown.size() > kMostNamed ? fmt::format(" and {} more", unknown.size() - kMostNamed) : ""));
}

/// Path of the picture that a material names; pictures lie beside the .mtl file.
fs::path textureFile(const MaterialLibrary::Entry& entry, std::string_view key, const MtlTexture& texture) {
  if (const auto found = findFileBeside(entry.library.parent_path(), texture.file)) return *found;
  failInput(entry.library.string(), "material \"{}\": the texture {} {} is missing; put it beside this file",
            entry.mtl->name, key, texture.file);
}

TextureUse useOf(const MtlTexture& texture) {
  const Wrap wrap = texture.clamp ? Wrap::kClamp : Wrap::kRepeat;
  return {.srgb = true, .wrapU = wrap, .wrapV = wrap, .nearest = false};
}

/// map_Ks colours the reflection of a coat, map_Ns turns into the roughness of whatever reflects.
void addReflectionTextures(Material& material, const MaterialLibrary::Entry& entry, TextureSet& textures) {
  const MtlMaterial& mtl = *entry.mtl;
  const bool coated = material.specular > 0.0f && material.transmission == 0.0f;
  if (coated && !mtl.mapKs.file.empty())
    material.specularColourTexture =
        textures.addFile(textureFile(entry, "map_Ks", mtl.mapKs), useOf(mtl.mapKs));
  const bool rough = material.roughness > kMirrorRoughness && (coated || material.metallic > 0.0f);
  if (!rough || mtl.mapNs.file.empty() || !mtl.ns) return;
  TextureUse use = useOf(mtl.mapNs);
  use.srgb = false;
  use.meaning = TextureMeaning::kExponents;
  use.meaningScale = *mtl.ns;
  material.metallicRoughnessTexture = textures.addFile(textureFile(entry, "map_Ns", mtl.mapNs), use);
  material.roughness = 1.0f;
}

/// White of a bump map of -bm 1 stands so far above its black, in parts of the picture's width.
constexpr float kBumpHeight = 0.01f;

void addNormalMap(Material& material, const MaterialLibrary::Entry& entry, TextureSet& textures) {
  const MtlMaterial& mtl = *entry.mtl;
  const bool isNormalMap = !mtl.norm.file.empty();
  const MtlTexture& map = isNormalMap ? mtl.norm : mtl.bump;
  if (map.file.empty()) return;
  TextureUse use = useOf(map);
  use.srgb = false;
  use.meaning = isNormalMap ? TextureMeaning::kAsRead : TextureMeaning::kHeights;
  use.meaningScale = isNormalMap ? 1.0f : map.bump * kBumpHeight;
  material.normalTexture = textures.addFile(textureFile(entry, isNormalMap ? "norm" : "map_Bump", map), use);
}

/// A map_d becomes the alpha of the base colour's texture and cuts holes. Where it is the map_Kd itself its
/// own alpha counts; where there is no map_Kd it serves as one, since it is white wherever anything is left.
void addTextures(Material& material, const MaterialLibrary::Entry& entry, TextureSet& textures) {
  const MtlMaterial& mtl = *entry.mtl;
  const bool hasColour = !mtl.mapKd.file.empty();
  const bool hasAlpha = !mtl.mapD.file.empty();
  if (hasColour || hasAlpha) {
    const MtlTexture& colour = hasColour ? mtl.mapKd : mtl.mapD;
    const fs::path file = textureFile(entry, hasColour ? "map_Kd" : "map_d", colour);
    const fs::path alphaFile = hasAlpha ? textureFile(entry, "map_d", mtl.mapD) : fs::path();
    const bool ownAlpha = hasColour && alphaFile == file;
    material.baseColourTexture = textures.addFile(file, useOf(colour), ownAlpha ? fs::path() : alphaFile);
  }
  if (hasAlpha) material.flags |= kMaterialAlphaMask;
  if (!mtl.mapKe.file.empty()) {
    TextureUse use = useOf(mtl.mapKe);
    use.emission = true;
    material.emissionTexture = textures.addFile(textureFile(entry, "map_Ke", mtl.mapKe), use);
  }
  addReflectionTextures(material, entry, textures);
  addNormalMap(material, entry, textures);
}

void addMaterials(Scene& scene, const ObjGeometry& geometry, const fs::path& file, const Job& job) {
  const MaterialLibrary library(file, geometry.libraries, job);
  TextureSet textures(scene, file.string());
  std::vector<std::string> unknown;
  for (const std::string& name : geometry.materialNames) {
    NamedMaterial material;
    static_cast<Material&>(material) = defaultObjMaterial();
    material.name = name.empty() ? "default" : name;
    if (const MaterialLibrary::Entry* entry = name.empty() ? nullptr : library.find(name)) {
      static_cast<Material&>(material) = materialFromMtl(*entry->mtl);
      addTextures(material, *entry, textures);
    } else if (!name.empty()) {
      unknown.push_back(name);
    }
    scene.materials.push_back(std::move(material));
  }
  if (!unknown.empty() && !library.isIncomplete()) warnUnknown(file, unknown, job);
  textures.decode(job);
}

}  // namespace

Scene loadObj(const fs::path& file, const Job& job) {
  const std::string subject = file.string();
  job.report("reading " + file.filename().string(), 0.0);
  const ObjGeometry geometry = [&] {
    const std::string text = readFile(file, job.memoryBudgetBytes);
    if (text.find('\0') != std::string::npos) failInput(subject, "is not a text file, as .obj files are");
    return parseObj(text, subject, file.stem().string(), job);
  }();
  if (geometry.groups.empty())
    failInput(subject, "holds no faces: an .obj file with lines that begin with f is expected");

  Scene scene;
  scene.name = file.stem().string();
  job.report("building " + file.filename().string(), 0.4);
  scene.meshes.resize(geometry.groups.size());
  tbb::parallel_for(std::size_t(0), geometry.groups.size(), [&](std::size_t i) {
    scene.meshes[i] = buildObjMesh(geometry, geometry.groups[i], job);
  });
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    Instance instance;
    instance.name = scene.meshes[i].name;
    instance.mesh = std::uint32_t(i);
    scene.instances.push_back(std::move(instance));
  }
  addMaterials(scene, geometry, file, job);
  return scene;
}

}  // namespace isophote
