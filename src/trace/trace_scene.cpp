// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "trace/trace_scene.h"

#include "base/error.h"
#include "math/rng.shared.h"
#include "scene/alpha_mask.h"
#include "trace/raster_scene.h"
#include "trace/shaded_scene.h"

#include <embree3/rtcore.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

namespace isophote {

namespace {

/// What an alpha test needs of one mesh.
struct MaskedMesh {
  const Scene* scene;
  const Mesh* mesh;
};

/// What our filters are told of a query, behind Embree's own context, whose address is handed on to them.
struct Query {
  RTCIntersectContext context;
  Blended blended = Blended::kByChance;
  const std::uint32_t* salts = nullptr;  ///< Ray::salt, by RTCRay::id; null: 0.
  /// For shadow rays, by RTCRay::id: what blended surfaces leave of the light is multiplied in.
  float* visible = nullptr;

  explicit Query(RTCIntersectContextFlags flags) {
    rtcInitIntersectContext(&context);
    context.flags = flags;
  }
};

/// A number in [0, 1) of a ray and a triangle, in whatever order triangles are met.
float chanceOf(const RTCFilterFunctionNArguments& a, unsigned i, std::uint32_t salt) {
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  const uvec3 origin(bits(RTCRayN_org_x(a.ray, a.N, i)), bits(RTCRayN_org_y(a.ray, a.N, i)),
                     bits(RTCRayN_org_z(a.ray, a.N, i)));
  const uvec3 direction(bits(RTCRayN_dir_x(a.ray, a.N, i)), bits(RTCRayN_dir_y(a.ray, a.N, i)),
                        bits(RTCRayN_dir_z(a.ray, a.N, i)));
  const uvec3 triangle(RTCHitN_primID(a.hit, a.N, i),
                       RTCHitN_geomID(a.hit, a.N, i) ^ (RTCHitN_instID(a.hit, a.N, i, 0) * 0x9e3779b9u),
                       salt);
  return unitFloat(hash3(hash3(hash3(origin) ^ direction) ^ triangle).x);
}

/// Lets rays pass where a masked texel is not there, and where a blended surface lets them.
void alphaFilter(const RTCFilterFunctionNArguments* arguments) {
  const auto& masked = *static_cast<const MaskedMesh*>(arguments->geometryUserPtr);
  const auto& query = *reinterpret_cast<const Query*>(arguments->context);
  const Material& material = masked.scene->materials[masked.mesh->material];
  const bool blends = (material.flags & kMaterialAlphaBlend) != 0u;
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] == 0) continue;
    const float alpha =
        alphaAt(*masked.scene, *masked.mesh, RTCHitN_primID(arguments->hit, arguments->N, i),
                RTCHitN_u(arguments->hit, arguments->N, i), RTCHitN_v(arguments->hit, arguments->N, i));
    const unsigned ray = RTCRayN_id(arguments->ray, arguments->N, i);
    bool passes = alpha < material.alphaCutoff;
    if (blends && query.visible) {
      passes = alpha < 1.0f;
      if (passes) query.visible[ray] *= 1.0f - alpha;
    } else if (blends && query.blended == Blended::kAlways) {
      passes = alpha <= 0.0f;
    } else if (blends) {
      passes = chanceOf(*arguments, i, query.salts ? query.salts[ray] : 0u) >= alpha;
    }
    if (passes) arguments->valid[i] = 0;
  }
}

}  // namespace

struct TraceScene::Embree {
  RTCDevice device = nullptr;
  RTCScene top = nullptr;
  std::vector<RTCScene> meshScenes;               ///< Null where the mesh is baked or unused.
  std::vector<std::uint32_t> instanceOfGeometry;  ///< By top-level geometry id.
  std::vector<MaskedMesh> maskedMeshes;           ///< By mesh; their addresses are handed to Embree.
  std::atomic<std::int64_t> bytes{0};
  std::uint64_t budgetBytes = 0;

