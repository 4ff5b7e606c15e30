#include "clash.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <queue>
#include <vector>

#include "cleave/core/rng.hpp"
#include "scenes.hpp"
#include "trials.hpp"

namespace cleave::dbem {
namespace {

using scenes::rectangle;
using Ring = std::vector<Vec2>;

/// How far inside a ring a point lies, negative: outside.
double depth_in(const Ring& ring, Vec2 p) {
  double nearest = std::numeric_limits<double>::infinity();
  bool in = false;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 a = ring[k], b = ring[(k + 1) % ring.size()], d = b - a;
    const double t = std::clamp(dot(p - a, d) / dot(d, d), 0.0, 1.0);
    nearest = std::min(nearest, norm(p - a - t * d));
    if ((a.y <= p.y) != (b.y <= p.y)) in ^= (cross(d, p - a) > 0) == (b.y > a.y);
  }
  return in ? nearest : -nearest;
}

/// Radius of the largest disc that lies in both rings, to a tenth; 0 when it is below `least`. By halving squares: a
/// square holds no centre of a larger disc than that of its own middle and half its diagonal.
double common_disc(const Ring& a, const Ring& b, double least) {
  const Box2 in_a = box_of(a), in_b = box_of(b);
  const Vec2 low{std::max(in_a.low.x, in_b.low.x), std::max(in_a.low.y, in_b.low.y)};
  const Vec2 high{std::min(in_a.high.x, in_b.high.x), std::min(in_a.high.y, in_b.high.y)};
  if (low.x >= high.x || low.y >= high.y) return 0;
  struct Cell {
    Vec2 middle;
    double half, bound;
    bool operator<(const Cell& other) const { return bound < other.bound; }
  };
  double best = 0;
  std::priority_queue<Cell> cells;
  const auto add = [&](Vec2 middle, double half) {
    const double here = std::min(depth_in(a, middle), depth_in(b, middle));
    best = std::max(best, here);
    cells.push({middle, half, here + half * std::numbers::sqrt2});
  };
  const double half = std::max({(high.x - low.x) / 2, (high.y - low.y) / 2});
  add(0.5 * (low + high), half);
  while (!cells.empty() && cells.top().bound > std::max(1.1 * best, least)) {
    const Cell c = cells.top();
    cells.pop();
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) add(c.middle + c.half * Vec2{x, y}, 0.5 * c.half);
    }
  }
  return best > least ? best : 0;
}

TEST(ClashTest, MeasuresKnownOverlaps) {
  const auto depth = [](const std::vector<Vec2>& a, const std::vector<Vec2>& b, bool convex) {
    return clash_depth({a, box_of(a), convex}, {b, box_of(b), convex}, 1e-12);
  };
  const auto square = rectangle(0, 0, 1, 1);
  for (const double deep : {1e-8, 1e-4, 0.1}) {
    // Beside one another: the whole side; by the outlines the same.
    EXPECT_NEAR(depth(square, rectangle(1 - deep, 0, 1, 1), true), deep, 1e-12);
    EXPECT_NEAR(depth(square, rectangle(1 - deep, 0, 1, 1), false), deep, 0.01 * deep);
    EXPECT_NEAR(depth(square, rectangle(0, 1 - deep, 1, 1), false), deep, 0.01 * deep);
  }
  // A toe that lies on the same line as the side it enters.
  const std::vector<Vec2> toe{{-1, 0}, {0.01, 0}, {-1, 1}};
  EXPECT_GT(depth(toe, square, true), 5e-3);
  EXPECT_GT(depth(toe, square, false), 2e-3);
  // An L around a square touches it on two sides and shares nothing.
  const std::vector<Vec2> ell{{-1, -1}, {2, -1}, {2, 0}, {0, 0}, {0, 2}, {-1, 2}};
  EXPECT_EQ(depth(ell, square, false), 0);
  EXPECT_NEAR(depth(ell, rectangle(-1e-3, 0, 1, 1), false), 1e-3, 1e-5);
  // One on the other.
  EXPECT_GT(depth(square, square, false), 0.1);
  EXPECT_GT(depth(ell, ell, false), 0.1);
  // Bars that cross without a corner inside.
  EXPECT_GT(depth(rectangle(-1, 0.4, 3, 0.2), rectangle(0.4, -1, 0.2, 3), false), 0.0999);  // half as wide
  EXPECT_GT(depth(rectangle(-1, 0.4, 3, 0.2), rectangle(0.4, -1, 0.2, 3), true), 0.1);
}

