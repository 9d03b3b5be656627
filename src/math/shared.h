// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The dialect of *.shared.h: headers that g++ (with glm) and glslc both compile, so that the physics is
// written once. Rules: float literals end in f; out parameters go through OUT and INOUT; no swizzles; no
// bool, enum or initialisers inside structs; constants are `const` at namespace scope; hot functions select
// with ?: instead of branching, so that the CPU engine's loops over lanes vectorise. In GLSL #extension
// GL_EXT_scalar_block_layout and GL_GOOGLE_include_directive must be on, and include guards are #ifndef
// (glslc knows no #pragma once).
#ifndef ISOPHOTE_MATH_SHARED_H
#define ISOPHOTE_MATH_SHARED_H

#ifdef __cplusplus

#include <glm/glm.hpp>
#include <glm/gtc/type_precision.hpp>

#define SHARED_BEGIN namespace isophote {
#define SHARED_END }
/// Every shared function is inlined whole, so that each instruction set gets its own copy.
#define SHARED_FN inline __attribute__((always_inline))
#define SHARED_CONST inline constexpr
/// An array constant: `SHARED_CONST uint kTable[2] = SHARED_ARRAY(uint, 2) SHARED_ARRAY_OPEN 1u, 2u
/// SHARED_ARRAY_CLOSE;`
#define SHARED_ARRAY(T, n)
#define SHARED_ARRAY_OPEN {
#define SHARED_ARRAY_CLOSE }
#define OUT(T) T&
#define INOUT(T) T&

namespace isophote {
using glm::ivec2;
using glm::ivec3;
using glm::mat3;
using glm::mat4;
using glm::mat4x3;
using glm::uint;
using glm::uvec2;
using glm::uvec3;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;

using glm::abs;
using glm::acos;
using glm::atan;
using glm::clamp;
using glm::cos;
using glm::cross;
using glm::dot;
using glm::exp;
using glm::floatBitsToUint;
using glm::floor;
using glm::inversesqrt;
using glm::length;
using glm::log;
using glm::max;
using glm::min;
using glm::mix;
using glm::normalize;
using glm::pow;
using glm::reflect;
using glm::sign;
using glm::sin;
using glm::sqrt;
using glm::tan;
using glm::uintBitsToFloat;
}  // namespace isophote

#else  // GLSL

#define SHARED_BEGIN
#define SHARED_END
#define SHARED_FN
#define SHARED_CONST const
#define SHARED_ARRAY(T, n) T[n]
#define SHARED_ARRAY_OPEN (
#define SHARED_ARRAY_CLOSE )
#define OUT(T) out T
#define INOUT(T) inout T

#endif

SHARED_BEGIN
SHARED_CONST float kPi = 3.14159265358979f;
SHARED_CONST float kInvPi = 0.318309886183791f;
SHARED_END

#endif
