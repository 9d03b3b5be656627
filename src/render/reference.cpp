// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/reference.h"

#include "math/rng.shared.h"
#include "math/sobol.shared.h"
#include "physics/shading_normal.shared.h"
#include "settings/apply.h"
#include "trace/light_sampler.h"
#include "trace/surface.h"

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>

namespace isophote {

namespace {

constexpr std::uint32_t kReferenceStream = 0xfffffffcu;
constexpr std::uint32_t kSamplesPerRound = 8;
/// Scattering events after which roulette may end a path.
constexpr std::uint32_t kRouletteStart = 3;

/// Random numbers of one path: the first triples from a Sobol sequence over the pixel's paths, scrambled for
/// each pixel; then independent ones.
class PathSampler {
 public:
  PathSampler(std::uint32_t seed, std::uint32_t pixel, std::uint32_t sample)
      : pixelKey_(pathKey(seed, 0, kReferenceStream, pixel)), sample_(sample) {}

  vec3 next() {
    const std::uint32_t triple = triple_++;
    if (3 * triple + 2 >= kSobolDimensions) return random3(pixelKey_, sample_, triple);
    const uvec3 scramble = hash3(uvec3(pixelKey_, triple, 0x9e3779b9u));
    return {unitFloat(owenScramble(sobolBits(sample_, 3 * triple), scramble.x)),
            unitFloat(owenScramble(sobolBits(sample_, 3 * triple + 1), scramble.y)),
            unitFloat(owenScramble(sobolBits(sample_, 3 * triple + 2), scramble.z))};
  }

  /// Tells the rays of one pixel apart that are otherwise the same.
  std::uint32_t salt() const { return sample_; }

 private:
  std::uint32_t pixelKey_;
  std::uint32_t sample_;
  std::uint32_t triple_ = 0;
};

/// Which light next-event estimation asks: half by power, half evenly, so that a weak light nearby is not
/// forgotten.
class LightChoice {
 public:
  explicit LightChoice(const Scene& scene) {
    double total = 0;
    for (const Light& light : scene.lights) total += double(light.power);
    const double even = scene.lights.empty() ? 0.0 : 1.0 / double(scene.lights.size());
    double cumulative = 0;
    for (const Light& light : scene.lights) {
      const double p = total > 0 ? 0.5 * (even + double(light.power) / total) : even;
      cumulative += p;
      probability_.push_back(float(p));
      cumulative_.push_back(float(cumulative));
    }
  }

  bool empty() const { return probability_.empty(); }
  float probability(std::uint32_t light) const { return probability_[light]; }
  std::uint32_t choose(float u) const {
    const auto at = std::upper_bound(cumulative_.begin(), cumulative_.end(), u) - cumulative_.begin();
    return std::uint32_t(std::min<std::ptrdiff_t>(at, std::ptrdiff_t(cumulative_.size()) - 1));
  }
  /// u's place within the light that it chose, a fresh number in [0, 1).
  float reuse(float u, std::uint32_t light) const {
    const float begin = light == 0 ? 0.0f : cumulative_[light - 1];
    return std::clamp((u - begin) / probability_[light], 0.0f, 0x1.fffffep-1f);
  }

 private:
  std::vector<float> probability_;
  std::vector<float> cumulative_;
};

/// Radiance along one path, by kind.
struct PathRadiance {
  vec3 emitted{0.0f};
  vec3 direct{0.0f};
  vec3 indirect{0.0f};
};

struct World {
  const TraceScene& trace;
  const LightSampler& lights;
  const LightChoice& choice;
  const ReferenceSettings& settings;
  CameraRays camera;
};

/// One path from the eye. Vertices up to the first non-specular surface belong to the eye; `events` counts
/// the scattering after that, so that light found from a vertex by next-event estimation has scattered
/// `events` times before its last surface.
class EyePath {
 public:
  EyePath(const World& world, PathSampler& random) : world_(world), random_(random) {}

  PathRadiance trace(Ray ray) {
    for (;;) {
      const Hit hit = world_.trace.closestHit(ray);
      // What the eye sees of the lights is as render() shows it, textures and all.
      if (seenByEye_)
        radiance_.emitted += throughput_ * shapeLightRadiance(world_.trace, ray, hit);
      else
        addMetLights(ray, hit);
      // Light found from the next vertex would exceed the limit, and so would all after it.
      if (!hit.valid() || events_ > world_.settings.bounces) return radiance_;
      const Surface s = surfaceAt(world_.trace, ray, hit);
      // What is met from its inside is what was gone through, whatever the path has entered before.
      if (s.solid > 0.5f && s.entering < 0.5f) absorption_ = s.absorption;
      throughput_ *= transmittanceOver(absorption_, hit.t);
      if (seenByEye_) radiance_.emitted += throughput_ * s.emission;
      const vec3 wo = -ray.direction;
      addSampledLight(s, wo);
      if (!scatter(s, wo, ray)) return radiance_;
    }
  }

