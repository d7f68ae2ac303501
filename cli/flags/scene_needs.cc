#include "cli/flags/scene_needs.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace lightfit::cli {

absl::Status CheckSceneNeeds(const SceneFlags& flags, std::vector<std::string> missing) {
  const LightFlags& lights = flags.lights;
  if (lights.path.empty() && lights.extra.empty() && flags.num_random_lights == 0 &&
      !TakesLightsOfScene(flags)) {
    missing.insert(missing.begin(),
                   "no lights: want --lights FILE, --light NAME=sun:X,Y,Z or --random-lights "
                   "COUNT");
  }
  if (CameraPath(flags).empty()) {
    missing.insert(missing.begin(),
                   "no camera: want --camera EYE:TARGET such as --camera 0,1.7,18:0,0.5,0, or "
                   "--camera FILE");
  }
  if (missing.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrJoin(missing, "; "));
}

}  // namespace lightfit::cli
