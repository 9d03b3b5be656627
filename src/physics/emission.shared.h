// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Light leaving its sources: photon emission, samples of a source seen from a point (next-event estimation)
// and their densities. Lights emit but do not block: a sphere or rectangle lets other light pass.
#ifndef ISOPHOTE_PHYSICS_EMISSION_SHARED_H
#define ISOPHOTE_PHYSICS_EMISSION_SHARED_H

#include "math/sampling.shared.h"
#include "math/shared.h"
#include "physics/environment.shared.h"
#include "physics/light.shared.h"

SHARED_BEGIN

SHARED_CONST float kInfiniteDistance = 1e30f;

/// One emitted photon that stands for all of its light: divide `power` by the number of photons of this
/// light.
struct EmittedPhoton {
  vec3 origin;
  vec3 direction;  ///< Unit, of travel.
  vec3 power;      ///< Emitted radiance (or its like) over the density of this choice [W].
};

/// A light as seen from one point: reflected radiance = f * |cos| * radiance / pdf, if nothing lies in
/// between.
struct LightSample {
  vec3 wi;         ///< Unit, towards the light.
  float distance;  ///< kInfiniteDistance for lights at infinity [m].
  vec3 radiance;   ///< Deltas (point, spot, directional): irradiance on a surface facing the light; pdf is
                   ///< then 1.
  float pdf;       ///< Per solid angle; 0: no light from there.
  float isDelta;
};

/// Falloff of a spot light's intensity with the angle off its axis (KHR_lights_punctual).
SHARED_FN float spotFalloff(Light light, float cosTheta) {
  float t = clamp((cosTheta - light.cosOuter) / max(light.cosInner - light.cosOuter, 1e-4f), 0.0f, 1.0f);
  return t * t;
}

/// Radiance of a point light's sphere.
SHARED_FN vec3 sphereRadiance(Light light) { return light.colour * (kInvPi / (light.radius * light.radius)); }

SHARED_FN EmittedPhoton emitPoint(Light light, vec2 uPosition, vec2 uDirection) {
  EmittedPhoton e;
  vec3 normal = sampleSphere(uPosition);
  float sphere = light.radius > 0.0f ? 1.0f : 0.0f;
  e.origin = light.position + normal * light.radius;
  e.direction =
      sphere > 0.5f ? basisAround(normal) * sampleCosineHemisphere(uDirection) : sampleSphere(uDirection);
  e.power = light.colour * (4.0f * kPi);
  return e;
}

SHARED_FN EmittedPhoton emitSpot(Light light, vec2 uDirection) {
  EmittedPhoton e;
  vec3 local = sampleCone(uDirection, light.cosOuter);
  e.origin = light.position;
  e.direction = basisAround(light.direction) * local;
  e.power = light.colour * (spotFalloff(light, local.z) * 2.0f * kPi * (1.0f - light.cosOuter));
  return e;
}

/// Half extents of the rectangle, perpendicular to `direction` in basisAround(direction), that covers the box
/// of half extents `halfSize`; z is the box's half depth along the direction.
SHARED_FN vec3 projectedHalfExtents(vec3 direction, vec3 halfSize) {
  mat3 frame = basisAround(direction);
  return vec3(dot(abs(frame[0]), halfSize), dot(abs(frame[1]), halfSize), dot(abs(frame[2]), halfSize));
}

/// Into the scene's bounding box (centre, halfSize), which every photon meets.
SHARED_FN EmittedPhoton emitDirectional(Light light, vec3 centre, vec3 halfSize, vec2 uPosition) {
  EmittedPhoton e;
  e.origin = originBeforeBox(light.direction, centre, halfSize, uPosition);
  e.direction = light.direction;
  e.power = light.colour * boxOutline(light.direction, halfSize);
  return e;
}

SHARED_FN EmittedPhoton emitRectangle(Light light, vec2 uPosition, vec2 uDirection) {
  EmittedPhoton e;
  e.origin = light.position + light.edgeU * uPosition.x + light.edgeV * uPosition.y;
  e.direction = basisAround(light.direction) * sampleCosineHemisphere(uDirection);
  e.power = light.colour * (kPi * light.area);
  return e;
}

