// tests/shaders/plan_shader.h
//
// The functions of docs/plans.md as compute shaders.
// In:   a block of uniforms, points, and a texture for light.
// Out:  for each point what FindPlanMap() and PlanLight() say, in single precision.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "partition/plan_uniforms.h"
#include "tests/shaders/gl.h"

namespace lightfit::testing {

inline constexpr int kMapsOfTheBlock = 8;  // LightPlan::maps as the page has it

using ShaderPoint = Eigen::Vector4f;  // the fourth is of no meaning

struct ShaderPlace {
  float map, u, v, depth;
};

// Programs that say where a point is; 0 when it does not link.
GLuint LinkGlslLookUp();
GLuint LinkHlslLookUp();

// The same, and what `function` says: "PlanLight" or "PlanLightInLayers".
GLuint LinkGlslLight(const std::string& function);

std::vector<ShaderPlace> PlacesOf(GLuint program,
                                  const PlanUniforms& uniforms,
                                  const std::vector<ShaderPoint>& points);

struct ShaderLights {
  std::vector<ShaderPlace> places;
  std::vector<float> lights;
};
ShaderLights LightsOf(GLuint program,
                      const PlanUniforms& uniforms,
                      const DepthTexture& maps,
                      const std::vector<ShaderPoint>& points);

}  // namespace lightfit::testing
