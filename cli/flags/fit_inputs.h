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
#include "io/notes/readback_notes.h"
#include "io/readback_exr.h"

namespace lightfit::cli {

struct FitInputs {
  std::vector<Light>
      lights;         // those of --lights, then those of --light, as far as --only keeps them
  ReadbackFile file;  // light_status[l] belongs to lights[l]

  // What is to be said of it.
  ReadbackNotes notes;

  // --cover-readback.
  std::optional<FineCoverFile> fine_cover_file;
  FineCover fine_cover;

  // With the finer cover, if there is one. Refers to this object.
  Readback View() const;
};

absl::StatusOr<FitInputs> ReadFitInputs(const FitFlags& flags);

// Parts of it, for verbs that read many read-backs: the lights; and how the channels and the camera
// of a read-back are to be understood.
absl::StatusOr<std::vector<Light>> ReadFitLights(const FitFlags& flags);
absl::StatusOr<ReadbackExrOptions> ReadbackOptionsOf(const FitFlags& flags);

// Those of the lights that `only` names, in their own order; all when it names none.
absl::StatusOr<std::vector<Light>> ChooseLights(const std::vector<Light>& lights,
                                                const std::vector<std::string>& only);

}  // namespace lightfit::cli
