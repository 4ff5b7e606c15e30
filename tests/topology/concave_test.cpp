#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "cleave/core/rng.hpp"
#include "cleave/geometry/triangulate.hpp"
#include "complexes.hpp"

// Polygons that are not convex are cut in convex pieces: what comes out does not tell which, and costs no more than the
// corners ask for.

namespace cleave::testing {
namespace {

using Outline = std::vector<std::array<double, 2>>;

/// Whole numbers, so that the plane z = x / 2 - y / 4, and those with axes changed, hold the corners exactly.
Vec3 onto_plane(std::array<double, 2> p, std::size_t axis) {
  const double z = p[0] / 2 - p[1] / 4;
  return axis == 0 ? Vec3{z, p[0], p[1]} : axis == 1 ? Vec3{p[1], z, p[0]} : Vec3{p[0], p[1], z};
}
topology::Joint whole(const Outline& outline, std::size_t axis) {
  std::vector<Vec3> corners;
  for (const auto& p : outline) corners.push_back(onto_plane(p, axis));
  return joint(std::move(corners));
}
topology::Joint as_triangles(const Outline& outline, std::size_t axis) {
  std::vector<Vec3> corners;
  for (const auto& p : outline) corners.push_back(onto_plane(p, axis));
  topology::Joint out;
  const auto triangles = geometry::triangulate(corners).value();
  for (const auto& [a, b, c] : triangles) {
    out.polygons.push_back(geometry::Polygon::make({corners[a], corners[b], corners[c]}).value());
  }
  return out;
}

/// Star-shaped about (0, 0), on whole numbers up to 64; corners on one level are common.
Outline star(Rng& rng, std::size_t count) {
  for (;;) {
    Outline out;
    for (std::size_t i = 0; i < count; ++i) {
      const double angle =
          2 * std::numbers::pi * (static_cast<double>(i) + 0.4 * rng.uniform()) / static_cast<double>(count);
      const double radius = 12 + 52 * rng.uniform();
      out.push_back({std::nearbyint(radius * std::cos(angle)), std::nearbyint(radius * std::sin(angle))});
    }
    std::vector<Vec3> corners;
    for (const auto& p : out) corners.push_back(onto_plane(p, 2));
    if (geometry::Polygon::make(corners)) return out;
  }
}
/// Teeth from a bar, with flanks that lean or stand, feet on one level or on several.
Outline comb(std::size_t teeth, bool upright, bool level, bool across) {
  Outline out{{0, 0}, {static_cast<double>(8 * teeth), 0}};
  for (std::size_t i = teeth; i-- > 0;) {
    const auto x = static_cast<double>(8 * i), low = level ? 8 : 8 + static_cast<double>(i * 7 % 5);
    out.push_back({x + 8, low});
    if (upright) out.push_back({x + 8, 64});
    out.push_back({x + 4, 64});
    if (upright) out.push_back({x + 4, low});
  }
  out.push_back({0, 4});
  for (auto& [x, y] : out) {
    x -= static_cast<double>(4 * teeth);
    y -= 32;
    if (across) x = std::exchange(y, -x);
  }
  return out;
}

topology::CutInput crossed(const topology::Joint& first, const topology::Joint& second) {
  auto input = scene(box({-70, -70, -70}, {70, 70, 70}), {first, second});
  const auto plane = [&](Vec3 through, Vec3 normal) {
    input.joints.emplace_back(topology::PersistentJoint{through, normal});
  };
  plane({1, 2, 3}, {1, 0.25, 0});
  plane({-9, 4, 1}, {0.1, 1, 0.2});
  plane({5, -7, 2}, {0.2, -0.3, 1});
  plane({-25, 0, 0}, {1, 0, 0});
  plane({0, 17, 0}, {0, 1, 0.5});
  plane({0, 0, 9}, {0, 0, 1});
  return input;
}
void expect_same(const Outline& first, const Outline& second) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto input = crossed(whole(first, axis), whole(second, (axis + 1) % 3));
    const auto triangles = crossed(as_triangles(first, axis), as_triangles(second, (axis + 1) % 3));
    const auto one = certified(input), other = certified(triangles);
    EXPECT_EQ(canonical_hash(one.complex()), canonical_hash(other.complex())) << "axis " << axis;
  }
}

