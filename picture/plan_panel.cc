#include "picture/plan_panel.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "geometry/affine_depth.h"
#include "picture/heat_panel.h"
#include "picture/theme.h"

namespace lightfit {
namespace {

// Pixels.
constexpr int kPanelGap = 10;
constexpr int kNumberSize = 18;
constexpr int kNumberRadius = 12;
constexpr int kMapTitleSize = 13;
constexpr int kMapTitleHeight = 20;
constexpr int kLeastTitleWidth = 130;  // that has room for the size as well
constexpr int kSmallBorder = 4;

// Period of the stripes, read-back pixels.
constexpr int kStripe = 4;
const Rgb kStripeColor = HexColor(0x2f343d);

Rgb HatchColor(int x, int y) {
  return (x + y) % kStripe < kStripe / 2 ? kUnratedColor : kStripeColor;
}

// For every map the pixel that is farthest from any of another map, in steps to one of eight
// neighbours; and how far. Two passes over the image.
struct Place {
  int x = 0, y = 0, distance = 0;
};
std::vector<Place> RoomiestPlaces(absl::Span<const int> maps,
                                  int width,
                                  int height,
                                  size_t num_maps) {
  std::vector<int> distance(maps.size(), 1);
  const auto from = [&](int x, int y, int other_x, int other_y) {
    if (other_x < 0 || other_x >= width || other_y < 0 || other_y >= height) return 0;
    const size_t other = static_cast<size_t>(other_y) * width + other_x;
    return maps[other] == maps[static_cast<size_t>(y) * width + x] ? distance[other] : 0;
  };
  std::vector<Place> places(num_maps);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      distance[static_cast<size_t>(y) * width + x] = 1 + std::min({from(x, y, x - 1, y),
                                                                   from(x, y, x - 1, y - 1),
                                                                   from(x, y, x, y - 1),
                                                                   from(x, y, x + 1, y - 1)});
    }
  }
  for (int y = height - 1; y >= 0; --y) {
    for (int x = width - 1; x >= 0; --x) {
      const size_t pixel = static_cast<size_t>(y) * width + x;
      distance[pixel] = std::min(distance[pixel],
                                 1 + std::min({from(x, y, x + 1, y),
                                               from(x, y, x + 1, y + 1),
                                               from(x, y, x, y + 1),
                                               from(x, y, x - 1, y + 1)}));
      if (maps[pixel] < 0) continue;
      Place& place = places[maps[pixel]];
      if (distance[pixel] > place.distance) place = {x, y, distance[pixel]};
    }
  }
  return places;
}

// Numbers can be read on every colour: light on a dark dot.
void DrawNumber(const Eigen::Vector2d& at, int number, const Typeface& typeface, Canvas* canvas) {
  canvas->DrawDot(at, kNumberRadius, kPageColor, 0.85f);
  typeface.Draw(
      static_cast<int>(at.x()),
      static_cast<int>(at.y()) + 6,
      absl::StrCat(number),
      {.size_px = kNumberSize, .color = kTextColor, .bold = true, .anchor = Anchor::kMiddle},
      canvas);
}

// How many columns of equal squares make them largest.
int BestColumns(int count, int width, int height) {
  int best = 1;
  double largest = 0.0;
  for (int columns = 1; columns <= count; ++columns) {
    const int rows = (count + columns - 1) / columns;
    const double side = std::min(static_cast<double>(width) / columns,
                                 static_cast<double>(height) / rows - kMapTitleHeight);
    if (side <= largest) continue;
    largest = side;
    best = columns;
  }
  return best;
}

}  // namespace

