// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/film_texture.h"

#include "base/error.h"

#include <array>
#include <utility>

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

constexpr const char* kFragmentShader = R"(#version 330 core
uniform sampler2D film;
in vec2 place;
out vec4 shown;
void main() { shown = texture(film, place); }
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
  gl_.GenVertexArrays(1, &vertices_);
  gl_.GenTextures(1, &texture_);
}

FilmTexture::~FilmTexture() {
  gl_.DeleteTextures(1, &texture_);
  gl_.DeleteVertexArrays(1, &vertices_);
  gl_.DeleteProgram(program_);
}

void FilmTexture::setFilm(std::shared_ptr<const Film> film) {
  film_ = std::move(film);
  uploaded_ = false;
}

void FilmTexture::upload(float ev, ToneMap toneMap) {
  if (uploaded_ && ev == ev_ && toneMap == toneMap_) return;
  const Image& image = film_->colour;
  displayedRgba(image, {.exposureEv = ev, .toneMap = toneMap}, rgba_);
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 4);
  if (image.width != width_ || image.height != height_) {
    width_ = image.width;
    height_ = image.height;
    gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width_, height_, 0, GL_RGBA, GL_UNSIGNED_BYTE, rgba_.data());
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      gl_.TexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
  } else {
    gl_.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, rgba_.data());
  }
  uploaded_ = true;
  ev_ = ev;
  toneMap_ = toneMap;
}

void FilmTexture::draw(float ev, ToneMap toneMap) {
  if (!film_) return;
  gl_.Disable(GL_BLEND);
  gl_.Disable(GL_SCISSOR_TEST);
  gl_.Disable(GL_DEPTH_TEST);
  gl_.UseProgram(program_);
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, texture_);
  upload(ev, toneMap);
  // As other pictures that do not fit the window's pixels, drafts are smoothed.
  GLint viewport[4] = {};
  gl_.GetIntegerv(GL_VIEWPORT, viewport);
  const GLint filter = viewport[2] == width_ && viewport[3] == height_ ? GL_NEAREST : GL_LINEAR;
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  gl_.BindVertexArray(vertices_);
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  gl_.BindVertexArray(0);
}

}  // namespace isophote::viewer
