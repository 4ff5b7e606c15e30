#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

#include "elastic_body.hpp"
#include "scenes.hpp"

// Bolts between bodies: closed forms of blocks that hang, slide and tear.
namespace cleave::dbem::tie_test {
namespace {

using namespace scenes;
using support::elastic_body;

constexpr double endless = std::numeric_limits<double>::infinity();

Tie tie(std::size_t first, std::size_t second, Vec2 at_first, Vec2 at_second, double stiffness,
        double capacity = endless, double ductility = 0) {
  return {.name = "bolt",
          .first = first,
          .second = second,
          .at_first = at_first,
          .at_second = at_second,
          .stiffness = pascals(stiffness),
          .capacity = newtons_per_metre(capacity),
          .ductility = Length::from_si(ductility)};
}

World made(std::vector<Body> bodies, Laws laws, WorldOptions options, std::vector<Tie> ties) {
  auto world = World::make(std::move(bodies), std::move(laws), std::move(options), std::move(ties));
  if (!world) throw std::runtime_error(describe(world.error()));
  return *std::move(world);
}

/// Body 0 above, body 1 of 1 x 1 m below it.
std::vector<Body> hanging() {
  return {fixed("roof", rectangle(-2, 3, 4, 1)), block("block", rectangle(-0.5, 0, 1, 1))};
}
constexpr double weight = 2600 * g;

/// Of what came in and what there is; relative.
double out_of_balance(const World& world, double start) {
  const Energy& e = world.energy();
  return std::abs(e.total() + e.friction + e.yielded + e.lost - e.work - e.projected - start) / weight;
}

TEST(TieTest, AHangingBlockStretchesItsBoltByItsWeight) {
  for (const double stiffness : {1e6, 1e8, 1e10}) {
    World world =
        made(hanging(), law(0.5), {.step = 0.05, .quasi_static = true}, {tie(0, 1, {0, 3}, {0, 1}, stiffness)});
    const auto done = relax(world, {.step = 0.05, .criterion = 1e-11});
    ASSERT_TRUE(done.has_value());
    ASSERT_TRUE(done->at_rest);
    EXPECT_NEAR(-world.displacement(1).y * stiffness / weight, 1, 1e-6);
    EXPECT_NEAR(world.ties()[0].force.si() / weight, 1, 1e-8);
    EXPECT_NEAR(world.energy().elastic / (0.5 * weight * weight / stiffness), 1, 1e-6);
  }
}

TEST(TieTest, ItSwingsWithThePeriodOfItsSpringAndLosesNothingToTheBolt) {
  const double stiffness = 2e6, omega = std::sqrt(stiffness / 2600), step = 1e-5;
  World world = made(hanging(), law(0), {.step = step, .sleep = false}, {tie(0, 1, {0, 3}, {0, 1}, stiffness)});
  const double start = world.energy().total();
  double lowest = 0;
  while (world.time() < std::numbers::pi / omega) {
    ASSERT_TRUE(world.step().has_value());
    const double exact = weight / stiffness * (1 - std::cos(omega * world.time()));
    ASSERT_NEAR(-world.displacement(1).y, exact, 2e-3 * weight / stiffness) << world.time();
    lowest = std::min(lowest, world.displacement(1).y);
    ASSERT_LT(out_of_balance(world, start), 1e-12);
  }
  EXPECT_NEAR(-lowest * stiffness / weight, 2, 1e-3);
  EXPECT_LT(std::abs(world.energy().lost), 2e-3 * weight * weight / stiffness);
  // Thrown up the bolt is slack: it does not push.
  World thrown = made(hanging(), law(0), {.step = 1e-3}, {tie(0, 1, {0, 3}, {0, 1}, 1e8)});
  ASSERT_TRUE(thrown.set_velocity(1, {0, 2}, 0).has_value());
  run(thrown, 0.3);
  EXPECT_NEAR(thrown.displacement(1).y, 2 * 0.3 - 0.5 * g * 0.09, 1e-9);
  EXPECT_EQ(thrown.ties()[0].force.si(), 0);
}

TEST(TieTest, TwoBoltsAtAnAngleShareTheWeight) {
  const double angle = radians(35), l = 2;
  World world = made(hanging(), law(0.5), {.step = 0.05, .quasi_static = true},
                     {tie(0, 1, {-0.5 - l * std::tan(angle), 3}, {-0.5, 1}, 1e10),
                      tie(1, 0, {0.5, 1}, {0.5 + l * std::tan(angle), 3}, 1e10)});
  const auto done = relax(world, {.step = 0.05, .criterion = 1e-11});
  ASSERT_TRUE(done.has_value());
  EXPECT_TRUE(done->at_rest);
  for (const TieState& bar : world.ties()) EXPECT_NEAR(bar.force.si() / (weight / (2 * std::cos(angle))), 1, 1e-5);
}

/// A block of 1 x 0.5 m on a slope, held by a bolt that goes up from it at `beta` over the slope's surface, so long
/// that it hardly turns; body 2 is where it is fixed.
struct Held {
  std::vector<Body> bodies;
  std::vector<Tie> ties;
  double needed;  // N/m, of the bolt
};
Held held_on_slope(double alpha, double phi, double beta, double share, double ductility) {
  Held out{.bodies = slider(alpha), .ties = {}, .needed = 0};
  const double far = 200, w = 0.5 * weight;
  const Vec2 up = rotated({1, 0}, alpha + beta);
  const Vec2 from = rotated({5.5, 0.25}, alpha), to = from + far * up;
  out.bodies.push_back(fixed("far", {to, to + Vec2{1, 0}, to + Vec2{1, 1}}));
  // Along: T cos b + tan phi (W cos a - T sin b) = W sin a.
  out.needed =
      w * (std::sin(alpha) - std::cos(alpha) * std::tan(phi)) / (std::cos(beta) - std::sin(beta) * std::tan(phi));
  out.ties.push_back(tie(1, 2, from, to, 1e11, share * out.needed, ductility));
  return out;
}

TEST(TieTest, ABlockOnASlopeIsHeldByWhatStaticsAsksFor) {
  const double alpha = radians(40), phi = radians(25);
  for (const double beta : {-0.5, 0.0, 0.4}) {
    for (const double share : {1.01, 0.99}) {
      const Held scene = held_on_slope(alpha, phi, beta, share, 0);
      // From rest to rest: a bolt that is loaded at once would swing to twice the force.
      World world = made(scene.bodies, law(std::tan(phi)), {.step = 0.01, .quasi_static = true}, scene.ties);
      const auto done = relax(world, {.step = 0.01, .criterion = 1e-9, .most = 200});
      ASSERT_TRUE(done.has_value());
      EXPECT_EQ(done->at_rest, share > 1) << beta;
      EXPECT_EQ(world.ties()[0].broken, share < 1) << beta;
      if (share > 1) {
        EXPECT_NEAR(world.ties()[0].force.si() / scene.needed, 1, 1e-3) << beta;
      }
    }
  }
}

TEST(TieTest, AYieldingBoltSlowsTheBlockByItsCapacity) {
  const double alpha = radians(40), phi = radians(25), beta = 0.3, share = 0.8;
  const Held scene = held_on_slope(alpha, phi, beta, share, endless);
  World world = made(scene.bodies, law(std::tan(phi)), {.step = 1e-3}, scene.ties);
  const double start = world.energy().total();
  run(world, 0.5);
  const double pull = std::cos(beta) - std::sin(beta) * std::tan(phi);
  const double a = (1 - share) * scene.needed * pull / (0.5 * 2600);
  EXPECT_NEAR(norm(world.displacement(1)) / (0.5 * a * 0.25), 1, 0.01);
  const TieState bar = world.ties()[0];
  EXPECT_FALSE(bar.broken);
  EXPECT_TRUE(bar.yielding);
  EXPECT_NEAR(bar.force.si() / (share * scene.needed), 1, 1e-12);
  EXPECT_NEAR(bar.plastic.si() / (norm(world.displacement(1)) * std::cos(beta)), 1, 0.01);
  const Energy& e = world.energy();
  EXPECT_NEAR(e.yielded / (bar.force.si() * bar.plastic.si()), 1, 1e-9);
  EXPECT_LT(out_of_balance(world, start), 1e-9);
  EXPECT_NEAR(e.kinetic + e.potential + e.friction + e.yielded + e.elastic - start, 0, 0.01 * e.yielded);
  // It breaks where it has lengthened by what it can.
  const Held brittle = held_on_slope(alpha, phi, beta, share, 0.01);
  World other = made(brittle.bodies, law(std::tan(phi)), {.step = 1e-3}, brittle.ties);
  while (!other.ties()[0].broken) ASSERT_TRUE(other.step().has_value());
  EXPECT_NEAR(other.ties()[0].plastic.si(), 0.01, 2e-4);
  EXPECT_EQ(other.ties()[0].force.si(), 0);
}

TEST(TieTest, WhatYieldedHoldsAgainAfterItIsLoadedLess) {
  // Pulled past its capacity and let go: the bar keeps what it was lengthened by, and springs back by force over
  // stiffness.
  std::vector<Body> bodies = hanging();
  const double stiffness = 1e7, capacity = 1.5 * weight;
  bodies[1].forces.push_back(
      {.at = {0, 0}, .force = {0, -weight}, .factor = [](double t) { return t < 0.1 ? 1.0 : 0.0; }});
  World world = made(bodies, law(0), {.step = 5e-4, .mass_damping = 30},
                     {tie(0, 1, {0, 3}, {0, 1}, stiffness, capacity, endless)});
  run(world, 2.5);
  const TieState bar = world.ties()[0];
  EXPECT_GT(bar.plastic.si(), 1e-3);
  EXPECT_FALSE(bar.yielding);
  EXPECT_NEAR(bar.force.si() / weight, 1, 1e-4);
  EXPECT_NEAR(-world.displacement(1).y, weight / stiffness + bar.plastic.si(), 1e-6);
}

TEST(TieTest, PretensionPressesAJointAndLaterBoltsStopWhatMoves) {
  // Through a block into its floor.
  const double tension = 3 * weight;
  std::vector<Tie> ties{tie(1, 0, {0, 1}, {0, -0.5}, 1e9)};
  ties[0].pretension = newtons_per_metre(tension);
  World world = made(stack(1), law(0.5), {.step = 0.05, .quasi_static = true}, ties);
  const auto done = relax(world, {.step = 0.05, .criterion = 1e-10});
  ASSERT_TRUE(done.has_value());
  double pressed = 0;
  for (const Contact& c : world.contacts()) pressed += c.normal_force;
  EXPECT_NEAR(pressed / (weight + tension), 1, 1e-6);
  // From 0.2 s on a bolt holds what slid until then.
  Held scene = held_on_slope(radians(30), radians(10), 0, 1, 0);
  scene.ties[0].capacity = newtons_per_metre(endless);
  scene.ties[0].installed = Time::from_si(0.2);
  World late = made(scene.bodies, law(std::tan(radians(10))), {.step = 3e-3}, scene.ties);
  run(late, 0.2);
  const double a = g * (0.5 - std::cos(radians(30)) * std::tan(radians(10)));
  EXPECT_NEAR(norm(late.displacement(1)), 0.5 * a * 0.04, 1e-8);
  const double kinetic = late.energy().kinetic;
  EXPECT_EQ(late.ties()[0].force.si(), 0);
  run(late, 0.4);
  EXPECT_LT(norm(late.displacement(1)), 0.5 * a * 0.04 + 2 * std::sqrt(2 * kinetic / 1e9) + 1e-3);
}

TEST(TieTest, MomentumAndAngularMomentumAreKept) {
  std::vector<Body> bodies{block("a", rectangle(0, 0, 1, 1)), block("b", rectangle(3, 0.2, 0.5, 2)),
                           elastic_body(rectangle(6, 0, 1, 1), {.young = 1e8}, 2, 8)};
  bodies[0].velocity = {-2, 0.5};
  bodies[1].spin = 0.8;
  World world =
      made(bodies, law(0.3), {.gravity = {}, .step = 1e-3},
           {tie(0, 1, {0.8, 0.7}, {3.1, 0.4}, 1e6, 4e4, 0.5), tie(1, 2, {3.4, 2}, bodies[2].outline[3], 1e6)});
  const Vec2 momentum = world.momentum();
  const double angular = world.angular_momentum();
  bool yielded = false;
  while (world.time() < 0.8) {
    ASSERT_TRUE(world.step().has_value());
    yielded = yielded || world.ties()[0].yielding;
  }
  EXPECT_TRUE(yielded);
  EXPECT_GT(norm(world.velocity(2)), 0.01);
  EXPECT_LT(norm(world.momentum() - momentum), 1e-11 * norm(momentum));
  EXPECT_NEAR(world.angular_momentum(), angular, 1e-9 * std::abs(angular));
}

TEST(TieTest, AnElasticBlockHangsByItsWeight) {
  Body body = elastic_body(rectangle(-0.5, 0, 1, 1), {.young = 1e8}, 2, 20);
  Vec2 top{};
  for (const Vec2 p : body.outline) {
    if (std::abs(p.x) < 1e-9 && p.y > 0) top = p;
  }
  World world = made({fixed("roof", rectangle(-2, 3, 4, 1)), body}, law(0.5), {.step = 0.05, .quasi_static = true},
                     {tie(0, 1, {0, 3}, top, 1e8)});
  const auto done = relax(world, {.step = 0.05, .criterion = 1e-10});
  ASSERT_TRUE(done.has_value());
  EXPECT_TRUE(done->at_rest);
  EXPECT_NEAR(world.ties()[0].force.si() / weight, 1, 1e-7);
  // Where it is fixed the bar ends at the body as it is bent there.
  EXPECT_NEAR(3 - world.position(1, top).y, 2 + weight / 1e8, 1e-8);
}

TEST(TieTest, ATiedPileSleepsAndANewBoltWakesIt) {
  std::vector<Tie> ties{tie(1, 0, {0.2, 0.5}, {0.2, -0.5}, 1e8), tie(1, 0, {-0.2, 0.5}, {-0.2, -0.5}, 1e8)};
  ties[0].pretension = newtons_per_metre(weight);
  ties[1].pretension = newtons_per_metre(weight);
  ties[1].installed = Time::from_si(0.5);
  World world = made(stack(2), law(0.5), {.step = 5e-3}, ties);
  run(world, 0.5);
  EXPECT_TRUE(world.asleep(1));
  EXPECT_NEAR(world.ties()[0].force.si() / weight, 1, 1e-6);
  const double work = world.energy().work;
  ASSERT_TRUE(world.step().has_value());
  EXPECT_FALSE(world.asleep(1));
  EXPECT_NEAR(world.energy().work - work, 0.5 * weight * weight / 1e8, 1e-6 * weight);
  run(world, 1);
  double pressed = 0;
  for (const Contact& c : world.contacts()) {
    if (c.edge_body == 0 || c.vertex_body == 0) pressed += c.normal_force;
  }
  EXPECT_NEAR(pressed / (4 * weight), 1, 1e-6);
}

TEST(TieTest, WhatIsWrongWithABoltIsSaid) {
  const auto refusal = [](const Tie& wrong) {
    const auto world = World::make(hanging(), law(0.5), {}, {wrong});
    return world ? std::string{"none"} : describe(world.error());
  };
  const Tie good = tie(0, 1, {0, 3}, {0, 1}, 1e8);
  EXPECT_EQ(refusal(good), "none");
  Tie wrong = good;
  wrong.second = 2;
  EXPECT_EQ(refusal(wrong), "bolt 'bolt': names a body that is not there");
  wrong.second = 0;
  EXPECT_EQ(refusal(wrong), "bolt 'bolt': both ends are in one body");
  EXPECT_EQ(refusal(tie(0, 1, {0, 3}, {0, 3}, 1e8)), "bolt 'bolt': its ends are at one place");
  EXPECT_EQ(refusal(tie(0, 1, {0, 3}, {0, 1}, 0)), "bolt 'bolt': its stiffness must be above 0 and finite");
  EXPECT_EQ(refusal(tie(0, 1, {0, 3}, {0, 1}, 1e8, 0)), "bolt 'bolt': its capacity must be above 0");
  wrong = tie(0, 1, {0, 3}, {0, 1}, 1e8, 5);
  wrong.pretension = newtons_per_metre(6);
  EXPECT_EQ(refusal(wrong), "bolt 'bolt': its pretension must be from 0 to its capacity");
}

}  // namespace
}  // namespace cleave::dbem::tie_test
