// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "isophote/world.h"

#include "api/content.h"

namespace isophote {

World World::load(const std::string& nameOrPath, const std::vector<std::filesystem::path>& assetFolders,
                  const Job& job) {
  return api::guarded([&] {
    return World(std::make_shared<const Content>(Content{loadScene(nameOrPath, {assetFolders}, job)}));
  });
}

std::vector<View> World::views() const {
  std::vector<View> views;
  for (const Camera& c : content_->scene.cameras)
    views.push_back({c.name, api::arrayOf(c.eye), api::arrayOf(c.target), api::arrayOf(c.up),
                     c.verticalFovDegrees, c.aspect, c.orthographicHeight});
  return views;
}

Float3 World::lowerCorner() const { return api::arrayOf(content_->scene.bounds.lower); }
Float3 World::upperCorner() const { return api::arrayOf(content_->scene.bounds.upper); }

std::uint64_t World::triangleCount() const {
  std::uint64_t count = 0;
  for (const Instance& instance : content_->scene.instances)
    count += content_->scene.meshes[instance.mesh].triangles.size();
  return count;
}

std::size_t World::lightCount() const { return content_->scene.lights.size(); }
std::uint64_t World::bytes() const { return sceneBytes(content_->scene); }

}  // namespace isophote
