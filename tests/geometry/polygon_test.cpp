#include "cleave/geometry/polygon.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "cleave/geometry/triangulate.hpp"

namespace cleave::geometry {
namespace {

template <class Expected>
const Expected* error_of(const std::vector<Vec3>& corners) {
  static PolygonError kept = ZeroArea{};
  const auto polygon = Polygon::make(corners);
  if (polygon) return nullptr;
  kept = polygon.error();
  return std::get_if<Expected>(&kept);
}

Vec3 area_of_ring(std::span<const Vec3> ring) {
  Vec3 sum{};
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) sum += cross(ring[i] - ring[0], ring[i + 1] - ring[0]);
  return sum / 2;
}

/// Rows of a rotation that mixes all axes.
Vec3 turned(Vec3 p) {
  const Vec3 ex = normalized(Vec3{2, 1, -1}), up = normalized(Vec3{1, -1, 1});
  return {dot(ex, p), dot(cross(up, ex), p), dot(up, p)};
}

const std::vector<Vec3> square{{0, 0, 5}, {2, 0, 5}, {2, 2, 5}, {0, 2, 5}};

TEST(PolygonTest, KeepsCornersAndKnowsConvexFromConcave) {
  const auto convex = Polygon::make(square);
  ASSERT_TRUE(convex.has_value());
  EXPECT_TRUE(convex->convex());
  EXPECT_TRUE(std::ranges::equal(convex->corners(), square));
  const auto concave = Polygon::make({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 1, 0}, {0, 4, 0}});
  ASSERT_TRUE(concave.has_value());
  EXPECT_FALSE(concave->convex());
  const auto clockwise = Polygon::make({{0, 2, 5}, {2, 2, 5}, {2, 0, 5}, {0, 0, 5}});
  EXPECT_TRUE(clockwise.value().convex());
  const auto flat_corner = Polygon::make({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}});
  EXPECT_TRUE(flat_corner.value().convex());
  EXPECT_EQ(flat_corner.value().corners().size(), 5U);
}

TEST(PolygonTest, DropsRepeatedCornersAndCountsErrorsAsGiven) {
  const auto polygon = Polygon::make({{0, 0, 0}, {0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 0}});
  ASSERT_TRUE(polygon.has_value());
  EXPECT_EQ(polygon->corners().size(), 4U);
  // The bow tie's edges start at the given corners 1 and 4.
  const auto* crossing = error_of<SelfCrossing>({{0, 0, 0}, {0, 0, 0}, {2, 2, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}});
  ASSERT_NE(crossing, nullptr);
  EXPECT_EQ(crossing->first_edge, 0U);
  EXPECT_EQ(crossing->second_edge, 4U);
}

TEST(PolygonTest, RefusesWithTheReason) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  ASSERT_NE(error_of<TooFewCorners>({{0, 0, 0}, {1, 0, 0}}), nullptr);
  ASSERT_NE(error_of<TooFewCorners>({}), nullptr);
  for (const double bad : {nan, inf, -inf, 1e300, 1.1e12}) {
    const auto* e = error_of<NonFiniteCorner>({{0, 0, 0}, {1, 0, 0}, {1, bad, 0}});
    ASSERT_NE(e, nullptr) << bad;
    EXPECT_EQ(e->corner, 2U);
  }
  EXPECT_NE(error_of<ZeroArea>({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}), nullptr);
  EXPECT_NE(error_of<ZeroArea>({{0, 0, 0}, {1, 1, 1}, {3, 3, 3}, {2, 2, 2}}), nullptr);
  // On one line up to the rounding of the decimal text.
  EXPECT_NE(error_of<ZeroArea>({{0.1, 0.2, 0}, {0.2, 0.4, 0}, {0.3, 0.6, 0}, {0.7, 1.4, 0}}), nullptr);
  EXPECT_NE(error_of<SelfCrossing>({{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}}), nullptr);
}

// Turns the same way at every corner, but twice around.
TEST(PolygonTest, PentagramsCrossThemselves) {
  for (const int step : {1, 2, 3, 4}) {
    std::vector<Vec3> corners;
    for (int i = 0; i < 5; ++i) {
      const double angle = 0.3 + 2 * std::numbers::pi * step * i / 5;
      corners.push_back({std::cos(angle), 2 * std::sin(angle), 7 + std::cos(angle)});
    }
    EXPECT_EQ(Polygon::make(corners).has_value(), step == 1 || step == 4) << step;
  }
  // Twice around the same square, a little smaller the second time.
  EXPECT_FALSE(Polygon::make({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 1, 0}, {3, 1, 0}, {3, 3, 0}, {1, 3, 0}})
                   .has_value());
}

TEST(PolygonTest, TouchingAndFoldedOutlinesCrossThemselves) {
  // a spike out and back along one line
  EXPECT_NE(error_of<SelfCrossing>({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {4, 2, 0}, {0, 4, 0}}), nullptr);
  // a corner on another edge
  EXPECT_NE(error_of<SelfCrossing>({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 0, 0}, {0, 4, 0}}), nullptr);
  // a corner twice, not in a row
  EXPECT_NE(error_of<SelfCrossing>({{0, 0, 0}, {4, 0, 0}, {2, 2, 0}, {4, 4, 0}, {0, 4, 0}, {2, 2, 0}}), nullptr);
  // one unit in the last place away from touching is simple
  EXPECT_TRUE(Polygon::make({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 1e-16, 0}, {0, 4, 0}}).has_value());
}

