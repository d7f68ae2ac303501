#include "io/camera_exr.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "io/camera_matrices.h"

namespace lightfit {

namespace {

using internal::CameraUnderConvention;
using Convention = CameraConvention;

absl::Status Refuse(const std::string& message) { return absl::InvalidArgumentError(message); }

// The whole of it, as the option has it.
std::string WordsOf(const Convention& convention) {
  const std::string words = CameraConventionWords(convention);
  return words.empty() ? "openexr" : words;
}

// All 64 conventions.
std::vector<Convention> AllConventions() {
  std::vector<Convention> all;
  for (int bits = 0; bits < 64; ++bits) {
    const auto bit = [bits](int i) { return bits >> i & 1; };
    all.push_back({static_cast<Convention::Layout>(bit(0)),
                   static_cast<Convention::NdcRange>(bit(1)),
                   static_cast<Convention::NdcY>(bit(2)),
                   static_cast<Convention::ViewAxis>(bit(3)),
                   static_cast<Convention::NdcW>(bit(4)),
                   static_cast<Convention::NdcSpan>(bit(5))});
  }
  return all;
}

// The two matrices as a convention reads them.
struct Reading {
  Convention convention;
  Camera camera;
  int64_t num_changes = 0;  // words that differ from those stated
};

// How many words there are to be changed for it.
int64_t NumWords(const Convention& convention, const Convention& stated) {
  const std::string words = CameraConventionWords(convention, stated);
  return words.empty() ? 0 : std::count(words.begin(), words.end(), ',') + 1;
}

// All but the stated one under which the matrices hold together, whatever the shift.
std::vector<Reading> OtherReadings(const Eigen::Matrix4d& world_to_camera,
                                   const Eigen::Matrix4d& world_to_ndc,
                                   int width,
                                   int height,
                                   CameraExrOptions options) {
  const Convention stated = options.convention;
  std::vector<Reading> readings;
  for (Convention convention : AllConventions()) {
    convention.frame_centre = stated.frame_centre;
    if (convention == stated) continue;
    options.convention = convention;
    absl::StatusOr<Camera> camera =
        CameraUnderConvention(world_to_camera, world_to_ndc, width, height, options);
    if (!camera.ok()) continue;
    readings.push_back({convention, *std::move(camera), NumWords(convention, stated)});
  }
  return readings;
}

std::string CentreText(const Camera& camera) {
  return absl::StrFormat("(%.4g, %.4g)",
                         camera.screen_from_camera(0, 2) / camera.width,
                         camera.screen_from_camera(1, 2) / camera.height);
}

std::string OptionText(const Reading& reading, bool with_centre) {
  return absl::StrCat(
      "--camera-convention \"",
      WordsOf(reading.convention),
      "\"",
      with_centre ? absl::StrCat(" (axis at ", CentreText(reading.camera), " of the frame)") : "");
}

// What to do about matrices that the stated convention does not fit: the fewest changes to it that
// make them hold together. Those with the axis in the very middle are the likeliest; of others no
// shift tells, so that both NDC ranges are named.
std::string WayOut(std::vector<Reading> readings, const Convention& stated) {
  constexpr double kMiddle = 0.02;
  if (readings.empty()) {
    return "the two matrices hold together under no known convention: give the camera as a file, "
           "--camera";
  }
  const auto is_off = [](const Reading& reading) { return FrameShift(reading.camera) > kMiddle; };
  const bool is_shifted = std::all_of(readings.begin(), readings.end(), is_off);
  if (!is_shifted) std::erase_if(readings, is_off);
  const auto changes_but_range = [&](const Reading& reading) {
    Convention convention = reading.convention;
    if (is_shifted) convention.ndc_range = stated.ndc_range;
    return NumWords(convention, stated);
  };
  int64_t fewest = std::numeric_limits<int64_t>::max();
  for (const Reading& reading : readings) fewest = std::min(fewest, changes_but_range(reading));
  std::vector<std::string> options;
  for (const Reading& reading : readings) {
    if (changes_but_range(reading) == fewest) {
      options.push_back(OptionText(reading, is_shifted));
    }
  }
  return absl::StrCat("they would hold together under ",
                      absl::StrJoin(options, " or "),
                      ": state it if that is what the renderer means");
}

// Whether another convention is likelier than the stated one, by the shift of the lens.
absl::Status CheckShift(const Camera& camera,
                        const std::vector<Reading>& readings,
                        const Convention& stated) {
  constexpr double kRounding = 1e-9;
  const Reading* nearest = nullptr;
  for (const Reading& reading : readings) {
    const double less =
        nearest == nullptr ? 1.0 : FrameShift(nearest->camera) - FrameShift(reading.camera);
    const bool is_simpler = nearest != nullptr && reading.num_changes < nearest->num_changes;
    if (less > kRounding || (less > -kRounding && is_simpler)) nearest = &reading;
  }
  if (nearest == nullptr || FrameShift(nearest->camera) >= FrameShift(camera) - kRounding) {
    return absl::OkStatus();
  }
  Convention shifted = stated;
  shifted.frame_centre = Convention::FrameCentre::kAnywhere;
  return Refuse(absl::StrCat("worldToNDC: the camera's axis meets the frame at ",
                             CentreText(camera),
                             "; if the lens is shifted, state --camera-convention ",
                             WordsOf(shifted),
                             ", if the renderer means ",
                             CentreText(nearest->camera),
                             ", --camera-convention ",
                             WordsOf(nearest->convention)));
}

}  // namespace

absl::StatusOr<Camera> CameraFromExrMatrices(const Eigen::Matrix4d& world_to_camera,
                                             const Eigen::Matrix4d& world_to_ndc,
                                             int width,
                                             int height,
                                             const CameraExrOptions& options) {
  if (width < 1 || height < 1) {
    return Refuse(absl::StrFormat("camera: size = %dx%d, want at least 1x1", width, height));
  }
  if (!(options.pixel_aspect >= 0.0) || !std::isfinite(options.pixel_aspect)) {
    return Refuse(absl::StrFormat("pixel_aspect = %g, want 0 (as the file says) or more",
                                  options.pixel_aspect));
  }
  if (!world_to_camera.allFinite() || !world_to_ndc.allFinite()) {
    return Refuse(absl::StrFormat("%s: has values that are not finite, want 16 numbers",
                                  world_to_camera.allFinite() ? "worldToNDC" : "worldToCamera"));
  }
  absl::StatusOr<Camera> camera =
      CameraUnderConvention(world_to_camera, world_to_ndc, width, height, options);
  const Convention& stated = options.convention;
  if (camera.ok() && (stated.frame_centre == Convention::FrameCentre::kAnywhere ||
                      FrameShift(*camera) <= kLikelyFrameShift)) {
    return camera;
  }
  std::vector<Reading> others =
      OtherReadings(world_to_camera, world_to_ndc, width, height, options);
  if (camera.ok()) {
    if (absl::Status status = CheckShift(*camera, others, stated); !status.ok()) return status;
    return camera;
  }
  return absl::Status(
      camera.status().code(),
      absl::StrCat(camera.status().message(), "; ", WayOut(std::move(others), stated)));
}

double FrameShift(const Camera& camera) {
  return std::max(std::abs(camera.screen_from_camera(0, 2) / camera.width - 0.5),
                  std::abs(camera.screen_from_camera(1, 2) / camera.height - 0.5));
}

}  // namespace lightfit
