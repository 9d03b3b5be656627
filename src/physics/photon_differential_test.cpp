// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Differentials against differences between neighbouring rays.
#include "physics/photon_differential.shared.h"

#include "physics/bsdf.shared.h"

#include <gtest/gtest.h>

#include <functional>

namespace isophote {
namespace {

using Vec = glm::dvec3;

struct RayOf {
  Vec origin, direction;
};

constexpr double kStep = 1e-5;

void expectClose(vec3 got, Vec wanted, const char* what) {
  EXPECT_NEAR(double(length(got - vec3(wanted))), 0.0, 1e-3 * (1.0 + glm::length(wanted))) << what;
}

/// What a sphere of radius 1 around the origin makes of a ray that meets it from outside.
RayOf atSphere(RayOf ray, double eta) {
  const double b = glm::dot(ray.origin, ray.direction);
  const double t = -b - std::sqrt(b * b - (glm::dot(ray.origin, ray.origin) - 1.0));
  const Vec p = ray.origin + t * ray.direction;
  const double before = glm::dot(ray.direction, p);
  if (eta == 0.0) return {p, ray.direction - 2.0 * before * p};
  const double after = -std::sqrt(1.0 - (1.0 - before * before) / (eta * eta));
  return {p, ray.direction / eta - p * (before / eta - after)};
}

/// Follows a photon and its neighbour to the sphere; eta 0 mirrors.
void expectSphere(double eta) {
  const vec3 from(0.2f, 2.0f, 2.5f);
  const vec3 direction = normalize(vec3(0.1f, -0.4f, 0.3f) - from);
  const PhotonDifferential left = leavingDifferential(direction, 0.3f, 0.1f);
  const RayOf ray{Vec(from), glm::normalize(Vec(direction))};
  const RayOf moved{Vec(from) + kStep * Vec(left.positionX),
                    glm::normalize(ray.direction + kStep * Vec(left.directionX))};
  const RayOf after = atSphere(ray, eta), neighbour = atSphere(moved, eta);
  const vec3 p(after.origin);
  const PhotonDifferential arrived =
      arrivingDifferential(left, direction, float(glm::length(after.origin - ray.origin)), p);
  expectClose(arrived.positionX, (neighbour.origin - after.origin) / kStep, "position");
  // The normal of the unit sphere is the position.
  const vec3 turned = eta == 0.0 ? mirroredStep(direction, arrived.directionX, p, arrived.positionX)
                                 : refractedStep(direction, arrived.directionX, vec3(after.direction), p,
                                                 arrived.positionX, float(eta));
  expectClose(turned, (neighbour.direction - after.direction) / kStep, "direction");
}

TEST(PhotonDifferential, FollowsAConvexMirror) { expectSphere(0.0); }
TEST(PhotonDifferential, FollowsRefractionIntoGlassAndOutOfIt) {
  expectSphere(1.5);
  expectSphere(1.0 / 1.1);
}

TEST(PhotonDifferential, MirrorsAsTheSurfacesDo) {
  const vec3 d = normalize(vec3(0.3f, -1.0f, 0.2f)), n(0, 1, 0);
  const vec3 step(0.01f, 0.003f, 0.0f);
  const vec3 before = mirrorDirection(-d, n, n), after = mirrorDirection(-(d + step), n, n);
  expectClose(mirroredStep(d, step, n, vec3(0.0f)), Vec(after - before), "plane mirror");
}

// IGPM eq. 8 and 9: unit steps, perpendicular to the direction and to each other, times one spacing.
TEST(PhotonDifferential, PointLightsEmitRoundFootprints) {
  const float spacing = photonSpacing(4.0f * kPi, 256e3f);
  EXPECT_NEAR(spacing, 2.0f * std::sqrt(kPi / 256e3f), 1e-9f);
  const vec3 d = normalize(vec3(1, -2, 3));
  const PhotonDifferential e = leavingDifferential(d, spacing, 0.0f);
  EXPECT_NEAR(length(e.directionX), spacing, 1e-8f);
  EXPECT_NEAR(length(e.directionY), spacing, 1e-8f);
  EXPECT_NEAR(dot(e.directionX, e.directionY), 0.0f, 1e-9f);
  EXPECT_NEAR(dot(e.directionX, d), 0.0f, 1e-9f);
  // n photons whose footprints' parallelograms are the spacing's square share the sphere around the light.
  const PhotonDifferential far = arrivingDifferential(e, d, 5.0f, -d);
  EXPECT_NEAR(length(cross(far.positionX, far.positionY)) * 256e3f, 4.0f * kPi * 25.0f, 0.05f);
}

TEST(PhotonDifferential, FootprintsLieOnTheSurface) {
  const vec3 d = normalize(vec3(1, -1, 0)), n(0, 1, 0);
  const PhotonDifferential a = arrivingDifferential(leavingDifferential(d, 0.1f, 0.0f), d, 2.0f, n);
  EXPECT_NEAR(dot(a.positionX, n), 0.0f, 1e-7f);
  EXPECT_NEAR(dot(a.positionY, n), 0.0f, 1e-7f);
  EXPECT_NEAR(length(cross(a.positionX, a.positionY)), 0.04f * std::sqrt(2.0f), 1e-6f);
}

// IGPM 4.2.
TEST(PhotonDifferential, RouletteGrowsTheAreaByItsInverse) {
  const vec3 d(0, -1, 0);
  const PhotonDifferential a = leavingDifferential(d, 0.1f, 0.2f), b = sparserDifferential(a, 0.25f);
  EXPECT_NEAR(length(cross(b.positionX, b.positionY)), 4.0f * length(cross(a.positionX, a.positionY)), 1e-7f);
  EXPECT_NEAR(length(cross(b.directionX, b.directionY)), 4.0f * length(cross(a.directionX, a.directionY)),
              1e-7f);
}

// IGPM eq. 13: after diffuse reflection the footprint where the photon leaves has the area that it had.
TEST(PhotonDifferential, DiffuseReflectionKeepsTheArea) {
  const vec3 d = normalize(vec3(1, -1, 0.5f)), n(0, 1, 0);
  PhotonDifferential a = arrivingDifferential(leavingDifferential(d, 0.1f, 0.0f), d, 2.0f, n);
  a.positionY = a.positionY * 3.0f + a.positionX;  // Skewed.
  const float area = length(cross(a.positionX, a.positionY));
  const vec3 leaving = normalize(vec3(-0.3f, 1, 0.2f));
  const PhotonDifferential b = scatteredDifferential(a, leaving, 0.05f);
  EXPECT_NEAR(length(cross(b.positionX, b.positionY)), area, 1e-6f);
  EXPECT_NEAR(length(b.directionX), 0.05f, 1e-7f);
  // As if it had come the way v = sqrt(area) / spacing from a point.
  const float v = std::sqrt(area) / 0.05f;
  EXPECT_NEAR(length(b.positionX - b.directionX * v), 0.0f, 1e-6f);
}

TEST(PhotonDifferential, InterpolatedNormalsTurnAsTheyDo) {
  const vec3 v0(0), v1(1, 0.1f, 0), v2(0.2f, 0, 1);
  const vec3 n0 = normalize(vec3(-0.3f, 1, 0)), n1 = normalize(vec3(0.4f, 1, 0.2f)),
             n2 = normalize(vec3(0, 1, 0.5f));
  const auto normal = [&](Vec p) {
    const Vec e1(v1), e2(v2), across = glm::cross(e1, e2);
    const double u = glm::dot(glm::cross(p, e2), across) / glm::dot(across, across);
    const double v = glm::dot(glm::cross(e1, p), across) / glm::dot(across, across);
    return glm::normalize(Vec(n0) * (1.0 - u - v) + Vec(n1) * u + Vec(n2) * v);
  };
  const float u = 0.3f, v = 0.4f;
  const vec3 step = (v1 - v0) * 0.7f - (v2 - v0) * 0.2f;
  const Vec p = Vec(v1) * double(u) + Vec(v2) * double(v);
  expectClose(normalStep(v1 - v0, v2 - v0, n0, n1, n2, u, v, step),
              (normal(p + kStep * Vec(step)) - normal(p)) / kStep, "normal");
}

TEST(PhotonDifferential, SharpLobesSpaceTheirPhotonsDensely) {
  const float all = photonSpacing(4.0f * kPi, 1000.0f);
  EXPECT_FLOAT_EQ(lobeSpacing(0.25f * kInvPi, 1000.0f), all);
  EXPECT_FLOAT_EQ(lobeSpacing(0.0f, 1000.0f), all);
  EXPECT_NEAR(lobeSpacing(100.0f * 0.25f * kInvPi, 1000.0f), 0.1f * all, 1e-6f);
}

}  // namespace
}  // namespace isophote
