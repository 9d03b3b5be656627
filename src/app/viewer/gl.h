// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <GL/glcorearb.h>

namespace isophote::viewer {

/// The functions of OpenGL 3.3 that the viewer calls, fetched from the present context, so that the program
/// links no libGL and starts where there is none.
struct Gl {
#define ISOPHOTE_GL_FUNCTIONS(F)                     \
  F(PFNGLACTIVETEXTUREPROC, ActiveTexture)           \
  F(PFNGLATTACHSHADERPROC, AttachShader)             \
  F(PFNGLBINDTEXTUREPROC, BindTexture)               \
  F(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)       \
  F(PFNGLCLEARCOLORPROC, ClearColor)                 \
  F(PFNGLCLEARPROC, Clear)                           \
  F(PFNGLCOMPILESHADERPROC, CompileShader)           \
  F(PFNGLCREATEPROGRAMPROC, CreateProgram)           \
  F(PFNGLCREATESHADERPROC, CreateShader)             \
  F(PFNGLDELETEPROGRAMPROC, DeleteProgram)           \
  F(PFNGLDELETESHADERPROC, DeleteShader)             \
  F(PFNGLDELETETEXTURESPROC, DeleteTextures)         \
  F(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays) \
  F(PFNGLDISABLEPROC, Disable)                       \
  F(PFNGLDRAWARRAYSPROC, DrawArrays)                 \
  F(PFNGLGENTEXTURESPROC, GenTextures)               \
  F(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays)       \
  F(PFNGLGETINTEGERVPROC, GetIntegerv)               \
  F(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog)   \
  F(PFNGLGETPROGRAMIVPROC, GetProgramiv)             \
  F(PFNGLGETSTRINGPROC, GetString)                   \
  F(PFNGLLINKPROGRAMPROC, LinkProgram)               \
  F(PFNGLPIXELSTOREIPROC, PixelStorei)               \
  F(PFNGLREADPIXELSPROC, ReadPixels)                 \
  F(PFNGLSHADERSOURCEPROC, ShaderSource)             \
  F(PFNGLTEXIMAGE2DPROC, TexImage2D)                 \
  F(PFNGLTEXPARAMETERIPROC, TexParameteri)           \
  F(PFNGLTEXSUBIMAGE2DPROC, TexSubImage2D)           \
  F(PFNGLUSEPROGRAMPROC, UseProgram)                 \
  F(PFNGLVIEWPORTPROC, Viewport)
#define ISOPHOTE_GL_MEMBER(type, name) type name = nullptr;
  ISOPHOTE_GL_FUNCTIONS(ISOPHOTE_GL_MEMBER)
#undef ISOPHOTE_GL_MEMBER

  /// Of the context that is current; throws Error(kDevice) that names a function it lacks. `address` is
  /// glfwGetProcAddress.
  static Gl load(void (*(*address)(const char* name))());
};

}  // namespace isophote::viewer