TEST(ConcavePieces, BlocksAreThoseOfTriangles) {
  Rng rng{17};
  for (int k = 0; k < 40; ++k) expect_same(star(rng, 5 + static_cast<std::size_t>(k)), star(rng, 9));
}

TEST(ConcavePieces, CornersOnOneLevel) {
  for (const bool upright : {false, true}) {
    for (const bool level : {false, true}) {
      for (const bool across : {false, true})
        expect_same(comb(9, upright, level, across), comb(5, upright, !level, !across));
    }
  }
}

TEST(ConcavePieces, HolesInAConcavePolygon) {
  const auto square = [](double x, double y, double r, std::size_t axis) {
    const Outline o{{x - r, y - r}, {x + r, y - r}, {x + r, y + r}, {x - r, y + r}};
    return whole(o, axis).polygons[0];
  };
  // A cross with a hole in each arm, and one in the middle; each plugged: as if there were none.
  const Outline cross{{-60, -20}, {-20, -20}, {-20, -60}, {20, -60}, {20, -20}, {60, -20},
                      {60, 20},   {20, 20},   {20, 60},   {-20, 60}, {-20, 20}, {-60, 20}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto open = whole(cross, axis);
    open.holes.emplace_back();
    for (const auto& [x, y] : {std::pair{-40, 0}, {40, 0}, {0, 40}, {0, -40}, {0, 0}}) {
      open.holes[0].push_back(square(x, y, 8, axis));
    }
    auto input = crossed(open, whole(cross, (axis + 1) % 3));
    for (const auto& hole : open.holes[0]) input.joints.emplace_back(topology::Joint{{hole}});
    EXPECT_EQ(hash_of(input), hash_of(crossed(whole(cross, axis), whole(cross, (axis + 1) % 3))));
  }
}

/// Signs asked for, a measure of the work that does not depend on the machine.
std::uint64_t work(std::size_t teeth, bool upright) {
  const auto outline = comb(teeth, upright, true, false);
  auto input = scene(box({-40000, -40000, -40000}, {40000, 40000, 40000}), {whole(outline, 2)});
  for (const double x : {-9.5, 9.5}) input.joints.emplace_back(topology::PersistentJoint{{x, 0, 0}, {1, 0, 0}});
  return certified(input).complex().report().predicate_calls;
}

TEST(ConcavePieces, WorkGrowsWithTheCorners) {
  for (const bool upright : {false, true}) EXPECT_LT(work(1000, upright), 6 * work(250, upright));
}

// A star in a turned plane is flat to a rounding only, so it is cut in triangles. No corner may have many of them:
// their planes nearly coincide, and the cube of those in one corner meet there.
TEST(ConcavePieces, APrismOverAFoldedStar) {
  const Vec3 w = geometry::normalized({0.3, 0.5, 1}), u = geometry::normalized(cross(w, Vec3{0.2, 1, 0}));
  const Vec3 v = cross(w, u);
  for (const std::size_t count : {100U, 402U, 1602U}) {
    std::vector<Vec3> low, high;
    double area = 0;
    const double step = 2 * std::numbers::pi / static_cast<double>(count);
    for (std::size_t i = 0; i < count; ++i) {
      const double a = step * static_cast<double>(i), r = i % 2 == 0 ? 5 : 3;
      const Vec3 corner = r * std::cos(a) * u + r * std::sin(a) * v;
      low.push_back(corner - 2 * w);
      high.push_back(corner + 2 * w);
      area += 0.5 * 5 * 3 * std::sin(step);
    }
    auto input = scene(box({-8, -8, -8}, {8, 8, 8}), {joint(low), joint(high)});
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t j = (i + 1) % count;
      input.joints.emplace_back(joint({low[i], low[j], high[j], high[i]}));
    }
    const auto audited = certified(input);
    ASSERT_EQ(audited.complex().blocks().size(), 2U);
    EXPECT_NEAR(volumes(audited.complex())[0], 4 * area, 1e-9);
    ASSERT_LT(audited.complex().report().predicate_calls, 3000 * count);
  }
}

}  // namespace
}  // namespace cleave::testing
