#include "elastic_body.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "scenes.hpp"

namespace cleave::dbem {
namespace {

using namespace scenes;
using support::elastic_body;

TEST(ElasticTest, ASliderGoesAsTheRigidOne) {
  for (const auto& [young, phi, tolerance] :
       {std::tuple{2e10, 10.0, 1e-4}, std::tuple{2e10, 20.0, 1e-4}, std::tuple{1e8, 20.0, 1e-2}}) {
    std::vector<Body> bodies{fixed("slope", turned(rectangle(-10, -1, 20, 1), radians(30))),
                             elastic_body(turned(rectangle(5, 0, 1, 0.5), radians(30)), {.young = young}, 2, 0)};
    World world = make(bodies, law(std::tan(radians(phi))), {.step = 1e-3});
    run(world, 0.5);
    const double exact = g * (0.5 - std::cos(radians(30)) * std::tan(radians(phi))) * 0.125;
    std::printf("E=%g phi=%g relative %g\n", young, phi, norm(world.displacement(1)) / exact - 1);
    EXPECT_NEAR(norm(world.displacement(1)) / exact, 1, tolerance);
  }
}

TEST(ElasticTest, ADropGainsNoEnergyAndItsImpulseIsTheChangeOfMomentum) {
  for (const double step : {2e-4, 5e-5}) {
    World world = make(
        {fixed("floor", rectangle(-5, -1, 10, 1)), elastic_body(rectangle(-0.5, 0.05, 1, 1), {.young = 1e8}, 2, 20)},
        law(0.4), {.step = step});
    const double start = world.energy().total();
    double impulse = 0, highest = -1;
    bool hit = false;
    while (world.time() < 0.3) {
      const auto report = world.step();
      ASSERT_TRUE(report.has_value()) << describe(report.error());
      for (const Contact& c : world.contacts())
        impulse += (c.edge_body == 0 ? 1 : -1) * c.normal_force * c.normal.y * report->step;
      ASSERT_LT(world.energy().total(), start + 1e-9 * 2600 * g);
      hit = hit || report->impact;
      if (hit) highest = std::max(highest, world.displacement(1).y + 0.05);
    }
    const double m = world.mass(1);
    EXPECT_NEAR(m * world.velocity(1).y, impulse - m * g * world.time(), 1e-9 * m * g);
    std::printf("elastic drop step %g: rebound / drop %g\n", step, highest / 0.05);
    EXPECT_GT(highest / 0.05, 0.3);
    EXPECT_LT(highest / 0.05, 0.8);
  }
}

// Three micrometres into the walls on both sides: parted as if rigid an elastic body may stay so, a rigid one may not,
// whatever is elastic elsewhere.
TEST(ElasticTest, OnlyPairsThatBendMayOverlapByMore) {
  for (const bool bends : {true, false}) {
    const std::vector<Vec2> jammed = rectangle(-3e-6, 0, 1 + 6e-6, 1);
    std::vector<Body> bodies{fixed("left", rectangle(-1, 0, 1, 1)), fixed("right", rectangle(1, 0, 1, 1)),
                             bends ? elastic_body(jammed, {.young = 1e10}, 2, 12) : block("jammed", jammed),
                             elastic_body(rectangle(5, 0, 1, 1), {.young = 1e10}, 2, 12)};
    World world =
        make(bodies, law(0.5), {.gravity = {0, 0}, .step = 1e-5, .overlap_elastic = 2e-5, .overlap_at_start = 2e-5});
    EXPECT_EQ(world.step().has_value(), bends);
  }
}

// One mode of 100 rad/s: held by its spring against the load of the spin it neither rings nor loses energy; a body that
// touches another one is not stretched from the start.
TEST(ElasticTest, ABodyThatSpinsIsStretchedByItsSpin) {
  Body spun = block("spun", rectangle(-0.5, -0.5, 1, 1));
  spun.spin = 3;
  spun.modes = ModalBasis{.omega = {100}, .shapes = {-1, -1, 1, -1, 1, 1, -1, 1}, .stretch = {2}};
  for (double& shape : spun.modes->shapes) shape *= 0.01;
  World world = make({spun}, law(0.5), {.gravity = {0, 0}, .step = 1e-3});
  const double stretched = 2 * 9.0 / 1e4;
  EXPECT_NEAR(world.modal_amplitudes(0)[0], stretched, 1e-15);
  run(world, 0.3);
  EXPECT_NEAR(world.modal_amplitudes(0)[0], stretched, 1e-12);
  EXPECT_NEAR(world.energy().lost, 0, 1e-8);
  // Told of it only now it swings about that, and what it gains is work.
  World told = make({spun}, law(0.5), {.gravity = {0, 0}, .step = 1e-4});
  ASSERT_TRUE(told.set_velocity(0, {0, 0}, 6).has_value());
  double most = 0;
  while (told.time() < 0.1) {
    ASSERT_TRUE(told.step().has_value());
    most = std::max(most, told.modal_amplitudes(0)[0]);
  }
  EXPECT_NEAR(most, 7 * stretched, 1e-3 * stretched);
  EXPECT_GT(told.energy().work, 0);
  EXPECT_NEAR(told.energy().lost, 0, 1e-8);
  World leaning = make({spun, fixed("wall", rectangle(0.5, -0.5, 1, 1))}, law(0.5), {.gravity = {0, 0}, .step = 1e-3});
  EXPECT_EQ(leaning.modal_amplitudes(0)[0], 0);
  spun.modes->stretch = {2, 1};
  EXPECT_FALSE(World::make({spun}, law(0.5), {}).has_value());
}

TEST(ElasticTest, ACollisionKeepsMomentumAndAngularMomentum) {
  Body a = elastic_body(rectangle(0, 0, 1, 1), {.young = 1e8}, 2, 16);
  Body b = elastic_body(turned(rectangle(1.2, 0.4, 1, 1.3), 0.1), {.young = 1e9}, 2, 16);
  a.velocity = {2, 0.3};
  a.spin = 0.5;
  World world = make({a, b}, law(0.4), {.gravity = {0, 0}, .step = 5e-4});
  const Vec2 p = world.momentum();
  const double l = world.angular_momentum(), energy = world.energy().total();
  bool hit = false;
  while (world.time() < 0.4) {
    const auto report = world.step();
    ASSERT_TRUE(report.has_value());
    hit = hit || report->impact;
    ASSERT_LE(world.energy().total(), energy * (1 + 1e-10));
  }
  EXPECT_TRUE(hit);
  EXPECT_LT(norm(world.momentum() - p), 1e-11 * norm(p));
  EXPECT_NEAR(world.angular_momentum(), l, 1e-10 * std::abs(l));
  EXPECT_GT(norm(world.velocity(1)), 0.1);
}

TEST(RelaxTest, ReactionsAreWeightsWhateverTheStiffness) {
  for (const auto& [low, high] : {std::pair{1e7, 1e7}, std::pair{1e13, 1e7}, std::pair{1e7, 1e13}}) {
    Body below = elastic_body(rectangle(-0.5, 0, 1, 1), {.young = low}, 2, 12);
    Body above = elastic_body(rectangle(-0.4, 1, 0.8, 1), {.young = high}, 2, 12);
    World world =
        make({fixed("floor", rectangle(-5, -1, 10, 1)), below, above}, law(0.5), {.step = 0.05, .quasi_static = true});
    const auto done = relax(world, {.step = 0.05, .criterion = 1e-9});
    ASSERT_TRUE(done.has_value()) << describe(done.error());
    EXPECT_TRUE(done->at_rest) << done->unbalanced;
    double floor = 0, between = 0;
    for (const Contact& c : world.contacts()) {
      const Vec2 f = c.normal_force * c.normal + c.tangential_force * turned_left(c.normal);
      const bool on_floor = c.vertex_body == 0 || c.edge_body == 0;
      (on_floor ? floor : between) += std::abs(f.y);
    }
    EXPECT_NEAR(floor / (1.8 * 2600 * g), 1, 1e-6) << low << ' ' << high;
    EXPECT_NEAR(between / (0.8 * 2600 * g), 1, 1e-6);
    std::printf("relax %g %g: %zu steps\n", low, high, done->steps);
  }
}

TEST(RelaxTest, SaysWhenThereIsNoEquilibrium) {
  World world = make(slider(radians(30)), law(std::tan(radians(20))), {.step = 0.01, .quasi_static = true});
  const auto done = relax(world, {.step = 0.01, .most = 20});
  ASSERT_TRUE(done.has_value());
  EXPECT_FALSE(done->at_rest);
  EXPECT_GT(done->unbalanced, 0.1);
}

TEST(ComplianceTest, PenetrationIsForceTimesCompliance) {
  for (const double compliance : {1e-9, 1e-8}) {
    Laws laws = law(0.5);
    laws.otherwise.compliance = compliance;
    World world = make(stack(1), laws, {.step = 0.05, .quasi_static = true});
    const auto done = relax(world, {.step = 0.05, .criterion = 1e-10});
    ASSERT_TRUE(done.has_value());
    EXPECT_TRUE(done->at_rest);
    EXPECT_NEAR(-world.displacement(1).y / (compliance * 0.5 * 2600 * g), 1, 1e-6);
  }
}

TEST(ComplianceTest, AnOscillationHasThePeriodOfItsSpringsAndGainsNothing) {
  // A block on two springs, released at the unstressed height: period 2 pi sqrt(m C / 2), amplitude the static sag.
  const double compliance = 1e-7;
  Laws laws = law(0);
  laws.otherwise.compliance = compliance;
  World world = make(stack(1), laws, {.step = 2e-5, .sleep = false});
  const double sag = compliance * 0.5 * 2600 * g;
  const double period = 2 * std::numbers::pi * std::sqrt(2600 * compliance / 2);
  double lowest = 0, at = 0;
  const double start = world.energy().total();
  while (world.time() < 0.8 * period) {
    ASSERT_TRUE(world.step().has_value());
    if (world.displacement(1).y < lowest) {
      lowest = world.displacement(1).y;
      at = world.time();
    }
    ASSERT_LT(world.energy().total(), start + 1e-6);
  }
  EXPECT_NEAR(at / (period / 2), 1, 0.02);
  EXPECT_NEAR(-lowest / (2 * sag), 1, 0.05);
}

/// A block of 2600 kg/m3 on a floor whose sides have more corners the more there are `pieces`.
World block_on_springs(double width, int pieces, std::optional<double> kn, double ks, Vec2 push, double overhang) {
  Laws laws = law(1);
  laws.otherwise.normal_stiffness = kn;
  laws.otherwise.shear_stiffness = ks;
  std::vector<Vec2> ring{{0, 0}};
  for (int k = 1; k < pieces; ++k) ring.push_back({width * k / pieces, 0});
  ring.insert(ring.end(), {{width, 0}, {width, 1}, {0, 1}});
  std::vector<Body> bodies{fixed("floor", {{-5, -1}, {width - overhang, -1}, {width - overhang, 0}, {-5, 0}}),
                           block("block", ring)};
  bodies[1].forces.push_back({{0.5 * width, 0.0}, push});
  World world = make(bodies, laws, {.step = 0.05, .quasi_static = true});
  const auto done = relax(world, {.step = 0.05, .criterion = 1e-10});
  EXPECT_TRUE(done.has_value() && done->at_rest);
  return world;
}

// Force over stiffness and length, whatever the width and however many corners share it.
TEST(StiffnessTest, AJointClosesAndShearsByItsLength) {
  const double kn = 1e9, ks = 3e8;
  for (const double width : {0.3, 1.0, 2.5}) {
    for (const int pieces : {1, 2, 5}) {
      const double weight = 2600 * width * g, push = 0.4 * weight;
      const World world = block_on_springs(width, pieces, kn, ks, {push, 0}, 0);
      EXPECT_NEAR(-world.displacement(1).y / (weight / (kn * width)), 1, 2e-4) << width << ' ' << pieces;
      // Pushed at its foot: it does not tip.
      // Over the end of the floor by as much: that length has left the joint.
      const double sheared = world.outline(1)[0].x;
      EXPECT_NEAR(sheared / (push / (ks * (width - sheared))), 1, 1e-5) << width << ' ' << pieces;
      EXPECT_NEAR(world.energy().elastic, 0.5 * (weight * weight / kn + push * push / ks) / width,
                  1e-4 * weight * weight / (kn * width));
    }
  }
}

// On three quarters of its width, which carry N (1 +- 2 e / l) / 2 at their ends.
TEST(StiffnessTest, AnEccentricLoadTurnsABlockOnItsSprings) {
  const double kn = 1e9, width = 2, overhang = 0.5, length = width - overhang;
  const World world = block_on_springs(width, 1, kn, kn, {0, 0}, overhang);
  const double weight = 2600 * width * g, off = 0.5 * width - 0.5 * length;
  const double left = 0.5 * weight * (1 - 2 * off / length), right = 0.5 * weight * (1 + 2 * off / length);
  EXPECT_NEAR(-world.outline(1)[0].y / (left / (kn * 0.5 * length)), 1, 1e-4);
  EXPECT_NEAR(-(world.position(1, {length, 0}).y) / (right / (kn * 0.5 * length)), 1, 1e-4);
}

// A joint that is stiff in one direction only is rigid in the other, and friction bounds its shear.
TEST(StiffnessTest, ShearsNoFartherThanFrictionLets) {
  const double weight = 2600 * g, ks = 1e8;
  // As far as its springs give way, on what of its length has not left the floor then.
  const double sheared = block_on_springs(1, 1, std::nullopt, ks, {0.5 * weight, 0}, 0).displacement(1).x;
  EXPECT_NEAR(sheared, 0.5 * weight / (ks * (1 - sheared)), 1e-9);
  EXPECT_NEAR(block_on_springs(1, 1, std::nullopt, ks, {0.5 * weight, 0}, 0).displacement(1).y, 0, 1e-9);
  Laws laws = law(0.3);
  laws.otherwise.normal_stiffness = laws.otherwise.shear_stiffness = 1e9;
  World world = make(slider(radians(30)), laws, {.step = 1e-3});
  run(world, 0.5);
  const double way = 0.5 * g * (std::sin(radians(30)) - 0.3 * std::cos(radians(30))) * 0.25;
  EXPECT_NEAR(norm(world.displacement(1)) / way, 1, 2e-3);
  // What slips on springs is friction, too; the springs keep the rest.
  EXPECT_NEAR(world.energy().friction / (0.3 * g * world.mass(1) * std::cos(radians(30)) * way), 1, 2e-3);
  EXPECT_LT(std::abs(world.energy().lost), 2e-2 * world.energy().friction);
}

TEST(BondTest, HoldsByTensionUntilItIsTooMuch) {
  // A block glued under a ceiling.
  for (const double factor : {0.99, 1.01}) {
    Laws laws = law(0.3);
    laws.otherwise.tension = factor * 2600 * g;  // Pa on 1 m, against the weight of 1 m2
    laws.otherwise.cohesion = 1e6;
    World world =
        make({fixed("ceiling", rectangle(-2, 0, 4, 1)), block("b", rectangle(-0.5, -1, 1, 1))}, laws, {.step = 1e-3});
    std::size_t broken = 0;
    while (world.time() < 0.1) {
      const auto report = world.step();
      ASSERT_TRUE(report.has_value());
      broken += report->broken;
    }
    if (factor > 1) {
      EXPECT_EQ(broken, 0U);
      EXPECT_LT(norm(world.displacement(1)), 1e-9);
    } else {
      EXPECT_EQ(broken, 2U);
      EXPECT_NEAR(-world.displacement(1).y, 0.5 * g * 0.01, 0.1 * 0.5 * g * 0.01);
    }
  }
}

/// Whether a block bonded to a fixed one still hangs there after a while.
bool hangs(const Body& support, const Body& held, double tension) {
  Laws laws = law(0.3);
  laws.otherwise.tension = tension;
  laws.otherwise.cohesion = 1e9;
  World world = make({support, held}, laws, {.step = 1e-3});
  std::size_t broken = 0;
  while (world.time() < 0.05) {
    const auto report = world.step();
    EXPECT_TRUE(report.has_value());
    if (!report) return false;
    broken += report->broken;
  }
  const bool fell = norm(world.displacement(1)) > 1e-4;
  EXPECT_EQ(fell, broken > 0);
  return !fell;
}

TEST(BondTest, BendingIsCarriedByTheSectionOfTheJoint) {
  // A console of length l and height h on a wall: the edge of its joint carries 6 M / h2 = 3 rho g l2 / h.
  for (const double l : {0.3, 1.0, 4.0}) {
    for (const double h : {0.5, 1.0}) {
      const Body wall = fixed("wall", rectangle(-1, -2, 1, 4));
      const double edge = 3 * 2600 * g * l * l / h;
      EXPECT_TRUE(hangs(wall, block("console", rectangle(0, 0, l, h)), 1.01 * edge)) << l << ' ' << h;
      EXPECT_FALSE(hangs(wall, block("console", rectangle(0, 0, l, h)), 0.99 * edge)) << l << ' ' << h;
      // The same with more contacts along the joint.
      const Body more = block("console", {{0, 0}, {l, 0}, {l, h}, {0, h}, {0, 0.7 * h}, {0, 0.4 * h}});
      EXPECT_TRUE(hangs(wall, more, 1.01 * edge)) << l << ' ' << h;
      EXPECT_FALSE(hangs(wall, more, 0.99 * edge)) << l << ' ' << h;
    }
  }
}

TEST(BondTest, PullAndBendingAddUpAtTheEdge) {
  // A block of 2 x 1 m under a ceiling that covers half of it: W / b + 6 (W b / 2) / b2 = 4 W / b.
  const double edge = 4 * 2 * 2600 * g;
  for (const double factor : {0.99, 1.01}) {
    EXPECT_EQ(hangs(fixed("ceiling", rectangle(-1, 0, 2, 1)), block("b", rectangle(0, -1, 2, 1)), factor * edge),
              factor > 1);
  }
}

TEST(BondTest, ANotchPartsAJointIntoTwoSections) {
  // A block on two feet of 0.1 m, 0.8 m apart, under a ceiling: they carry W / 0.2, not W / 1. How rigid feet share a
  // couple is not unique, so the upper bound leaves room.
  const std::vector<Vec2> feet{{-0.5, -1},  {0.5, -1},    {0.5, 0},  {0.4, 0},
                               {0.4, -0.1}, {-0.4, -0.1}, {-0.4, 0}, {-0.5, 0}};
  const double pull = (1 - 0.08) * 2600 * g / 0.2;
  for (const double factor : {0.9, 1.5}) {
    EXPECT_EQ(hangs(fixed("ceiling", rectangle(-2, 0, 4, 1)), block("b", feet), factor * pull), factor > 1);
  }
}

TEST(BondTest, DoesNotHealAndKeepsResidualFriction) {
  // A block pulled along a floor by a pulse stronger than its cohesion: afterwards only residual friction is left.
  Laws laws = law(std::tan(radians(40)));
  laws.otherwise.cohesion = 2000;
  laws.otherwise.residual_friction = 0.1;
  std::vector<Body> bodies = stack(1);
  bodies[1].outline = rectangle(-0.5, 0, 1, 0.4);
  bodies[1].forces.push_back(
      {.at = {0, 0.2}, .force = {3e4, 0}, .factor = [](double t) { return t < 0.02 ? 1.0 : 0.0; }});
  World world = make(bodies, laws, {.step = 1e-3});
  std::size_t broken = 0;
  while (world.time() < 0.0205) {
    const auto report = world.step();
    ASSERT_TRUE(report.has_value());
    broken += report->broken;
  }
  EXPECT_EQ(broken, 2U);
  const double before = world.velocity(1).x, from = world.time();
  ASSERT_GT(before, 0.1);
  run(world, 0.0605);
  EXPECT_NEAR((before - world.velocity(1).x) / (0.1 * g * (world.time() - from)), 1, 1e-6);
}

/// A block on a floor, pulled at its base: to where in 0.4 s, and the closed form where it yields when it is pulled
/// with more than it holds.
struct Pulled {
  double way, exact;
};
Pulled pulled(double step, JointLaw joint, double pull, double rise) {
  std::vector<Body> bodies{fixed("floor", rectangle(-5, -1, 10, 1)), block("block", rectangle(0, 0, 1, 0.1))};
  const double mass = 260, weight = mass * g;
  // At the base the pull turns nothing; from `pull` on it rises by `rise` (N/m and second).
  const auto at = [=](double t) { return 1 + rise * t; };
  const auto mean = [=](double from, double to) { return 1 + 0.5 * rise * (from + to); };
  bodies[1].forces.push_back({{0.5, 0}, {pull, 0}, at, false, mean});
  Laws laws;
  laws.otherwise = joint;
  auto world = World::make(bodies, laws, {.step = step, .displacement = 1});
  EXPECT_TRUE(world.has_value()) << describe(world.error());
  run(*world, 0.4);
  const double holds = joint.cohesion + joint.friction * weight;
  const double left = joint.residual_cohesion + joint.residual_friction.value_or(joint.friction) * weight;
  const double since = pull >= holds ? 0 : (holds / pull - 1) / rise, t = 0.4 - since;
  const double over = pull * (1 + rise * since) - left;
  return {world->displacement(1).x, (0.5 * over * t * t + pull * rise * t * t * t / 6) / mass};
}

// What is lost is lost in the step that loses it: a joint that yields at once moves as one without a bond from the
// start; one whose load rises, within half a step of the moment.
TEST(BondTest, WhatIsLostIsLostInTheStepThatLosesIt) {
  const std::vector<JointLaw> joints{{.friction = 0.3, .cohesion = 2000},
                                     {.friction = 0.3, .cohesion = 2000, .residual_cohesion = 500},
                                     {.friction = 0.6, .residual_friction = 0.2},
                                     {.friction = 0.6, .cohesion = 1000, .residual_friction = 0.2}};
  for (std::size_t k = 0; k < joints.size(); ++k) {
    for (const double step : {0.02, 0.004}) {
      const Pulled at_once = pulled(step, joints[k], 3000, 0);
      EXPECT_NEAR(at_once.way / at_once.exact, 1, 1e-7) << k << ' ' << step;
      const Pulled later = pulled(step, joints[k], 2000, 2);
      const double speed = std::sqrt(2 * later.exact) * 10;  // more than any it has on its way
      EXPECT_GT(later.exact, 0.01) << k;
      EXPECT_NEAR(later.way, later.exact, 0.5 * step * speed) << k << ' ' << step;
    }
  }
}

// On a slope without friction: from the step on in which the bond breaks, what is left of it holds.
TEST(BondTest, KeepsResidualCohesionWhileItStaysClosed) {
  const double angle = radians(30), weight = 2600 * 0.5 * g, pull = weight * std::sin(angle), step = 1e-3;
  for (const double left : {0.0, 0.3, 0.8}) {
    Laws laws = law(0);
    laws.otherwise.cohesion = 0.9 * pull;
    laws.otherwise.residual_cohesion = left * pull;
    World world = make(slider(angle), laws, {.step = step});
    run(world, 0.3);
    const double way = 0.5 * (1 - left) * pull / (2600 * 0.5) * world.time() * world.time();
    EXPECT_NEAR(norm(world.displacement(1)), way, 1e-9) << left;
  }
}

// Lifted off and laid down again it holds no more.
TEST(BondTest, LosesResidualCohesionWhereItOpened) {
  for (const bool lifted : {false, true}) {
    Laws laws = law(0);
    laws.otherwise.cohesion = 2000;
    laws.otherwise.residual_cohesion = 2000;
    std::vector<Body> bodies = stack(1);
    bodies[1].outline = rectangle(-0.5, 0, 1, 0.4);
    const double mass = 2600 * 0.4;
    bodies[1].forces.push_back({.at = {0, 0.2}, .force = {2500, 0}, .factor = [](double) { return 1.0; }});
    if (lifted) {
      bodies[1].forces.push_back({.at = {0, 0.2}, .force = {0, 1.2 * mass * g}, .factor = [](double t) {
                                    return t > 0.05 && t < 0.07 ? 1.0 : 0.0;
                                  }});
    }
    World world = make(bodies, laws, {.step = 1e-3});
    run(world, 0.2);
    const double before = world.velocity(1).x, from = world.time();
    run(world, 0.3);
    const double pull = (lifted ? 2500 : 500) / mass;
    EXPECT_NEAR((world.velocity(1).x - before) / (pull * (world.time() - from)), 1, 1e-6) << lifted;
  }
}

TEST(BondTest, RefusesMoreResidualCohesionThanCohesion) {
  Laws laws = law(0.5);
  laws.otherwise.residual_cohesion = 1;
  EXPECT_FALSE(World::make(stack(1), laws, {}).has_value());
}

TEST(PropertyTest, EdgesCarryTheirOwnLaw) {
  // A block whose base is rough and whose sides are smooth, on a slope by its base or by its side.
  Laws laws = law(0);
  laws.pairs.push_back({0, 1, {.friction = 1}});
  for (const bool by_base : {true, false}) {
    std::vector<Body> bodies = slider(radians(30), 0.5, 0.5);
    bodies[1].properties = by_base ? std::vector<std::size_t>{1, 2, 2, 2} : std::vector<std::size_t>{2, 1, 1, 1};
    World world = make(bodies, laws, {.step = 5e-3});
    run(world, 0.2);
    EXPECT_NEAR(norm(world.displacement(1)), by_base ? 0.0 : 0.5 * g * 0.5 * 0.04, 1e-8);
  }
}

TEST(SleepTest, PilesFallAsleepAndWakeWhenHit) {
  std::vector<Body> bodies = stack(6);
  bodies.push_back(block("far", rectangle(-0.4, 8, 1, 1)));
  World world = make(bodies, law(0.6), {.step = 2e-3});
  bool slept = false;
  while (world.time() < 0.5) {
    const auto report = world.step();
    ASSERT_TRUE(report.has_value());
    EXPECT_TRUE(!slept || report->asleep == 6) << world.time();   // they stay so: nothing touches them yet
    EXPECT_TRUE(!slept || report->islands == 0) << world.time();  // nor is anything solved for them
    slept = slept || report->asleep == 6;
  }
  EXPECT_TRUE(slept);
  EXPECT_TRUE(world.asleep(3));
  EXPECT_FALSE(world.asleep(7));
  double base = 0;
  for (const Contact& c : world.contacts()) base += c.vertex_body == 0 || c.edge_body == 0 ? c.normal_force : 0;
  EXPECT_NEAR(base / (6 * 2600 * g), 1, 1e-8);  // contacts of sleeping bodies stay known
  bool woke = false;
  while (world.time() < 0.7) {
    ASSERT_TRUE(world.step().has_value());
    woke = woke || !world.asleep(3);
  }
  EXPECT_TRUE(woke);
  run(world, 3);
  base = 0;
  for (const Contact& c : world.contacts()) base += c.vertex_body == 0 || c.edge_body == 0 ? c.normal_force : 0;
  EXPECT_NEAR(base / (7 * 2600 * g), 1, 1e-6);
}

}  // namespace
}  // namespace cleave::dbem
