#include "picture/canvas.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "absl/strings/str_cat.h"
#include "base/output_file.h"

namespace lightfit {
namespace {

// Share of a pixel that a shape covers whose edge is `inside_px` away from the pixel's centre.
float Coverage(double inside_px) {
  return static_cast<float>(std::clamp(inside_px + 0.5, 0.0, 1.0));
}

// First and one-past-last pixel that the interval [low - reach, high + reach] touches.
int FirstPixel(double low, double reach) {
  return static_cast<int>(std::floor(std::max(low - reach, 0.0)));
}
int EndPixel(double high, double reach, int size) {
  return static_cast<int>(std::ceil(std::clamp(high + reach, 0.0, static_cast<double>(size))));
}

}  // namespace

Rgb HexColor(uint32_t rgb) {
  const auto channel = [rgb](int shift) { return ((rgb >> shift) & 0xff) / 255.0f; };
  return {channel(16), channel(8), channel(0)};
}

Rgb Mix(Rgb a, Rgb b, float share) {
  return {a.r + share * (b.r - a.r), a.g + share * (b.g - a.g), a.b + share * (b.b - a.b)};
}

Canvas::Canvas(int width, int height, Rgb background)
    : width_(width), height_(height), pixels_(static_cast<size_t>(width) * height, background) {}

void Canvas::Blend(int x, int y, Rgb color, float opacity) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
  Rgb& pixel = pixels_[Index(x, y)];
  pixel = Mix(pixel, color, opacity);
}

void Canvas::FillRectangle(int x, int y, int width, int height, Rgb color, float opacity) {
  for (int row = y; row < y + height; ++row) {
    for (int column = x; column < x + width; ++column) Blend(column, row, color, opacity);
  }
}

void Canvas::DrawImage(int x, int y, const Canvas& image) {
  for (int row = 0; row < image.height(); ++row) {
    for (int column = 0; column < image.width(); ++column) {
      Blend(x + column, y + row, image.At(column, row));
    }
  }
}

void Canvas::DrawLine(const Eigen::Vector2d& from,
                      const Eigen::Vector2d& to,
                      double width_px,
                      Rgb color,
                      float opacity) {
  if (!from.allFinite() || !to.allFinite()) return;
  const Eigen::Vector2d along = to - from;
  const double squared_length = along.squaredNorm();
  const double reach = width_px / 2 + 1;
  const int x_end = EndPixel(std::max(from.x(), to.x()), reach, width_);
  const int y_end = EndPixel(std::max(from.y(), to.y()), reach, height_);
  for (int y = FirstPixel(std::min(from.y(), to.y()), reach); y < y_end; ++y) {
    for (int x = FirstPixel(std::min(from.x(), to.x()), reach); x < x_end; ++x) {
      const Eigen::Vector2d center(x + 0.5, y + 0.5);
      const double share = squared_length > 0
                               ? std::clamp((center - from).dot(along) / squared_length, 0.0, 1.0)
                               : 0.0;
      const double distance = (center - from - share * along).norm();
      const float coverage = Coverage(width_px / 2 - distance);
      if (coverage > 0) Blend(x, y, color, opacity * coverage);
    }
  }
}

void Canvas::DrawPolygon(absl::Span<const Eigen::Vector2d> corners,
                         double width_px,
                         Rgb color,
                         float opacity) {
  for (size_t i = 0; i < corners.size(); ++i) {
    DrawLine(corners[i], corners[(i + 1) % corners.size()], width_px, color, opacity);
  }
}

void Canvas::DrawDot(const Eigen::Vector2d& center, double radius_px, Rgb color, float opacity) {
  if (!center.allFinite()) return;
  const int x_end = EndPixel(center.x(), radius_px + 1, width_);
  const int y_end = EndPixel(center.y(), radius_px + 1, height_);
  for (int y = FirstPixel(center.y(), radius_px + 1); y < y_end; ++y) {
    for (int x = FirstPixel(center.x(), radius_px + 1); x < x_end; ++x) {
      const double distance = (Eigen::Vector2d(x + 0.5, y + 0.5) - center).norm();
      const float coverage = Coverage(radius_px - distance);
      if (coverage > 0) Blend(x, y, color, opacity * coverage);
    }
  }
}

Canvas Magnified(const Canvas& canvas, int factor) {
  Canvas large(canvas.width() * factor, canvas.height() * factor, {});
  for (int y = 0; y < large.height(); ++y) {
    for (int x = 0; x < large.width(); ++x) {
      large.Blend(x, y, canvas.At(x / factor, y / factor));
    }
  }
  return large;
}

Canvas Reduced(const Canvas& canvas, int factor) {
  Canvas small((canvas.width() + factor - 1) / factor, (canvas.height() + factor - 1) / factor, {});
  for (int y = 0; y < small.height(); ++y) {
    for (int x = 0; x < small.width(); ++x) {
      Rgb mean;
      float num_pixels = 0;
      for (int row = y * factor; row < std::min((y + 1) * factor, canvas.height()); ++row) {
        for (int column = x * factor; column < std::min((x + 1) * factor, canvas.width());
             ++column) {
          num_pixels += 1;
          mean = Mix(mean, canvas.At(column, row), 1 / num_pixels);
        }
      }
      small.Blend(x, y, mean);
    }
  }
  return small;
}

absl::Status WritePng(const Canvas& canvas, const std::string& path) {
  std::vector<uint8_t> bytes;
  bytes.reserve(canvas.pixels().size() * 3);
  for (const Rgb& pixel : canvas.pixels()) {
    for (const float value : {pixel.r, pixel.g, pixel.b}) {
      bytes.push_back(static_cast<uint8_t>(std::lround(255 * std::clamp(value, 0.0f, 1.0f))));
    }
  }
  return WriteThroughTemporary(path, [&](const std::string& temporary) -> absl::Status {
    const auto failure = [&](const std::string& reason) {
      return absl::UnknownError(absl::StrCat("cannot write picture ", path, ": ", reason));
    };
    // The temporary name does not end in .png, so the format is named here.
    const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("png");
    if (output == nullptr) return failure(OIIO::geterror());
    const OIIO::ImageSpec spec(canvas.width(), canvas.height(), 3, OIIO::TypeDesc::UINT8);
    if (!output->open(temporary, spec) ||
        !output->write_image(OIIO::TypeDesc::UINT8, bytes.data()) || !output->close()) {
      return failure(output->geterror());
    }
    return absl::OkStatus();
  });
}

}  // namespace lightfit
