// picture/map_panel.h
//
// The shadow map seen from the light: where the receivers land, and how much of it they use.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/types/span.h"
#include "geometry/map_size.h"
#include "geometry/polygon.h"
#include "picture/canvas.h"
#include "picture/text.h"
#include "picture/theme.h"

namespace lightfit {

// What lands where in the map of one matrix.
struct MapView {
  std::vector<Eigen::Vector2d> receivers;  // texels
  std::vector<Eigen::Vector2d> others;     // texels; of a plan, those that ask another map
  std::vector<Eigen::Vector2d> samples;    // texels
  Polygon hull;                            // convex hull of the receivers that need room, texels
  double hull_share = 0;                   // of the map's area
};

// What a receiver is to the light's map.
struct ReceiverRole {
  bool needs_room = false;  // the map's border would answer it wrongly
  bool is_sample = false;
};

// `roles` are in the receivers' order.
MapView ViewMap(absl::Span<const Eigen::Vector3d> receivers_in_world,
                absl::Span<const ReceiverRole> roles,
                const Eigen::Matrix4d& map_from_world,
                MapSize map);

struct MapPanelStyle {
  int border_px = 26;  // around the map
  bool has_labels = true;
  Rgb receivers = kReceiverColor;
  Rgb samples = kSampleColor;
  Rgb outline = kTextColor;
};

// The map's rectangle at the top of a square panel of `size` pixels, texel (0, 0) at the upper
// left: receivers by their density, samples, hull and outline, with the size in texels written
// below.
Canvas DrawMapPanel(const MapView& view,
                    MapSize map,
                    int size,
                    const Typeface& typeface,
                    const MapPanelStyle& style = {});

}  // namespace lightfit
