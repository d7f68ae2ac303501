#include "tests/shaders/gl.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <cstdlib>

namespace lightfit::testing {

namespace {

constexpr int kGroup = 64;

EGLContext context = EGL_NO_CONTEXT;

GLuint Link(GLuint shader) {
  GLint is_ok = GL_FALSE;
  char log[4096] = "";
  glGetShaderiv(shader, GL_COMPILE_STATUS, &is_ok);
  glGetShaderInfoLog(shader, sizeof(log), nullptr, log);
  EXPECT_TRUE(is_ok) << log;
  const GLuint program = glCreateProgram();
  glAttachShader(program, shader);
  glDeleteShader(shader);  // with the program
  if (is_ok) {
    glLinkProgram(program);
    glGetProgramiv(program, GL_LINK_STATUS, &is_ok);
    glGetProgramInfoLog(program, sizeof(log), nullptr, log);
    EXPECT_TRUE(is_ok) << log;
  }
  if (is_ok) return program;
  glDeleteProgram(program);
  return 0;
}

GLuint LinkText(GLenum stage, const std::string& glsl) {
  const GLuint shader = glCreateShader(stage);
  const char* text = glsl.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  return Link(shader);
}

}  // namespace

// Is never taken down: a driver that is unloaded leaves memory behind that the leak sanitizer would
// find.
void GlTest::SetUpTestSuite() {
  if (context != EGL_NO_CONTEXT) return;
  // Whatever GPU there may be: results repeat. Nothing is left in the home folder.
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);         // NOLINT(concurrency-mt-unsafe): the one thread
  setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);  // NOLINT(concurrency-mt-unsafe)
  EGLDisplay display =
      eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (!eglInitialize(display, nullptr, nullptr) || !eglBindAPI(EGL_OPENGL_API)) return;
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                               4,
                               EGL_CONTEXT_MINOR_VERSION,
                               5,
                               EGL_CONTEXT_OPENGL_PROFILE_MASK,
                               EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                               EGL_NONE};
  context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  if (context == EGL_NO_CONTEXT) return;
  eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
}

void GlTest::SetUp() {
  ASSERT_NE(context, EGL_NO_CONTEXT)
      << "no OpenGL 4.5 by EGL: packages-test.txt, libgl1-mesa-dri. EGL error 0x" << std::hex
      << eglGetError();
}

void GlTest::TearDown() {
  if (context != EGL_NO_CONTEXT) {
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
  }
}

GLuint LinkCompute(const std::string& glsl) { return LinkText(GL_COMPUTE_SHADER, glsl); }

GLuint LinkVertex(const std::string& glsl) { return LinkText(GL_VERTEX_SHADER, glsl); }

GLuint LinkComputeSpirv(const std::string& spirv) {
  const auto specialize = reinterpret_cast<PFNGLSPECIALIZESHADERARBPROC>(
      eglGetProcAddress("glSpecializeShaderARB"));  // GL_ARB_gl_spirv
  if (specialize == nullptr) {
    ADD_FAILURE() << "this OpenGL takes no SPIR-V";
    return 0;
  }
  const GLuint shader = glCreateShader(GL_COMPUTE_SHADER);
  glShaderBinary(
      1, &shader, GL_SHADER_BINARY_FORMAT_SPIR_V, spirv.data(), static_cast<GLsizei>(spirv.size()));
  specialize(shader, "main", 0, nullptr, nullptr);
  return Link(shader);
}

GlBuffer::GlBuffer(GLenum target, GLuint binding, size_t bytes, const void* data)
    : target_(target) {
  glGenBuffers(1, &name_);
  glBindBuffer(target_, name_);
  glBufferData(target_, static_cast<GLsizeiptr>(bytes), data, GL_STATIC_DRAW);
  glBindBufferBase(target_, binding, name_);
}

void GlBuffer::Read(size_t bytes, void* data) const {
  glBindBuffer(target_, name_);
  glGetBufferSubData(target_, 0, static_cast<GLsizeiptr>(bytes), data);
}

void Dispatch(GLuint program, size_t num_items) {
  glUseProgram(program);
  glDispatchCompute(static_cast<GLuint>((num_items + kGroup - 1) / kGroup), 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
}

DepthTexture::DepthTexture(int width, int height, const float* depths, const Sampling& sampling) {
  const bool is_array = sampling.num_layers > 0;
  const GLenum target = is_array ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D;
  glCreateTextures(target, 1, &name_);
  if (is_array) {
    glTextureStorage3D(name_, 1, GL_DEPTH_COMPONENT32F, width, height, sampling.num_layers);
  } else {
    glTextureStorage2D(name_, 1, GL_DEPTH_COMPONENT32F, width, height);
  }
  if (depths != nullptr && is_array) {
    glTextureSubImage3D(name_,
                        0,
                        0,
                        0,
                        0,
                        width,
                        height,
                        sampling.num_layers,
                        GL_DEPTH_COMPONENT,
                        GL_FLOAT,
                        depths);
  } else if (depths != nullptr) {
    glTextureSubImage2D(name_, 0, 0, 0, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, depths);
  }
  const GLint filter = sampling.blends ? GL_LINEAR : GL_NEAREST;
  glTextureParameteri(name_, GL_TEXTURE_MIN_FILTER, filter);
  glTextureParameteri(name_, GL_TEXTURE_MAG_FILTER, filter);
  glTextureParameteri(name_, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTextureParameteri(name_, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glTextureParameteri(name_, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTextureParameteri(name_, GL_TEXTURE_COMPARE_FUNC, sampling.is_less ? GL_LESS : GL_LEQUAL);
}

}  // namespace lightfit::testing