/// `probability` is that of having chosen this triangle among its light's. Of a double-sided one uSide picks
/// the side.
SHARED_FN EmittedPhoton emitTriangle(EmissiveTriangle t, float probability, float uSide, vec2 uPosition,
                                     vec2 uDirection) {
  EmittedPhoton e;
  vec2 b = sampleTriangle(uPosition);
  vec3 normal = cross(t.edge1, t.edge2);
  float area2 = length(normal);
  float back = t.doubleSided != 0u && uSide < 0.5f ? -1.0f : 1.0f;
  normal = normal * (back / max(area2, 1e-30f));
  e.origin = t.v0 + t.edge1 * b.x + t.edge2 * b.y;
  e.direction = basisAround(normal) * sampleCosineHemisphere(uDirection);
  e.power = t.radiance * (kPi * 0.5f * area2 * (t.doubleSided != 0u ? 2.0f : 1.0f) / probability);
  return e;
}

/// Constant light through the surface of the scene's bounding box, which every photon meets: all carry the
/// same power. uSide picks one of two opposite faces.
SHARED_FN EmittedPhoton emitEnvironment(Light light, vec3 centre, vec3 halfSize, float uSide, vec2 uPosition,
                                        vec2 uDirection) {
  EmittedPhoton e;
  float outside = uSide < 0.5f ? -1.0f : 1.0f;
  vec3 axis;
  vec3 p = pointOnFaces(boxFaces(halfSize), vec3(outside), uPosition, axis);
  e.direction = basisAround(axis * -outside) * sampleCosineHemisphere(uDirection);
  e.origin = centre + p * halfSize - e.direction * (length(halfSize) + 1e-3f);
  vec3 faces = boxFaces(halfSize);
  e.power = light.colour * (2.0f * kPi * (faces.x + faces.y + faces.z));
  return e;
}

/// 1 - cos of the half angle under which a point light's sphere is seen from that distance; 0 for a true
/// point and from inside. Keeps its digits for a far, small sphere.
SHARED_FN float sphereOneMinusCos(Light light, float distance2) {
  float sin2 = light.radius * light.radius / distance2;
  return sin2 < 1.0f ? sin2 / (1.0f + sqrt(1.0f - sin2)) : 0.0f;
}

/// samplePoint's density of a direction that hits the sphere; 0 from inside.
SHARED_FN float sphereLightPdf(Light light, vec3 from) {
  vec3 toCentre = light.position - from;
  float oneMinusCos = sphereOneMinusCos(light, max(dot(toCentre, toCentre), 1e-12f));
  return oneMinusCos > 0.0f ? 1.0f / (2.0f * kPi * oneMinusCos) : 0.0f;
}

SHARED_FN LightSample samplePoint(Light light, vec3 from, vec2 u) {
  LightSample s;
  vec3 toCentre = light.position - from;
  float distance2 = max(dot(toCentre, toCentre), 1e-12f);
  float centreDistance = sqrt(distance2);
  vec3 axis = dot(toCentre, toCentre) > 0.0f ? toCentre / centreDistance : vec3(0.0f, 0.0f, 1.0f);
  float oneMinusCos = sphereOneMinusCos(light, distance2);
  s.isDelta = light.radius > 0.0f ? 0.0f : 1.0f;
  s.wi = s.isDelta > 0.5f ? axis : normalize(basisAround(axis) * sampleNarrowCone(u, oneMinusCos));
  float along = dot(toCentre, s.wi);
  // The perpendicular offset is formed as a vector: the difference of squares has no digits left far away.
  vec3 offset = toCentre - s.wi * along;
  float under = max(0.0f, light.radius * light.radius - dot(offset, offset));
  s.distance = s.isDelta > 0.5f ? centreDistance : along - sqrt(under);
  s.radiance = s.isDelta > 0.5f ? light.colour / distance2 : sphereRadiance(light);
  s.pdf = s.isDelta > 0.5f ? 1.0f : sphereLightPdf(light, from);
  return s;
}

SHARED_FN LightSample sampleSpot(Light light, vec3 from) {
  LightSample s;
  vec3 toLight = light.position - from;
  float distance2 = max(dot(toLight, toLight), 1e-12f);
  s.distance = sqrt(distance2);
  s.wi = toLight / s.distance;
  s.radiance = light.colour * (spotFalloff(light, -dot(s.wi, light.direction)) / distance2);
  s.pdf = 1.0f;
  s.isDelta = 1.0f;
  return s;
}