absl::StatusOr<PlanView> ViewPlan(const Readback& readback,
                                  const Light& light,
                                  const Plan& plan,
                                  double guard_texels,
                                  absl::Span<const uint8_t> samples) {
  const absl::StatusOr<PlanLookUp> look_up = PlanLookUp::Create(plan, light, guard_texels);
  if (!look_up.ok()) return look_up.status();
  const AffineDepth affine_depth = AffineDepthOf(readback);
  const Eigen::Matrix4d world_from_screen = readback.camera.WorldFromScreen();
  PlanView view;
  view.maps.assign(readback.depth.size(), PlanView::kNoSurface);
  view.views.resize(plan.maps.size());
  int64_t num_surfaces = 0, num_outside = 0;
  for (int y = 0; y < readback.height(); ++y) {
    for (int x = 0; x < readback.width(); ++x) {
      const size_t pixel = readback.Index(x, y);
      const double depth = readback.depth[pixel];
      if (!affine_depth.IsSurface(depth)) continue;
      const Eigen::Vector4d screen(x + 0.5, y + 0.5, affine_depth.At(x, y, depth), 1.0);
      const Eigen::Vector3d world = (world_from_screen * screen).hnormalized();
      const int asked = look_up->At(world).map;
      ++num_surfaces;
      num_outside += asked < 0 ? 1 : 0;
      view.maps[pixel] = asked < 0 ? PlanView::kOutside : asked;
      for (int k = 0; k < look_up->num_maps(); ++k) {
        Eigen::Vector2d texel;
        if (!look_up->IsAskable(k, world, &texel)) continue;
        MapView& map = view.views[k];
        (k == asked ? map.receivers : map.others).push_back(texel);
        if (k == asked && samples[pixel] != 0) map.samples.push_back(texel);
      }
    }
  }
  if (num_surfaces > 0) {
    view.outside_share = static_cast<double>(num_outside) / static_cast<double>(num_surfaces);
  }
  return view;
}

Canvas DrawCellsPanel(const Readback& readback,
                      const Light& light,
                      const PlanView& view,
                      absl::Span<const uint8_t> samples,
                      const Typeface& typeface) {
  Image colors(readback.width(), readback.height(), kPanelColor);
  for (int y = 0; y < readback.height(); ++y) {
    for (int x = 0; x < readback.width(); ++x) {
      const int map = view.maps[readback.Index(x, y)];
      if (map >= 0) colors.Blend(x, y, MapColor(map));
      if (map == PlanView::kOutside) colors.Blend(x, y, HatchColor(x, y));
    }
  }
  Canvas canvas(DrawScreenPanel(readback, light, std::move(colors), samples));
  const double zoom = static_cast<double>(canvas.width()) / readback.width();
  const std::vector<Place> places =
      RoomiestPlaces(view.maps, readback.width(), readback.height(), view.views.size());
  for (size_t k = 0; k < places.size(); ++k) {
    if (zoom * places[k].distance < kNumberRadius) continue;
    const Eigen::Vector2d at(zoom * (places[k].x + 0.5), zoom * (places[k].y + 0.5));
    DrawNumber(at, static_cast<int>(k), typeface, &canvas);
  }
  return canvas;
}

void DrawHatchedSquare(int x, int y, int size, Canvas* canvas) {
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      canvas->FillRectangle(x + column, y + row, 1, 1, HatchColor(column / 2, row / 2));
    }
  }
}

Canvas DrawPlanMaps(
    const PlanView& view, const Plan& plan, int width, int height, const Typeface& typeface) {
  Canvas canvas(width, height, kPageColor);
  const int count = static_cast<int>(plan.maps.size());
  const int columns = BestColumns(count, width + kPanelGap, height + kPanelGap);
  const int rows = std::max(1, (count + columns - 1) / columns);
  const int cell_width = (width + kPanelGap) / columns, cell_height = (height + kPanelGap) / rows;
  const int side = std::min(cell_width, cell_height - kMapTitleHeight) - kPanelGap;
  if (side <= 2 * kSmallBorder) return canvas;
  for (int k = 0; k < count; ++k) {
    const int x = k % columns * cell_width, y = k / columns * cell_height;
    const MapSize size = plan.maps[k].size;
    const std::string title = side >= kLeastTitleWidth
                                  ? absl::StrCat(k, ": ", size.width, " x ", size.height)
                                  : absl::StrCat(k);
    typeface.Draw(x + side / 2,
                  y + kMapTitleHeight - 6,
                  title,
                  {.size_px = kMapTitleSize, .color = kTextColor, .anchor = Anchor::kMiddle},
                  &canvas);
    canvas.DrawCanvas(x,
                      y + kMapTitleHeight,
                      DrawMapPanel(view.views[k],
                                   size,
                                   side,
                                   typeface,
                                   {.border_px = kSmallBorder,
                                    .has_labels = false,
                                    .receivers = MapColor(k),
                                    .samples = kBoundaryColor,
                                    .outline = MapColor(k)}));
  }
  return canvas;
}

}  // namespace lightfit
