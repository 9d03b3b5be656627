// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/gl.h"

#include "base/error.h"

namespace isophote::viewer {

Gl Gl::load(void (*(*address)(const char* name))()) {
  Gl gl;
#define ISOPHOTE_GL_FETCH(type, name)                    \
  gl.name = reinterpret_cast<type>(address("gl" #name)); \
  if (!gl.name) fail(ErrorKind::kDevice, "", "OpenGL lacks gl{}; the viewer needs version 3.3", #name);
  ISOPHOTE_GL_FUNCTIONS(ISOPHOTE_GL_FETCH)
#undef ISOPHOTE_GL_FETCH
  return gl;
}

}  // namespace isophote::viewer
