#include "jobs/shot/key.h"

#include <zlib.h>

#include <fstream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/parallel.h"
#include "base/version.h"
#include "optimizer/fit.h"
#include "wire/camera_proto.h"
#include "wire/light_proto.h"
#include "wire/matrix_proto.h"
#include "wire/options_proto.h"
#include "wire/plan_proto.h"
#include "wire/plan_shot_proto.h"
#include "wire/proto_json.h"
#include "wire/shot_proto.h"

namespace lightfit {
namespace {

std::string KeyText(uLong crc, int64_t num_bytes) {
  return absl::StrFormat("%08x-%d", static_cast<uint32_t>(crc), num_bytes);
}

std::string KeyOf(const std::string& text) {
  const uLong crc =
      crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size()));
  return KeyText(crc, static_cast<int64_t>(text.size()));
}

std::string KeyOfFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return "unreadable";
  std::vector<char> piece(1 << 18);
  uLong crc = crc32(0, nullptr, 0);
  int64_t num_bytes = 0;
  while (file.read(piece.data(), static_cast<std::streamsize>(piece.size())) || file.gcount() > 0) {
    const auto size = static_cast<uInt>(file.gcount());
    crc = crc32(crc, reinterpret_cast<const Bytef*>(piece.data()), size);
    num_bytes += size;
  }
  return file.bad() ? "unreadable" : KeyText(crc, num_bytes);
}

std::string JsonOrError(const google::protobuf::Message& message) {
  const absl::StatusOr<std::string> json = ProtoToJson(message);
  return json.ok() ? *json : json.status().ToString();
}

// Raised whenever the same options may find other channels in a file.
constexpr int kReadingRevision = 3;

// How a file is to be understood.
std::string ReadingText(const ReadbackExrOptions& exr) {
  const std::string channels = absl::StrJoin({absl::string_view(exr.depth_channel),
                                              absl::string_view(exr.shadow_channel_format),
                                              absl::string_view(exr.shadow_bits_channel),
                                              absl::string_view(exr.facing_channel_format),
                                              absl::string_view(exr.mapped_channel_format),
                                              absl::string_view(exr.view)},
                                             "\n");
  return absl::StrFormat("%d %d %s\n%s\n%s\n%.17g %.17g %.17g\n%s",
                         kReadingRevision,
                         static_cast<int>(exr.depth_kind),
                         exr.background.has_value() ? absl::StrCat(*exr.background) : "",
                         channels,
                         CameraConventionWords(exr.camera_exr.convention),
                         exr.camera_exr.near,
                         exr.camera_exr.far,
                         exr.camera_exr.pixel_aspect,
                         exr.camera.has_value() ? JsonOrError(CameraToProto(*exr.camera)) : "");
}

std::string FrameText(const ShotFrame& frame) {
  return absl::StrCat(frame.name,
                      " ",
                      frame.number,
                      "\n",
                      KeyOfFile(frame.path),
                      "\n",
                      frame.exr.ok() ? ReadingText(*frame.exr) : frame.exr.status().ToString());
}

// What goes into summaries.
std::string SummarySettings(const ShotJob& job) {
  std::string text = absl::StrCat(
      kVersion, " fits ", kFitRevision, "\n", JsonOrError(FitOptionsToProto(job.fit())));
  for (const Light& light : job.lights) {
    absl::StrAppend(&text, JsonOrError(LightToProto(light)), light.shadow_bit, "\n");
  }
  return text;
}

std::string PlanText(const PlanTrackerOptions& plans) {
  return JsonOrError(PlanOptionsToProto(plans.plan));
}

}  // namespace

ShotKeys ComputeShotKeys(const ShotJob& job) {
  const auto num_frames = static_cast<int>(job.frames.size());
  std::vector<std::string> frame_keys(job.frames.size());
  ParallelFor(num_frames, 1, job.num_threads, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) frame_keys[i] = KeyOf(FrameText(job.frames[i]));
  });
  const std::string summary_settings = SummarySettings(job);
  const std::string settings = absl::StrCat(summary_settings,
                                            job.map.width,
                                            "x",
                                            job.map.height,
                                            "\n",
                                            JsonOrError(ClipConventionToProto(job.clip)),
                                            job.plans.has_value() ? PlanText(*job.plans) : "");
  const std::string tracker = job.plans.has_value()
                                  ? JsonOrError(PlanTrackerSettingsToProto(*job.plans))
                                  : JsonOrError(TrackerSettingsToProto(job.tracker));
  ShotKeys keys;
  std::string before = "none", tracked = "none", all;
  for (const std::string& frame : frame_keys) {
    keys.summaries.push_back(KeyOf(absl::StrCat(summary_settings, frame)));
    keys.frames[static_cast<size_t>(ShotMode::kPerFrame)].push_back(
        KeyOf(absl::StrCat(settings, before, " ", frame)));
    tracked = KeyOf(absl::StrCat(settings, tracker, tracked, " ", frame));
    keys.frames[static_cast<size_t>(ShotMode::kTracked)].push_back(tracked);
    absl::StrAppend(&all, frame, "\n");
    before = frame;
  }
  keys.shot = KeyOf(absl::StrCat(settings, job.rounds, "\n", all));
  keys.frames[static_cast<size_t>(ShotMode::kPerShot)].assign(job.frames.size(), keys.shot);
  return keys;
}

}  // namespace lightfit