TEST(PolygonTest, PlanarityHasTheStatedTolerance) {
  const auto bent = [](double h) { return std::vector<Vec3>{{0, 0, 0}, {3, 0, 0}, {3, 4, h}, {0, 4, 0}}; };
  // The best-fit plane passes h / 4 below the lifted corner; the size is the diagonal, 5.
  EXPECT_TRUE(Polygon::make(bent(4 * 4.99e-6)).has_value());
  const auto* e = error_of<NotPlanar>(bent(4 * 5.02e-6));
  ASSERT_NE(e, nullptr);
  EXPECT_NEAR(e->distance.si(), 5.02e-6, 1e-9);
  EXPECT_NEAR(e->allowed.si(), 5e-6, 1e-12);
  // Far from the origin the rounding of the coordinates themselves is allowed: 8 ulp of 5e9 is 7.6e-6 m.
  const auto far = [](double h) {
    return std::vector<Vec3>{{5e9, 0, 0}, {5e9 + 1, 0, 0}, {5e9 + 1, 1, h}, {5e9, 1, 0}};
  };
  EXPECT_TRUE(Polygon::make(far(4 * 7.4e-6)).has_value());
  EXPECT_FALSE(Polygon::make(far(4 * 7.8e-6)).has_value());
}

TEST(PolygonTest, EveryErrorSaysWhatAndWhatToDo) {
  const std::vector<PolygonError> all{TooFewCorners{2}, NonFiniteCorner{1}, ZeroArea{},
                                      NotPlanar{3, metres(0.5), metres(1e-6)}, SelfCrossing{1, 4}};
  for (const PolygonError& error : all) EXPECT_NE(describe(error).find("; "), std::string::npos) << describe(error);
  EXPECT_NE(describe(all[3]).find("0.5 m"), std::string::npos);
}

// Random star-shaped rings in a turned plane, far from the origin: simple by construction, so never refused.
TEST(PolygonTest, StarsAreSimpleAndDoubleTurnsCross) {
  std::mt19937_64 bits{5};
  const auto uniform = [&] { return static_cast<double>(bits() >> 11U) * 0x1p-53; };
  int concave = 0;
  for (int trial = 0; trial < 500; ++trial) {
    SCOPED_TRACE(trial);
    const std::size_t n = 5 + static_cast<std::size_t>(trial) % 40;
    std::vector<Vec3> ring;
    for (std::size_t i = 0; i < n; ++i) {
      const double t = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
      const double r = 1 + 4 * uniform();
      ring.push_back(Vec3{3e5, 4e6, 500} + turned({r * std::cos(t), r * std::sin(t), 0}));
    }
    const auto star = Polygon::make(ring);
    ASSERT_TRUE(star.has_value()) << describe(star.error());
    concave += star->convex() ? 0 : 1;
    const auto triangles = Polygon::triangulated(ring);
    ASSERT_TRUE(triangles.has_value());
    ASSERT_EQ(triangles->size(), n - 2);
    Vec3 sum{};
    double magnitude = 0;
    for (const Polygon& t : *triangles) {
      sum += area_of_ring(t.corners());
      magnitude += norm(area_of_ring(t.corners()));
    }
    const double area = norm(area_of_ring(ring));
    EXPECT_NEAR(norm(sum), area, 1e-7 * area);
    EXPECT_NEAR(magnitude, area, 1e-7 * area);  // no triangle overlaps another
    if (n % 2 == 1) {  // every second corner, twice around the centre: no simple ring can do that
      std::vector<Vec3> twice;
      for (std::size_t i = 0; i < n; ++i) twice.push_back(ring[2 * i % n]);
      EXPECT_NE(error_of<SelfCrossing>(twice), nullptr);
    }
  }
  EXPECT_GT(concave, 450);
}

TEST(TriangulateTest, BentQuadIsCutAlongItsShorterDiagonal) {
  const std::vector<Vec3> bent{{0, 0, 0}, {3, 0, 0}, {5, 5, 1}, {0, 3, 0}};
  const auto pieces = Polygon::triangulated(bent);
  ASSERT_TRUE(pieces.has_value());
  ASSERT_EQ(pieces->size(), 2U);
  for (const Polygon& p : *pieces) {
    EXPECT_TRUE(std::ranges::find(p.corners(), bent[1]) != p.corners().end());
    EXPECT_TRUE(std::ranges::find(p.corners(), bent[3]) != p.corners().end());
  }
}

TEST(TriangulateTest, CombsWithFlatCornersAreCutWithoutFlatTriangles) {
  for (int teeth = 1; teeth < 30; ++teeth) {
    std::vector<Vec3> comb;
    for (int i = 0; i <= 2 * teeth; ++i)
      comb.push_back({static_cast<double>(i), 0, 0});  // flat corners all along the back
    for (int i = 2 * teeth; i >= 0; --i) comb.push_back({static_cast<double>(i), i % 2 == 0 ? 3.0 : 1.0, 0});
    const auto triangles = triangulate(comb);
    ASSERT_TRUE(triangles.has_value());
    EXPECT_EQ(triangles->size(), comb.size() - 2);
    double sum = 0;
    for (const auto& [a, b, c] : *triangles) {
      const double area = cross(comb[b] - comb[a], comb[c] - comb[a]).z / 2;
      EXPECT_GT(area, 0);
      sum += area;
    }
    EXPECT_DOUBLE_EQ(sum, 4.0 * teeth);
  }
}

TEST(TriangulateTest, NumbersAreThoseOfTheGivenCorners) {
  const std::vector<Vec3> repeated{{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}};
  const auto triangles = triangulate(repeated);
  ASSERT_TRUE(triangles.has_value());
  ASSERT_EQ(triangles->size(), 1U);
  const auto [a, b, c] = triangles->front();
  EXPECT_EQ(cross(repeated[b] - repeated[a], repeated[c] - repeated[a]).z, 1);
}

}  // namespace
}  // namespace cleave::geometry
