// cli/flags/frame_inputs.h
//
// What is another in every frame of a shot: its camera, and lights that move.
// In:   the files of --camera and --lights, or without lights the headers of the read-backs
//       (io/header_lights.h); which frames they are read for.
// Out:  by the frame's number, what belongs to it; or why that cannot be known.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "base/frame_number.h"
#include "cli/flags/fit_flags.h"
#include "geometry/light.h"
#include "io/camera_file.h"
#include "io/frames/frame_table.h"
#include "io/frames/light_frames.h"
#include "io/lights_file.h"
#include "io/readback_exr.h"
#include "jobs/shot/frames.h"

namespace lightfit::cli {

struct FrameLights {
  std::vector<Light> lights;        // of use; the same in the same order in all frames
  std::vector<std::string> absent;  // names of those that are not there in this frame
};

class FrameInputs {
 public:
  // Of one read-back, whose name or header says its number.
  static absl::StatusOr<FrameInputs> ForFile(const FitFlags& flags, const std::string& path);
  // Of the frames of a shot.
  static absl::StatusOr<FrameInputs> ForShot(const FitFlags& flags, const FrameList& list);

  // How the frame's file is to be read, with its camera if --camera has it.
  absl::StatusOr<ReadbackExrOptions> ReadingOf(const std::string& path, FrameNumber number) const;

  // As ListFitLights(); a light that is not there in this frame is of no use.
  absl::StatusOr<std::vector<ListedLight>> ListLightsOf(const std::string& path,
                                                        FrameNumber number) const;

  // Of those the ones that are of use in any frame, at most kMaxLights.
  absl::StatusOr<FrameLights> LightsOf(const std::string& path, FrameNumber number) const;
  bool HasMovingLights() const { return light_frames_.has_value(); }

  // The number of the file that ForFile() was made for; 0 where it has none.
  FrameNumber number() const { return shot_.first; }

 private:
  FrameInputs(const FitFlags& flags, const ShotNumbers& shot) : flags_(flags), shot_(shot) {}
  static absl::StatusOr<FrameInputs> Read(const FitFlags& flags, const ShotNumbers& shot);

  // The place among the entries of lights that move.
  absl::StatusOr<size_t> LightsEntryOf(const std::string& path, FrameNumber number) const;

  FitFlags flags_;
  ShotNumbers shot_;
  std::optional<CameraFile> camera_file_;
  std::optional<EntryChooser> cameras_;  // absent: one camera for all, or none
  std::optional<LightFrames> light_frames_;
  std::optional<EntryChooser> lights_;
  bool lights_are_of_headers_ = false;
};

// ListFitLights() of --lights for the read-back that is fitted.
absl::StatusOr<std::vector<ListedLight>> ListFrameLights(const FitFlags& flags);

// The same for verbs of many frames: what is of no use is that in all of them.
absl::StatusOr<std::vector<ListedLight>> ListLightsOfAnyFrame(const FitFlags& flags);

}  // namespace lightfit::cli
