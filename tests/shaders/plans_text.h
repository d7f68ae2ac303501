// tests/shaders/plans_text.h
//
// The code blocks of docs/plans.md, and the compiler that looks at them.
#pragma once

#include <string>
#include <vector>

namespace lightfit::testing {

// The page's indented blocks, without their indent, in its order.
std::vector<std::string> PlansBlocks();

// Those that open with the comment "// LANGUAGE", one after the other.
std::string PlansText(const std::string& language);

// The first of them alone: FindPlanMap(), without a texture.
std::string PlansLookUp(const std::string& language);

struct ShaderFile {
  bool is_ok = false;
  std::string log;    // what the compiler said
  std::string spirv;  // bytes, where the arguments ask for it
};

// By glslangValidator; stage "frag" or "comp".
ShaderFile CompileShader(const std::string& text,
                         const std::string& stage,
                         const std::vector<std::string>& arguments = {});

// HLSL to SPIR-V, uniforms packed as Direct3D does.
ShaderFile CompileHlsl(const std::string& text, const std::string& stage);

}  // namespace lightfit::testing
