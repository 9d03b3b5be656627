// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/gbuffer/eye_paths.h"

#include "math/rng.shared.h"
#include "physics/shading_normal.shared.h"
#include "trace/light_sampler.h"

namespace isophote::gbuffer {

namespace {

/// Stands for "the eye" where random numbers are keyed by light.
constexpr std::uint32_t kEyeStream = 0xfffffffeu;
/// Up to this depth a path through glass follows both the reflection and the refraction; deeper it chooses
/// one.
constexpr std::uint32_t kSplitDepth = 2;
/// A path of less throughput survives with a probability in proportion.
constexpr float kRouletteThroughput = 0.02f;
/// Blended surfaces behind one another that a path sees at most.
constexpr std::uint32_t kMostLayers = 256;

}  // namespace

/// The paths of one pixel.
struct EyePaths::Pixel {
  const Options& options;
  std::uint32_t index;
  std::vector<Path>& pending;
  std::vector<ViewSample>& secondary;
  FirstSurface& out;
  std::uint32_t event = 0;

  void shade(const Path& path, const Hit& hit, bool first) {
    out.emitted += path.throughput * shapeLightRadiance(options.trace, path.ray, hit);
    if (!hit.valid()) return;
    const Surface s = surfaceAt(options.trace, path.ray, hit);
    // What is met from its inside is what was gone through, whatever the path has entered before.
    const vec3 absorption = s.solid > 0.5f && s.entering < 0.5f ? s.absorption : path.absorption;
    Path here = path;
    here.absorption = absorption;
    here.throughput *= transmittanceOver(absorption, hit.t);
    if (s.coverage < 1.0f) {
      seeThrough(here, s);
      here.throughput *= s.coverage;
    }
    shadeSurface(here, s, first);
  }

  /// Goes on behind a blended surface with what it lets through.
  void seeThrough(const Path& path, const Surface& s) {
    if (path.layers >= kMostLayers) return;
    const float u = random3(pathKey(options.seed, options.pass, kEyeStream, index), event++, 1).x;
    const std::size_t before = pending.size();
    push(path, s, path.ray.direction, vec3(1.0f - s.coverage), u, path.absorption);
    if (pending.size() == before) return;
    pending.back().depth = path.depth;
    pending.back().layers = path.layers + 1;
  }

  void shadeSurface(const Path& path, const Surface& s, bool first) {
    out.emitted += path.throughput * s.emission;
    const vec3 wo = -path.ray.direction;
    const bool lit = hasNonDeltaLobe(s.bsdf) > 0.5f;
    const vec3 throughput = path.throughput * viewFade(wo, s.ng, s.ns);
    const ViewSample sample{s.position, s.ng, s.ns, wo, s.bsdf, throughput, index, s.entering};
    if (first) {
      out.met = true;
      out.lit = lit;
      out.sample = sample;
      out.baseColour = s.baseColour;
      out.ns = s.ns;
    } else if (lit) {
      secondary.push_back(sample);
    }
    if (hasDeltaLobe(s.bsdf) > 0.5f && path.depth < options.mirrorDepth) scatterSpecularly(path, s, wo);
  }

  void scatterSpecularly(const Path& path, const Surface& s, vec3 wo) {
    const float cosO = abs(dot(wo, s.ns));
    const vec3 reflected = s.bsdf.alpha > 0.0f ? vec3(0.0f) : mirrorReflectance(s.bsdf, cosO, s.entering);
    const vec3 refracted =
        refractsRoughly(s.bsdf) > 0.5f ? vec3(0.0f) : refractedPart(s.bsdf, cosO, s.entering);
    const float r = meanOf(reflected);
    const float t = meanOf(refracted);
    if (r + t <= 0.0f) return;
    const vec3 u = random3(pathKey(options.seed, options.pass, kEyeStream, index), event++, 0);
    const bool both = path.depth < kSplitDepth;
    const bool reflect = u.x * (r + t) < r;
    const float odds = both ? 1.0f : reflect ? (r + t) / r : (r + t) / t;
    if (r > 0.0f && (both || reflect)) {
      const vec3 direction = mirrorDirection(wo, s.ng, s.ns);
      push(path, s, direction, reflected * (odds * eyeShadingFactor(direction, wo, s.ng, s.ns)), u.y,
           path.absorption);
    }
    if (t > 0.0f && (both || !reflect)) {
      float etaScale = 1.0f;
      const vec3 direction = refractionOf(s.bsdf, wo, s.ng, s.ns, s.entering, etaScale);
      const vec3 beyond = s.solid < 0.5f ? path.absorption : s.entering > 0.5f ? s.absorption : vec3(0.0f);
      push(path, s, direction, refracted * (odds * etaScale * eyeShadingFactor(direction, wo, s.ng, s.ns)),
           u.z, beyond);
    }
  }

  void push(const Path& path, const Surface& s, vec3 direction, vec3 weight, float u, vec3 absorption) {
    vec3 throughput = path.throughput * weight;
    const float survival = min(maxOf(throughput) / kRouletteThroughput, 1.0f);
    if (u >= survival) return;
    throughput = throughput / survival;
    pending.push_back(
        {rayFrom(s.position, s.ng, direction), throughput, path.depth + 1, path.layers, absorption});
  }
};

FirstSurface EyePaths::follow(const Options& options, std::uint32_t pixel, const Ray& ray, const Hit& hit,
                              std::vector<ViewSample>& secondary) {
  FirstSurface first;
  Pixel paths{options, pixel, pending_, secondary, first};
  paths.shade({ray, vec3(1.0f), 0, 0}, hit, true);
  while (!pending_.empty()) {
    const Path path = pending_.back();
    pending_.pop_back();
    paths.shade(path, options.trace.closestHit(path.ray, Blended::kAlways), false);
  }
  return first;
}

}  // namespace isophote::gbuffer
