// Totals of hand-made comparisons, and the pieces of their picture.

#include "picture/compare_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/progress.h"
#include "jobs/compare/totals.h"
#include "picture/bar_chart.h"
#include "picture/compare_choice.h"
#include "picture/shadow_panel.h"
#include "picture/theme.h"
#include "tests/jobs/compare/compared_lights.h"

namespace lightfit {
namespace {

TEST(Totals, CountTheLightsThatBothHave) {
  const std::vector<MethodTotals> totals = TotalsOf(ThreeLights());
  ASSERT_EQ(totals.size(), 2u);
  const MethodTotals& focused = totals[0];
  EXPECT_EQ(focused.num_lights, 2);
  EXPECT_EQ(focused.num_failed, 1);
  EXPECT_EQ(focused.ideal->total, 35);
  EXPECT_EQ(focused.ideal->lightfit_total, 19);
  EXPECT_DOUBLE_EQ(*focused.ideal->ratio, 35.0 / 19.0);
  EXPECT_DOUBLE_EQ(focused.ideal->mean_ratio, std::sqrt((31.0 / 11.0) * (6.0 / 10.0)));
  EXPECT_EQ(focused.ideal->num_wins, 1);
  EXPECT_EQ(focused.practical->num_wins, 0);  // a draw is no win
  EXPECT_DOUBLE_EQ(*focused.mean_energy_ratio, std::sqrt((8.0 / 2.0) * (2.0 / 4.0)));
  EXPECT_EQ(totals[1].num_lights, 3);
  EXPECT_DOUBLE_EQ(*totals[1].ideal->ratio, 1.0);
}

TEST(Totals, HaveNoRatioToNothing) {
  const std::vector<LightComparison> lights = {
      OneLight("a", {Row("focused", 3, 0, 0), Row("lightfit", 0, 0, 0)}),
      OneLight("b", {FailedRow("focused", "?"), FailedRow("lightfit", "?")})};
  const std::vector<MethodTotals> totals = TotalsOf(lights);
  EXPECT_FALSE(totals[0].ideal->ratio.has_value());
  EXPECT_DOUBLE_EQ(totals[0].ideal->mean_ratio, 4.0);
  EXPECT_FALSE(totals[0].mean_energy_ratio.has_value());
  EXPECT_EQ(totals[1].num_failed, 1);
  EXPECT_TRUE(TotalsOf({}).empty());
}

TEST(DurationText, ReadsAsPeopleSayIt) {
  EXPECT_EQ(DurationText(0), "0 s");
  EXPECT_EQ(DurationText(7.2), "8 s");
  EXPECT_EQ(DurationText(59.5), "1 min 0 s");
  EXPECT_EQ(DurationText(125), "2 min 5 s");
  EXPECT_EQ(DurationText(4800), "1 h 20 min");
  EXPECT_EQ(DurationText(NAN), "0 s");
  EXPECT_EQ(DurationText(INFINITY), "1000 h 0 min");
}

// Marks stay as they are, and so does what asks no map.
TEST(ShadeShadows, TintsByTheMapThatIsAsked) {
  SurfaceImage image;
  image.camera.width = 4;
  image.camera.height = 1;
  image.pixels.resize(4);
  for (SurfacePoint& pixel : image.pixels) {
    pixel.triangle = 0;
    pixel.normal = Eigen::Vector3d::UnitZ();
  }
  const Light sun = Light::Directional("sun", {0, 0, -1});
  const std::vector<Lighting> truth(4, Lighting::kLit);
  std::vector<Lighting> shadows = truth;
  shadows[3] = Lighting::kShadowed;
  const Image plain = ShadeShadows(image, sun, truth, shadows);
  const std::vector<int> asked = {-1, 0, 1, 1};
  const Image tinted = ShadeShadows(image, sun, truth, shadows, asked);
  const auto differ = [](Rgb a, Rgb b) { return a.r != b.r || a.g != b.g || a.b != b.b; };
  EXPECT_FALSE(differ(tinted.At(0, 0), plain.At(0, 0)));
  EXPECT_TRUE(differ(tinted.At(1, 0), plain.At(1, 0)));
  EXPECT_TRUE(differ(tinted.At(2, 0), tinted.At(1, 0)));
  EXPECT_FALSE(differ(tinted.At(3, 0), plain.At(3, 0)));
}

// Two methods that get nothing wrong on a screen of a few pixels, magnified.
class ComparePage : public ::testing::Test {
 protected:
  static constexpr int kMargin = 36, kTitleBottom = 62;  // pixels of the page

  ComparePage() {
    stage_.screen.camera.width = 8;
    stage_.screen.camera.height = 6;
    stage_.screen.pixels.resize(48);
    for (SurfacePoint& pixel : stage_.screen.pixels) {
      pixel.triangle = 0;
      pixel.normal = Eigen::Vector3d::UnitY();
    }
    light_ = OneLight("sun", {Row("focused", 0, 0, 2), Row("lightfit", 0, 0, 1)});
    light_.truth.assign(48, Lighting::kLit);
    for (ComparedRow& row : light_.rows) row.image.ideal = row.image.practical = light_.truth;
  }

