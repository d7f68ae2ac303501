#include "render/plan_costs.h"

#include <Eigen/Core>
#include <bit>

#include "base/parallel.h"

namespace lightfit {

namespace {

static_assert(kMaxPlanMaps <= 32, "a word has a bit for each map");

// The planes of a map's frustum, in the order of the header; each >= 0 inside.
Eigen::Matrix<double, 5, 4> FrustumPlanes(const PlanMap& map) {
  const Eigen::RowVector4d uw = map.map_from_world.row(0), vw = map.map_from_world.row(1);
  const Eigen::RowVector4d w = map.map_from_world.row(3);
  Eigen::Matrix<double, 5, 4> planes;
  planes << uw, map.size.width * w - uw, vw, map.size.height * w - vw, w;
  return planes;
}

// Whether no plane has all three corners, homogeneous columns, on its far side.
bool MayReachInto(const Eigen::Matrix<double, 5, 4>& planes,
                  const Eigen::Matrix<double, 4, 3>& corners) {
  const Eigen::Matrix<double, 5, 3> inside = planes * corners;
  for (int plane = 0; plane < 4; ++plane) {
    if (inside.row(plane).maxCoeff() < 0.0) return false;
  }
  return inside.row(4).maxCoeff() > 0.0;
}

// bit k of words[i]: has(i, k), from all threads.
template <typename Has>
std::vector<uint32_t> Words(size_t count, int num_maps, int num_threads, const Has& has) {
  std::vector<uint32_t> words(count, 0);
  ParallelFor(static_cast<int>(count), 4096, num_threads, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      for (int k = 0; k < num_maps; ++k) {
        if (has(i, k)) words[i] |= uint32_t{1} << k;
      }
    }
  });
  return words;
}

// 0 of none.
double Mean(int64_t sum, int64_t count) {
  return count > 0 ? static_cast<double>(sum) / static_cast<double>(count) : 0.0;
}

}  // namespace

absl::StatusOr<PlanCosts> MeasurePlanCosts(const RayCaster& caster,
                                           const SurfaceImage& image,
                                           absl::Span<const Lighting> truth,
                                           const Light& light,
                                           const Plan& plan) {
  if (absl::Status status = ValidateLighting(truth, image, light); !status.ok()) return status;
  const absl::StatusOr<PlanLookUp> look_up = PlanLookUp::Create(plan, light);
  if (!look_up.ok()) return look_up.status();
  const int num_maps = look_up->num_maps();
  PlanCosts costs;
  costs.maps.resize(num_maps);

  const std::vector<uint32_t> askable =
      Words(truth.size(), num_maps, caster.num_threads(), [&](int i, int k) {
        Eigen::Vector2d texel;
        return IsJudged(truth[i]) && look_up->IsAskable(k, image.pixels[i].position, &texel);
      });
  int64_t num_askable = 0;
  for (size_t i = 0; i < askable.size(); ++i) {
    if (!IsJudged(truth[i])) continue;
    ++costs.receivers;
    num_askable += std::popcount(askable[i]);
    for (int k = 0; k < num_maps; ++k) costs.maps[k].receivers += askable[i] >> k & 1u;
    const PlanPlace place = look_up->At(image.pixels[i].position);
    if (place.map >= 0) ++costs.maps[place.map].asked;
  }
  costs.overlap = Mean(num_askable, costs.receivers);

  const Scene& scene = caster.scene();
  std::vector<Eigen::Matrix<double, 5, 4>> planes;
  for (const PlanMap& map : plan.maps) planes.push_back(FrustumPlanes(map));
  const std::vector<uint32_t> drawn =
      Words(scene.triangles.size(), num_maps, caster.num_threads(), [&](int i, int k) {
        Eigen::Matrix<double, 4, 3> corners;
        for (int corner = 0; corner < 3; ++corner) {
          corners.col(corner) = scene.WorldOf(scene.triangles[i][corner]).homogeneous();
        }
        return MayReachInto(planes[k], corners);
      });
  int64_t num_drawn = 0;
  for (const uint32_t word : drawn) {
    if (word != 0) ++costs.casters;
    num_drawn += std::popcount(word);
    for (int k = 0; k < num_maps; ++k) costs.maps[k].casters += word >> k & 1u;
  }
  costs.draws_per_caster = Mean(num_drawn, costs.casters);
  return costs;
}

}  // namespace lightfit
