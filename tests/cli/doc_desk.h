// tests/cli/doc_desk.h
//
// The folder that commands of documents run in, with the inputs that they name.
// In:   the name of an input: frame.exr, scene.glb, readbacks/walk.
// Out:  a file or folder of that name: a read-back that is shipped, or what stands in for it.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "tests/cli/box_shot.h"
#include "tests/cli/doc_commands.h"
#include "tests/cli/examples.h"
#include "tests/testing/process.h"

namespace lightfit {

// A floor with rows of columns on it, y up, as GLB.
inline std::string ColumnsGlb() {
  std::vector<float> positions;
  std::vector<uint32_t> indices;
  const auto add_box = [&](float x, float y, float z, float half, float height) {
    const auto first = static_cast<uint32_t>(positions.size() / 3);
    for (int corner = 0; corner < 8; ++corner) {
      positions.push_back(x + (corner & 1 ? half : -half));
      positions.push_back(y + (corner & 2 ? height : 0.0F));
      positions.push_back(z + (corner & 4 ? half : -half));
    }
    constexpr int kFaces[6][4] = {
        {0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
    for (const int* face : kFaces) {
      for (const int corner : {0, 1, 2, 0, 2, 3}) {
        indices.push_back(first + static_cast<uint32_t>(face[corner]));
      }
    }
  };
  add_box(0.0F, -0.2F, 0.0F, 20.0F, 0.2F);
  for (int column = 0; column < 5; ++column) {
    for (int row = 0; row < 5; ++row) {
      add_box(-1.0F - 3.0F * static_cast<float>(column),
              0.0F,
              -6.0F + 3.0F * static_cast<float>(row),
              0.25F,
              1.5F);
    }
  }
  const size_t position_bytes = positions.size() * sizeof(float);
  const size_t index_bytes = indices.size() * sizeof(uint32_t);
  std::string json = absl::StrFormat(
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
      R"("buffers":[{"byteLength":%d}],)"
      R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":%d},)"
      R"({"buffer":0,"byteOffset":%d,"byteLength":%d}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":%d,"type":"VEC3",)"
      R"("min":[-20,-0.2,-20],"max":[20,1.5,20]},)"
      R"({"bufferView":1,"componentType":5125,"count":%d,"type":"SCALAR"}]})",
      position_bytes + index_bytes,
      position_bytes,
      position_bytes,
      index_bytes,
      positions.size() / 3,
      indices.size());
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string glb = "glTF";
  const auto put = [&glb](size_t value) {
    const auto word = static_cast<uint32_t>(value);
    glb.append(reinterpret_cast<const char*>(&word), sizeof(word));
  };
  put(2);
  put(12 + 8 + json.size() + 8 + position_bytes + index_bytes);
  put(json.size());
  glb += "JSON" + json;
  put(position_bytes + index_bytes);
  glb += std::string("BIN\0", 4);
  glb.append(reinterpret_cast<const char*>(positions.data()), position_bytes);
  glb.append(reinterpret_cast<const char*>(indices.data()), index_bytes);
  return glb;
}

// The folder that commands run in, with what they name and nobody has made yet.
class Desk {
 public:
  explicit Desk(const CommandBlock& block)
      : before_(std::filesystem::current_path()),
        has_walk_(absl::StrContains(absl::StrJoin(block.commands, "\n"), "readbacks/walk")),
        shot_(2) {
    std::filesystem::current_path(folder_.Path(""));
    std::filesystem::create_directory("docs");
    std::filesystem::create_directory_symlink(RepositoryPath("examples"), "examples");
  }
  ~Desk() { std::filesystem::current_path(before_); }
  Desk(const Desk&) = delete;
  Desk& operator=(const Desk&) = delete;

  // Makes the input unless it is there. Whoever writes a new name into a document adds it here.
  void Provide(const std::string& name) {
    if (std::filesystem::exists(name)) return;
    const std::set<std::string> yard = {"frame.exr", "0001.exr", "0007.exr"};
    const std::set<std::string> summaries = {"part1.summary", "part2.summary", "shot.summary"};
    if (yard.count(name) > 0) {
      std::filesystem::copy_file(kYard, name);
    } else if (name == "scene.json") {
      std::filesystem::copy_file(has_walk_ ? shot_.LightsPath() : kYardLights, name);
    } else if (absl::EndsWith(name, ".glb")) {
      WriteFile(name, ColumnsGlb());
    } else if (name == "readbacks/walk") {
      std::filesystem::create_directory("readbacks");
      std::filesystem::copy(shot_.Path("walk"), name);
    } else if (name == "frames.txt") {
      WriteFile(name, absl::StrCat(shot_.FramePath(0), "\n", shot_.FramePath(1), "\n"));
    } else if (summaries.count(name) > 0) {
      Run({"summarize",
           shot_.FramePath(name == "part2.summary" ? 1 : 0),
           "--lights",
           shot_.LightsPath(),
           "-o",
           name});
    } else if (name == "engine.json") {
      Run({"fit", kYard, "--lights", kYardLights, "--map", "400x400", "--json", name});
    } else if (name == "plan.json") {
      Provide("sponza.glb");
      const std::string sun = "sun=sun:1,-3,0.5";
      Run({"render",
           "sponza.glb",
           "--camera",
           "3.5,1.7,-4.2:-9,2.2,-4.4:55",
           "--light",
           sun,
           "-o",
           "plan.exr"});
      Run({"fit",
           "plan.exr",
           "--light",
           sun,
           "--maps",
           "4",
           "--texels",
           "128x128",
           "--json",
           name});
    } else {
      ADD_FAILURE() << "no stand-in for the input " << name << ": add one to Desk::Provide()";
    }
  }

 private:
  static void Run(const std::vector<std::string>& arguments) {
    const ProcessResult result = RunLightfit(arguments);
    EXPECT_EQ(result.exit_code, 0) << absl::StrJoin(arguments, " ") << "\n" << result.err;
  }

  const std::filesystem::path before_;
  const bool has_walk_;
  const TemporaryFolder folder_;
  const BoxShot shot_;
};

}  // namespace lightfit
