// tests/io/summary_examples.h
//
// Summary files of the yard, and what goes into one by hand.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "io/summary_file.h"
#include "optimizer/fit.h"
#include "optimizer/light_matrix.h"
#include "tests/io/testing.h"
#include "tests/testing/matchers.h"
#include "wire/result_json.h"
#include "wire/summary_proto.h"

namespace lightfit::testing {

inline constexpr char kWriter[] = "lightfit test";
inline constexpr MapSize kMap = {1024, 512};

struct Example {
  std::vector<Light> lights;
  ReadbackFile file;
};

inline const Example& Yard() {
  static const Example& example = *new Example([] {
    Example yard;
    yard.lights = *ReadLightsFile(RepositoryFile("examples/yard_180/scene.json"));
    yard.file = *ReadReadbackExr(RepositoryFile("examples/yard_180/0001.exr"), yard.lights);
    return yard;
  }());
  return example;
}

// The yard with a bar of it gone, another one for each number: frames that see different things.
inline ReadbackFile FrameOfYard(int number) {
  ReadbackFile file = Yard().file;
  const int width = file.camera.width;
  const int first = 11 * number % width;
  for (int y = 0; y < file.camera.height; ++y) {
    for (int x = first; x < std::min(first + 40, width); ++x) {
      file.depth[static_cast<size_t>(y) * width + x] = std::numeric_limits<float>::infinity();
    }
  }
  return file;
}

inline SummarySet SetOf(const ReadbackFile& file,
                        const std::string& name,
                        const FitOptions& options = {}) {
  std::vector<LightSummary> lights;
  for (const Light& light : Yard().lights) {
    lights.push_back(SummaryOfFrame(light, Summarize(file.View(), light, options), name, options));
  }
  return MakeSummarySet(options, std::move(lights));
}

inline std::vector<SummarySet> FramesOfYard(int count) {
  std::vector<SummarySet> sets;
  for (int i = 0; i < count; ++i) sets.push_back(SetOf(FrameOfYard(i), absl::StrCat(i, ".exr")));
  return sets;
}

inline std::string BytesOf(const SummarySet& set) {
  const absl::StatusOr<std::string> bytes = SerializeSummarySet(set, kWriter);
  EXPECT_THAT(bytes, IsOk());
  return bytes.ok() ? *bytes : "";
}

// One frame's; what the tests below change.
inline const std::string& YardBytes() {
  static const std::string& bytes = *new std::string(BytesOf(SetOf(Yard().file, "yard.exr")));
  return bytes;
}

inline v1::SummaryFile YardProto() {
  v1::SummaryFile proto;
  EXPECT_TRUE(proto.ParseFromString(YardBytes().substr(20)));
  return proto;
}

inline std::string Uint32Bytes(uint32_t value) {
  std::string bytes;
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> 8 * i);
  return bytes;
}

// A file around any payload, with length and checksum as they should be.
inline std::string FileAround(const std::string& payload) {
  const uLong crc = crc32(0, reinterpret_cast<const Bytef*>(payload.data()), payload.size());
  return absl::StrCat(YardBytes().substr(0, 12),
                      Uint32Bytes(static_cast<uint32_t>(payload.size())),
                      Uint32Bytes(static_cast<uint32_t>(crc)),
                      payload);
}

// Whatever a file says that is read without complaint: a fit is a matrix of numbers or a status.
// Returns whether it is a matrix.
inline bool FitsOrSaysWhy(const LightSummary& light, const FitOptions& options) {
  const absl::StatusOr<Summary> summary = SummaryOfTotal(light.total);
  LightFit fit;
  fit.light = light.total.light;
  fit.matrix = summary.ok() ? Fit(*summary, fit.light, kMap, options)
                            : absl::StatusOr<LightMatrix>(summary.status());
  const bool has_matrix = fit.matrix.ok();
  if (has_matrix) {
    EXPECT_TRUE(fit.matrix->map_from_world.allFinite());
    EXPECT_TRUE(std::isfinite(fit.matrix->figures.energy)) << fit.matrix->figures.energy;
  } else {
    EXPECT_FALSE(fit.matrix.status().message().empty());
  }
  FitReport report;
  report.options = options;
  report.map = kMap;
  report.lights = {fit};
  EXPECT_THAT(FitResultToJson(FitResultToProto(report)), IsOk());
  return has_matrix;
}

}  // namespace lightfit::testing
