#include "io/notes/readback_warnings.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "geometry/affine_depth.h"
#include "io/camera_exr.h"
#include "optimizer/readback/background.h"
#include "optimizer/readback/depth_check.h"
#include "optimizer/readback/shadow_check.h"

namespace lightfit {

namespace {

constexpr char kAboutBackground[] = "background";

std::string VectorText(const Eigen::Vector3d& vector) {
  return absl::StrFormat("(%g, %g, %g)", vector.x(), vector.y(), vector.z());
}

std::string LightText(const Light& light) {
  return light.kind == Light::Kind::kPoint
             ? absl::StrCat("position ", VectorText(light.position))
             : absl::StrCat("direction ", VectorText(light.direction));
}

// Where the camera stands; for an orthographic one its plane's middle will do.
Eigen::Vector3d EyeOf(const Camera& camera) {
  const Eigen::Matrix3d axes = camera.camera_from_world.topLeftCorner<3, 3>();
  return -axes.transpose() * camera.camera_from_world.topRightCorner<3, 1>();
}

// Positions by their share of the way to the camera; directions in radians.
bool AreAlike(const Light& a, const Light& b, const Camera& camera) {
  constexpr double kTolerance = 2e-3;
  if (a.kind != b.kind) return false;
  if (a.kind == Light::Kind::kDirectional) {
    const Eigen::Vector3d one = a.direction.stableNormalized();
    const Eigen::Vector3d other = b.direction.stableNormalized();
    return (one - other).norm() <= kTolerance;
  }
  const Eigen::Vector3d eye = EyeOf(camera);
  const double scale = std::max((a.position - eye).norm(), (b.position - eye).norm());
  return (a.position - b.position).norm() <= kTolerance * scale;
}

// Pixels of a shape that a camera of another image gives them: of one with the sides swapped, or a
// square one. Anamorphic ones have other shapes.
void AddPixelShape(const Camera& camera, std::vector<ReadbackWarning>* warnings) {
  constexpr double kTolerance = 0.01;
  const double shape = std::abs(camera.screen_from_camera(1, 1) / camera.screen_from_camera(0, 0));
  const double sides = static_cast<double>(camera.width) / camera.height;
  const auto is_about = [shape](double value) {
    return std::abs(shape / value - 1.0) <= kTolerance;
  };
  if (is_about(1.0)) return;
  const bool is_swapped = is_about(sides * sides) || is_about(1.0 / (sides * sides));
  if (!is_swapped && !is_about(sides) && !is_about(1.0 / sides)) return;
  warnings->push_back(
      {"pixel shape",
       absl::StrFormat(
           "a pixel of the %d x %d image is %.4g times as wide as high, as if the camera "
           "were that of %s image: want the camera of this image%s",
           camera.width,
           camera.height,
           shape,
           is_swapped ? "a " + absl::StrFormat("%d x %d", camera.height, camera.width)
                      : std::string("a square"),
           is_swapped ? ", and the image not transposed" : "")});
}

void AddDepthKind(const Readback& readback,
                  WarningWords words,
                  std::vector<ReadbackWarning>* warnings) {
  const DepthDoubt doubt = DoubtOfDepth(readback);
  if (doubt == DepthDoubt::kNone) return;
  const char* const option = words == WarningWords::kCommandLine ? "--depth-kind " : "depth_kind ";
  std::string text =
      doubt == DepthDoubt::kProjective
          ? absl::StrCat(
                "all depths lie within 0 ... 1, and what is flat is so only if they are 1/z "
                "or lie between clip planes: want ",
                option,
                "ndc-0-1, ndc-minus-1-1 or ndc-reversed, or for 1/z a channel of z itself")
          : absl::StrCat(
                "all depths lie within 0 ... 1 and reach an end of it, as normalised ones "
                "do, which are no distances: want a channel of z itself, or ",
                option,
                "ndc-0-1 or ndc-reversed if they lie between clip planes");
  warnings->push_back({"depth-kind", std::move(text)});
}

void AddShadows(const Readback& readback,
                const Light& light,
                std::vector<ReadbackWarning>* warnings) {
  const ShadowCheck check = CheckShadows(readback, light);
  const ShadowVerdict verdict = VerdictOf(check);
  if (verdict == ShadowVerdict::kPlausible) return;
  const std::string counts = absl::StrFormat(
      "of %d lit pixels that were tried %d have a surface before the light, of %d in shadow %d",
      check.num_lit,
      check.num_lit_blocked,
      check.num_shadowed,
      check.num_shadowed_blocked);
  const char* const way_out =
      verdict == ShadowVerdict::kInverted
          ? "is its shadow the wrong way round (1 is where it is blocked), or the light of another "
            "scene?"
          : "is the light, or the camera, that of another scene or frame?";
  warnings->push_back({absl::StrCat("shadow of ", light.name),
                       absl::StrFormat("light \"%s\": %s: %s", light.name, counts, way_out)});
}

// The largest distance on the screen, in pixels, of points in view of one camera seen by the other.
double LargestDifference(const Camera& a, const Camera& b) {
  const Eigen::Matrix4d b_from_a = b.ScreenFromWorld() * a.WorldFromScreen();
  double largest = 0.0;
  for (const double depth : {0.02, 0.1, 0.5}) {
    for (const double x : {0.0, 0.5 * a.width, static_cast<double>(a.width)}) {
      for (const double y : {0.0, 0.5 * a.height, static_cast<double>(a.height)}) {
        const Eigen::Vector4d there = b_from_a * Eigen::Vector4d(x, y, depth, 1.0);
        if (!(there.w() > 0.0)) return 1e9;
        largest = std::max(largest, (there.head<2>() / there.w() - Eigen::Vector2d(x, y)).norm());
      }
    }
  }
  return largest;
}

}  // namespace

std::vector<ReadbackWarning> BackgroundWarnings(absl::Span<const Light> lights,
                                                WarningWords words,
                                                Readback* readback) {
  uint32_t light_mask = 0;
  for (const Light& light : lights) light_mask |= uint32_t{1} << light.shadow_bit;
  const std::optional<FarDepth> found = SettleBackground(light_mask, readback);
  if (!found.has_value()) return {};
  const bool is_line = words == WarningWords::kCommandLine;
  return {{kAboutBackground,
           found->Text(is_line ? "--background " : "background = ", is_line ? "inf" : "infinity")}};
}

std::vector<ReadbackWarning> PixelWarnings(absl::Span<const Light> lights,
                                           WarningWords words,
                                           Readback* readback) {
  std::vector<ReadbackWarning> warnings = BackgroundWarnings(lights, words, readback);
  AddPixelShape(readback->camera, &warnings);
  const size_t num_before = warnings.size();
  AddDepthKind(*readback, words, &warnings);
  // Surfaces that are elsewhere would contradict all lights.
  if (warnings.size() == num_before) {
    for (const Light& light : lights) AddShadows(*readback, light, &warnings);
  }
  for (ReadbackWarning& warning : warnings) {
    warning.is_of_pixels = warning.about != kAboutBackground;
  }
  return warnings;
}

std::vector<ReadbackWarning> LightWarnings(absl::Span<const Light> lights,
                                           absl::Span<const Light> of_header,
                                           const Camera& camera) {
  std::vector<ReadbackWarning> warnings;
  for (const Light& light : lights) {
    const auto same = std::find_if(of_header.begin(), of_header.end(), [&](const Light& other) {
      return other.name == light.name;
    });
    if (same == of_header.end() || AreAlike(light, *same, camera)) continue;
    warnings.push_back(
        {absl::StrCat("header of ", light.name),
         absl::StrFormat("light \"%s\": its %s is not that of the file's header, %s: want the "
                         "lights that the read-back was rendered with",
                         light.name,
                         LightText(light),
                         LightText(*same))});
  }
  return warnings;
}

std::vector<ReadbackWarning> CameraWarnings(const Camera& given, const Camera& of_file) {
  constexpr double kPixels = 1.0;
  const double pixels =
      given.orthographic == of_file.orthographic ? LargestDifference(of_file, given) : 1e9;
  if (pixels <= kPixels) return {};
  return {
      {"camera",
       absl::StrFormat(
           "the camera of --camera is not that of the file's own matrices: it stands at %s, the "
           "file's at %s%s; want the camera of this frame (--frame), or leave --camera out",
           VectorText(EyeOf(given)),
           VectorText(EyeOf(of_file)),
           pixels < 1e9 ? absl::StrFormat(", and the image differs by up to %.3g pixels", pixels)
                        : "")}};
}

std::vector<ReadbackWarning> ShiftWarnings(const Camera& camera) {
  if (FrameShift(camera) <= kLikelyFrameShift) return {};
  return {
      {"lens shift",
       absl::StrFormat("the camera's axis meets the frame at (%.4g, %.4g), taken for a shifted "
                       "lens: --camera-convention shifted says so; else state what the renderer "
                       "means, such as --camera-convention ndc-minus-1-1",
                       camera.screen_from_camera(0, 2) / camera.width,
                       camera.screen_from_camera(1, 2) / camera.height)}};
}

}  // namespace lightfit
