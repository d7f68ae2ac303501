#include "optimizer/readback/background.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "geometry/affine_depth.h"
#include "optimizer/readback/kernels.h"

namespace lightfit {

namespace {

// What programs write where nothing was hit, beside the powers of ten. The first is the largest
// half float, which is also what whatever lies beyond becomes.
constexpr float kLargestHalf = 65504.0F;
constexpr std::array<float, 10> kSkyDepths = {
    65535.0F, 65536.0F, 99999.0F, 999999.0F, 9999999.0F, 1e5F, 1e6F, 1e7F, 1e8F, 16777215.0F};

// Shares of all pixels, and how many times as deep as the others the one depth is.
constexpr double kManyPixels = 0.01;
constexpr double kRemarkablePixels = 0.05;
constexpr double kLittleBeyond = 1.5;
constexpr double kBeyond = 4.0;
constexpr double kFarBeyond = 10.0;
constexpr double kBeyondAll = 100.0;

// A few pixels between the one depth and the rest are what smoothed outlines leave.
constexpr double kFewOthers = 0.02;

internal::DepthIntervals Below(const AffineDepth& affine_depth, double above, double below) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  return {static_cast<float>(std::max(affine_depth.surface_min(), above)),
          static_cast<float>(std::min(affine_depth.surface_max(), below)),
          kInfinity,
          kInfinity};
}

internal::DepthStatistics Scan(const Readback& readback, const internal::DepthIntervals& of) {
  const size_t width = readback.width();
  return internal::ScanDepth(
      readback.depth.data(), nullptr, 0, width, width, readback.height(), of);
}

bool IsSkyDepth(float depth) {
  return depth == kLargestHalf ||
         std::find(kSkyDepths.begin(), kSkyDepths.end(), depth) != kSkyDepths.end();
}

// Whether the pixels of that depth are all in shadow, or all without, for each light: edges of
// shadows lie on surfaces.
bool HasNoShadowEdge(const Readback& readback, float depth, uint32_t light_mask) {
  uint32_t any = 0, all = ~uint32_t{0};
  for (size_t i = 0; i < readback.depth.size(); ++i) {
    if (readback.depth[i] != depth) continue;
    any |= readback.shadow_bits[i];
    all &= readback.shadow_bits[i];
  }
  return ((any & ~all) & light_mask) == 0;
}

struct Found {
  FarDepth far;
  double beyond;                 // `depth` over the greatest depth of the others
  double num_between_share = 0;  // of the others, how many are nearer to it than kFarBeyond
  bool has_shadow_edge;
};

bool IsBackground(const Found& found, const Readback& readback) {
  const bool are_many = found.far.share >= kManyPixels;
  if (IsSkyDepth(found.far.depth)) {
    if (found.beyond >= kFarBeyond) return true;
    if (found.far.depth == kLargestHalf && are_many) return true;
    return are_many && found.beyond >= kLittleBeyond && !found.has_shadow_edge;
  }
  if (!are_many || found.has_shadow_edge || !found.far.has_others) return false;
  if (readback.depth_kind == DepthKind::kDistance && !readback.camera.orthographic) {
    return found.beyond >= kLittleBeyond;
  }
  if (found.far.depth > kLargestHalf && found.beyond >= kFarBeyond) return true;
  return found.beyond >= kBeyondAll;
}

bool IsDoubtful(const Found& found) {
  if (found.has_shadow_edge || !found.far.has_others) return false;
  if (found.far.share < kRemarkablePixels) return false;
  return found.beyond >= kBeyond || IsSkyDepth(found.far.depth) ||
         found.num_between_share <= kFewOthers;
}

}  // namespace

std::string FarDepth::Text(absl::string_view option, absl::string_view infinity) const {
  const std::string depth_text = absl::StrFormat("%.9g", depth);
  return absl::StrFormat(
      "%.3g %% of the pixels have one depth, %s%s: taken for %s; %s%s states that it is the "
      "background, %s%s that it is a surface",
      100.0 * share,
      depth_text,
      has_others ? absl::StrFormat(", and the others at most %.6g", next) : "",
      is_background ? "background" : "a surface",
      option,
      depth_text,
      option,
      infinity);
}

std::optional<FarDepth> FindFarDepth(const Readback& readback, uint32_t light_mask) {
  if (IsNdc(readback.depth_kind)) return std::nullopt;
  const AffineDepth affine_depth(readback.camera, readback.depth_kind);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const internal::DepthStatistics all = Scan(readback, Below(affine_depth, -kInfinity, kInfinity));
  if (all.num_surface == 0 || !(all.max > 0.0F)) return std::nullopt;
  const internal::DepthStatistics others = Scan(readback, Below(affine_depth, -kInfinity, all.max));
  Found found;
  found.far.depth = all.max;
  found.far.share = static_cast<double>(all.num_surface - others.num_surface) /
                    static_cast<double>(readback.depth.size());
  found.far.has_others = others.num_surface > 0;
  found.far.next = others.max;
  // Orthographic depths may be negative.
  const double extent = std::max(std::abs(double{others.min}), std::abs(double{others.max}));
  found.beyond = found.far.has_others ? all.max / extent : kInfinity;
  // Nearly every read-back ends here.
  const bool is_sky_depth = IsSkyDepth(all.max);
  if (found.far.share < kManyPixels && !is_sky_depth) return std::nullopt;
  if (found.far.has_others) {
    const internal::DepthStatistics between =
        Scan(readback, Below(affine_depth, all.max / kFarBeyond, all.max));
    found.num_between_share = static_cast<double>(between.num_surface) / others.num_surface;
  }
  if (found.beyond < kLittleBeyond && found.num_between_share > kFewOthers && !is_sky_depth) {
    return std::nullopt;
  }
  found.has_shadow_edge = !HasNoShadowEdge(readback, all.max, light_mask);
  found.far.is_background = IsBackground(found, readback);
  if (!found.far.is_background && !IsDoubtful(found)) return std::nullopt;
  return found.far;
}

std::optional<FarDepth> SettleBackground(uint32_t light_mask, Readback* readback) {
  if (readback->background.has_value()) return std::nullopt;
  const std::optional<FarDepth> found = FindFarDepth(*readback, light_mask);
  readback->background = found.has_value() && found->is_background
                             ? found->depth
                             : std::numeric_limits<float>::infinity();
  return found;
}

}  // namespace lightfit
