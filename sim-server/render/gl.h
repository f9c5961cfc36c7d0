// The GL 3.3 functions that we call, loaded from OSMesa, and the context they work in. The only header that knows GL; include it in .cpp
// files of this folder only. A context is used by one thread at a time; make it current before every call.
#pragma once

#include <GL/glcorearb.h>

#include <array>
#include <memory>
#include <utility>

#include "base/result.h"

namespace sim::gl {

struct Functions {
  PFNGLACTIVETEXTUREPROC ActiveTexture;
  PFNGLATTACHSHADERPROC AttachShader;
  PFNGLBINDATTRIBLOCATIONPROC BindAttribLocation;
  PFNGLBINDBUFFERPROC BindBuffer;
  PFNGLBINDFRAMEBUFFERPROC BindFramebuffer;
  PFNGLBINDRENDERBUFFERPROC BindRenderbuffer;
  PFNGLBINDTEXTUREPROC BindTexture;
  PFNGLBINDVERTEXARRAYPROC BindVertexArray;
  PFNGLBLENDFUNCPROC BlendFunc;
  PFNGLBUFFERDATAPROC BufferData;
  PFNGLCHECKFRAMEBUFFERSTATUSPROC CheckFramebufferStatus;
  PFNGLCLEARPROC Clear;
  PFNGLCLEARCOLORPROC ClearColor;
  PFNGLCOLORMASKPROC ColorMask;
  PFNGLCOMPILESHADERPROC CompileShader;
  PFNGLCOPYIMAGESUBDATAPROC CopyImageSubData;  // of GL 4.3: null when this Mesa has none
  PFNGLCREATEPROGRAMPROC CreateProgram;
  PFNGLCREATESHADERPROC CreateShader;
  PFNGLCULLFACEPROC CullFace;
  PFNGLDELETEBUFFERSPROC DeleteBuffers;
  PFNGLDELETEFRAMEBUFFERSPROC DeleteFramebuffers;
  PFNGLDELETEPROGRAMPROC DeleteProgram;
  PFNGLDELETERENDERBUFFERSPROC DeleteRenderbuffers;
  PFNGLDELETESHADERPROC DeleteShader;
  PFNGLDELETETEXTURESPROC DeleteTextures;
  PFNGLDELETEVERTEXARRAYSPROC DeleteVertexArrays;
  PFNGLDEPTHFUNCPROC DepthFunc;
  PFNGLDEPTHMASKPROC DepthMask;
  PFNGLDISABLEPROC Disable;
  PFNGLDRAWARRAYSPROC DrawArrays;
  PFNGLDRAWBUFFERPROC DrawBuffer;
  PFNGLDRAWELEMENTSPROC DrawElements;
  PFNGLENABLEPROC Enable;
  PFNGLENABLEVERTEXATTRIBARRAYPROC EnableVertexAttribArray;
  PFNGLFINISHPROC Finish;
  PFNGLFRAMEBUFFERRENDERBUFFERPROC FramebufferRenderbuffer;
  PFNGLFRAMEBUFFERTEXTURE2DPROC FramebufferTexture2D;
  PFNGLFRONTFACEPROC FrontFace;
  PFNGLGENBUFFERSPROC GenBuffers;
  PFNGLGENFRAMEBUFFERSPROC GenFramebuffers;
  PFNGLGENRENDERBUFFERSPROC GenRenderbuffers;
  PFNGLGENTEXTURESPROC GenTextures;
  PFNGLGENVERTEXARRAYSPROC GenVertexArrays;
  PFNGLGETERRORPROC GetError;
  PFNGLGETINTEGERVPROC GetIntegerv;
  PFNGLGETPROGRAMINFOLOGPROC GetProgramInfoLog;
  PFNGLGETPROGRAMIVPROC GetProgramiv;
  PFNGLGETSHADERINFOLOGPROC GetShaderInfoLog;
  PFNGLGETSHADERIVPROC GetShaderiv;
  PFNGLGETSTRINGPROC GetString;
  PFNGLGETUNIFORMLOCATIONPROC GetUniformLocation;
  PFNGLLINKPROGRAMPROC LinkProgram;
  PFNGLPIXELSTOREIPROC PixelStorei;
  PFNGLPOLYGONOFFSETPROC PolygonOffset;
  PFNGLREADBUFFERPROC ReadBuffer;
  PFNGLREADPIXELSPROC ReadPixels;
  PFNGLRENDERBUFFERSTORAGEPROC RenderbufferStorage;
  PFNGLSCISSORPROC Scissor;
  PFNGLSHADERSOURCEPROC ShaderSource;
  PFNGLTEXIMAGE2DPROC TexImage2D;
  PFNGLTEXPARAMETERFPROC TexParameterf;
  PFNGLTEXPARAMETERFVPROC TexParameterfv;
  PFNGLTEXPARAMETERIPROC TexParameteri;
  PFNGLUNIFORM1FPROC Uniform1f;
  PFNGLUNIFORM1IPROC Uniform1i;
  PFNGLUNIFORM2FPROC Uniform2f;
  PFNGLUNIFORM3FPROC Uniform3f;
  PFNGLUNIFORM3FVPROC Uniform3fv;
  PFNGLUNIFORM4FPROC Uniform4f;
  PFNGLUNIFORM4FVPROC Uniform4fv;
  PFNGLUNIFORMMATRIX3FVPROC UniformMatrix3fv;
  PFNGLUNIFORMMATRIX4FVPROC UniformMatrix4fv;
  PFNGLUSEPROGRAMPROC UseProgram;
  PFNGLVERTEXATTRIBPOINTERPROC VertexAttribPointer;
  PFNGLVIEWPORTPROC Viewport;
};

// An off-screen context of llvmpipe (GL 3.3 core or newer), drawn by the calling thread alone. Objects are made in framebuffers of our own.
class Context {
 public:
  static base::Result<std::unique_ptr<Context>> open();
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  // Makes this context the calling thread's own; cheap when it is already. False when OSMesa rejects.
  bool make_current();
  const Functions& functions() const { return functions_; }

 private:
  Context() = default;
  void* handle_ = nullptr;
  Functions functions_{};
  std::array<unsigned char, 4 * 4 * 4> surface_{};  // OSMesa insists on one; nothing is drawn to it
};

// A GL object's name with its owner. The deleter is a member of Functions of the glDelete*s kind; the context must be current.
class Object {
 public:
  using Delete = void(APIENTRYP)(GLsizei, const GLuint*);
  using Generate = void(APIENTRYP)(GLsizei, GLuint*);
  Object() = default;
  Object(Generate generate, Delete destroy) : destroy_(destroy) { generate(1, &name_); }
  ~Object() { reset(); }
  Object(Object&& other) noexcept : destroy_(other.destroy_), name_(std::exchange(other.name_, 0)) {}
  Object& operator=(Object&& other) noexcept {
    if (this != &other) {
      reset();
      destroy_ = other.destroy_;
      name_ = std::exchange(other.name_, 0);
    }
    return *this;
  }
  GLuint name() const { return name_; }

 private:
  void reset() {
    if (name_ != 0) destroy_(1, &name_);
    name_ = 0;
  }
  Delete destroy_ = nullptr;
  GLuint name_ = 0;
};

}  // namespace sim::gl
