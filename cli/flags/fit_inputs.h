// cli/flags/fit_inputs.h
//
// What `lightfit fit` works on: the lights and the read-back that the flags name.
#pragma once

#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/flags/fit_flags.h"
#include "geometry/light.h"
#include "io/fine_cover_exr.h"
#include "io/lights_file.h"
#include "io/notes/readback_notes.h"
#include "io/readback_exr.h"

namespace lightfit::cli {

struct FitInputs {
  std::vector<Light>
      lights;         // those of --lights, then those of --light, as far as --only keeps them
  ReadbackFile file;  // light_status[l] belongs to lights[l], also of what can be no light

  // What is to be said of it.
  ReadbackNotes notes;

  // --cover-readback.
  std::optional<FineCoverFile> fine_cover_file;
  FineCover fine_cover;

  // With the finer cover, if there is one. Refers to this object.
  Readback View() const;
};

absl::StatusOr<FitInputs> ReadFitInputs(const FitFlags& flags);

// Parts of it. The lights that --only keeps, as many as they are, each with what is wrong with it;
// an error where none of them is of use.
absl::StatusOr<std::vector<ListedLight>> ListFitLights(const FitFlags& flags);

// The same in groups of which each has room in the shadow bits of one read-back: one group but for
// files of more than kMaxLights. Their shadow_bit is then another than their number in the file.
std::vector<std::vector<ListedLight>> GroupsOfLights(std::vector<ListedLight> lights);

// For one group. Where all shadows are in one channel a light beyond its bits fails alone.
absl::StatusOr<FitInputs> ReadFitInputs(const FitFlags& flags, std::vector<ListedLight> lights);

// For verbs that read many read-backs: the lights that can be used, at most kMaxLights, where they
// stand still; and how the channels of a read-back are to be understood. Cameras, and lights that
// move: cli/flags/frame_inputs.h.
absl::StatusOr<std::vector<Light>> ReadFitLights(const FitFlags& flags);
absl::StatusOr<std::vector<Light>> UsableLights(std::vector<ListedLight> list);
ReadbackExrOptions ReadbackOptionsOf(const FitFlags& flags);

// Those of the lights that `only` names, in their own order; all when it names none.
absl::StatusOr<std::vector<Light>> ChooseLights(const std::vector<Light>& lights,
                                                const std::vector<std::string>& only);
absl::StatusOr<std::vector<ListedLight>> ChooseLights(const std::vector<ListedLight>& lights,
                                                      const std::vector<std::string>& only);

}  // namespace lightfit::cli
