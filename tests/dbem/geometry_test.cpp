#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "cleave/core/rng.hpp"
#include "contact_candidate.hpp"
#include "scenes.hpp"

namespace cleave::dbem {
namespace {

using namespace scenes;
using std::numbers::pi;

Vec2 at_angle(double a) { return {std::cos(a), std::sin(a)}; }

/// Whether two wedges with corners at p and q share inner points, by brute force: a separating line exists iff one
/// along an edge of either does (both are convex).
bool wedges_overlap(const Wedge& i, Vec2 p, const Wedge& j, Vec2 q) {
  const auto separates = [](const Wedge& own, Vec2 corner, const Wedge& other, Vec2 there) {
    for (const Vec2 inward : {turned_left(own.out), turned_right(own.back)}) {
      if (dot(inward, other.out) <= 1e-12 && dot(inward, other.back) <= 1e-12 && dot(inward, there - corner) <= 0) {
        return true;
      }
    }
    return false;
  };
  return !separates(i, p, j, q) && !separates(j, q, i, p);
}

TEST(EntranceLinesTest, AreTheBoundaryOfTheForbiddenCone) {
  Rng rng{7};
  std::size_t entered = 0;
  for (int k = 0; k < 20000; ++k) {
    const double alpha = 0.1 + (pi - 0.2) * rng.uniform();
    const double beta = 0.1 + (pi - 0.2) * rng.uniform();
    const double start = 2 * pi * rng.uniform();
    const double between = (2 * pi - alpha - beta) * rng.uniform();
    const Wedge i{at_angle(start), at_angle(start + alpha)};
    const Wedge j{at_angle(start + alpha + between), at_angle(start + alpha + between + beta)};
    const EntranceLines lines = entrance_lines(i, j);
    const Vec2 d = at_angle(2 * pi * rng.uniform());
    const double first = dot(lines.first, d);
    const double last = dot(lines.last, d);
    if (std::min(std::abs(first), std::abs(last)) < 1e-6) continue;
    const bool in = first < 0 && last < 0;
    entered += in ? 1 : 0;
    ASSERT_EQ(in, wedges_overlap(i, d, j, {0, 0})) << k;
  }
  EXPECT_GT(entered, 4000U);
}

Placed placed(std::uint32_t body, const std::vector<Vec2>& corners, const std::vector<std::uint8_t>& sharp) {
  return {body, corners, sharp, box_of(corners), std::ranges::count(sharp, 0) == 0};
}

std::vector<ContactCandidate> touches_of(const std::vector<Vec2>& a, const std::vector<Vec2>& b,
                                         std::vector<std::uint8_t> sharp_b = {}) {
  const std::vector<std::uint8_t> sharp_a(a.size(), 1);
  if (sharp_b.empty()) sharp_b.assign(b.size(), 1);
  std::vector<ContactCandidate> out;
  std::vector<CornerChoice> choices;
  find_candidates(placed(0, a, sharp_a), placed(1, b, sharp_b), {1e-3, 0.1, 1e-5, 1e-5, 1e-9}, {}, out, choices);
  return out;
}

TEST(TouchTest, FaceOnFaceGivesTheEndsOfTheCommonInterval) {
  const auto floor = rectangle(-5, -1, 10, 1);
  for (const double shift : {0.0, 0.3, 5.3, -5.2}) {  // inside, inside, over the end, over the other end
    const std::vector<ContactCandidate> t = touches_of(rectangle(shift - 0.5, 0, 1, 1), floor);
    ASSERT_EQ(t.size(), 2U) << shift;
    std::set<double> ends;
    for (const ContactCandidate& touch : t) {
      EXPECT_NEAR(touch.gap, 0, 1e-15);
      EXPECT_NEAR(std::abs(touch.normal.y), 1, 1e-15);
      EXPECT_EQ(touch.normal.y > 0, touch.i == 0U);  // out of the body of the edge
      ends.insert(touch.point.x);
    }
    EXPECT_NEAR(*ends.begin(), std::max(-5.0, shift - 0.5), 1e-15);
    EXPECT_NEAR(*ends.rbegin(), std::min(5.0, shift + 0.5), 1e-15);
  }
}

TEST(TouchTest, EqualFacesTouchAtTheirTwoCornersOnly) {
  const std::vector<ContactCandidate> t = touches_of(rectangle(0, 1, 1, 1), rectangle(0, 0, 1, 1));
  ASSERT_EQ(t.size(), 2U);
  for (const ContactCandidate& touch : t) EXPECT_NEAR(std::abs(touch.normal.y), 1, 1e-15);
}

TEST(TouchTest, NearlyParallelFacesStillTouchTwice) {
  for (const double turn : {1e-10, 1e-8, 1e-6}) {
    const std::vector<ContactCandidate> t =
        touches_of(turned(rectangle(-0.5, 0, 1, 1), turn), rectangle(-5, -1, 10, 1));
    EXPECT_EQ(t.size(), 2U) << turn;
  }
}

TEST(TouchTest, ACornerInAConcaveCornerIsHeldByBothEdges) {
  // An L: the notch corner at (0, 0).
  const std::vector<Vec2> ell{{-1, -1}, {2, -1}, {2, 0}, {0, 0}, {0, 2}, {-1, 2}};
  std::vector<std::uint8_t> sharp(6, 1);
  sharp[3] = 0;
  const std::vector<ContactCandidate> exactly = touches_of(rectangle(0, 0, 1, 1), ell, sharp);
  const std::vector<ContactCandidate> nearly = touches_of(rectangle(1e-4, 2e-4, 1, 1), ell, sharp);
  for (const auto* t : {&exactly, &nearly}) {
    std::size_t up = 0, right = 0;
    for (const ContactCandidate& touch : *t) {
      const Vec2 n = touch.i == 0 ? touch.normal : -touch.normal;
      up += n.y > 0.999 ? 1U : 0U;
      right += n.x > 0.999 ? 1U : 0U;
    }
    EXPECT_EQ(up, 2U);
    EXPECT_EQ(right, 2U);
    EXPECT_EQ(t->size(), 4U);
  }
  // The concave corner itself touches nothing.
  for (const ContactCandidate& touch : exactly) EXPECT_FALSE(touch.i == 1 && touch.vertex == 3);
}

TEST(TouchTest, CornersApartChooseTheLineTheyMissLess) {
  // Corner of a square above and left of the corner of another by nearly nothing.
  const std::vector<ContactCandidate> t = touches_of(rectangle(-1 + 2e-6, 1e-6, 1, 1), rectangle(0, -1, 1, 1));
  ASSERT_EQ(t.size(), 1U);
  EXPECT_NEAR(std::abs(t[0].normal.y), 1, 1e-12);
  EXPECT_NEAR(t[0].gap, 1e-6, 1e-12);
}

// A tip that has slid off another one lies behind the line of its far side, and was pushed back from there where the
// side it slid along was out of reach: it lost its speed again and again.
TEST(TouchTest, ATipThatHasPassedAnotherIsBehindNoneOfItsLines) {
  const std::vector<Vec2> house{{-0.5, 0}, {0.5, 0}, {0.5, 1}, {0, 2}, {-0.5, 1}};
  const std::vector<std::uint8_t> three(3, 1), five(5, 1);
  int near_one = 0;
  for (double off = 1e-8; off < 0.1; off *= 1.05) {
    const std::vector<Vec2> tip{{off, 2 - off}, {off + 0.5, 2.5 - off}, {off - 0.5, 2.5 - off}};
    std::vector<ContactCandidate> found;
    std::vector<CornerChoice> choices;
    find_candidates(placed(0, tip, three), placed(1, house, five), {1e-6, 0.1, 5e-6, 5e-6, 1e-9}, {}, found, choices);
    for (const ContactCandidate& touch : found) EXPECT_GT(touch.gap, -1e-9) << off;
    near_one += found.empty() ? 0 : 1;
  }
  EXPECT_GT(near_one, 100);
}

TEST(CrossingTest, FindsTheEdgeAPointComesThrough) {
  const auto square = rectangle(0, 0, 1, 1);
  EXPECT_EQ(first_crossing(square, square, {0.5, -1}, {0.5, 0.5}), 0U);
  EXPECT_EQ(first_crossing(square, square, {2, 0.5}, {0.5, 0.5}), 1U);
  EXPECT_EQ(first_crossing(square, square, {-1, 0.2}, {3, 0.3}), 3U);  // right through
  EXPECT_EQ(first_crossing(square, square, {-1, -1}, {-0.5, 3}), std::nullopt);
}

TEST(OverlapTest, SeesEveryKindOfOverlap) {
  const auto depth = [](const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
    const std::vector<std::uint8_t> sa(a.size(), 1), sb(b.size(), 1);
    return overlap(placed(0, a, sa), placed(1, b, sb), 1e-9).depth;
  };
  const auto square = rectangle(0, 0, 1, 1);
  EXPECT_NEAR(depth(square, rectangle(0.9, 0.2, 1, 0.5)), 0.1, 1e-12);
  EXPECT_GT(depth(rectangle(-1, 0.4, 3, 0.2), rectangle(0.4, -1, 0.2, 3)), 0.05);  // a cross: no corner inside
  EXPECT_GT(depth(square, square), 0.1);
  EXPECT_GT(depth(square, rectangle(0.25, 0.25, 0.5, 0.5)), 0.1);
  EXPECT_EQ(depth(square, rectangle(1, 0, 1, 1)), 0);
  EXPECT_EQ(depth(square, rectangle(1, 1, 1, 1)), 0);
  EXPECT_EQ(depth(square, rectangle(3, 0, 1, 1)), 0);
}

TEST(BroadPhaseTest, FindsThePairsOfBruteForce) {
  Rng rng{11};
  for (int round = 0; round < 20; ++round) {
    std::vector<Box2> boxes;
    for (int k = 0; k < 120; ++k) {
      const Vec2 low{20 * rng.uniform(), 20 * rng.uniform()};
      const double size = k % 40 == 0 ? 15 * rng.uniform() : 0.2 + 1.5 * rng.uniform();
      boxes.push_back({low, low + Vec2{size, size * rng.uniform()}});
    }
    std::vector<std::uint8_t> idle(boxes.size());
    for (std::uint8_t& i : idle) i = rng.uniform() < 0.3 ? 1 : 0;
    std::vector<BodyPair> expected;
    for (std::uint32_t a = 0; a < boxes.size(); ++a) {
      for (std::uint32_t b = a + 1; b < boxes.size(); ++b) {
        const bool meet = boxes[a].low.x <= boxes[b].high.x && boxes[b].low.x <= boxes[a].high.x &&
                          boxes[a].low.y <= boxes[b].high.y && boxes[b].low.y <= boxes[a].high.y;
        if (meet && !(idle[a] != 0 && idle[b] != 0)) expected.push_back({a, b});
      }
    }
    EXPECT_EQ(overlapping_pairs(boxes, idle), expected);
  }
}

TEST(SpeedTest, NothingPassesThroughAThinWall) {
  // A small fast block at a thin plate; angles, speeds and places at random. It must never be on the other side.
  Rng rng{3};
  std::size_t hits = 0;
  for (int k = 0; k < 60; ++k) {
    const double speed = std::pow(10.0, 1 + 3 * rng.uniform());  // up to 10 km/s
    std::vector<Body> bodies{fixed("plate", rectangle(0, -5, 0.02, 10)),
                             block("shot", turned(rectangle(-0.05, -0.05, 0.1, 0.1), rng.uniform() * pi))};
    bodies[1].origin = {-1 - rng.uniform(), 2 * rng.uniform() - 1};
    bodies[1].velocity = {speed, speed * (rng.uniform() - 0.5)};
    bodies[1].spin = 20 * (rng.uniform() - 0.5);
    auto world = World::make(bodies, law(0.3, 0.5), {.gravity = {0, 0}, .step = 1e-2});
    ASSERT_TRUE(world.has_value());
    for (int s = 0; s < 400 && world->time() < 6 / speed; ++s) {
      const auto report = world->step(6 / speed);
      ASSERT_TRUE(report.has_value()) << describe(report.error());
      ASSERT_LT(world->centroid(1).x, 0.0) << "shot " << k << " speed " << speed;
    }
    hits += world->velocity(1).x < 0 ? 1U : 0U;
  }
  EXPECT_GT(hits, 50U);
}

TEST(SpeedTest, CornersFlyingAtCornersMeet) {
  // Two free squares corner to corner: a diagonal approach where no corner has its foot on an edge of the other.
  for (const double offset : {0.0, 1e-7, 1e-3, 0.05, -0.02}) {
    std::vector<Body> bodies{block("a", rectangle(-1, -1, 1, 1)), block("b", rectangle(0.3, 0.3 + offset, 1, 1))};
    bodies[0].velocity = {50, 50};
    auto world = World::make(bodies, law(0, 1), {.gravity = {0, 0}, .step = 1e-2});
    ASSERT_TRUE(world.has_value());
    while (world->time() < 0.1) {
      const auto report = world->step();
      ASSERT_TRUE(report.has_value());
      const auto a = world->outline(0);
      const auto b = world->outline(1);
      for (const Vec2 c : a) EXPECT_FALSE(inside(b, c) && c.x > b[0].x + 1e-6 && c.y > b[0].y + 1e-6);
    }
    EXPECT_GT(norm(world->velocity(1)), 1.0) << offset;
  }
}

}  // namespace
}  // namespace cleave::dbem
