#include "render/shipped/judge_rays.h"

#include <cmath>
#include <memory>
#include <optional>

#include "absl/strings/str_format.h"
#include "geometry/border.h"
#include "render/judge_texels.h"
#include "render/shadow_map.h"
#include "render/texel_maps.h"

namespace lightfit {

namespace {

// Of directions, of lengths, and of a light's place as a share of its distance from the origin:
// rounding.
constexpr double kRounding = 1e-9;

class ParaboloidMaps : public TexelMaps {
 public:
  ParaboloidMaps(const ParaboloidPair& pair, const Eigen::Vector2d& move)
      : pair_(pair), move_(move), grid_(GridOf(pair)) {}

  int64_t num_texels() const override { return grid_.num_texels(); }

  int32_t TexelOf(const Eigen::Vector3d& world) const override {
    const ParaboloidPlace place = pair_.At(world);
    return place.half < 0 ? kNoTexel : grid_.NumberAt(place.half, place.texel + move_);
  }

  std::optional<Ray> RayOf(int32_t number) const override {
    const TexelGrid::Texel texel = grid_.TexelOf(number);
    const TexelRay ray = pair_.RayAt({texel.map, TexelGrid::CentreOf(texel) - move_});
    return Ray{ray.origin, ray.direction};
  }

 protected:
  const ParaboloidPair& pair_;
  Eigen::Vector2d move_;
  TexelGrid grid_;
};

class DrawnParaboloidMaps : public ParaboloidMaps {
 public:
  DrawnParaboloidMaps(const ParaboloidPair& pair,
                      const Eigen::Vector2d& move,
                      const ParaboloidRasterOptions& options)
      : ParaboloidMaps(pair, move), options_(options) {}

  std::unique_ptr<TexelHits> Draw(const RayCaster& caster,
                                  absl::Span<const uint8_t> wanted) const override {
    return std::make_unique<ParaboloidRaster>(
        caster.scene(), pair_, move_, wanted, caster.num_threads(), options_);
  }

 private:
  ParaboloidRasterOptions options_;
};

class PageMaps : public TexelMaps {
 public:
  PageMaps(const PagedMap& pages, const Eigen::Vector2d& move, const Eigen::AlignedBox3d& bounds)
      : pages_(pages),
        move_(move),
        grid_({pages.page_side, static_cast<int>(pages.pages.size())}),
        start_(StartOfSunRays(pages.direction, bounds) * pages.direction) {}

  int64_t num_texels() const override { return grid_.num_texels(); }

  int32_t TexelOf(const Eigen::Vector3d& world) const override {
    const PagePlace place = pages_.At(world);
    return place.page < 0 ? kNoTexel : grid_.NumberAt(place.page, place.texel + move_);
  }

  std::optional<Ray> RayOf(int32_t number) const override {
    const TexelGrid::Texel texel = grid_.TexelOf(number);
    const TexelRay ray = pages_.RayAt({texel.map, TexelGrid::CentreOf(texel) - move_});
    return Ray{ray.origin + start_, ray.direction};
  }

 private:
  const PagedMap& pages_;
  Eigen::Vector2d move_;
  TexelGrid grid_;
  Eigen::Vector3d start_;
};

absl::Status CheckTexels(const Light& light, int64_t num_maps, int64_t side) {
  const int64_t most = static_cast<int64_t>(std::sqrt(kMaxJudgedTexels)) - 2;
  const bool is_judged = num_maps >= 1 && side >= 1 && side <= most &&
                         num_maps <= kMaxJudgedTexels / ((side + 2) * (side + 2));
  if (is_judged) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("light \"%s\": %d maps of %dx%d texels, want one or more of 1x1 or more, and "
                      "at most %d texels in all",
                      light.name,
                      num_maps,
                      side,
                      side,
                      kMaxJudgedTexels));
}

absl::Status CheckPair(const ParaboloidPair& pair, const Light& light) {
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  const double distance = (pair.centre - light.position).norm();
  if (light.kind != Light::Kind::kPoint || !(distance <= kRounding * light.position.norm())) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": the pair of paraboloids around (%g, %g, %g) is not of this "
                        "light: want a point light there",
                        light.name,
                        pair.centre.x(),
                        pair.centre.y(),
                        pair.centre.z()));
  }
  if (!(std::abs(pair.normal.norm() - 1.0) <= kRounding)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("light \"%s\": the pair's normal = (%g, %g, %g), want length 1",
                        light.name,
                        pair.normal.x(),
                        pair.normal.y(),
                        pair.normal.z()));
  }
  return CheckTexels(light, 2, pair.size);
}

absl::Status CheckPages(const PagedMap& pages, const Light& light) {
  if (absl::Status status = ValidateLight(light); !status.ok()) return status;
  const Eigen::Vector3d direction = light.direction.stableNormalized();
  if (light.kind != Light::Kind::kDirectional ||
      !((pages.direction - direction).norm() <= kRounding) ||
      !((pages.plane_from_world.leftCols<3>() * direction).norm() <= kRounding)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "light \"%s\": the pages along (%g, %g, %g) are not of this light: want a directional "
        "light of that direction",
        light.name,
        pages.direction.x(),
        pages.direction.y(),
        pages.direction.z()));
  }
  return CheckTexels(light, static_cast<int64_t>(pages.pages.size()), pages.page_side);
}

}  // namespace

absl::StatusOr<ShadowImage> JudgeParaboloids(const RayCaster& caster,
                                             const SurfaceImage& image,
                                             absl::Span<const Lighting> truth,
                                             const Light& light,
                                             const ParaboloidPair& pair,
                                             const JudgeOptions& options) {
  if (absl::Status status = CheckPair(pair, light); !status.ok()) return status;
  const auto maps = [&](const Eigen::Vector2d& move) -> std::unique_ptr<TexelMaps> {
    return std::make_unique<ParaboloidMaps>(pair, move);
  };
  return JudgeTexels(caster, image, truth, light, Border::kLit, maps, options);
}

absl::StatusOr<ShadowImage> JudgeDrawnParaboloids(const RayCaster& caster,
                                                  const SurfaceImage& image,
                                                  absl::Span<const Lighting> truth,
                                                  const Light& light,
                                                  const ParaboloidPair& pair,
                                                  const JudgeOptions& options,
                                                  const ParaboloidRasterOptions& raster) {
  if (absl::Status status = CheckPair(pair, light); !status.ok()) return status;
  if (absl::Status status = ValidateParaboloidRasterOptions(raster); !status.ok()) return status;
  const auto maps = [&](const Eigen::Vector2d& move) -> std::unique_ptr<TexelMaps> {
    return std::make_unique<DrawnParaboloidMaps>(pair, move, raster);
  };
  return JudgeTexels(caster, image, truth, light, Border::kLit, maps, options);
}

absl::StatusOr<ShadowImage> JudgePages(const RayCaster& caster,
                                       const SurfaceImage& image,
                                       absl::Span<const Lighting> truth,
                                       const Light& light,
                                       const PagedMap& pages,
                                       const JudgeOptions& options) {
  if (absl::Status status = CheckPages(pages, light); !status.ok()) return status;
  const auto maps = [&](const Eigen::Vector2d& move) -> std::unique_ptr<TexelMaps> {
    return std::make_unique<PageMaps>(pages, move, caster.bounds());
  };
  return JudgeTexels(caster, image, truth, light, Border::kLit, maps, options);
}

}  // namespace lightfit