  explicit Embree(std::uint64_t budget) : budgetBytes(budget) {
    device = rtcNewDevice(nullptr);
    if (!device)
      fail(ErrorKind::kResources, "", "Embree could not be started (error {})",
           int(rtcGetDeviceError(nullptr)));
    rtcSetDeviceMemoryMonitorFunction(
        device,
        [](void* self, ssize_t change, bool) {
          auto& e = *static_cast<Embree*>(self);
          return std::uint64_t(std::max<std::int64_t>(e.bytes += change, 0)) <= e.budgetBytes;
        },
        this);
  }

  ~Embree() {
    for (RTCScene scene : meshScenes)
      if (scene) rtcReleaseScene(scene);
    if (top) rtcReleaseScene(top);
    if (device) rtcReleaseDevice(device);
  }

  RTCScene newScene() {
    RTCScene scene = rtcNewScene(device);
    // Medium quality: the high one depends on the number of threads.
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
    return scene;
  }

  void commit(RTCScene scene) {
    rtcCommitScene(scene);
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_OUT_OF_MEMORY)
      fail(ErrorKind::kResources, "", "the ray tracing hierarchy needs more than the memory budget of {} MiB",
           budgetBytes >> 20);
    if (error != RTC_ERROR_NONE)
      fail(ErrorKind::kInternal, "", "Embree failed to build the hierarchy (error {})", int(error));
  }

  /// A triangle geometry with its own copy of the vertices (Embree reads 16 bytes at each, so the last needs
  /// padding).
  RTCGeometry newTriangles(const Mesh& mesh, const mat4x3& transform, const MaskedMesh* masked) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<vec3*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(vec3), mesh.positions.size()));
    if (!vertices) {
      rtcReleaseGeometry(geometry);
      fail(ErrorKind::kResources, "", "the ray tracing hierarchy needs more than the memory budget of {} MiB",
           budgetBytes >> 20);
    }
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
      vertices[i] = transform * vec4(mesh.positions[i], 1.0f);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                               sizeof(uvec3), mesh.triangles.size());
    if (masked) {
      rtcSetGeometryUserData(geometry, const_cast<MaskedMesh*>(masked));
      rtcSetGeometryIntersectFilterFunction(geometry, alphaFilter);
      rtcSetGeometryOccludedFilterFunction(geometry, alphaFilter);
    }
    rtcCommitGeometry(geometry);
    return geometry;
  }

  void attach(RTCGeometry geometry, std::uint32_t instance) {
    const unsigned id = rtcAttachGeometry(top, geometry);
    rtcReleaseGeometry(geometry);
    if (instanceOfGeometry.size() <= id) instanceOfGeometry.resize(id + 1, kNoHit);
    instanceOfGeometry[id] = instance;
  }

  void attachInstance(std::uint32_t meshIndex, const Mesh& mesh, const MaskedMesh* masked,
                      const mat4x3& transform, std::uint32_t instance) {
    RTCScene& scene = meshScenes[meshIndex];
    if (!scene) {
      scene = newScene();
      RTCGeometry triangles = newTriangles(mesh, mat4x3(1.0f), masked);
      rtcAttachGeometry(scene, triangles);
      rtcReleaseGeometry(triangles);
      commit(scene);
    }
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, scene);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, &transform[0].x);
    rtcCommitGeometry(geometry);
    attach(geometry, instance);
  }

  Hit hitFrom(float t, float u, float v, unsigned geometry, unsigned primitive, unsigned instance) const {
    if (geometry == RTC_INVALID_GEOMETRY_ID) return {};
    return {t, u, v, instanceOfGeometry[instance != RTC_INVALID_GEOMETRY_ID ? instance : geometry],
            primitive};
  }
};

