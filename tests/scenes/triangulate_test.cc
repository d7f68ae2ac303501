#include "scenes/triangulate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <numeric>
#include <random>
#include <set>
#include <vector>

namespace lightfit {
namespace {

// Outlines have whole coordinates, so that everything about them is exact.
using Point = Eigen::Matrix<int64_t, 2, 1>;
using Outline = std::vector<Point>;

int64_t TwiceArea(const Point& a, const Point& b, const Point& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

int64_t TwiceArea(const Outline& outline) {
  int64_t area = 0;
  for (size_t i = 0; i < outline.size(); ++i) {
    area += TwiceArea({0, 0}, outline[i], outline[(i + 1) % outline.size()]);
  }
  return area;
}

// Brute force: by the crossings of a ray from a point that is no whole one.
bool IsInside(const Outline& outline, const Eigen::Vector2d& point) {
  bool inside = false;
  for (size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d a = outline[i].cast<double>();
    const Eigen::Vector2d b = outline[(i + 1) % outline.size()].cast<double>();
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    const double x = a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (x > point.x()) inside = !inside;
  }
  return inside;
}

// Cuts the outline, put onto a plane in space, and compares with what brute force says.
void ExpectFilledOnce(Outline outline, std::mt19937& random) {
  if (TwiceArea(outline) < 0) std::reverse(outline.begin(), outline.end());
  const int64_t slope_x = static_cast<int64_t>(random() % 5) - 2;
  const int64_t slope_y = static_cast<int64_t>(random() % 5) - 2;
  const int turn = static_cast<int>(random() % 3);
  std::vector<Eigen::Vector3d> positions(1, Eigen::Vector3d::Constant(1e9));
  for (const Point& point : outline) {
    Eigen::Vector3d position;
    position[turn] = static_cast<double>(point.x());
    position[(turn + 1) % 3] = static_cast<double>(point.y());
    position[(turn + 2) % 3] = static_cast<double>(slope_x * point.x() + slope_y * point.y());
    positions.push_back(position);
  }
  std::vector<int> corners(outline.size());
  std::iota(corners.begin(), corners.end(), 1);
  std::vector<Eigen::Vector3i> triangles;
  ASSERT_TRUE(Triangulator(positions).Append(corners, &triangles));
  ASSERT_LE(triangles.size(), outline.size() - 2);
  int64_t area = 0;
  Point low = outline[0], high = outline[0];
  for (const Point& point : outline) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  std::vector<Outline> cut;
  for (const Eigen::Vector3i& triangle : triangles) {
    cut.push_back({outline[triangle[0] - 1], outline[triangle[1] - 1], outline[triangle[2] - 1]});
    const int64_t part = TwiceArea(cut.back());
    EXPECT_GT(part, 0);
    area += part;
  }
  EXPECT_EQ(area, TwiceArea(outline));
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector2d point(
        static_cast<double>(low.x()) + share(random) * static_cast<double>(high.x() - low.x()),
        static_cast<double>(low.y()) + share(random) * static_cast<double>(high.y() - low.y()));
    const auto covering = std::count_if(
        cut.begin(), cut.end(), [&](const Outline& part) { return IsInside(part, point); });
    ASSERT_EQ(covering, IsInside(outline, point) ? 1 : 0) << point.transpose();
  }
}

// Corners on the edges: `scale` times as large, with whole points on every edge.
Outline WithCornersOnEdges(const Outline& outline, int64_t scale, std::mt19937& random) {
  Outline more;
  for (size_t i = 0; i < outline.size(); ++i) {
    const Point a = scale * outline[i], b = scale * outline[(i + 1) % outline.size()];
    more.push_back(a);
    const Point step = (b - a) / scale;
    for (int64_t k = 1; k < scale; ++k) {
      if (random() % 3 == 0) more.push_back(a + k * step);
    }
  }
  return more;
}

Outline RandomStar(std::mt19937& random) {
  const int count = 4 + static_cast<int>(random() % 40);
  Outline outline;
  for (int i = 0; i < count; ++i) {
    const double radius = 50.0 + static_cast<double>(random() % 5000);
    const double angle = 2.0 * M_PI * i / count;
    outline.push_back(
        {std::lround(radius * std::cos(angle)), std::lround(radius * std::sin(angle))});
  }
  return outline;
}

// Points in random order whose crossings are undone.
Outline RandomTangleUndone(std::mt19937& random) {
  const int count = 5 + static_cast<int>(random() % 14);
  Outline outline;
  std::set<std::pair<int64_t, int64_t>> taken;
  while (static_cast<int>(outline.size()) < count) {
    const Point point(random() % 1000, random() % 1000);
    if (taken.insert({point.x(), point.y()}).second) outline.push_back(point);
  }
  const auto sign = [](int64_t value) { return (value > 0) - (value < 0); };
  for (bool changed = true; changed;) {
    changed = false;
    for (int i = 0; i < count && !changed; ++i) {
      for (int j = i + 1; j < count && !changed; ++j) {
        const Point &a = outline[i], &b = outline[i + 1 == count ? 0 : i + 1];
        const Point &c = outline[j], &d = outline[j + 1 == count ? 0 : j + 1];
        if (sign(TwiceArea(a, b, c)) * sign(TwiceArea(a, b, d)) < 0 &&
            sign(TwiceArea(c, d, a)) * sign(TwiceArea(c, d, b)) < 0) {
          std::reverse(outline.begin() + i + 1, outline.begin() + j + 1);
          changed = true;
        }
      }
    }
  }
  return outline;
}

// The outline of squares of a chequered sheet that hang together: it touches itself at corners, and
// goes there and back where it joins a hole to the outside.
Outline RandomSquares(std::mt19937& random) {
  // A tree of squares; the outline goes around it, so that walls between neighbours in space that
  // are none in the tree are passed there and back.
  std::set<std::pair<int64_t, int64_t>> taken = {{0, 0}};
  std::vector<std::pair<int64_t, int64_t>> squares = {{0, 0}};
  std::vector<std::vector<int>> open = {{0, 0, 0, 0}};  // by side: joined to a neighbour
  std::vector<std::vector<int>> neighbour = {{-1, -1, -1, -1}};
  constexpr int kStep[4][2] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
  const int count = 2 + static_cast<int>(random() % 60);
  for (int tries = 0; static_cast<int>(squares.size()) < count && tries < 1000; ++tries) {
    const int from = static_cast<int>(random() % squares.size()),
              side = static_cast<int>(random() % 4);
    const std::pair<int64_t, int64_t> next = {squares[from].first + kStep[side][0],
                                              squares[from].second + kStep[side][1]};
    if (!taken.insert(next).second) continue;
    const int index = static_cast<int>(squares.size());
    squares.push_back(next);
    open.push_back({0, 0, 0, 0});
    neighbour.push_back({-1, -1, -1, -1});
    neighbour[from][side] = index;
    neighbour[index][(side + 2) % 4] = from;
  }
  // Counterclockwise: side s of a square begins at corner s.
  constexpr int kCorner[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  Outline outline;
  const auto walk = [&](const auto& self, int square, int entry) -> void {
    for (int i = 1; i <= 3; ++i) {
      const int side = (entry + i) % 4;
      if (neighbour[square][side] >= 0) {
        self(self, neighbour[square][side], (side + 2) % 4);
      } else {
        outline.push_back(
            {squares[square].first + kCorner[side][0], squares[square].second + kCorner[side][1]});
      }
    }
  };
  // The last one is joined to one other.
  const auto last = static_cast<int>(squares.size()) - 1;
  int side = 0;
  while (neighbour[last][side] >= 0) ++side;
  outline.push_back(
      {squares[last].first + kCorner[side][0], squares[last].second + kCorner[side][1]});
  walk(walk, last, side);
  return outline;
}

class TriangulateRandom : public ::testing::Test {
 protected:
  TriangulateRandom() { std::printf("[   seed   ] %d\n", kSeed); }

  static constexpr int kSeed = 1403;
  std::mt19937 random_{kSeed};
};

TEST_F(TriangulateRandom, FillsStarsOnce) {
  for (int i = 0; i < 200 && !HasFatalFailure(); ++i)
    ExpectFilledOnce(RandomStar(random_), random_);
}

TEST_F(TriangulateRandom, FillsTanglesUndoneOnce) {
  for (int i = 0; i < 300 && !HasFatalFailure(); ++i) {
    ExpectFilledOnce(RandomTangleUndone(random_), random_);
  }
}

TEST_F(TriangulateRandom, FillsOutlinesWithCornersOnTheirEdgesOnce) {
  for (int i = 0; i < 200 && !HasFatalFailure(); ++i) {
    ExpectFilledOnce(WithCornersOnEdges(RandomTangleUndone(random_), 6, random_), random_);
  }
}

TEST_F(TriangulateRandom, FillsOutlinesThatTouchThemselvesOnce) {
  for (int i = 0; i < 300 && !HasFatalFailure(); ++i) {
    const Outline outline = RandomSquares(random_);
    ExpectFilledOnce(outline, random_);
    ExpectFilledOnce(WithCornersOnEdges(outline, 4, random_), random_);
  }
}

// A wall with a window, joined to the outside by an edge there and back.
TEST(Triangulate, LeavesAHoleThatIsJoinedToTheOutline) {
  std::mt19937 random(7);
  ExpectFilledOnce({{0, 0}, {9, 0}, {9, 9}, {0, 9}, {0, 0}, {3, 3}, {3, 6}, {6, 6}, {6, 3}, {3, 3}},
                   random);
}

TEST(Triangulate, KeepsConvexPolygonsAsFans) {
  const std::vector<Eigen::Vector3d> positions = {
      {0, 0, 0}, {2, 0, 1}, {3, 1, 2}, {2, 3, 4}, {0, 2, 1}};
  std::vector<Eigen::Vector3i> triangles;
  ASSERT_TRUE(Triangulator(positions).Append({0, 1, 2, 3, 4}, &triangles));
  EXPECT_EQ(triangles, (std::vector<Eigen::Vector3i>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
}

TEST(Triangulate, CutsAConcaveQuadAlongTheDiagonalWithin) {
  const std::vector<Eigen::Vector3d> arrow = {{4, 0, 0}, {0, 3, 0}, {1, 0, 0}, {0, -3, 0}};
  for (int first = 0; first < 4; ++first) {
    std::vector<Eigen::Vector3i> triangles;
    std::vector<int> corners;
    for (int i = 0; i < 4; ++i) corners.push_back((first + i) % 4);
    ASSERT_TRUE(Triangulator(arrow).Append(corners, &triangles));
    ASSERT_EQ(triangles.size(), 2u);
    for (const Eigen::Vector3i& triangle : triangles) {
      EXPECT_EQ(std::count(triangle.begin(), triangle.end(), 0), 1);
      EXPECT_EQ(std::count(triangle.begin(), triangle.end(), 2), 1);
    }
  }
}

// Far out the corners' products have no digits left for the notch.
TEST(Triangulate, IsExactFarFromTheOrigin) {
  std::vector<Eigen::Vector3d> positions;
  for (const auto& [x, y] :
       {std::pair{-3, 0}, {3, 0}, {3, 3}, {1, 3}, {1, 1}, {-1, 1}, {-1, 3}, {-3, 3}}) {
    positions.emplace_back(1e7 + 1e-3 * x, 2e7 + 1e-3 * y, 5.0);
  }
  std::vector<Eigen::Vector3i> triangles;
  ASSERT_TRUE(Triangulator(positions).Append({0, 1, 2, 3, 4, 5, 6, 7}, &triangles));
  ASSERT_EQ(triangles.size(), 6u);
  double area = 0.0;
  for (const Eigen::Vector3i& t : triangles) {
    area += 0.5 * (positions[t[1]] - positions[t[0]]).cross(positions[t[2]] - positions[t[0]]).z();
  }
  EXPECT_NEAR(area, 14e-6, 1e-9);
}

TEST(Triangulate, CornersThatAreNotThereStayForTheCount) {
  const std::vector<Eigen::Vector3d> positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  std::vector<Eigen::Vector3i> triangles;
  ASSERT_TRUE(Triangulator(positions).Append({0, 1, 2, 9, -1}, &triangles));
  EXPECT_EQ(triangles.size(), 3u);
  triangles.clear();
  ASSERT_TRUE(Triangulator(positions).Append({0, 1}, &triangles));
  EXPECT_TRUE(triangles.empty());
}

// Crossing outlines have no right answer, but an end.
TEST(Triangulate, EndsOnOutlinesThatCrossThemselves) {
  std::mt19937 random(99);
  for (int i = 0; i < 200; ++i) {
    std::vector<Eigen::Vector3d> positions;
    std::vector<int> corners;
    for (int k = 0; k < 4 + i / 4; ++k) {
      positions.emplace_back(random() % 20, random() % 20, random() % 3);
      corners.push_back(k);
    }
    std::vector<Eigen::Vector3i> triangles;
    EXPECT_TRUE(Triangulator(positions).Append(corners, &triangles));
    EXPECT_LE(triangles.size(), corners.size() - 2);
  }
}

// A comb of 100000 corners, and one with as many whose every ear sees all others.
TEST(Triangulate, LargeOutlinesTakeTimeInProportionOrAreRefused) {
  std::vector<Eigen::Vector3d> comb = {{0, -1, 0}};
  constexpr int kTeeth = 25000;
  comb.emplace_back(2.0 * kTeeth, -1, 0);
  for (int i = kTeeth; i-- > 0;) {
    comb.emplace_back(2.0 * i + 1.5, 0, 0);
    comb.emplace_back(2.0 * i + 1, 10, 0);
    comb.emplace_back(2.0 * i + 0.5, 10, 0);
    comb.emplace_back(2.0 * i, 0, 0);
  }
  std::vector<int> corners(comb.size());
  std::iota(corners.begin(), corners.end(), 0);
  std::vector<Eigen::Vector3i> triangles;
  ASSERT_TRUE(Triangulator(comb).Append(corners, &triangles));
  EXPECT_EQ(triangles.size(), comb.size() - 2);

  std::mt19937 random(5);
  std::vector<Eigen::Vector3d> tangle;
  for (int i = 0; i < 20000; ++i) tangle.emplace_back(random() % 100000, random() % 100000, 0);
  corners.resize(tangle.size());
  triangles.clear();
  EXPECT_FALSE(Triangulator(tangle).Append(corners, &triangles));
}

}  // namespace
}  // namespace lightfit
