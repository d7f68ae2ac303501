#include "render/shipped/paraboloid_raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "absl/strings/str_format.h"
#include "base/parallel.h"

namespace lightfit {

namespace {

// What is left of a texel when corners are rounded: hardware has 8 bits.
constexpr int64_t kPerTexel = 256;
// Radii of the disc.
constexpr double kGuard = 4.0;
// Corners with a smaller 1 + d_z are straight behind.
constexpr double kLeastDepth = 1e-12;

struct Corner {
  Eigen::Vector2d uv;  // of the disc of radius 1
  double distance = 0.0;
  double d_z = 0.0;
};

// Three corners, and one more for each side of a box and the limit; where rounding makes a polygon
// that is not convex every other edge may add one.
class CornerList {
 public:
  void Add(const Corner& corner) { corners_[size_++] = corner; }
  int size() const { return size_; }
  const Corner& operator[](int i) const { return corners_[i]; }

 private:
  std::array<Corner, 24> corners_;
  int size_ = 0;
};

// On the edge from one side of a plane to the other, always from the side that is kept, so that
// two triangles are cut alike at an edge of theirs.
Corner Cut(const Corner& kept, const Corner& other, double kept_value, double other_value) {
  const double share = kept_value / (kept_value - other_value);
  Corner cut;
  cut.uv = kept.uv + share * (other.uv - kept.uv);
  cut.distance = kept.distance + share * (other.distance - kept.distance);
  cut.d_z = kept.d_z + share * (other.d_z - kept.d_z);
  return cut;
}

// The part with value(corner) >= 0, for a value that is linear in the plane.
template <typename Value>
CornerList Clipped(const CornerList& polygon, const Value& value) {
  CornerList clipped;
  for (int i = 0; i < polygon.size(); ++i) {
    const Corner &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    const double from_value = value(from), to_value = value(to);
    if (from_value >= 0.0) clipped.Add(from);
    if (from_value >= 0.0 && to_value < 0.0) clipped.Add(Cut(from, to, from_value, to_value));
    if (from_value < 0.0 && to_value >= 0.0) clipped.Add(Cut(to, from, to_value, from_value));
  }
  return clipped;
}

struct Fragment {
  int32_t texel;
  double distance;
};
using Fragments = std::vector<Fragment>;

// A corner in 1/256 of a texel.
struct RoundedCorner {
  int64_t x, y;
  double distance;
};

// Twice the area of (a, b, p), > 0 where they turn from x to y.
int64_t Turn(const RoundedCorner& a, const RoundedCorner& b, int64_t x, int64_t y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

// Whether a centre on the edge from a to b belongs to the triangle on its inner side.
bool IsTopOrLeft(const RoundedCorner& a, const RoundedCorner& b) {
  return b.y < a.y || (b.y == a.y && b.x > a.x);
}

// Fills the map of one half.
class HalfRaster {
 public:
  HalfRaster(const ParaboloidPair& pair,
             int half,
             const Eigen::Vector2d& move,
             absl::Span<const uint8_t> wanted,
             const ParaboloidRasterOptions& options)
      : centre_(pair.centre),
        half_from_world_(pair.HalfFromWorld(half)),
        grid_(GridOf(pair)),
        half_(half),
        move_(move),
        wanted_(wanted),
        least_d_z_(-options.rim_texels * 2.0 / pair.size) {}

  void Draw(const std::array<Eigen::Vector3d, 3>& triangle, Fragments* fragments) const {
    CornerList polygon;
    bool is_within = false;
    for (const Eigen::Vector3d& world : triangle) {
      const Eigen::Vector3d at = half_from_world_ * (world - centre_);
      Corner corner;
      corner.distance = at.stableNorm();
      corner.d_z = at.z() / corner.distance;
      // Above half a turn away 1 + d_z loses its digits.
      const double across = at.head<2>().squaredNorm();
      const double depth =
          at.z() > 0.0 ? 1.0 + corner.d_z : across / (corner.distance * (corner.distance - at.z()));
      if (!(depth > kLeastDepth)) corner.d_z = std::nan("");
      corner.uv = at.head<2>() / (corner.distance * depth);
      is_within |= corner.d_z >= least_d_z_;
      polygon.Add(corner);
    }
    if (!is_within) return;
    for (int i = 0; i < 3; ++i) {
      if (!std::isfinite(polygon[i].d_z + polygon[i].uv.sum())) return;
    }
    Fill(Within(polygon), fragments);
  }

 private:
  CornerList Within(CornerList polygon) const {
    bool is_near = true;
    for (int i = 0; i < polygon.size(); ++i) {
      is_near &= polygon[i].d_z >= least_d_z_ && polygon[i].uv.cwiseAbs().maxCoeff() <= kGuard;
    }
    if (is_near) return polygon;
    polygon = Clipped(polygon, [this](const Corner& corner) { return corner.d_z - least_d_z_; });
    for (int axis = 0; axis < 2; ++axis) {
      for (const double sign : {1.0, -1.0}) {
        polygon = Clipped(polygon, [axis, sign](const Corner& corner) {
          return kGuard - sign * corner.uv(axis);
        });
      }
    }
    return polygon;
  }

  RoundedCorner Rounded(const Corner& corner) const {
    const Eigen::Vector2d texel = 0.5 * grid_.side * (corner.uv + Eigen::Vector2d::Ones()) + move_;
    return {
        std::llround(kPerTexel * texel.x()), std::llround(kPerTexel * texel.y()), corner.distance};
  }

  void Fill(const CornerList& polygon, Fragments* fragments) const {
    for (int i = 2; i < polygon.size(); ++i) {
      Fill(Rounded(polygon[0]), Rounded(polygon[i - 1]), Rounded(polygon[i]), fragments);
    }
  }

  void Fill(const RoundedCorner& a, RoundedCorner b, RoundedCorner c, Fragments* fragments) const {
    int64_t area = Turn(a, b, c.x, c.y);
    if (area == 0) return;
    if (area < 0) {
      std::swap(b, c);
      area = -area;
    }
    const auto [left, right] = Span(a.x, b.x, c.x);
    const auto [top, bottom] = Span(a.y, b.y, c.y);
    const int64_t least_a = IsTopOrLeft(b, c) ? 0 : 1, least_b = IsTopOrLeft(c, a) ? 0 : 1,
                  least_c = IsTopOrLeft(a, b) ? 0 : 1;
    for (int row = top; row <= bottom; ++row) {
      for (int column = left; column <= right; ++column) {
        const int64_t x = kPerTexel * column + kPerTexel / 2, y = kPerTexel * row + kPerTexel / 2;
        const int64_t of_a = Turn(b, c, x, y), of_b = Turn(c, a, x, y), of_c = Turn(a, b, x, y);
        if (of_a < least_a || of_b < least_b || of_c < least_c) continue;
        const int32_t texel = grid_.NumberOf({half_, column, row});
        if (wanted_[texel] == 0) continue;
        const double distance =
            (static_cast<double>(of_a) * a.distance + static_cast<double>(of_b) * b.distance +
             static_cast<double>(of_c) * c.distance) /
            static_cast<double>(area);
        fragments->push_back({texel, distance});
      }
    }
  }

  // The texels of the grid whose centres lie between the least and the greatest.
  std::pair<int, int> Span(int64_t a, int64_t b, int64_t c) const {
    const auto texel = [](int64_t at) {
      return static_cast<int>(std::floor(static_cast<double>(at) / kPerTexel));
    };
    const auto [least, most] = std::minmax({a, b, c});
    return {std::max(texel(least + kPerTexel / 2 - 1), -1),
            std::min(texel(most - kPerTexel / 2), grid_.side)};
  }

  Eigen::Vector3d centre_;
  Eigen::Matrix3d half_from_world_;
  TexelGrid grid_;
  int half_;
  Eigen::Vector2d move_;
  absl::Span<const uint8_t> wanted_;
  double least_d_z_;
};

}  // namespace

absl::Status ValidateParaboloidRasterOptions(const ParaboloidRasterOptions& options) {
  constexpr double kMostTexels = 1000.0;
  if (options.rim_texels >= 0.0 && options.rim_texels <= kMostTexels) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrFormat("paraboloids: rim_texels = %g, want 0 ... %g texels beyond the rim",
                      options.rim_texels,
                      kMostTexels));
}

ParaboloidRaster::ParaboloidRaster(const Scene& scene,
                                   const ParaboloidPair& pair,
                                   const Eigen::Vector2d& move,
                                   absl::Span<const uint8_t> wanted,
                                   int num_threads,
                                   const ParaboloidRasterOptions& options)
    : begin_(wanted.size() + 1, 0) {
  constexpr int kChunk = 8192;
  const std::array<HalfRaster, 2> halves = {HalfRaster(pair, 0, move, wanted, options),
                                            HalfRaster(pair, 1, move, wanted, options)};
  const auto count = static_cast<int>(scene.triangles.size());
  std::vector<Fragments> chunks((count + kChunk - 1) / kChunk);
  ParallelFor(count, kChunk, num_threads, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      std::array<Eigen::Vector3d, 3> triangle;
      for (int k = 0; k < 3; ++k) {
        triangle[k] = scene.WorldOf(scene.triangles[i][k]);
      }
      for (const HalfRaster& half : halves) half.Draw(triangle, &chunks[begin / kChunk]);
    }
  });
  for (const Fragments& fragments : chunks) {
    for (const Fragment& fragment : fragments) ++begin_[fragment.texel + 1];
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  distances_.resize(begin_.back());
  std::vector<int64_t> next = begin_;
  for (const Fragments& fragments : chunks) {
    for (const Fragment& fragment : fragments) {
      distances_[next[fragment.texel]++] = fragment.distance;
    }
  }
  for (size_t texel = 0; texel < wanted.size(); ++texel) {
    std::sort(distances_.begin() + begin_[texel], distances_.begin() + begin_[texel + 1]);
  }
}

double ParaboloidRaster::First(int32_t texel) const {
  const absl::Span<const double> distances = DistancesOf(texel);
  return distances.empty() ? std::numeric_limits<double>::infinity() : distances.front();
}

bool ParaboloidRaster::HasBehind(int32_t texel, double resolution, double far) const {
  for (const double distance : DistancesOf(texel)) {
    if (distance > First(texel) + resolution) return distance < far;
  }
  return false;
}

absl::Span<const double> ParaboloidRaster::DistancesOf(int32_t texel) const {
  return absl::MakeSpan(distances_).subspan(begin_[texel], begin_[texel + 1] - begin_[texel]);
}

}  // namespace lightfit
