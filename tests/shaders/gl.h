// tests/shaders/gl.h
//
// OpenGL 4.5 without a display or a GPU: Mesa's software renderer, by EGL.
// In:   sources of shaders, buffers.
// Out:  what they compute. What goes wrong is a failure of the test that asked.
#pragma once

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

namespace lightfit::testing {

// One context for all tests of a program.
class GlTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite();
  void SetUp() override;
  void TearDown() override;  // there was no error
};

// A linked program, 0 when it cannot be.
GLuint LinkCompute(const std::string& glsl);
GLuint LinkComputeSpirv(const std::string& spirv);
GLuint LinkVertex(const std::string& glsl);  // of depth alone

// Memory that shaders see at `binding`.
class GlBuffer {
 public:
  GlBuffer(GLenum target, GLuint binding, size_t bytes, const void* data = nullptr);
  ~GlBuffer() { glDeleteBuffers(1, &name_); }
  GlBuffer(const GlBuffer&) = delete;
  GlBuffer& operator=(const GlBuffer&) = delete;

  void Read(size_t bytes, void* data) const;
  GLuint name() const { return name_; }

 private:
  GLenum target_;
  GLuint name_ = 0;
};

// Runs `program` for 0 ... num_items - 1, in groups of 64, and waits for it.
void Dispatch(GLuint program, size_t num_items);

// A texture of depths, 32 bits, and how it is sampled.
class DepthTexture {
 public:
  struct Sampling {
    bool is_less = false;  // compares LESS, else LESS_OR_EQUAL
    bool blends = false;   // 2x2 texels
    int num_layers = 0;    // of an array; 0: none
  };

  // `depths`: row by row, layer by layer; null: undefined.
  DepthTexture(int width, int height, const float* depths, const Sampling& sampling);
  ~DepthTexture() { glDeleteTextures(1, &name_); }
  DepthTexture(const DepthTexture&) = delete;
  DepthTexture& operator=(const DepthTexture&) = delete;

  GLuint name() const { return name_; }

 private:
  GLuint name_ = 0;
};

}  // namespace lightfit::testing
