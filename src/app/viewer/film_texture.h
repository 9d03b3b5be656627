// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/viewer/gl.h"
#include "image/image.h"
#include "image/tonemap.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace isophote::viewer {

/// Draws a film with OpenGL. It goes through exposure, tone map and sRGB curve as a PNG of it does, on the
/// processor: where OpenGL is software, too, a shader takes five times as long.
class FilmTexture {
 public:
  explicit FilmTexture(const Gl& gl);
  ~FilmTexture();
  FilmTexture(const FilmTexture&) = delete;
  FilmTexture& operator=(const FilmTexture&) = delete;

  /// What is to be drawn from now on.
  void setFilm(std::shared_ptr<const Film> film);
  /// Fills the viewport; `ev` is the exposure, an automatic one included.
  void draw(float ev, ToneMap toneMap);

 private:
  void upload(float ev, ToneMap toneMap);

  const Gl& gl_;
  GLuint program_ = 0;
  GLuint vertices_ = 0;
  GLuint texture_ = 0;
  std::shared_ptr<const Film> film_;
  bool uploaded_ = false;  ///< film_, with the exposure and the tone map below.
  float ev_ = 0;
  ToneMap toneMap_ = ToneMap::kNone;
  std::vector<std::uint32_t> rgba_;
  int width_ = 0, height_ = 0;  ///< Of the texture.
};

}  // namespace isophote::viewer
