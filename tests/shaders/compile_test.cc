// The code of docs/plans.md as compilers of shaders see it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <sstream>
#include <string>

#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "partition/plan_uniforms.h"
#include "tests/shaders/plans_text.h"
#include "tests/testing/process.h"

namespace lightfit {
namespace {

using testing::CompileHlsl;
using testing::CompileShader;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::PlansText;
using testing::ShaderFile;

constexpr char kGlslFragment[] = R"(
layout(location = 0) out vec4 color;
void main() { color = vec4(PlanLight(gl_FragCoord.xyz), PlanLightInLayers(gl_FragCoord.xyz), 0, 1); }
)";

constexpr char kGlslCompute[] = R"(
layout(local_size_x = 64) in;
layout(std430, binding = 1) buffer Lights { float lights[]; };
void main() {
  vec3 x = vec3(gl_GlobalInvocationID);
  lights[gl_GlobalInvocationID.x] = PlanLight(x) + PlanLightInLayers(x);
}
)";

constexpr char kHlslFragment[] = R"(
float4 main(float4 at : SV_Position) : SV_Target {
  return float4(PlanLight(at.xyz), PlanLightInLayers(at.xyz), 0, 1);
}
)";

constexpr char kHlslCompute[] = R"(
RWStructuredBuffer<float> lights;
[numthreads(64, 1, 1)] void main(uint3 id : SV_DispatchThreadID) {
  lights[id.x] = PlanLight(float3(id)) + PlanLightInLayers(float3(id));
}
)";

TEST(PlansPage, GlslCompilesInEveryVersionAsFragmentAndComputeShader) {
  const std::string text = PlansText("GLSL");
  const std::string es =
      "precision highp float;\nprecision highp sampler2DShadow;\n"
      "precision highp sampler2DArrayShadow;\n";
  struct Case {
    std::string head, stage, tail;
  };
  const Case cases[] = {
      {"#version 330 core\n", "frag", kGlslFragment},
      {"#version 450 core\n", "frag", kGlslFragment},
      {"#version 450 core\n", "comp", kGlslCompute},
      {"#version 310 es\n" + es, "frag", kGlslFragment},
      {"#version 310 es\n" + es, "comp", kGlslCompute},
  };
  for (const Case& test : cases) {
    const ShaderFile shader = CompileShader(test.head + text + test.tail, test.stage);
    EXPECT_TRUE(shader.is_ok) << test.head << test.stage << "\n" << shader.log;
    EXPECT_THAT(shader.log, Not(HasSubstr("WARNING"))) << test.head << test.stage;
  }
}

TEST(PlansPage, GlslCompilesForVulkan) {
  const std::string text = PlansText("GLSL");
  for (const std::string stage : {"frag", "comp"}) {
    const ShaderFile shader =
        CompileShader("#version 450\n" + text + (stage == "frag" ? kGlslFragment : kGlslCompute),
                      stage,
                      {"-V", "--auto-map-bindings"});
    EXPECT_TRUE(shader.is_ok) << stage << "\n" << shader.log;
    EXPECT_FALSE(shader.spirv.empty());
  }
}

TEST(PlansPage, HlslCompilesAsPixelAndComputeShader) {
  const std::string text = PlansText("HLSL");
  for (const std::string stage : {"frag", "comp"}) {
    const ShaderFile shader =
        CompileHlsl(text + (stage == "frag" ? kHlslFragment : kHlslCompute), stage);
    EXPECT_TRUE(shader.is_ok) << stage << "\n" << shader.log;
    EXPECT_FALSE(shader.spirv.empty());
  }
}

TEST(PlansPage, ThisTestSeesCodeThatDoesNotCompile) {
  const auto damaged = [](const std::string& text) {
    return absl::StrReplaceAll(text, {{"best_w = w;", "best_w = v;"}});
  };
  EXPECT_FALSE(
      CompileShader("#version 450\n" + damaged(PlansText("GLSL")) + kGlslFragment, "frag").is_ok);
  EXPECT_FALSE(CompileHlsl(damaged(PlansText("HLSL")) + kHlslFragment, "frag").is_ok);
}

TEST(PlansPage, ItsExampleIsTheOneThatIsTested) {
  // plans_example.h has it between two marks, indented by its function.
  std::istringstream source(ReadFile(RepositoryPath("tests/shaders/plans_example.h")));
  std::string line, example;
  while (std::getline(source, line) && line != "  // docs/plans.md (") continue;
  while (std::getline(source, line) && line != "  // )") {
    example += (line.empty() ? line : line.substr(2)) + "\n";
  }
  EXPECT_THAT(testing::PlansBlocks(), Contains(example));
}

// As the compiler lays blocks out: PlanUniforms can be copied into them.
void ExpectLayout(const std::string& reflection, const std::string& block_name) {
  const auto at = [&](const std::string& name, size_t offset) {
    EXPECT_THAT(reflection,
                HasSubstr(absl::StrFormat("%s%s: offset %d,", block_name, name, offset)));
  };
  constexpr size_t kMaps = offsetof(PlanUniforms, maps);
  at("num_maps", offsetof(PlanUniforms, num_maps));
  at("guard_texels", offsetof(PlanUniforms, guard_texels));
  at("border_light", offsetof(PlanUniforms, border_light));
  at("maps.u_row", kMaps + offsetof(PlanMapUniforms, u_row));
  at("maps.v_row", kMaps + offsetof(PlanMapUniforms, v_row));
  at("maps.w_row", kMaps + offsetof(PlanMapUniforms, w_row));
  at("maps.z_row", kMaps + offsetof(PlanMapUniforms, z_row));
  at("maps.size", kMaps + offsetof(PlanMapUniforms, size));
  at("maps.atlas_offset", kMaps + offsetof(PlanMapUniforms, atlas_offset));
  at("maps.c", kMaps + offsetof(PlanMapUniforms, c));
  EXPECT_THAT(reflection,
              HasSubstr(absl::StrFormat("topLevelArrayStride %d", sizeof(PlanMapUniforms))));
}

TEST(PlansPage, BlocksAreLaidOutAsPlanUniforms) {
  const ShaderFile hlsl = CompileHlsl(PlansText("HLSL") + kHlslFragment, "frag");
  ASSERT_TRUE(hlsl.is_ok) << hlsl.log;
  ExpectLayout(hlsl.log, "");
  const ShaderFile glsl = CompileShader(
      "#version 450 core\n" + PlansText("GLSL") + kGlslFragment, "frag", {"-l", "-q"});
  ASSERT_TRUE(glsl.is_ok) << glsl.log;
  ExpectLayout(glsl.log, "LightPlan.");
}

}  // namespace
}  // namespace lightfit
