// tests/shaders/gl_atlas.h
//
// The atlas of an engine that draws points: its maps stand side by side in one texture of depths.
// In:   casters; what docs/plans.md gives an atlas.
// Out:  the texture, the uniforms.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "partition/plan.h"
#include "partition/plan_uniforms.h"
#include "tests/shaders/gl.h"

namespace lightfit::testing {

class GlAtlas {
 public:
  explicit GlAtlas(std::vector<Eigen::Vector4f> casters) : casters_(std::move(casters)) {}
  ~GlAtlas();
  GlAtlas(const GlAtlas&) = delete;
  GlAtlas& operator=(const GlAtlas&) = delete;

  std::vector<Eigen::Vector2i> Place(const Plan& plan);
  void Draw(const Eigen::Vector2i& offset, MapSize size, const Eigen::Matrix4d& clip_from_world);
  void Upload(const void* data, size_t bytes);

  const Plan& plan() const { return plan_; }
  const PlanUniforms& uniforms() const { return uniforms_; }
  const DepthTexture& texture() const { return *texture_; }

 private:
  std::vector<Eigen::Vector4f> casters_;
  Plan plan_;
  PlanUniforms uniforms_;
  std::unique_ptr<DepthTexture> texture_;
  GLuint frame_ = 0, program_ = 0, vertices_ = 0;
};

// Offsets of maps that stand side by side, and the size of the texture that holds them.
struct AtlasLayout {
  std::vector<Eigen::Vector2i> offsets;
  int width = 0, height = 0;
};
AtlasLayout SideBySide(const Plan& plan);

}  // namespace lightfit::testing
