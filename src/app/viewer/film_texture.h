// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/viewer/gl.h"
#include "image/image.h"
#include "image/tonemap.h"

namespace isophote::viewer {

/// Draws a film with OpenGL: linear radiance in a texture, exposure, tone map and sRGB curve in the fragment
/// shader, so that they cost no render. What is seen differs from a PNG of the same film by rounding alone.
class FilmTexture {
 public:
  explicit FilmTexture(const Gl& gl);
  ~FilmTexture();
  FilmTexture(const FilmTexture&) = delete;
  FilmTexture& operator=(const FilmTexture&) = delete;

  /// Uploads the picture.
  void setImage(const Image& image);
  /// Fills the viewport; `ev` is the exposure, an automatic one included.
  void draw(float ev, ToneMap toneMap) const;

 private:
  const Gl& gl_;
  GLuint program_ = 0;
  GLuint vertices_ = 0;
  GLuint texture_ = 0;
  GLint scale_ = -1;
  GLint toneMap_ = -1;
  int width_ = 0;
  int height_ = 0;
};

}  // namespace isophote::viewer