// A tip in a side, and at the same height a long side that touches elsewhere: the tip's depth was spread over both.
TEST(ClashTest, ATipInsideIsNotLostBesideASideThatTouches) {
  const std::vector<Vec2> block = rectangle(0, 0, 1, 1);
  const std::vector<Vec2> clamp{{-1, 0},    {1e-10, 0}, {1e-10, 1.5}, {1.5, 1.5}, {1.5, 0.6}, {1 - 1e-5, 0.5},
                                {1.5, 0.4}, {1.5, 0},   {2, 0},       {2, 2},     {-1, 2}};
  const double depth = clash_depth({block, box_of(block), true}, {clamp, box_of(clamp), false}, 1e-12);
  EXPECT_GT(depth, 1e-6);
  EXPECT_LT(depth, 1e-5);
}

// A tip between shoulders that have just sunk in: its depth was spread over the whole side.
TEST(ClashTest, ATipInsideIsNotLostInASideThatTouchesBesideIt) {
  const std::vector<Vec2> floor = rectangle(-2, -1, 4, 1);
  for (const double sunk : {-1e-9, 1e-12, 1e-9}) {
    const std::vector<Vec2> tooth{{-1, -sunk}, {-1e-4, -sunk}, {0, -1e-4}, {1e-4, -sunk}, {1, -sunk}, {1, 1}, {-1, 1}};
    for (const double angle : {0.0, 1e-13, 0.3, 1.5707963267948966}) {
      const Ring a = scenes::turned(floor, angle), b = scenes::turned(tooth, angle);
      EXPECT_NEAR(clash_depth({a, box_of(a), true}, {b, box_of(b), false}, 1e-12), 1e-4, 1e-8) << sunk;
    }
  }
}

/// A star about the origin with corners on a lattice.
Ring star(Rng& rng) {
  while (true) {
    const auto n = static_cast<std::size_t>(rng.between(3, 9));
    Ring ring;
    for (std::size_t k = 0; k < n; ++k) {
      const double angle =
          2 * std::numbers::pi * (static_cast<double>(k) + 0.9 * rng.uniform()) / static_cast<double>(n);
      const double radius = 1 + 3 * rng.uniform();
      ring.push_back({std::round(radius * std::cos(angle)), std::round(radius * std::sin(angle))});
    }
    double turned = 0;
    bool forward = true;
    for (std::size_t k = 0; k < n; ++k) {
      const Vec2 p = ring[k], q = ring[(k + 1) % n];
      forward = forward && cross(p, q) > 0;
      turned += std::atan2(cross(p, q), dot(p, q));
    }
    if (forward && std::abs(turned - 2 * std::numbers::pi) < 1e-6) return ring;
  }
}

/// Teeth of unit width on a bar.
Ring comb(Rng& rng) {
  const std::int64_t n = rng.between(2, 5);
  Ring ring{{0, 0}, {static_cast<double>(n), 0}};
  for (std::int64_t k = n - 1, last = 0; k >= 0; --k) {
    const std::int64_t high = rng.between(1, 3);
    const auto x = static_cast<double>(k), y = static_cast<double>(high == last ? high + 1 : high);
    ring.insert(ring.end(), {{x + 1, y}, {x, y}});
    last = static_cast<std::int64_t>(y);
  }
  return ring;
}

Ring moved(Ring ring, double angle, Vec2 by) {
  for (Vec2& p : ring) p = rotated(p, angle) + by;
  return ring;
}

