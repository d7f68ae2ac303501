// render/texel_maps.h
//
// The maps of one light as a judge sees them: the texel that a receiver asks, the light's ray
// through that texel's centre, and what is drawn on it.
// In:   whatever maps: a plan of matrices, paraboloids, pages.
// Out:  TexelMaps, the look-up and the rays; TexelHits, what the texels hold.
//
// All texels of all maps are counted on, so that one number names a texel of one of them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>

#include "absl/types/span.h"
#include "render/ray_caster.h"

namespace lightfit {

inline constexpr int32_t kNoTexel = -1;

// Both functions from any number of threads at once.
class TexelHits {
 public:
  virtual ~TexelHits() = default;

  // Distance of the first hit along the texel's ray; infinite without one.
  virtual double First(int32_t texel) const = 0;

  // Whether there is another one, further behind the first than `resolution` and nearer than `far`.
  virtual bool HasBehind(int32_t texel, double resolution, double far) const = 0;
};

class TexelMaps {
 public:
  virtual ~TexelMaps() = default;

  virtual int64_t num_texels() const = 0;  // of all maps

  // The texel that a receiver asks; kNoTexel: it finds the border. From any number of threads.
  virtual int32_t TexelOf(const Eigen::Vector3d& world) const = 0;

  // Through the texel's centre; nothing where the map has no ray. From any number of threads.
  virtual std::optional<Ray> RayOf(int32_t texel) const = 0;

  // What is drawn into the texels, a flag for each: 0 for those that nobody looks up, which stay
  // empty. Here by casting each texel's ray. The result refers to this and the caster.
  virtual std::unique_ptr<TexelHits> Draw(const RayCaster& caster,
                                          absl::Span<const uint8_t> wanted) const;
};

}  // namespace lightfit
