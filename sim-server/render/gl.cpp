// Loading GL from OSMesa and opening contexts.
#include "render/gl.h"

#include <GL/osmesa.h>

#include <cstdlib>
#include <mutex>
#include <string_view>

namespace sim::gl {
namespace {

// Both must be set before the first context of the process: drawing in the calling thread costs the same on every machine and scales over
// cameras; vectors of 512 bits crash llvmpipe.
void prepare_environment() {
  static std::once_flag once;
  std::call_once(once, [] {
    ::setenv("LP_NUM_THREADS", "0", 1);
    const char* width = std::getenv("LP_NATIVE_VECTOR_WIDTH");
    if (width != nullptr && std::string_view(width) == "512") ::setenv("LP_NATIVE_VECTOR_WIDTH", "256", 1);
  });
}

template <class Function>
bool load(Function& function, const char* name) {
  function = reinterpret_cast<Function>(OSMesaGetProcAddress(name));
  return function != nullptr;
}

// The name of a function that is missing, or null.
const char* load_all(Functions& f) {
  if (!load(f.ActiveTexture, "glActiveTexture")) return "glActiveTexture";
  if (!load(f.AttachShader, "glAttachShader")) return "glAttachShader";
  if (!load(f.BindAttribLocation, "glBindAttribLocation")) return "glBindAttribLocation";
  if (!load(f.BindBuffer, "glBindBuffer")) return "glBindBuffer";
  if (!load(f.BindFramebuffer, "glBindFramebuffer")) return "glBindFramebuffer";
  if (!load(f.BindRenderbuffer, "glBindRenderbuffer")) return "glBindRenderbuffer";
  if (!load(f.BindTexture, "glBindTexture")) return "glBindTexture";
  if (!load(f.BindVertexArray, "glBindVertexArray")) return "glBindVertexArray";
  if (!load(f.BlendFunc, "glBlendFunc")) return "glBlendFunc";
  if (!load(f.BufferData, "glBufferData")) return "glBufferData";
  if (!load(f.CheckFramebufferStatus, "glCheckFramebufferStatus")) return "glCheckFramebufferStatus";
  if (!load(f.Clear, "glClear")) return "glClear";
  if (!load(f.ClearColor, "glClearColor")) return "glClearColor";
  if (!load(f.ColorMask, "glColorMask")) return "glColorMask";
  if (!load(f.CompileShader, "glCompileShader")) return "glCompileShader";
  load(f.CopyImageSubData, "glCopyImageSubData");
  if (!load(f.CreateProgram, "glCreateProgram")) return "glCreateProgram";
  if (!load(f.CreateShader, "glCreateShader")) return "glCreateShader";
  if (!load(f.CullFace, "glCullFace")) return "glCullFace";
  if (!load(f.DeleteBuffers, "glDeleteBuffers")) return "glDeleteBuffers";
  if (!load(f.DeleteFramebuffers, "glDeleteFramebuffers")) return "glDeleteFramebuffers";
  if (!load(f.DeleteProgram, "glDeleteProgram")) return "glDeleteProgram";
  if (!load(f.DeleteRenderbuffers, "glDeleteRenderbuffers")) return "glDeleteRenderbuffers";
  if (!load(f.DeleteShader, "glDeleteShader")) return "glDeleteShader";
  if (!load(f.DeleteTextures, "glDeleteTextures")) return "glDeleteTextures";
  if (!load(f.DeleteVertexArrays, "glDeleteVertexArrays")) return "glDeleteVertexArrays";
  if (!load(f.DepthFunc, "glDepthFunc")) return "glDepthFunc";
  if (!load(f.DepthMask, "glDepthMask")) return "glDepthMask";
  if (!load(f.Disable, "glDisable")) return "glDisable";
  if (!load(f.DrawArrays, "glDrawArrays")) return "glDrawArrays";
  if (!load(f.DrawBuffer, "glDrawBuffer")) return "glDrawBuffer";
  if (!load(f.DrawElements, "glDrawElements")) return "glDrawElements";
  if (!load(f.Enable, "glEnable")) return "glEnable";
  if (!load(f.EnableVertexAttribArray, "glEnableVertexAttribArray")) return "glEnableVertexAttribArray";
  if (!load(f.Finish, "glFinish")) return "glFinish";
  if (!load(f.FramebufferRenderbuffer, "glFramebufferRenderbuffer")) return "glFramebufferRenderbuffer";
  if (!load(f.FramebufferTexture2D, "glFramebufferTexture2D")) return "glFramebufferTexture2D";
  if (!load(f.FrontFace, "glFrontFace")) return "glFrontFace";
  if (!load(f.GenBuffers, "glGenBuffers")) return "glGenBuffers";
  if (!load(f.GenFramebuffers, "glGenFramebuffers")) return "glGenFramebuffers";
  if (!load(f.GenRenderbuffers, "glGenRenderbuffers")) return "glGenRenderbuffers";
  if (!load(f.GenTextures, "glGenTextures")) return "glGenTextures";
  if (!load(f.GenVertexArrays, "glGenVertexArrays")) return "glGenVertexArrays";
  if (!load(f.GetError, "glGetError")) return "glGetError";
  if (!load(f.GetIntegerv, "glGetIntegerv")) return "glGetIntegerv";
  if (!load(f.GetProgramInfoLog, "glGetProgramInfoLog")) return "glGetProgramInfoLog";
  if (!load(f.GetProgramiv, "glGetProgramiv")) return "glGetProgramiv";
  if (!load(f.GetShaderInfoLog, "glGetShaderInfoLog")) return "glGetShaderInfoLog";
  if (!load(f.GetShaderiv, "glGetShaderiv")) return "glGetShaderiv";
  if (!load(f.GetString, "glGetString")) return "glGetString";
  if (!load(f.GetUniformLocation, "glGetUniformLocation")) return "glGetUniformLocation";
  if (!load(f.LinkProgram, "glLinkProgram")) return "glLinkProgram";
  if (!load(f.PixelStorei, "glPixelStorei")) return "glPixelStorei";
  if (!load(f.PolygonOffset, "glPolygonOffset")) return "glPolygonOffset";
  if (!load(f.ReadBuffer, "glReadBuffer")) return "glReadBuffer";
  if (!load(f.ReadPixels, "glReadPixels")) return "glReadPixels";
  if (!load(f.RenderbufferStorage, "glRenderbufferStorage")) return "glRenderbufferStorage";
  if (!load(f.Scissor, "glScissor")) return "glScissor";
  if (!load(f.ShaderSource, "glShaderSource")) return "glShaderSource";
  if (!load(f.TexImage2D, "glTexImage2D")) return "glTexImage2D";
  if (!load(f.TexParameterf, "glTexParameterf")) return "glTexParameterf";
  if (!load(f.TexParameterfv, "glTexParameterfv")) return "glTexParameterfv";
  if (!load(f.TexParameteri, "glTexParameteri")) return "glTexParameteri";
  if (!load(f.Uniform1f, "glUniform1f")) return "glUniform1f";
  if (!load(f.Uniform1i, "glUniform1i")) return "glUniform1i";
  if (!load(f.Uniform2f, "glUniform2f")) return "glUniform2f";
  if (!load(f.Uniform3f, "glUniform3f")) return "glUniform3f";
  if (!load(f.Uniform3fv, "glUniform3fv")) return "glUniform3fv";
  if (!load(f.Uniform4f, "glUniform4f")) return "glUniform4f";
  if (!load(f.Uniform4fv, "glUniform4fv")) return "glUniform4fv";
  if (!load(f.UniformMatrix3fv, "glUniformMatrix3fv")) return "glUniformMatrix3fv";
  if (!load(f.UniformMatrix4fv, "glUniformMatrix4fv")) return "glUniformMatrix4fv";
  if (!load(f.UseProgram, "glUseProgram")) return "glUseProgram";
  if (!load(f.VertexAttribPointer, "glVertexAttribPointer")) return "glVertexAttribPointer";
  if (!load(f.Viewport, "glViewport")) return "glViewport";
  return nullptr;
}

}  // namespace

base::Result<std::unique_ptr<Context>> Context::open() {
  prepare_environment();
  static constexpr int attributes[] = {
      OSMESA_FORMAT, OSMESA_RGBA, OSMESA_PROFILE, OSMESA_CORE_PROFILE, OSMESA_CONTEXT_MAJOR_VERSION, 3, OSMESA_CONTEXT_MINOR_VERSION, 3, 0};
  std::unique_ptr<Context> context(new Context);
  context->handle_ = OSMesaCreateContextAttribs(attributes, nullptr);
  if (context->handle_ == nullptr) return base::Error{"render: OSMesa makes no GL 3.3 core context"};
  if (!context->make_current()) return base::Error{"render: OSMesa cannot make its own context current"};
  if (const char* missing = load_all(context->functions_)) return base::Error{std::string("render: this OSMesa has no ") + missing};
  return context;
}

Context::~Context() {
  if (handle_ == nullptr) return;
  OSMesaDestroyContext(static_cast<OSMesaContext>(handle_));
}

bool Context::make_current() {
  const auto handle = static_cast<OSMesaContext>(handle_);
  if (OSMesaGetCurrentContext() == handle) return true;
  return OSMesaMakeCurrent(handle, surface_.data(), GL_UNSIGNED_BYTE, 4, 4) != 0;
}

}  // namespace sim::gl
