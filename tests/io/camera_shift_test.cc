// Lenses that are shifted, and tiles: the axis meets the frame anywhere, or outside of it.

#include <gtest/gtest.h>

#include <iostream>
#include <utility>

#include "io/camera_exr.h"
#include "tests/io/camera_conventions.h"

namespace lightfit {
namespace {

using testing::Convention;
using testing::ConventionOfBits;
using testing::HasAll;
using testing::kDoublePrecision;
using testing::kHeight;
using testing::kWidth;
using testing::LargestScreenDifference;
using testing::Read;
using testing::StandardMatrices;
using testing::WrittenAs;

// The standard pair whose axis meets the frame there.
StandardMatrices Shifted(double x, double y) {
  StandardMatrices matrices = testing::Standard(kWidth, kHeight);
  Eigen::Matrix4d ndc = matrices.world_to_ndc.transpose();
  ndc.row(0) += (x - 0.5) * ndc.row(3);
  ndc.row(1) += (y - 0.5) * ndc.row(3);
  matrices.world_to_ndc = ndc.transpose();
  return matrices;
}

Convention WithAnyCentre(Convention convention) {
  convention.frame_centre = Convention::FrameCentre::kAnywhere;
  return convention;
}

TEST(CameraExr, AnyLensShiftIsReadWhenStated) {
  for (const auto& [x, y] : {std::pair{0.65, 0.5}, {0.95, 0.2}, {0.0, 0.0}, {-3.5, 1.5}}) {
    for (int bits = 0; bits < 64; ++bits) {
      const Convention convention = WithAnyCentre(ConventionOfBits(bits));
      const auto camera = Read(WrittenAs(convention, Shifted(x, y), kWidth, kHeight), convention);
      ASSERT_TRUE(camera.ok()) << CameraConventionWords(convention) << ": " << camera.status();
      EXPECT_NEAR(camera->screen_from_camera(0, 2), x * kWidth, kDoublePrecision);
      EXPECT_NEAR(camera->screen_from_camera(1, 2), y * kHeight, kDoublePrecision);
    }
  }
}

TEST(CameraExr, LensShiftsAreReadUnstatedWhereTheOtherRangeIsNoLikelier) {
  for (const auto& [x, y] : {std::pair{0.65, 0.5}, {0.95, 0.2}, {0.9, 0.1}, {0.9, 0.15}}) {
    const auto camera = Read(Shifted(x, y));
    ASSERT_TRUE(camera.ok()) << camera.status();
    EXPECT_NEAR(camera->screen_from_camera(0, 2), x * kWidth, kDoublePrecision);
    EXPECT_NEAR(camera->screen_from_camera(1, 2), y * kHeight, kDoublePrecision);
  }
}

TEST(CameraExr, AShiftThatMayBeTheOtherRangeIsRefusedWithBothOptions) {
  const auto camera = Read(Shifted(0.1, 0.5));
  ASSERT_FALSE(camera.ok());
  EXPECT_TRUE(HasAll(camera.status().message(),
                     {"(0.1, 0.5)",
                      "--camera-convention shifted",
                      "(0.55, 0.75)",
                      "--camera-convention ndc-minus-1-1"}));
}

// Of all conventions and shifts, unstated: what is read wrongly is read with the axis nearer to the
// middle than it was, or within what most lenses have; and never with the axis in the very middle.
TEST(CameraExr, NoShiftMakesAWrongConventionLikelier) {
  int num_right = 0, num_refused = 0, num_likelier = 0;
  for (double x = -1.0; x <= 2.0; x += 0.3) {
    for (double y = -1.0; y <= 2.0; y += 0.3) {
      const StandardMatrices standard = Shifted(x, y);
      const auto truth = Read(standard, WithAnyCentre({}));
      ASSERT_TRUE(truth.ok()) << truth.status();
      for (int bits = 0; bits < 64; ++bits) {
        const Convention convention = ConventionOfBits(bits);
        if ((bits & 24) == 24) continue;  // number for number the standard, looking the other way
        const auto camera = Read(WrittenAs(convention, standard, kWidth, kHeight));
        if (!camera.ok()) {
          ++num_refused;
        } else if (LargestScreenDifference(*truth, *camera, 20) <= kDoublePrecision) {
          ++num_right;
        } else {
          ++num_likelier;
          EXPECT_TRUE(FrameShift(*camera) <= kLikelyFrameShift ||
                      FrameShift(*camera) <= FrameShift(*truth))
              << CameraConventionWords(convention) << " " << x << " " << y;
          EXPECT_GE(FrameShift(*truth), kLikelyFrameShift - kDoublePrecision);
        }
      }
    }
  }
  std::cout << num_right << " right, " << num_refused << " refused, " << num_likelier
            << " read as the likelier convention\n";
  // Only the other range can be taken for a shift.
  EXPECT_LT(num_likelier, 11 * 11);
}

}  // namespace
}  // namespace lightfit
