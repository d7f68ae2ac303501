// tests/cli/box_shot.h
//
// A short shot on disk: a camera that walks past boxes, with a sun and a lamp.
// In:   a folder.
// Out:  walk/walk.0998.exr, walk.0999.exr and so on in it, and lights.json.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "io/readback_exr_write.h"
#include "tests/testing/frame_loop.h"
#include "tests/testing/process.h"
#include "wire/light_proto.h"
#include "wire/proto_json.h"

namespace lightfit {

class BoxShot {
 public:
  explicit BoxShot(int num_frames) : walk_(kSeed, 2, num_frames, 72, 48) {
    std::filesystem::create_directory(folder_.Path("walk"));
    for (int i = 0; i < num_frames; ++i) Write(i, walk_.lights);
    v1::LightList list;
    for (const Light& light : walk_.lights) *list.add_lights() = LightToProto(light);
    WriteFile(LightsPath(), ProtoToJson(list).value());
  }

  // The frame's file with the shadows of some of the lights alone.
  void Write(int frame, absl::Span<const Light> lights) const {
    const absl::Status status =
        WriteReadbackExr(FramePath(frame), walk_.views[frame].View(), lights);
    EXPECT_TRUE(status.ok()) << status;
  }

  // `lightfit shot` on the folder, results in Output(); `more` are further arguments.
  ProcessResult Run(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {
        "shot", Path("walk"), "--lights", LightsPath(), "--map", "300x200", "-o", Output()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunLightfit(arguments);
  }

  const std::vector<Light>& lights() const { return walk_.lights; }
  int num_frames() const { return static_cast<int>(walk_.views.size()); }
  std::string Path(const std::string& name) const { return folder_.Path(name); }
  std::string LightsPath() const { return Path("lights.json"); }
  std::string Output() const { return Path("out"); }
  std::string FrameName(int frame) const { return absl::StrFormat("walk.%04d", 998 + frame); }
  std::string FramePath(int frame) const { return Path("walk/" + FrameName(frame) + ".exr"); }
  std::string ResultPath(const std::string& mode, int frame) const {
    return Output() + "/" + mode + "/" + FrameName(frame) + ".json";
  }

 private:
  static constexpr uint64_t kSeed = 7;

  TemporaryFolder folder_;
  testing::BoxWalk walk_;
};

// Every file below a folder with what is in it.
inline std::map<std::string, std::string> FilesBelow(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    files[std::filesystem::relative(entry.path(), folder).string()] =
        ReadFile(entry.path().string());
  }
  return files;
}

}  // namespace lightfit