// Stars and combs, their sides parallel or nearly so, a corner of one put on a corner of the other and then pushed. A
// disc that fits into both tells how deep they overlap: the check may not say less. Nor may it say anything of bodies
// that do not overlap, here pushed apart along a line that has one on each side.
TEST(ClashTest, SaysNoLessThanADiscThatFitsIntoBoth) {
  Rng rng{618};
  const std::array tilts{0.0, 0.0, 1e-13, 1e-10, 1e-7, 1e-4, 1e-3, 1e-2, -1e-13, -1e-10, -1e-4, -1e-2};
  int deep = 0, shallow = 0;
  for (int trial = 0; trial < testing::trials(6000, 300); ++trial) {
    SCOPED_TRACE(trial);
    const auto quarter = [&] { return static_cast<double>(rng.between(0, 3)) * std::numbers::pi / 2; };
    const auto any = [&](std::size_t n) { return static_cast<std::size_t>(rng.between(0, static_cast<int>(n) - 1)); };
    const double common = rng.uniform() < 0.5 ? 0 : std::numbers::pi * rng.uniform();
    const auto shape = [&] {
      return moved(rng.uniform() < 0.5 ? star(rng) : comb(rng), common + quarter() + tilts[any(tilts.size())], {});
    };
    const Ring a = shape();
    Ring b = shape();
    const double push = std::pow(10, -0.5 - 3 * rng.uniform());
    const double direction = rng.uniform() < 0.5 ? common + quarter() : 2 * std::numbers::pi * rng.uniform();
    b = moved(b, 0, a[any(a.size())] - b[any(b.size())] + push * Vec2{std::cos(direction), std::sin(direction)});
    const double disc = common_disc(a, b, 1e-4);
    const Solid in_a{a, box_of(a), false}, in_b{b, box_of(b), false};
    const double depth = clash_depth(in_a, in_b, 1e-12);
    EXPECT_GE(depth, 0.25 * disc);
    EXPECT_GE(clash_depth(in_b, in_a, 1e-12), 0.25 * disc);
    deep += disc > 0 ? 1 : 0;
    shallow += disc > 0 && disc < 1e-2 ? 1 : 0;
    double left = std::numeric_limits<double>::infinity();
    for (const Vec2 p : b) left = std::min(left, rotated(p, -common).x);
    double right = -std::numeric_limits<double>::infinity();
    for (const Vec2 p : a) right = std::max(right, rotated(p, -common).x);
    const Ring apart = moved(b, 0, (right - left) * Vec2{std::cos(common), std::sin(common)});
    EXPECT_LT(clash_depth(in_a, {apart, box_of(apart), false}, 1e-12), 1e-12);
  }
  EXPECT_GT(deep, testing::trials(4000, 200));
  EXPECT_GT(shallow, testing::trials(500, 10));
}

TEST(ClashTest, TheSweepFindsThePairsOfBruteForceAsBodiesMove) {
  Rng rng{5};
  std::vector<Box2> boxes(80);
  std::vector<std::uint8_t> idle(boxes.size());
  for (std::uint8_t& i : idle) i = rng.uniform() < 0.3 ? 1 : 0;
  for (Box2& box : boxes) {
    box.low = {10 * rng.uniform(), 15 * rng.uniform()};
    box.high = box.low + Vec2{2 * rng.uniform(), 2 * rng.uniform()};
  }
  Sweep sweep;
  for (int round = 0; round < 30; ++round) {
    std::vector<BodyPair> expected;
    for (std::uint32_t a = 0; a < boxes.size(); ++a) {
      for (std::uint32_t b = a + 1; b < boxes.size(); ++b) {
        const bool meet = boxes[a].low.x < boxes[b].high.x && boxes[b].low.x < boxes[a].high.x &&
                          boxes[a].low.y < boxes[b].high.y && boxes[b].low.y < boxes[a].high.y;
        if (meet && !(idle[a] != 0 && idle[b] != 0)) expected.push_back({a, b});
      }
    }
    EXPECT_EQ(sweep.pairs(boxes, idle), expected);
    for (Box2& box : boxes) {
      const Vec2 by{rng.uniform() - 0.5, rng.uniform() - 0.5};
      box.low += by;
      box.high += by;
    }
  }
}

}  // namespace
}  // namespace cleave::dbem
