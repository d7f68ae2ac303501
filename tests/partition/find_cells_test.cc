#include "partition/find_cells.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "partition/divided_maps.h"
#include "partition/split_cell.h"
#include "tests/partition/plan_case.h"
#include "tests/testing/random_cases.h"

namespace lightfit {
namespace {

using testing::HasShadows;
using testing::PlanCase;
using testing::Random;

constexpr double kTexels = 160000.0;

// Every bin in exactly one cell.
void ExpectPartition(const PlanCase& at, const Cells& cells) {
  std::vector<int> bins;
  for (const Cell& cell : cells) bins.insert(bins.end(), cell.bins.begin(), cell.bins.end());
  std::sort(bins.begin(), bins.end());
  EXPECT_EQ(bins, at.AllBins());
}

double SumOfTerms(const CellFitter& fitter, const Cells& cells) {
  double sum = 0.0;
  for (const Cell& cell : cells) sum += PlanTerm(fitter, cell.map.energy);
  return sum;
}

TEST(GrowCells, EachPlanCutsOneCellOfTheOneBeforeAndLowersTheEnergy) {
  int num_grown = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    for (int index = 0; index < 3; ++index) {
      const PlanCase at(seed, index);
      if (!HasShadows(at)) continue;
      const CellFitter fitter = at.Fitter();
      const ScratchVector<Cells> plans = GrowCells(fitter, 4);
      ASSERT_FALSE(plans.empty());
      for (size_t k = 0; k < plans.size(); ++k) {
        ASSERT_EQ(plans[k].size(), k + 1);
        ExpectPartition(at, plans[k]);
        if (k == 0) continue;
        EXPECT_LT(SumOfTerms(fitter, plans[k]), SumOfTerms(fitter, plans[k - 1]));
        // All but one cell are as they were.
        int num_kept = 0;
        for (const Cell& cell : plans[k]) {
          num_kept += std::any_of(plans[k - 1].begin(),
                                  plans[k - 1].end(),
                                  [&](const Cell& other) { return other.bins == cell.bins; })
                          ? 1
                          : 0;
        }
        EXPECT_EQ(num_kept, static_cast<int>(k) - 1);
      }
      num_grown += plans.size() == 4 ? 1 : 0;
    }
  }
  EXPECT_GE(num_grown, 6);
}

TEST(AlternateCells, IsNeverAboveWhereItBeganAndOftenBelow) {
  int num_cases = 0, num_lower = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    for (int index = 0; index < 3; ++index) {
      const PlanCase at(seed, index);
      if (!HasShadows(at)) continue;
      const CellFitter fitter = at.Fitter();
      const ScratchVector<Cells> plans = GrowCells(fitter, 3);
      ASSERT_FALSE(plans.empty());
      const double before = DividedMaps(fitter, plans.back(), kTexels).Energy();
      const Cells cells = AlternateCells(fitter, plans.back(), kTexels);
      ExpectPartition(at, cells);
      const double after = DividedMaps(fitter, cells, kTexels).Energy();
      EXPECT_LE(after, before);
      ++num_cases;
      num_lower += after < 0.999 * before ? 1 : 0;
    }
  }
  std::printf("%d of %d lower\n", num_lower, num_cases);
  EXPECT_GT(num_lower, num_cases / 4);
}

// math.md (16): no other division of the same texels has less energy, each cell by itself.
TEST(DivideTexels, RandomDivisionsAreNoBetter) {
  const PlanCase at(1, 0);
  const CellFitter fitter = at.Fitter();
  const Cells cells = GrowCells(fitter, 4).back();
  const auto energy = [&](const ScratchVector<double>& texels) {
    double sum = 0.0;
    for (size_t k = 0; k < cells.size(); ++k) {
      sum += cells[k].map.energy * std::sqrt(kCellTexels / texels[k]);
    }
    return sum;
  };
  const ScratchVector<double> divided = DivideTexels(fitter, cells, kTexels);
  double total = 0.0;
  for (const double texels : divided) total += texels;
  EXPECT_NEAR(total / kTexels, 1.0, 1e-12);
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    ScratchVector<double> other;
    double sum = 0.0;
    for (size_t k = 0; k < cells.size(); ++k) {
      other.push_back(divided[k] * random.LogUniform(0.5, 2.0));
      sum += other.back();
    }
    for (double& texels : other) texels *= kTexels / sum;
    EXPECT_GE(energy(other), energy(divided) * (1.0 - 1e-12));
  }
}

// Sample by sample, map by map.
TEST(DividedMaps, EnergyIsThatOfTheDensestMapThatHoldsEachSample) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    const PlanCase at(seed, 0);
    if (!HasShadows(at)) continue;
    const CellFitter fitter = at.Fitter();
    const Cells cells = GrowCells(fitter, 4).back();
    const ScratchVector<double> texels = DivideTexels(fitter, cells, kTexels);
    double sum = 0.0;
    for (const RaySample& sample : at.rays.samples) {
      double least = INFINITY, footprint = 0.0;
      for (size_t k = 0; k < cells.size(); ++k) {
        const double scale = std::sqrt(texels[k] / kCellTexels);
        Eigen::Matrix3d map_from_ray = cells[k].map.map_from_ray;
        map_from_ray.topRows<2>() *= scale;
        const Eigen::Vector3d uvw = map_from_ray * sample.X;
        const Eigen::Vector2d uv = uvw.hnormalized();
        const bool is_inside = uvw.z() > 0.0 && uv.minCoeff() >= 0.0 &&
                               uv.x() < scale * cells[k].map.width &&
                               uv.y() < scale * cells[k].map.height;
        const double q = uvw.z() / std::cbrt(std::abs(map_from_ray.determinant()));
        if (!is_inside || q >= least) continue;
        least = q;
        const Extents of = MapExtents(map_from_ray).Of(sample);
        footprint = std::sqrt(of.along_u + of.along_v);
      }
      sum += sample.weight * footprint;
    }
    EXPECT_NEAR(DividedMaps(fitter, cells, kTexels).Energy() / sum, 1.0, 1e-9);
  }
}

TEST(SplitCell, ACellOfOneBinCannotBeCut) {
  const PlanCase at(1, 0);
  const CellFitter fitter = at.Fitter();
  Cell cell;
  cell.bins = {0};
  EXPECT_FALSE(SplitCell(fitter, cell).has_value());
}

}  // namespace
}  // namespace lightfit
