#include "tests/shaders/gl_atlas.h"

#include <algorithm>
#include <cstring>

namespace lightfit::testing {

namespace {

constexpr char kVertexShader[] = R"(#version 450 core
layout(location = 0) uniform mat4 clip_from_world;
layout(std430, binding = 3) readonly buffer Casters { vec4 casters[]; };
out gl_PerVertex { vec4 gl_Position; float gl_PointSize; };
void main() {
  gl_Position = clip_from_world * casters[gl_VertexID];
  gl_PointSize = 1.0;
}
)";

}  // namespace

AtlasLayout SideBySide(const Plan& plan) {
  AtlasLayout layout;
  for (const PlanMap& map : plan.maps) {
    layout.offsets.emplace_back(layout.width, 0);
    layout.width += map.size.width;
    layout.height = std::max(layout.height, map.size.height);
  }
  return layout;
}

GlAtlas::~GlAtlas() {
  glDeleteFramebuffers(1, &frame_);
  glDeleteVertexArrays(1, &vertices_);
  glDeleteProgram(program_);
}

std::vector<Eigen::Vector2i> GlAtlas::Place(const Plan& plan) {
  plan_ = plan;
  const AtlasLayout layout = SideBySide(plan);
  texture_ = std::make_unique<DepthTexture>(
      layout.width,
      layout.height,
      nullptr,
      DepthTexture::Sampling{.is_less = plan.border == Border::kDark});
  program_ = LinkVertex(kVertexShader);
  glGenVertexArrays(1, &vertices_);
  glGenFramebuffers(1, &frame_);
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  glFramebufferTexture(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, texture_->name(), 0);
  EXPECT_EQ(glCheckFramebufferStatus(GL_FRAMEBUFFER), static_cast<GLenum>(GL_FRAMEBUFFER_COMPLETE));
  glClearDepth(1.0);
  glClear(GL_DEPTH_BUFFER_BIT);
  return layout.offsets;
}

void GlAtlas::Draw(const Eigen::Vector2i& offset,
                   MapSize size,
                   const Eigen::Matrix4d& clip_from_world) {
  const Eigen::Matrix4f matrix = clip_from_world.cast<float>();
  const GlBuffer casters(
      GL_SHADER_STORAGE_BUFFER, 3, casters_.size() * sizeof(Eigen::Vector4f), casters_.data());
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  glBindVertexArray(vertices_);
  glUseProgram(program_);
  glUniformMatrix4fv(0, 1, GL_FALSE, matrix.data());
  glViewport(offset.x(), offset.y(), size.width, size.height);
  glScissor(offset.x(), offset.y(), size.width, size.height);
  for (const GLenum state : {GL_SCISSOR_TEST, GL_DEPTH_TEST, GL_DEPTH_CLAMP}) glEnable(state);
  glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(casters_.size()));
  for (const GLenum state : {GL_SCISSOR_TEST, GL_DEPTH_TEST, GL_DEPTH_CLAMP}) glDisable(state);
}

void GlAtlas::Upload(const void* data, size_t bytes) { std::memcpy(&uniforms_, data, bytes); }

}  // namespace lightfit::testing