TraceScene::TraceScene(const Scene& scene, const Job& job)
    : scene_(scene), lights_(scene.lights), embree_(std::make_unique<Embree>(job.memoryBudgetBytes)) {
  Embree& e = *embree_;
  e.top = e.newScene();
  e.meshScenes.resize(scene.meshes.size(), nullptr);
  for (const Mesh& mesh : scene.meshes) e.maskedMeshes.push_back({&scene, &mesh});
  std::vector<std::uint32_t> uses(scene.meshes.size(), 0);
  for (const Instance& instance : scene.instances) ++uses[instance.mesh];

  const std::vector<std::size_t> firstTriangle =
      gatherTriangles(scene, uses, job.memoryBudgetBytes, triangles_);
  for (const NamedMaterial& material : scene.materials) {
    materials_.push_back(shadedMaterial(scene, material));
    absorbs_ |= absorbsInside(material);
    blends_ |= materials_.back().blended;
  }
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    if (i % 64 == 0) job.throwIfStopped();
    const Instance& instance = scene.instances[i];
    const Mesh& mesh = scene.meshes[instance.mesh];
    instances_.push_back(
        shadedInstance(scene, instance, triangles_.data() + firstTriangle[instance.mesh], materials_.data()));
    if (uses[instance.mesh] == 1) moveToWorld(instances_.back(), mesh.triangles.size(), triangles_);
    const bool hasHoles = isMasked(scene, mesh) || isBlended(scene, mesh);
    const MaskedMesh* masked = hasHoles ? &e.maskedMeshes[instance.mesh] : nullptr;
    // A small mesh costs less baked several times than the transformation of every ray that comes near it.
    const bool bake = uses[instance.mesh] == 1 || mesh.triangles.size() <= 64;
    if (bake)
      e.attach(e.newTriangles(mesh, instance.worldFromObject, masked), std::uint32_t(i));
    else
      e.attachInstance(instance.mesh, mesh, masked, instance.worldFromObject, std::uint32_t(i));
  }
  e.commit(e.top);
}

TraceScene::~TraceScene() = default;

const RasterScene& TraceScene::raster() const {
  std::call_once(rasterOnce_, [&] {
    // Isolated, so that no task of another render begins here, asks for the same and waits for itself.
    tbb::this_task_arena::isolate([&] {
      raster_ = std::make_unique<const RasterScene>(*this, Job{.memoryBudgetBytes = embree_->budgetBytes});
    });
  });
  return *raster_;
}

namespace {
RTCRay embreeRay(const Ray& ray) {
  const vec3 o = ray.origin;
  const vec3 d = ray.direction;
  return {o.x, o.y, o.z, ray.tMin, d.x, d.y, d.z, 0.0f, ray.tMax, 0xffffffffu, 0, 0};
}
}  // namespace