 private:
  void add(std::uint32_t events, vec3 contribution) {
    if (events == 0)
      radiance_.direct += contribution;
    else if (events <= world_.settings.bounces)
      radiance_.indirect += contribution;
  }

  void addMetLights(const Ray& ray, const Hit& hit) {
    world_.lights.visitMet(
        world_.trace, ray, hit, lastNg_, [&](std::uint32_t light, vec3 emitted, float pdf) {
          // The density that next-event estimation would have had; none after a delta.
          const float other = lastPdf_ > 0.0f ? pdf * world_.choice.probability(light) : 0.0f;
          const float weight = lastPdf_ > 0.0f ? lastPdf_ / (lastPdf_ + other) : 1.0f;
          add(events_ - 1, throughput_ * emitted * weight);
        });
  }

  /// Light of the side that the path came from, and through rough glass that of the other.
  void addSampledLight(const Surface& s, vec3 wo) {
    const vec3 u = random_.next();
    if (world_.choice.empty() || hasNonDeltaLobe(s.bsdf) < 0.5f) return;
    addSampledSide(s, wo, s.ng, u);
    if (refractsRoughly(s.bsdf) > 0.5f) addSampledSide(s, wo, -s.ng, random_.next());
  }

  /// ng: the geometric normal, on the side whose light is sampled.
  void addSampledSide(const Surface& s, vec3 wo, vec3 ng, vec3 u) {
    const std::uint32_t light = world_.choice.choose(u.x);
    const float probability = world_.choice.probability(light);
    const LightSample l =
        world_.lights.sample(light, s.position, ng, vec3(world_.choice.reuse(u.x, light), u.y, u.z));
    if (!(l.pdf > 0.0f) || dot(l.wi, ng) <= 0.0f) return;
    const vec3 f = evalBsdf(s.bsdf, l.wi, wo, s.ng, s.ns, s.entering) *
                   (abs(dot(l.wi, s.ns)) * eyeShadingFactor(l.wi, wo, s.ng, s.ns));
    if (maxOf(f) <= 0.0f) return;
    Ray ray = rayFrom(s.position, s.ng, l.wi, l.distance * (1.0f - 1e-4f));
    ray.salt = random_.salt();
    if (world_.trace.occluded(ray)) return;
    const float density = l.pdf * probability;
    const float other = l.isDelta > 0.5f ? 0.0f : pdfBsdf(s.bsdf, l.wi, wo, s.ng, s.ns, s.entering);
    add(events_, throughput_ * f * l.radiance * (1.0f / (density + other)));
  }

  /// Samples the way on; false where the path ends.
  bool scatter(const Surface& s, vec3 wo, Ray& ray) {
    const BsdfSample b = sampleBsdf(s.bsdf, wo, s.ng, s.ns, s.entering, random_.next());
    if (b.lobe == kLobeNone) return false;
    const bool delta = b.lobe == kLobeMirror || b.lobe == kLobeRefract;
    throughput_ *= b.weight * (b.etaScale * eyeShadingFactor(b.wi, wo, s.ng, s.ns));
    if (seenByEye_ && delta) {
      if (++mirrorEvents_ > world_.settings.mirrorDepth) return false;
    } else {
      seenByEye_ = false;
      ++events_;
    }
    if (events_ > kRouletteStart) {
      const float survival = std::min(maxOf(throughput_), 1.0f);
      if (random_.next().x >= survival) return false;
      throughput_ = throughput_ / survival;
    }
    lastPdf_ = b.pdf;
    lastNg_ = dot(b.wi, s.ng) >= 0.0f ? s.ng : -s.ng;
    if (s.solid > 0.5f && dot(b.wi, s.ng) < 0.0f) absorption_ = s.entering > 0.5f ? s.absorption : vec3(0.0f);
    ray = rayFrom(s.position, s.ng, b.wi);
    ray.salt = random_.salt();
    return true;
  }

  const World& world_;
  PathSampler& random_;
  PathRadiance radiance_;
  vec3 throughput_{1.0f};
  bool seenByEye_ = true;
  std::uint32_t mirrorEvents_ = 0;
  std::uint32_t events_ = 0;
  float lastPdf_ = 0;  ///< Of the last scattering; 0 for deltas and the eye.
  vec3 lastNg_{0, 0, 1};
  vec3 absorption_{0.0f};  ///< Of the solid that the path goes through [1/m].
};

/// Sums over the paths of each pixel; double, so that a million paths still add up.
struct Sums {
  std::vector<glm::dvec3> emitted, direct, indirect, squares;

  explicit Sums(std::size_t pixels)
      : emitted(pixels, glm::dvec3(0)), direct(emitted), indirect(emitted), squares(emitted) {}

