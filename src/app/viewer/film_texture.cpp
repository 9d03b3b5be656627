// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/film_texture.h"

#include "base/error.h"

#include <array>
#include <cmath>
#include <string>

namespace isophote::viewer {

namespace {

/// One triangle that covers the viewport.
constexpr const char* kVertexShader = R"(#version 330 core
out vec2 place;
void main() {
  vec2 corner = vec2(float((gl_VertexID << 1) & 2), float(gl_VertexID & 2));
  place = vec2(corner.x, 1.0 - corner.y);
  gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
}
)";

/// What src/image/tonemap.cpp does to a pixel; the curves are numbered as ToneMap.
constexpr const char* kFragmentShader = R"(#version 330 core
uniform sampler2D film;
uniform float scale;
uniform int toneMap;
in vec2 place;
out vec4 shown;
void main() {
  vec3 x = texture(film, place).rgb * scale;
  // Not a number compares as false.
  x = vec3(x.r > 0.0 ? min(x.r, 1e18) : 0.0, x.g > 0.0 ? min(x.g, 1e18) : 0.0, x.b > 0.0 ? min(x.b, 1e18) : 0.0);
  if (toneMap == 1) x = (x * (x * 2.51 + 0.03)) / (x * (x * 2.43 + 0.59) + 0.14);
  if (toneMap == 2) x /= 1.0 + dot(x, vec3(0.2126, 0.7152, 0.0722));
  x = clamp(x, 0.0, 1.0);
  shown = vec4(mix(1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, 12.92 * x, vec3(lessThanEqual(x, vec3(0.0031308)))), 1.0);
}
)";

GLuint compile(const Gl& gl, GLenum kind, const char* source) {
  const GLuint shader = gl.CreateShader(kind);
  gl.ShaderSource(shader, 1, &source, nullptr);
  gl.CompileShader(shader);
  return shader;
}

}  // namespace

FilmTexture::FilmTexture(const Gl& gl) : gl_(gl) {
  program_ = gl_.CreateProgram();
  const std::array<GLuint, 2> shaders{compile(gl_, GL_VERTEX_SHADER, kVertexShader),
                                      compile(gl_, GL_FRAGMENT_SHADER, kFragmentShader)};
  for (const GLuint shader : shaders) gl_.AttachShader(program_, shader);
  gl_.LinkProgram(program_);
  for (const GLuint shader : shaders) gl_.DeleteShader(shader);
  GLint linked = 0;
  gl_.GetProgramiv(program_, GL_LINK_STATUS, &linked);
  if (linked == 0) {
    std::array<char, 512> log{};
    gl_.GetProgramInfoLog(program_, GLsizei(log.size()), nullptr, log.data());
    gl_.DeleteProgram(program_);
    fail(ErrorKind::kDevice, "", "OpenGL does not take the viewer's shader: {}", log.data());
  }
  scale_ = gl_.GetUniformLocation(program_, "scale");
  toneMap_ = gl_.GetUniformLocation(program_, "toneMap");
  gl_.GenVertexArrays(1, &vertices_);
  gl_.GenTextures(1, &texture_);
}

FilmTexture::~FilmTexture() {
  gl_.DeleteTextures(1, &texture_);
  gl_.DeleteVertexArrays(1, &vertices_);
  gl_.DeleteProgram(program_);
}

void FilmTexture::setImage(const Image& image) {
  gl_.BindTexture(GL_TEXTURE_2D, texture_);
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 4);
  if (image.width != width_ || image.height != height_) {
    width_ = image.width;
    height_ = image.height;
    gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGB32F, width_, height_, 0, GL_RGB, GL_FLOAT, image.pixels.data());
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      gl_.TexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      gl_.TexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
    return;
  }
  gl_.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, GL_RGB, GL_FLOAT, image.pixels.data());
}

void FilmTexture::draw(float ev, ToneMap toneMap) const {
  if (width_ == 0) return;
  gl_.Disable(GL_BLEND);
  gl_.Disable(GL_SCISSOR_TEST);
  gl_.Disable(GL_DEPTH_TEST);
  gl_.UseProgram(program_);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, texture_);
  // As other pictures that do not fit the window's pixels, drafts are smoothed.
  GLint viewport[4] = {};
  gl_.GetIntegerv(GL_VIEWPORT, viewport);
  const GLint filter = viewport[2] == width_ && viewport[3] == height_ ? GL_NEAREST : GL_LINEAR;
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  gl_.Uniform1f(scale_, std::exp2(ev));
  gl_.Uniform1i(toneMap_, GLint(toneMap));
  gl_.BindVertexArray(vertices_);
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  gl_.BindVertexArray(0);
}

}  // namespace isophote::viewer
