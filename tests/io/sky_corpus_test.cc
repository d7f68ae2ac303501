// Read-backs whose sky is a finite depth: of every value, depth format, depth kind and shadow of
// the sky each is read right, or what may be wrong is told.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "io/readback_exr.h"
#include "optimizer/fit.h"
#include "tests/io/exr_file.h"
#include "tests/io/testing.h"
#include "tests/testing/box_scene.h"
#include "tests/testing/matchers.h"

namespace lightfit {
namespace {

using testing::ExrPart;

constexpr int kWidth = 64, kHeight = 48;
constexpr MapSize kMap = {1024, 1024};

// Matrices of the same pixels differ by rounding at most.
constexpr double kTexels = 1e-3;

// A scene of boxes on a floor that ends, below a sky.
struct Frame {
  SyntheticReadback image;
  std::vector<Light> lights;

  bool IsSky(size_t pixel) const { return image.depth[pixel] == kSyntheticBackground; }
  double SkyShare() const {
    double sum = 0.0;
    for (size_t i = 0; i < image.depth.size(); ++i) sum += IsSky(i) ? 1.0 : 0.0;
    return sum / static_cast<double>(image.depth.size());
  }
};

Frame FrameOf(uint64_t seed, bool orthographic) {
  const BoxScene scene = MakeBoxScene(seed);
  Frame frame;
  frame.lights = {RandomLight(scene, seed, RandomLightKind::kSun, 0),
                  RandomLight(scene, seed, RandomLightKind::kNearPoint, 1)};
  frame.lights[0].name = "sun";
  frame.lights[1].name = "lamp";
  Camera camera = RandomCamera(scene, seed, kWidth, kHeight);
  if (orthographic) {
    camera.orthographic = true;
    const double scale = kWidth / (2.5 * scene.floor_half_size);
    camera.screen_from_camera << (camera.screen_from_camera(0, 0) < 0 ? -scale : scale), 0,
        0.5 * kWidth, 0, (camera.screen_from_camera(1, 1) < 0 ? -scale : scale), 0.5 * kHeight, 0,
        0, 1;
  }
  frame.image = Render(scene, camera, frame.lights);
  return frame;
}

// The value of the kind for a surface that is z away.
double ValueOf(const Camera& camera, DepthKind kind, int x, int y, double z) {
  if (kind == DepthKind::kCameraZ || camera.orthographic) return z;
  const Eigen::Vector3d ray =
      camera.screen_from_camera.inverse() * Eigen::Vector3d(x + 0.5, y + 0.5, 1.0);
  return z * ray.norm();
}

struct Form {
  DepthKind kind = DepthKind::kCameraZ;
  Imf::PixelType type = Imf::FLOAT;
  bool is_sky_in_shadow = false;
};

class SkyCorpus : public ::testing::Test {
 protected:
  std::string Write(const Frame& frame, const Form& form, double sky) {
    ExrPart part;
    part.width = part.data_width = kWidth;
    part.height = part.data_height = kHeight;
    const SyntheticReadback& image = frame.image;
    part.channels.push_back({"Z", form.type, [&, sky, form](int x, int y) {
                               const size_t i = static_cast<size_t>(y) * kWidth + x;
                               return frame.IsSky(i)
                                          ? sky
                                          : ValueOf(image.camera, form.kind, x, y, image.depth[i]);
                             }});
    for (const Light& light : frame.lights) {
      part.channels.push_back({"shadow." + light.name, Imf::HALF, [&, light, form](int x, int y) {
                                 const size_t i = static_cast<size_t>(y) * kWidth + x;
                                 if (frame.IsSky(i)) return form.is_sky_in_shadow ? 1.0 : 0.0;
                                 return (image.shadow_bits[i] >> light.shadow_bit & 1U) != 0 ? 1.0
                                                                                             : 0.0;
                               }});
    }
    const std::string path = folder_.File("a.exr");
    testing::WriteExr(path, {part});
    return path;
  }

  absl::StatusOr<ReadbackFile> Read(const Frame& frame,
                                    const Form& form,
                                    double sky,
                                    std::optional<float> background = std::nullopt) {
    ReadbackExrOptions options;
    options.depth_kind = form.kind;
    options.camera = frame.image.camera;
    options.background = background;
    return ReadReadbackExr(Write(frame, form, sky), frame.lights, options);
  }