  void add(std::size_t pixel, const PathRadiance& r, bool indirectOnly) {
    emitted[pixel] += r.emitted;
    direct[pixel] += r.direct;
    indirect[pixel] += r.indirect;
    const glm::dvec3 colour = indirectOnly ? r.indirect : r.emitted + r.direct + r.indirect;
    squares[pixel] += colour * colour;
  }
};

void traceRound(const World& world, std::uint32_t firstSample, std::uint32_t samples, Sums& sums,
                const Job& job) {
  const ReferenceSettings& settings = world.settings;
  const vec2 size(float(settings.width), float(settings.height));
  using Range = tbb::blocked_range2d<std::uint32_t>;
  tbb::parallel_for(Range(0, settings.height, 8, 0, settings.width, 8), [&](const Range& range) {
    for (std::uint32_t y = range.rows().begin(); y < range.rows().end(); ++y)
      for (std::uint32_t x = range.cols().begin(); x < range.cols().end(); ++x) {
        if (job.stop.stop_requested()) return;
        const std::uint32_t pixel = y * settings.width + x;
        for (std::uint32_t i = firstSample; i < firstSample + samples; ++i) {
          PathSampler random(settings.seed, pixel, i);
          const vec3 u = random.next();
          const vec2 inPixel = settings.aa == 1 ? vec2(0.5f) : vec2(u.x, u.y);
          const vec2 p = imagePlaneFromPixel(vec2(float(x), float(y)) + inPixel, size);
          const Ray ray{cameraRayOrigin(world.camera, p), 0.0f, cameraRayDirection(world.camera, p), 1e30f,
                        random.salt()};
          sums.add(pixel, EyePath(world, random).trace(ray), settings.indirectOnly);
        }
      }
  });
  job.throwIfStopped();
}

Film filmFrom(const Sums& sums, const ReferenceSettings& settings, std::uint32_t samples) {
  const int width = int(settings.width);
  const int height = int(settings.height);
  Film film;
  film.colour = Image(width, height);
  for (const char* layer : {"direct", "indirect", "emitted", "variance"})
    film.layers[layer] = Image(width, height);
  const double n = double(samples);
  for (std::size_t i = 0; i < film.colour.pixels.size(); ++i) {
    const glm::dvec3 indirect = sums.indirect[i] / n;
    const glm::dvec3 colour =
        settings.indirectOnly ? indirect : (sums.emitted[i] + sums.direct[i]) / n + indirect;
    film.colour.pixels[i] = vec3(colour);
    film.layers["direct"].pixels[i] = vec3(sums.direct[i] / n);
    film.layers["indirect"].pixels[i] = vec3(indirect);
    film.layers["emitted"].pixels[i] = vec3(sums.emitted[i] / n);
    const glm::dvec3 variance = (sums.squares[i] / n - colour * colour) / std::max(n - 1.0, 1.0);
    film.layers["variance"].pixels[i] = vec3(glm::max(variance, glm::dvec3(0)));
  }
  return film;
}

void warnOfUnreachableCaustics(const Scene& scene, const Job& job) {
  const bool specular =
      std::any_of(scene.materials.begin(), scene.materials.end(), [](const NamedMaterial& m) {
        return m.roughness <= kMirrorRoughness &&
               (m.transmission > 0.0f || m.metallic > 0.0f || m.specular > 0.0f);
      });
  const bool delta = std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& l) {
    return l.type == kLightSpot || l.type == kLightDirectional || (l.type == kLightPoint && l.radius == 0.0f);
  });
  if (specular && delta)
    job.warn(
        "no path from the eye finds caustics of a light without extent: give point lights a radius to "
        "compare caustics");
}

}  // namespace

Film renderReference(const Scene& scene, const Camera& camera, const ReferenceSettings& settings,
                     Stats& stats, const Job& job) {
  stats.engine = "reference";
  stats.device = processorName();
  warnOfUnreachableCaustics(scene, job);
  const TraceScene trace(scene, job);
  const LightSampler lights(trace);
  const LightChoice choice(scene);
  const World world{trace, lights, choice, settings,
                    cameraRays(camera, int(settings.width), int(settings.height))};

  Sums sums(std::size_t(settings.width) * settings.height);
  std::uint32_t samples = 0;
  const auto scope = stats.scope("reference");
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const auto done = [&] {
    return settings.timeSeconds > 0 ? elapsed() / double(settings.timeSeconds)
                                    : double(samples) / settings.spp;
  };
  while (done() < 1.0) {
    const std::uint32_t round =
        settings.timeSeconds > 0 ? kSamplesPerRound : std::min(kSamplesPerRound, settings.spp - samples);
    traceRound(world, samples, round, sums, job);
    samples += round;
    job.report("path tracing", std::min(done(), 1.0));
  }
  stats.setCounter("samplesPerPixel", double(samples));
  Film film = filmFrom(sums, settings, samples);
  ReferenceSettings copy = settings;
  for (const Field& field : fieldsOf(copy, "reference"))
    film.metadata.emplace_back(field.key, valueText(field));
  return film;
}

}  // namespace isophote