  Image Drawn(const std::string& title) const {
    return DrawComparePicture(stage_, light_, {.title = title, .maps = "map"}, typeface_).ToImage();
  }

  // Columns with ink in the line of the title.
  static std::vector<int> TitleColumns(const Image& page) {
    std::vector<int> columns;
    for (int x = 0; x < page.width(); ++x) {
      for (int y = 0; y < kTitleBottom; ++y) {
        if (std::abs(page.At(x, y).r - page.At(0, 0).r) < 0.05f) continue;
        columns.push_back(x);
        break;
      }
    }
    return columns;
  }

  const Typeface typeface_ = Typeface::Find();
  CompareStage stage_;
  LightComparison light_;
};

TEST_F(ComparePage, TheTitleIsCutOnlyWhereThereIsNoRoom) {
  if (!typeface_.found()) GTEST_SKIP() << "no typeface on this machine (fonts-dejavu-core)";
  const std::string name = "courtyard_of_the_old_mill_before_noon_v042.glb";
  ASSERT_GT(name.size(), 40u);
  std::string other = name;
  other[16] = 'W';
  EXPECT_NE(TitleColumns(Drawn(name)), TitleColumns(Drawn(other)));  // nothing of it is left out

  const Image page = Drawn(std::string(300, 'o') + ".glb");
  const std::vector<int> columns = TitleColumns(page);
  EXPECT_LT(columns.back(), page.width() - kMargin);
  EXPECT_GT(columns.back(), page.width() - kMargin - 60);  // no more than a few letters of room
}

TEST(BestCrop, IsTheLargestSumOfAll) {
  constexpr int kWidth = 23, kHeight = 17;
  std::mt19937 random(7);
  std::vector<int32_t> gain(kWidth * kHeight);
  for (int32_t& value : gain) value = static_cast<int32_t>(random() % 7) - 3;
  const CropBox size = {0, 0, 6, 4};
  const auto sum_of = [&](int x0, int y0) {
    int64_t sum = 0;
    for (int y = y0; y < y0 + size.height; ++y) {
      for (int x = x0; x < x0 + size.width; ++x) sum += gain[y * kWidth + x];
    }
    return sum;
  };
  const CropBox best = BestCrop(gain, kWidth, kHeight, size);
  for (int y = 0; y + size.height <= kHeight; ++y) {
    for (int x = 0; x + size.width <= kWidth; ++x) {
      EXPECT_LE(sum_of(x, y), sum_of(best.x, best.y));
    }
  }
  const CropBox whole = BestCrop(gain, kWidth, kHeight, {0, 0, kWidth, kHeight});
  EXPECT_EQ(whole.x, 0);
  EXPECT_EQ(whole.y, 0);
}

TEST(ReducedPanel, KeepsASingleWrongPixelVisible) {
  Image full(40, 40, {0.5f, 0.5f, 0.5f});
  std::vector<uint8_t> wrong(40 * 40, 0);
  full.Blend(21, 9, kFalseShadowColor);
  wrong[9 * 40 + 21] = 1;
  const Image panel = ReducedPanel(full, wrong, 4);
  ASSERT_EQ(panel.width(), 10);
  // Sixteen pixels share the square, yet it is more mark than grey.
  EXPECT_GT(panel.At(5, 2).r - panel.At(5, 2).b, 0.4f);
  EXPECT_NEAR(panel.At(4, 2).r, 0.5, 1e-6);
}

TEST(EnlargedCrop, RepeatsPixels) {
  Image full(8, 8, {});
  full.Blend(3, 2, {1, 1, 1});
  const Image crop = EnlargedCrop(full, {2, 1, 4, 3}, 5);
  EXPECT_EQ(crop.width(), 20);
  EXPECT_EQ(crop.height(), 15);
  EXPECT_EQ(crop.At(5, 5).r, 1);
  EXPECT_EQ(crop.At(9, 9).r, 1);
  EXPECT_EQ(crop.At(10, 9).r, 0);
}

TEST(BarChart, IsAsLongAsTheNumbers) {
  Canvas canvas(200, 100, {});
  DrawBarChart(0,
               0,
               200,
               100,
               {{"", 10, {1, 0, 0}}, {"", 5, {0, 1, 0}}, {"", 0, {0, 0, 1}}},
               Typeface(),
               &canvas);
  float red = 0, green = 0, blue = 0;
  const Image drawn = canvas.ToImage();
  for (const Rgb& pixel : drawn.pixels()) {
    red += pixel.r;
    green += pixel.g;
    blue += pixel.b;
  }
  EXPECT_GT(red, 100);
  EXPECT_NEAR(green / red, 0.5, 0.01);
  EXPECT_EQ(blue, 0);
}

TEST(ComparePicture, DrawsTheLightWhereMethodsDifferMost) {
  const std::vector<LightComparison> lights = ThreeLights();
  EXPECT_EQ(MostTellingLight(lights, Bias::kIdeal), 0u);
  EXPECT_EQ(MostTellingLight(absl::MakeSpan(lights).subspan(1), Bias::kPractical), 0u);
  EXPECT_EQ(MostTellingLight(absl::MakeSpan(lights).subspan(2), Bias::kIdeal), 0u);
}

}  // namespace
}  // namespace lightfit