SHARED_FN LightSample sampleDirectional(Light light) {
  LightSample s;
  s.wi = -light.direction;
  s.distance = kInfiniteDistance;
  s.radiance = light.colour;
  s.pdf = 1.0f;
  s.isDelta = 1.0f;
  return s;
}

/// Solid-angle density of a uniform point on a flat emitter of that area, from `toPoint` away; 0 from behind.
SHARED_FN float areaSamplePdf(vec3 toPoint, vec3 emitterNormal, float area) {
  float distance2 = dot(toPoint, toPoint);
  float cosEmitter = -dot(toPoint, emitterNormal);  // times the distance
  return cosEmitter > 0.0f ? distance2 * sqrt(distance2) / (cosEmitter * area) : 0.0f;
}

SHARED_FN LightSample sampleFlat(vec3 point, vec3 normal, float area, vec3 radiance, vec3 from) {
  LightSample s;
  vec3 toPoint = point - from;
  s.distance = length(toPoint);
  s.wi = toPoint / max(s.distance, 1e-20f);
  s.radiance = radiance;
  s.pdf = areaSamplePdf(toPoint, normal, area);
  s.isDelta = 0.0f;
  return s;
}

SHARED_FN LightSample sampleRectangle(Light light, vec3 from, vec2 u) {
  return sampleFlat(light.position + light.edgeU * u.x + light.edgeV * u.y, light.direction, light.area,
                    light.colour, from);
}

/// `probability` is that of having chosen this triangle among its light's.
SHARED_FN LightSample sampleEmissiveTriangle(EmissiveTriangle t, float probability, vec3 from, vec2 u) {
  vec2 b = sampleTriangle(u);
  vec3 normal = cross(t.edge1, t.edge2);
  float area2 = length(normal);
  normal = normal / max(area2, 1e-30f);
  vec3 point = t.v0 + t.edge1 * b.x + t.edge2 * b.y;
  float turned = t.doubleSided != 0u && dot(point - from, normal) > 0.0f ? -1.0f : 1.0f;
  LightSample s = sampleFlat(point, normal * turned, 0.5f * area2, t.radiance, from);
  s.pdf = s.pdf * probability;
  return s;
}

/// Of a constant environment, cosine-distributed around n.
SHARED_FN LightSample sampleEnvironment(Light light, vec3 n, vec2 u) {
  LightSample s;
  vec3 local = sampleCosineHemisphere(u);
  s.wi = basisAround(n) * local;
  s.distance = kInfiniteDistance;
  s.radiance = light.colour;
  s.pdf = local.z * kInvPi;
  s.isDelta = 0.0f;
  return s;
}

/// Distance along the unit ray to the front of a point light's sphere; negative: missed, behind, or from
/// inside.
SHARED_FN float intersectSphereLight(Light light, vec3 origin, vec3 direction) {
  vec3 toCentre = light.position - origin;
  float along = dot(toCentre, direction);
  // The perpendicular offset is formed as a vector: the difference of squares has no digits left far away.
  vec3 offset = toCentre - direction * along;
  float under = light.radius * light.radius - dot(offset, offset);
  float t = along - sqrt(max(under, 0.0f));
  return under > 0.0f && light.radius > 0.0f ? t : -1.0f;
}

/// Distance along the unit ray to a rectangle light's front; negative: missed or seen from behind.
SHARED_FN float intersectRectangleLight(Light light, vec3 origin, vec3 direction) {
  float cosine = dot(direction, light.direction);
  float t = dot(light.position - origin, light.direction) / (abs(cosine) > 1e-12f ? cosine : 1e-12f);
  vec3 p = origin + direction * t - light.position;
  // Coordinates in the (possibly skewed) edges.
  vec3 n = cross(light.edgeU, light.edgeV);
  float inverse = 1.0f / max(dot(n, n), 1e-30f);
  float u = dot(cross(p, light.edgeV), n) * inverse;
  float v = dot(cross(light.edgeU, p), n) * inverse;
  float inside = u >= 0.0f && u <= 1.0f && v >= 0.0f && v <= 1.0f && cosine < 0.0f ? 1.0f : 0.0f;
  return inside > 0.5f ? t : -1.0f;
}

SHARED_END

#endif