  testing::TemporaryFolder folder_;
};

// How far apart two maps put the surfaces of the frame, texels.
double TexelsApart(const ReadbackFile& file, const Eigen::Matrix4d& a, const Eigen::Matrix4d& b) {
  const Readback view = file.View();
  const AffineDepth affine_depth = AffineDepthOf(view);
  const Eigen::Matrix4d world_from_screen = view.camera.WorldFromScreen();
  double largest = 0.0;
  for (int y = 0; y < kHeight; y += 3) {
    for (int x = 0; x < kWidth; x += 3) {
      const float depth = view.depth[view.Index(x, y)];
      if (!affine_depth.IsSurface(depth)) continue;
      const Eigen::Vector4d world =
          world_from_screen * Eigen::Vector4d(x + 0.5, y + 0.5, affine_depth.At(x, y, depth), 1.0);
      const Eigen::Vector4d at = a * world, there = b * world;
      // Whoever is far outside either map does not look it up.
      if (!(at.w() > 0.0) || (at.head<2>() / at.w()).cwiseAbs().maxCoeff() > 4 * kMap.width)
        continue;
      largest = std::max(
          largest, (at.head<2>() / at.w() - there.head<2>() / there.w()).cwiseAbs().maxCoeff());
    }
  }
  return largest;
}

bool Tells(const ReadbackFile& file) {
  for (const ReadbackWarning& warning : file.warnings) {
    if (warning.about == "background") return true;
  }
  return false;
}

struct Tally {
  int num_right = 0, num_told = 0, num_wrong = 0;
};

// Whether both lights have the matrices of the clean file, and the same counts of samples.
bool IsRight(const Frame& frame,
             const ReadbackFile& file,
             const std::vector<absl::StatusOr<LightMatrix>>& clean) {
  FitOptions options;
  options.cover = Cover::kReceivers;
  options.search = Search::kFocused;  // from the same cover and samples as any other
  const LightMatrices fits = FitLights(file.View(), frame.lights, kMap, options);
  for (size_t l = 0; l < fits.size(); ++l) {
    if (fits[l].status().code() != clean[l].status().code()) return false;
    if (!fits[l].ok()) continue;
    const SampleCounts &a = fits[l]->figures.samples, &b = clean[l]->figures.samples;
    if (a.candidates != b.candidates || a.used != b.used || a.background != b.background ||
        a.receivers != b.receivers) {
      return false;
    }
    if (!(TexelsApart(file, clean[l]->map_from_world, fits[l]->map_from_world) <= kTexels)) {
      return false;
    }
  }
  return true;
}

std::vector<absl::StatusOr<LightMatrix>> CleanFits(const Frame& frame, const ReadbackFile& file) {
  FitOptions options;
  options.cover = Cover::kReceivers;
  options.search = Search::kFocused;  // from the same cover and samples as any other
  std::vector<absl::StatusOr<LightMatrix>> fits;
  for (absl::StatusOr<LightMatrix>& fit : FitLights(file.View(), frame.lights, kMap, options)) {
    fits.push_back(std::move(fit));
  }
  return fits;
}

TEST_F(SkyCorpus, EverySkyIsReadRightOrTold) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  // Those that programs write; far planes; and one that is hardly further than the scene.
  const double kSkies[] = {
      65504, 65535, 65536, 99999, 1e5, 1e6, 1e7, 1e8, 9e8, 1e10, kInfinity, 20000, 1000, 500};
  Tally tally;
  for (const bool orthographic : {false, true}) {
    for (const uint64_t seed : {4U, 9U}) {
      const Frame frame = FrameOf(seed, orthographic);
      ASSERT_GT(frame.SkyShare(), 0.05) << seed;
      for (const DepthKind kind : {DepthKind::kCameraZ, DepthKind::kDistance}) {
        for (const Imf::PixelType type : {Imf::FLOAT, Imf::HALF}) {
          const auto clean = Read(frame, {kind, type, false}, kInfinity);
          ASSERT_THAT(clean, testing::IsOk());
          const std::vector<absl::StatusOr<LightMatrix>> fits = CleanFits(frame, *clean);
          for (const double sky : kSkies) {
            // A half float of these is infinite.
            if (type == Imf::HALF && sky > 65536 && !std::isinf(sky)) continue;
            for (const bool is_sky_in_shadow : {false, true}) {
              const Form form = {kind, type, is_sky_in_shadow};
              SCOPED_TRACE(absl::StrCat(orthographic ? "orthographic " : "",
                                        DepthKindName(kind),
                                        " sky ",
                                        sky,
                                        type == Imf::HALF ? " half" : "",
                                        is_sky_in_shadow ? " in shadow" : "",
                                        " seed ",
                                        seed));
              const auto file = Read(frame, form, sky);
              ASSERT_THAT(file, testing::IsOk());
              const bool is_right = IsRight(frame, *file, fits);
              if (is_right) {
                ++tally.num_right;
              } else {
                ++(Tells(*file) ? tally.num_told : tally.num_wrong);
              }
              EXPECT_TRUE(is_right || (Tells(*file) && sky < 65504));
              // As anyone does who reads the warning.
              if (std::isinf(sky)) continue;
              const auto stated = Read(frame, form, sky, static_cast<float>(sky) * 0.99F);
              ASSERT_THAT(stated, testing::IsOk());
              EXPECT_TRUE(IsRight(frame, *stated, fits));
              EXPECT_FALSE(Tells(*stated));
            }
          }
        }
      }
    }
  }
  std::printf("%d files: %d read right, %d told of, %d wrong\n",
              tally.num_right + tally.num_told + tally.num_wrong,
              tally.num_right,
              tally.num_told,
              tally.num_wrong);
  EXPECT_EQ(tally.num_wrong, 0);
}

TEST_F(SkyCorpus, ACleanSkyIsNotSpokenOf) {
  const Frame frame = FrameOf(4, false);
  for (const double sky : {1e9, 1e10, 3.4e38}) {
    const auto file = Read(frame, {}, sky);
    ASSERT_THAT(file, testing::IsOk());
    EXPECT_FALSE(Tells(*file));
  }
}

TEST_F(SkyCorpus, StatedAsInfinityItIsASurface) {
  const Frame frame = FrameOf(4, false);
  const auto file = Read(frame, {}, 65504, std::numeric_limits<float>::infinity());
  ASSERT_THAT(file, testing::IsOk());
  EXPECT_FALSE(Tells(*file));
  EXPECT_TRUE(AffineDepthOf(file->View()).IsSurface(65504));
}

TEST_F(SkyCorpus, TheWarningNamesDepthShareAndOption) {
  const Frame frame = FrameOf(4, false);
  const auto file = Read(frame, {}, 65504);
  ASSERT_THAT(file, testing::IsOk());
  ASSERT_TRUE(Tells(*file));
  EXPECT_TRUE(testing::HasAll(file->warnings.front().text,
                              {absl::StrFormat("%.3g %%", 100.0 * frame.SkyShare()),
                               "65504",
                               "--background 65504",
                               "--background inf"}));
}

}  // namespace
}  // namespace lightfit
