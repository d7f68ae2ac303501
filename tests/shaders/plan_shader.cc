#include "tests/shaders/plan_shader.h"

#include <gtest/gtest.h>

#include "tests/shaders/plans_text.h"

namespace lightfit::testing {

namespace {

constexpr char kGlslLookUp[] = R"(
layout(local_size_x = 64) in;
layout(std430, binding = 1) readonly buffer Points { vec4 points[]; };
layout(std430, binding = 2) writeonly buffer Places { vec4 places[]; };
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= points.length()) return;
  vec2 texel;
  float depth;
  int k = FindPlanMap(points[i].xyz, texel, depth);
  places[i] = vec4(k, texel, depth);
}
)";

constexpr char kGlslLight[] = R"(
layout(local_size_x = 64) in;
layout(std430, binding = 1) readonly buffer Points { vec4 points[]; };
layout(std430, binding = 2) writeonly buffer Places { vec4 places[]; };
layout(std430, binding = 3) writeonly buffer Lights { float lights[]; };
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= points.length()) return;
  vec2 texel;
  float depth;
  int k = FindPlanMap(points[i].xyz, texel, depth);
  places[i] = vec4(k, texel, depth);
  lights[i] = LIGHT(points[i].xyz);
}
)";

constexpr char kHlslLookUp[] = R"(
StructuredBuffer<float4> points : register(t1);
RWStructuredBuffer<float4> places : register(u2);
[numthreads(64, 1, 1)] void main(uint3 id : SV_DispatchThreadID) {
  uint num_points, stride;
  points.GetDimensions(num_points, stride);
  if (id.x >= num_points) return;
  float2 texel;
  float depth;
  int k = FindPlanMap(points[id.x].xyz, texel, depth);
  places[id.x] = float4(k, texel, depth);
}
)";

// As an engine would: no more than the maps that there are. The rest is noise.
PlanUniforms Uploaded(const PlanUniforms& uniforms) {
  EXPECT_LE(uniforms.num_maps, kMapsOfTheBlock);
  PlanUniforms uploaded = uniforms;
  for (int k = uniforms.num_maps; k < kMaxPlanMaps; ++k) {
    uploaded.maps[k] = uniforms.maps[0];
    uploaded.maps[k].c *= 1e-3f;  // by far the densest, were it looked at
  }
  return uploaded;
}

}  // namespace

GLuint LinkGlslLookUp() {
  return LinkCompute("#version 450 core\n" + PlansLookUp("GLSL") + kGlslLookUp);
}

GLuint LinkGlslLight(const std::string& function) {
  return LinkCompute("#version 450 core\n#define LIGHT " + function + "\n" + PlansText("GLSL") +
                     kGlslLight);
}

GLuint LinkHlslLookUp() {
  const ShaderFile shader = CompileHlsl(PlansLookUp("HLSL") + kHlslLookUp, "comp");
  EXPECT_TRUE(shader.is_ok) << shader.log;
  return LinkComputeSpirv(shader.spirv);
}

std::vector<ShaderPlace> PlacesOf(GLuint program,
                                  const PlanUniforms& uniforms,
                                  const std::vector<ShaderPoint>& points) {
  std::vector<ShaderPlace> places(points.size());
  const PlanUniforms uploaded = Uploaded(uniforms);
  const GlBuffer block(GL_UNIFORM_BUFFER, 0, sizeof(uploaded), &uploaded);
  const GlBuffer in(
      GL_SHADER_STORAGE_BUFFER, 1, points.size() * sizeof(ShaderPoint), points.data());
  const GlBuffer out(GL_SHADER_STORAGE_BUFFER, 2, places.size() * sizeof(ShaderPlace));
  Dispatch(program, points.size());
  out.Read(places.size() * sizeof(ShaderPlace), places.data());
  return places;
}

ShaderLights LightsOf(GLuint program,
                      const PlanUniforms& uniforms,
                      const DepthTexture& maps,
                      const std::vector<ShaderPoint>& points) {
  ShaderLights result;
  result.lights.resize(points.size());
  const GlBuffer lights(GL_SHADER_STORAGE_BUFFER, 3, points.size() * sizeof(float));
  glBindTextureUnit(0, maps.name());
  result.places = PlacesOf(program, uniforms, points);
  lights.Read(points.size() * sizeof(float), result.lights.data());
  return result;
}

}  // namespace lightfit::testing
