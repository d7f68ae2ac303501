#include "optimizer/energy/summary_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optimizer/energy/summary_kernel.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Sums run in this many interleaved lanes, whatever the vector width.
#ifndef LIGHTFIT_SUMMARY_LANES
#define LIGHTFIT_SUMMARY_LANES 4
#endif

HWY_BEFORE_NAMESPACE();
namespace lightfit::internal {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, LIGHTFIT_SUMMARY_LANES>;
using Vector = hn::Vec<Tag>;

// Three components of a ray, one sample to a lane.
struct Vector3 {
  Vector x, y, z;
};

HWY_INLINE Vector3 Cross(const Vector3& a, const Vector3& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}

HWY_INLINE Vector Dot(const Vector3& a, const Vector3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

// The six entries of a a'.
HWY_INLINE void OuterSquare(const Vector3& a, Vector* out) {
  out[0] = hn::Mul(a.x, a.x);
  out[1] = hn::Mul(a.x, a.y);
  out[2] = hn::Mul(a.x, a.z);
  out[3] = hn::Mul(a.y, a.y);
  out[4] = hn::Mul(a.y, a.z);
  out[5] = hn::Mul(a.z, a.z);
}

// Four samples from `i` on (lanes of a vector at a time) into sums[36][4].
HWY_INLINE void AccumulateLanes(const double* const* arrays,
                                const double* matrix,
                                const double* edge_normal_x,
                                const double* edge_normal_y,
                                const MetricWeights& metric,
                                size_t i,
                                double* sums) {
  const Tag tag;
  const Vector x = hn::LoadU(tag, arrays[0] + i), y = hn::LoadU(tag, arrays[1] + i);
  const Vector d = hn::LoadU(tag, arrays[2] + i);
  const Vector d_x = hn::LoadU(tag, arrays[3] + i), d_y = hn::LoadU(tag, arrays[4] + i);
  const Vector weight = hn::LoadU(tag, arrays[5] + i);
  // Columns of ray_from_screen.
  const Vector3 c0 = {hn::Set(tag, matrix[0]), hn::Set(tag, matrix[1]), hn::Set(tag, matrix[2])};
  const Vector3 c1 = {hn::Set(tag, matrix[3]), hn::Set(tag, matrix[4]), hn::Set(tag, matrix[5])};
  const Vector3 c2 = {hn::Set(tag, matrix[6]), hn::Set(tag, matrix[7]), hn::Set(tag, matrix[8])};
  const Vector3 c3 = {hn::Set(tag, matrix[9]), hn::Set(tag, matrix[10]), hn::Set(tag, matrix[11])};
  const auto along = [](const Vector3& a, Vector s, const Vector3& b) -> Vector3 {
    return {hn::Add(a.x, hn::Mul(s, b.x)),
            hn::Add(a.y, hn::Mul(s, b.y)),
            hn::Add(a.z, hn::Mul(s, b.z))};
  };
  // math.md (11), then (1) with D scaled by V; the weight makes up for it.
  const Vector3 X = along(along(along(c3, d, c2), y, c1), x, c0);
  const Vector3 T1 = along(c0, d_x, c2);
  const Vector3 T2 = along(c1, d_y, c2);
  const Vector V = Dot(X, Cross(T1, T2));
  const Vector3 D1 = Cross(T2, X);
  const Vector3 D2 = Cross(X, T1);
  const Vector scale = hn::Div(weight, hn::Mul(V, V));

  Vector G[6], other[6], rays[6];
  OuterSquare(D1, G);
  OuterSquare(D2, other);
  for (int k = 0; k < 6; ++k) G[k] = hn::Add(G[k], other[k]);
  if (edge_normal_x != nullptr) {
    const Vector n_x = hn::LoadU(tag, edge_normal_x + i), n_y = hn::LoadU(tag, edge_normal_y + i);
    const Vector3 across = {hn::Add(hn::Mul(n_x, D1.x), hn::Mul(n_y, D2.x)),
                            hn::Add(hn::Mul(n_x, D1.y), hn::Mul(n_y, D2.y)),
                            hn::Add(hn::Mul(n_x, D1.z), hn::Mul(n_y, D2.z))};
    OuterSquare(across, other);
    const Vector share_across = hn::Set(tag, metric.across_edge);
    // A sample without an edge normal counts whole.
    const auto unknown = hn::And(hn::Eq(n_x, hn::Zero(tag)), hn::Eq(n_y, hn::Zero(tag)));
    const Vector share_whole = hn::IfThenElse(
        unknown, hn::Set(tag, metric.whole + metric.across_edge), hn::Set(tag, metric.whole));
    for (int k = 0; k < 6; ++k) {
      G[k] = hn::Add(hn::Mul(share_whole, G[k]), hn::Mul(share_across, other[k]));
    }
  }
  OuterSquare(X, rays);
  for (int k = 0; k < 6; ++k) rays[k] = hn::Mul(rays[k], scale);
  for (size_t row = 0; row < 6; ++row) {
    for (size_t column = 0; column < 6; ++column) {
      double* sum = sums + LIGHTFIT_SUMMARY_LANES * (6 * row + column);
      hn::Store(hn::Add(hn::Load(tag, sum), hn::Mul(rays[row], G[column])), tag, sum);
    }
  }
}

void AccumulateSimd(const double* const* arrays,
                    const double* matrix,
                    const double* edge_normal_x,
                    const double* edge_normal_y,
                    const MetricWeights& metric,
                    size_t begin,
                    size_t end,
                    double* sums) {
  const size_t lanes = hn::Lanes(Tag());
  for (size_t i = begin; i < end; i += LIGHTFIT_SUMMARY_LANES) {
    for (size_t lane = 0; lane < LIGHTFIT_SUMMARY_LANES; lane += lanes) {
      AccumulateLanes(arrays, matrix, edge_normal_x, edge_normal_y, metric, i + lane, sums + lane);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace lightfit::internal
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>

#include "base/stop.h"

namespace lightfit::internal {

HWY_EXPORT(AccumulateSimd);

Eigen::Matrix<double, 6, 6> AccumulateTensor(const Samples& samples, const MetricWeights& metric) {
  constexpr size_t kLanes = LIGHTFIT_SUMMARY_LANES;
  alignas(64) double sums[36 * kLanes] = {};
  const bool edges = metric.across_edge != 0.0 && samples.has_edge_normals();
  const double* arrays[6] = {samples.x.data(),
                             samples.y.data(),
                             samples.d.data(),
                             samples.d_x.data(),
                             samples.d_y.data(),
                             samples.weight.data()};
  const double* normal_x = edges ? samples.edge_normal_x.data() : nullptr;
  const double* normal_y = edges ? samples.edge_normal_y.data() : nullptr;
  const size_t whole = samples.size() / kLanes * kLanes;
  constexpr size_t kBlock = 1024 * kLanes;  // some ten microseconds
  for (size_t begin = 0; begin < whole && !StopRequested(); begin += kBlock) {
    HWY_DYNAMIC_DISPATCH(AccumulateSimd)
    (arrays,
     samples.ray_from_screen.data(),
     normal_x,
     normal_y,
     metric,
     begin,
     std::min(begin + kBlock, whole),
     sums);
  }

  // The last few samples go through the same kernel, padded with a copy of weight zero.
  const size_t rest = samples.size() - whole;
  if (rest > 0) {
    alignas(64) double padded[8][kLanes];
    const double* padded_arrays[6];
    for (int array = 0; array < 8; ++array) {
      const double* source = array < 6 ? arrays[array] : array == 6 ? normal_x : normal_y;
      for (size_t lane = 0; lane < kLanes && source != nullptr; ++lane) {
        padded[array][lane] = source[whole + std::min(lane, rest - 1)];
      }
      if (array < 6) padded_arrays[array] = padded[array];
    }
    for (size_t lane = rest; lane < kLanes; ++lane) padded[5][lane] = 0.0;
    HWY_DYNAMIC_DISPATCH(AccumulateSimd)
    (padded_arrays,
     samples.ray_from_screen.data(),
     edges ? padded[6] : nullptr,
     edges ? padded[7] : nullptr,
     metric,
     0,
     kLanes,
     sums);
  }

  // Where no edge is known, every sample counts whole.
  const double scale = edges ? 1.0 : metric.whole + metric.across_edge;
  Eigen::Matrix<double, 6, 6> tensor;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      const double* sum = sums + kLanes * (6 * row + column);
      tensor(row, column) = scale * ((sum[0] + sum[1]) + (sum[2] + sum[3]));
    }
  }
  return tensor;
}

}  // namespace lightfit::internal
#endif  // HWY_ONCE
