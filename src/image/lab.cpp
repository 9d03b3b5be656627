// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/lab.h"

#include <cmath>

namespace isophote {

namespace {

/// Columns are the XYZ of red, green and blue, from their chromaticities in IEC 61966-2-1.
constexpr glm::dmat3 kXyzFromLinear{0.4123907992659595,  0.21263900587151036, 0.01933081871559185,
                                    0.35758433938387796, 0.7151686787677559,  0.11919477979462599,
                                    0.1804807884018343,  0.07219231536073371, 0.9505321522496607};
constexpr float kDelta = 6.0f / 29.0f;

/// The matrix above with each row divided by white's.
glm::mat3 relativeMatrix() {
  const glm::dvec3 white = kXyzFromLinear * glm::dvec3(1.0);
  glm::dmat3 matrix = kXyzFromLinear;
  for (int column = 0; column < 3; ++column) matrix[column] /= white;
  return glm::mat3(matrix);
}

float labCurve(float t) {
  return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3.0f * kDelta * kDelta) + 4.0f / 29.0f;
}

float labCurveInverse(float f) {
  return f > kDelta ? f * f * f : 3.0f * kDelta * kDelta * (f - 4.0f / 29.0f);
}

}  // namespace

vec3 relativeXyzFromLinear(vec3 linear) {
  static const glm::mat3 kMatrix = relativeMatrix();
  return kMatrix * linear;
}

vec3 linearFromRelativeXyz(vec3 xyz) {
  static const glm::mat3 kMatrix = glm::inverse(glm::dmat3(relativeMatrix()));
  return kMatrix * xyz;
}

vec3 labFromLinear(vec3 linear) {
  const vec3 xyz = relativeXyzFromLinear(linear);
  const float fx = labCurve(xyz.x), fy = labCurve(xyz.y), fz = labCurve(xyz.z);
  return vec3(116.0f * fy - 16.0f, 500.0f * (fx - fy), 200.0f * (fy - fz));
}

vec3 linearFromLab(vec3 lab) {
  const float fy = (lab.x + 16.0f) / 116.0f;
  const float fx = fy + lab.y / 500.0f, fz = fy - lab.z / 200.0f;
  return linearFromRelativeXyz(vec3(labCurveInverse(fx), labCurveInverse(fy), labCurveInverse(fz)));
}

vec3 ycxczFromLinear(vec3 linear) {
  const vec3 xyz = relativeXyzFromLinear(linear);
  return vec3(116.0f * xyz.y - 16.0f, 500.0f * (xyz.x - xyz.y), 200.0f * (xyz.y - xyz.z));
}

vec3 linearFromYcxcz(vec3 ycxcz) {
  const float y = (ycxcz.x + 16.0f) / 116.0f;
  return linearFromRelativeXyz(vec3(y + ycxcz.y / 500.0f, y, y - ycxcz.z / 200.0f));
}

}  // namespace isophote