Hit TraceScene::closestHit(const Ray& ray, Blended blended) const {
  Query query(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  query.blended = blended;
  query.salts = &ray.salt;
  RTCRayHit q;
  q.ray = embreeRay(ray);
  q.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(embree_->top, &query.context, &q);
  return embree_->hitFrom(q.ray.tfar, q.hit.u, q.hit.v, q.hit.geomID, q.hit.primID, q.hit.instID[0]);
}

bool TraceScene::occluded(const Ray& ray) const {
  Query query(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  query.salts = &ray.salt;
  RTCRay q = embreeRay(ray);
  rtcOccluded1(embree_->top, &query.context, &q);
  return q.tfar < 0.0f;
}

float TraceScene::coverageAt(const Hit& hit) const {
  const ShadedInstance& instance = instances_[hit.instance];
  if (!instance.shadedMaterial->blended) return 1.0f;
  return alphaAt(scene_, scene_.meshes[scene_.instances[hit.instance].mesh], hit.triangle, hit.u, hit.v);
}

namespace {

void load(std::span<const Ray> rays, RTCRay16& q, int* valid, std::uint32_t* salts) {
  for (std::size_t i = 0; i < 16; ++i) {
    valid[i] = i < rays.size() ? -1 : 0;
    const Ray& ray = rays[std::min(i, rays.size() - 1)];
    q.org_x[i] = ray.origin.x;
    q.org_y[i] = ray.origin.y;
    q.org_z[i] = ray.origin.z;
    q.tnear[i] = ray.tMin;
    q.dir_x[i] = ray.direction.x;
    q.dir_y[i] = ray.direction.y;
    q.dir_z[i] = ray.direction.z;
    q.time[i] = 0.0f;
    q.tfar[i] = ray.tMax;
    q.mask[i] = 0xffffffffu;
    q.id[i] = unsigned(i);
    salts[i] = ray.salt;
    q.flags[i] = 0;
  }
}

void load(const RayColumns& rays, RTCRay16& q) {
  for (std::size_t i = 0; i < 16; ++i) {
    q.org_x[i] = rays.origin[0][i];
    q.org_y[i] = rays.origin[1][i];
    q.org_z[i] = rays.origin[2][i];
    q.dir_x[i] = rays.direction[0][i];
    q.dir_y[i] = rays.direction[1][i];
    q.dir_z[i] = rays.direction[2][i];
    q.tnear[i] = q.time[i] = 0.0f;
    q.tfar[i] = 1e30f;
    q.mask[i] = 0xffffffffu;
    q.id[i] = unsigned(i);
    q.flags[i] = 0;
  }
}

RTCIntersectContextFlags flagFor(bool coherent) {
  return coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
}

}  // namespace

/// Sixteen rays and hits as Embree lays them out.
struct TraceScene::Sixteen {
  alignas(64) RTCRayHit16 q;
  alignas(64) int valid[16];
  std::uint32_t salts[16];

  void intersect(const Embree& e, Query& query, std::span<Hit> hits) {
    for (int i = 0; i < 16; ++i) q.hit.geomID[i] = q.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect16(valid, e.top, &query.context, &q);
    for (std::size_t i = 0; i < hits.size(); ++i)
      hits[i] = e.hitFrom(q.ray.tfar[i], q.hit.u[i], q.hit.v[i], q.hit.geomID[i], q.hit.primID[i],
                          q.hit.instID[0][i]);
  }
};

void TraceScene::closestHits(std::span<const Ray> rays, std::span<Hit> hits, bool coherent,
                             Blended blended) const {
  if (rays.empty()) return;
  Sixteen sixteen;
  load(rays, sixteen.q.ray, sixteen.valid, sixteen.salts);
  Query query(flagFor(coherent));
  query.blended = blended;
  query.salts = sixteen.salts;
  sixteen.intersect(*embree_, query, hits);
}

void TraceScene::closestHits(const RayColumns& rays, std::span<Hit> hits, bool coherent) const {
  if (hits.empty()) return;
  Sixteen sixteen;
  for (std::size_t i = 0; i < 16; ++i) sixteen.valid[i] = i < hits.size() ? -1 : 0;
  load(rays, sixteen.q.ray);
  Query query(flagFor(coherent));
  sixteen.intersect(*embree_, query, hits);
}

// Never with the coherent flag: Embree 3.13.5 then loops for ever on ordinary packets where there are
// instances.
void TraceScene::occluded(std::span<const Ray> rays, std::span<std::uint8_t> occluded) const {
  if (rays.empty()) return;
  alignas(64) RTCRay16 q;
  alignas(64) int valid[16];
  std::uint32_t salts[16];
  load(rays, q, valid, salts);
  Query query(flagFor(false));
  query.salts = salts;
  rtcOccluded16(valid, embree_->top, &query.context, &q);
  for (std::size_t i = 0; i < rays.size(); ++i) occluded[i] = q.tfar[i] < 0.0f ? 1 : 0;
}

void TraceScene::visibility(std::span<const Ray> rays, std::span<float> visible) const {
  if (rays.empty()) return;
  alignas(64) RTCRay16 q;
  alignas(64) int valid[16];
  std::uint32_t salts[16];
  load(rays, q, valid, salts);
  float left[16];
  std::fill_n(left, 16, 1.0f);
  Query query(flagFor(false));
  query.visible = left;
  rtcOccluded16(valid, embree_->top, &query.context, &q);
  for (std::size_t i = 0; i < rays.size(); ++i) visible[i] = q.tfar[i] < 0.0f ? 0.0f : left[i];
}

void TraceScene::visibility(const RayColumns& rays, const float* distances, std::uint32_t wanted,
                            float* visible) const {
  alignas(64) RTCRay16 q;
  alignas(64) int valid[16];
  for (std::uint32_t i = 0; i < 16; ++i) valid[i] = (wanted >> i & 1u) != 0u ? -1 : 0;
  load(rays, q);
  std::copy_n(distances, 16, q.tfar);
  float left[16];
  std::fill_n(left, 16, 1.0f);
  Query query(flagFor(false));
  query.visible = left;
  rtcOccluded16(valid, embree_->top, &query.context, &q);
  for (std::uint32_t i = 0; i < 16; ++i) visible[i] = valid[i] == 0 || q.tfar[i] < 0.0f ? 0.0f : left[i];
}

}  // namespace isophote
