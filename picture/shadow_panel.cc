#include "picture/shadow_panel.h"

#include <algorithm>

#include "picture/theme.h"

namespace lightfit {
namespace {

// Grey levels, display space.
constexpr float kUnlitLevel = 0.16f;  // in shadow or turned away
constexpr float kFormShare = 0.09f;   // of the eye's own light, so that unlit surfaces have a form
constexpr float kLitLevel = 0.42f;
constexpr float kCosineShare = 0.46f;

constexpr float kTintOpacity = 0.22f;  // of the map that a pixel asks
constexpr float kMarkOpacity = 0.92f;
constexpr float kLeastMarkOpacity = 0.55f;  // of a square in which one pixel is wrong

Rgb Grey(const SurfacePoint& pixel, const Eigen::Vector3d& eye, const Light& light, bool is_lit) {
  const bool is_point = light.kind == Light::Kind::kPoint;
  const Eigen::Vector3d to_light = is_point ? Eigen::Vector3d(light.position - pixel.position)
                                            : Eigen::Vector3d(-light.direction);
  const double cos_eye = pixel.normal.dot((eye - pixel.position).stableNormalized());
  const double cos_light = pixel.normal.dot(to_light.stableNormalized());
  float level = (is_lit ? kLitLevel : kUnlitLevel) +
                kFormShare * static_cast<float>(std::clamp(cos_eye, 0.0, 1.0));
  if (is_lit) level += kCosineShare * static_cast<float>(std::clamp(cos_light, 0.0, 1.0));
  // A little warm in the light, a little cold in the shade.
  return is_lit ? Rgb{level, level * 0.985f, level * 0.955f}
                : Rgb{level * 0.94f, level * 0.98f, level * 1.08f};
}

}  // namespace

Image ShadeShadows(const SurfaceImage& image,
                   const Light& light,
                   absl::Span<const Lighting> truth,
                   absl::Span<const Lighting> shadows,
                   absl::Span<const int> asked,
                   const Exposure& exposure) {
  Image shaded(image.camera.width, image.camera.height, kPanelColor);
  const Eigen::Matrix4d world_from_camera = image.camera.camera_from_world.inverse();
  const Eigen::Vector3d eye = world_from_camera.block<3, 1>(0, 3);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    const SurfacePoint& pixel = image.pixels[i];
    if (!pixel.is_surface()) continue;
    if (IsJudged(truth[i]) && shadows[i] != truth[i]) {
      const Rgb mark = shadows[i] == Lighting::kShadowed ? kFalseShadowColor : kLightLeakColor;
      shaded.pixels()[i] = Mix(exposure(Grey(pixel, eye, light, true)), mark, kMarkOpacity);
    } else {
      const Rgb grey = exposure(Grey(pixel, eye, light, shadows[i] == Lighting::kLit));
      const bool is_tinted = !asked.empty() && asked[i] >= 0;
      shaded.pixels()[i] = is_tinted ? Mix(grey, MapColor(asked[i]), kTintOpacity) : grey;
    }
  }
  return shaded;
}

Exposure ExposureFor(const SurfaceImage& image,
                     const Light& light,
                     absl::Span<const Lighting> truth) {
  const Image shaded = ShadeShadows(image, light, truth, truth);
  std::vector<Rgb> surfaces;
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    if (image.pixels[i].is_surface()) surfaces.push_back(shaded.pixels()[i]);
  }
  return Exposure::For(surfaces);
}

Image ReducedPanel(const Image& full, absl::Span<const uint8_t> wrong, int factor) {
  if (factor == 1) return full;
  // The unmarked pixels and the marked ones are averaged apart, then put over each other.
  Image panel = Reduced(full, factor);
  for (int y = 0; y < panel.height(); ++y) {
    for (int x = 0; x < panel.width(); ++x) {
      Rgb marked, unmarked;
      float num_marked = 0, num_unmarked = 0;
      for (int row = y * factor; row < std::min((y + 1) * factor, full.height()); ++row) {
        for (int column = x * factor; column < std::min((x + 1) * factor, full.width()); ++column) {
          const bool is_wrong = wrong[static_cast<size_t>(row) * full.width() + column] != 0;
          Rgb& mean = is_wrong ? marked : unmarked;
          float& count = is_wrong ? num_marked : num_unmarked;
          count += 1;
          mean = Mix(mean, full.At(column, row), 1 / count);
        }
      }
      if (num_marked == 0) continue;
      const float share = num_marked / (num_marked + num_unmarked);
      const float opacity = kLeastMarkOpacity + (1 - kLeastMarkOpacity) * share;
      panel.Blend(x, y, num_unmarked > 0 ? Mix(unmarked, marked, opacity) : marked);
    }
  }
  return panel;
}

Image EnlargedCrop(const Image& full, const CropBox& crop, int factor) {
  Image cut(crop.width, crop.height, kPanelColor);
  for (int y = 0; y < crop.height; ++y) {
    for (int x = 0; x < crop.width; ++x) cut.Blend(x, y, full.At(crop.x + x, crop.y + y));
  }
  return Magnified(cut, factor);
}

std::vector<uint8_t> WrongMask(absl::Span<const Lighting> truth,
                               absl::Span<const Lighting> shadows) {
  std::vector<uint8_t> wrong(truth.size(), 0);
  for (size_t i = 0; i < truth.size(); ++i) {
    wrong[i] = IsJudged(truth[i]) && shadows[i] != truth[i] ? 1 : 0;
  }
  return wrong;
}

CropBox BestCrop(absl::Span<const int32_t> gain, int width, int height, CropBox size) {
  CropBox best = {(width - size.width) / 2, (height - size.height) / 2, size.width, size.height};
  // sums[(y, x)]: of all gains above and to the left.
  const size_t columns = static_cast<size_t>(width) + 1;
  std::vector<int64_t> sums(columns * (height + 1), 0);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      sums[(y + 1) * columns + x + 1] = gain[static_cast<size_t>(y) * width + x] +
                                        sums[y * columns + x + 1] + sums[(y + 1) * columns + x] -
                                        sums[y * columns + x];
    }
  }
  const auto sum_at = [&](int x, int y) {
    return sums[(y + size.height) * columns + x + size.width] - sums[y * columns + x + size.width] -
           sums[(y + size.height) * columns + x] + sums[y * columns + x];
  };
  int64_t best_sum = sum_at(best.x, best.y);
  for (int y = 0; y + size.height <= height; ++y) {
    for (int x = 0; x + size.width <= width; ++x) {
      if (sum_at(x, y) <= best_sum) continue;
      best_sum = sum_at(x, y);
      best.x = x;
      best.y = y;
    }
  }
  return best;
}

}  // namespace lightfit
