#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "analyse_complex.hpp"
#include "handmade.hpp"
#include "statics.hpp"

namespace cleave::stability {
namespace {

using geometry::Vec3;
using handmade::Complex;
using handmade::radians;
using handmade::upward;
using statics::settings;
using statics::strength;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// One block of weight 100 on rock, with these contacts (joint number = index).
struct Wall {
  Vec3 inward;
  double area = 1;
};
Judgement judge_one(const std::vector<Wall>& walls, const Settings& with, double volume = 100) {
  Complex complex;
  const auto rock = complex.fixed_block();
  const auto block = complex.block(volume);
  complex.free_face(block);
  std::uint32_t joint = 0;
  for (const Wall& wall : walls) complex.contact(block, rock, wall.inward, wall.area, joint++);
  const Analysis analysis = analyse_complex(complex.build(), with);
  EXPECT_LT(analysis.equilibrium_residual, 1e-13);
  EXPECT_EQ(analysis.judgements.size(), 1U);
  EXPECT_EQ(analysis.judgements.at(0).block, block);
  return analysis.judgements.at(0);
}

TEST(ResistanceTest, SlidingOnAPlane) {
  const Judgement j = judge_one({{upward(40, 90)}}, settings({strength(30)}));
  EXPECT_EQ(j.mode, Mode::sliding);
  EXPECT_TRUE(j.key);
  EXPECT_EQ(j.batch, 1U);
  EXPECT_EQ(j.cone_dimension, 3);
  EXPECT_NEAR(j.weight.si(), 100, 0);
  EXPECT_NEAR(j.driving.si(), 100 * std::sin(radians(40)), 1e-10);
  EXPECT_NEAR(j.factor_of_safety, std::tan(radians(30)) / std::tan(radians(40)), 1e-12);
  EXPECT_LT(geometry::norm(j.direction - handmade::dip_vector(40, 90)), 1e-12);
  ASSERT_EQ(j.pressing.size(), 1U);
  EXPECT_NEAR(j.pressing[0].reaction.si(), 100 * std::cos(radians(40)), 1e-10);
  EXPECT_NEAR(j.pressing[0].shear.si(), 100 * std::cos(radians(40)) * std::tan(radians(30)), 1e-10) << "all it has";
  const Judgement rough = judge_one({{upward(40, 90)}}, settings({strength(41)}));
  EXPECT_EQ(rough.mode, Mode::sliding);
  EXPECT_FALSE(rough.key);
  EXPECT_NEAR(rough.pressing.at(0).shear.si(), 100 * std::sin(radians(40)), 1e-10) << "no more than is driving";
  EXPECT_FALSE(rough.batch.has_value());
}

// Cohesion of a wall on which nothing presses does not count; the more the resultant stands against it, the more of it
// does, up to one degree: no jump between a vertical joint and one that is nearly so.
TEST(ResistanceTest, CohesionDoesNotJumpWhereAJointStandsUpright) {
  const Settings with = settings({strength(30, 1680)});
  const auto factor = [&](double dip, const Settings& s) {
    return judge_one({{upward(dip, 90)}, {-upward(dip, 90)}}, s).factor_of_safety;
  };
  EXPECT_EQ(factor(90, with), 0);
  EXPECT_NEAR(factor(90 - 1e-6, with), 0, 1e-4);  // was 16.8
  double before = factor(90, with);
  for (double dip = 89.99; dip > 88; dip -= 0.01) {
    const double here = factor(dip, with);
    EXPECT_GE(here, before - 1e-3) << dip;
    EXPECT_LT(here - before, 0.2) << dip;
    before = here;
  }
  EXPECT_NEAR(factor(88.9, with),
              (100 * std::cos(radians(88.9)) * std::tan(radians(30)) + 1680) / (100 * std::sin(radians(88.9))), 1e-9);
  // Asked for, cohesion of both walls counts, and it does not jump either where one begins to open.
  Settings both = with;
  both.parallel_contact = true;
  EXPECT_NEAR(factor(90, both), 33.6, 1e-9);
  EXPECT_NEAR(factor(90 - 1e-6, both), 33.6, 1e-3);
  const auto between = [&](double other) {
    return judge_one({{upward(80, 90)}, {-upward(other, 90)}}, both).factor_of_safety;
  };
  EXPECT_NEAR(between(80 - 1e-6), between(80), 1e-3);
  EXPECT_NEAR(between(80) - between(75), 1680 / (100 * std::sin(radians(80))), 1e-9);
  EXPECT_EQ(judge_one({{upward(90, 90)}}, both).cohesion_left_out.si(), 0);
  EXPECT_NEAR(judge_one({{upward(90, 90)}}, with).cohesion_left_out.si(), 1680, 1e-9);
  EXPECT_EQ(judge_one({{upward(40, 90)}}, with).cohesion_left_out.si(), 0);
}

// Friction equal to the dip: FoS is 1 to rounding, and 1 holds.
TEST(ResistanceTest, LimitEquilibriumHolds) {
  for (int dip = 5; dip < 90; dip += 5) {
    const Judgement j = judge_one({{upward(dip, 90)}}, settings({strength(dip)}));
    EXPECT_NEAR(j.factor_of_safety, 1, 1e-12);
    EXPECT_FALSE(j.key) << dip;
    EXPECT_TRUE(judge_one({{upward(dip, 90)}}, settings({strength(dip - 1e-9)})).key) << dip;
  }
}

// Plane slide with water, cohesion and 0.1 g: the water thrust is given as a force of its own through the coefficient.
TEST(ResistanceTest, PlaneSlideWithWaterAndEarthquake) {
  const double weight = 5000, area = 40, u = 15;
  const Vec3 n = upward(35, 90);
  const Vec3 k = Vec3{0.1, 0, 0} + (u * area / weight) * n;
  const Judgement j = judge_one({{n, area}}, settings({strength(30, 20)}, k), weight);
  EXPECT_EQ(j.mode, Mode::sliding);
  EXPECT_NEAR(j.factor_of_safety, 0.809377, 1e-6);
}

TEST(ResistanceTest, HoekAndBrayWedgeWithTensionCrack) {
  const double a1 = 5565.00784, a2 = 6428.12540, a5 = 1846.53855, weight = 28272195.4;
  const std::vector<Wall> walls{{upward(45, 105), a1}, {upward(70, 235), a2}, {upward(70, 165), a5}};
  const Judgement dry = judge_one(walls, settings({strength(20, 500), strength(30, 1000), strength(0)}), weight);
  EXPECT_EQ(dry.mode, Mode::wedge);
  EXPECT_NEAR(dry.factor_of_safety, 1.73557674673, 1e-9);
  ASSERT_EQ(dry.pressing.size(), 2U);
  EXPECT_NEAR(dry.pressing[0].reaction.si() / 22557120.5, 1, 1e-8);
  EXPECT_NEAR(dry.pressing[1].reaction.si() / 13848679.0, 1, 1e-8);
  EXPECT_NEAR(dry.driving.si() / 14644289.5, 1, 1e-8);
  // Shear: c A + N tan(friction) of each plane over the factor; both together hold the driving force.
  EXPECT_NEAR(dry.pressing[0].shear.si() * 1.73557674673 / (500 * a1 + 22557120.5 * std::tan(radians(20))), 1, 1e-8);
  EXPECT_NEAR(dry.pressing[1].shear.si() * 1.73557674673 / (1000 * a2 + 13848679.0 * std::tan(radians(30))), 1, 1e-8);
  EXPECT_NEAR((dry.pressing[0].shear + dry.pressing[1].shear) / dry.driving, 1, 1e-12);
  EXPECT_NEAR(judge_one(walls, settings({strength(30, 500), strength(20, 1000), strength(0)}), weight).factor_of_safety,
              1.862466, 1e-6);

  const double u = 1084.26644;
  const Vec3 thrust = (u / weight) * (a1 * walls[0].inward + a2 * walls[1].inward + a5 * walls[2].inward);
  const Judgement wet =
      judge_one(walls, settings({strength(20, 500), strength(30, 1000), strength(0)}, thrust), weight);
  EXPECT_NEAR(wet.factor_of_safety, 1.13782292336, 1e-9);
}

TEST(ResistanceTest, HoekAndBrayFullWedge) {
  const std::vector<Wall> walls{{upward(45, 105), 9349.3015}, {upward(70, 235), 9421.8586}};
  EXPECT_NEAR(judge_one(walls, settings({strength(20, 500), strength(30, 1000)}), 36789671).factor_of_safety, 1.846356,
              1e-6);
  EXPECT_NEAR(judge_one(walls, settings({strength(30, 500), strength(20, 1000)}), 36789671).factor_of_safety, 1.973246,
              1e-6);
}

TEST(ResistanceTest, RoofFallsFloorStands) {
  std::vector<Wall> roof, floor;
  for (const double a : {0.0, 120.0, 240.0}) {
    floor.push_back({upward(60, a)});
    roof.push_back({-upward(60, a)});
  }
  const Judgement fallen = judge_one(roof, settings({strength(89, 1e9)}));
  EXPECT_EQ(fallen.mode, Mode::falling);
  EXPECT_EQ(fallen.factor_of_safety, 0);
  EXPECT_TRUE(fallen.key);
  EXPECT_EQ(fallen.net.si(), 100);
  EXPECT_TRUE(fallen.pressing.empty());
  EXPECT_EQ(fallen.direction, (Vec3{0, 0, -1}));

  const Judgement standing = judge_one(floor, settings({strength(0)}));
  EXPECT_EQ(standing.mode, Mode::stable);
  EXPECT_FALSE(standing.key);
  EXPECT_EQ(standing.factor_of_safety, infinity);
  EXPECT_EQ(standing.direction, Vec3{});
  EXPECT_EQ(standing.cone_dimension, 3);

  const Judgement lifted = judge_one(floor, settings({strength(0)}, {0, 0, 1.2}));
  EXPECT_EQ(lifted.mode, Mode::lifting);
  EXPECT_NEAR(lifted.net.si(), 20, 1e-12);
}

TEST(ResistanceTest, CubeInAWall) {
  const std::vector<Wall> walls{{{0, 0, 1}}, {{0, 0, -1}}, {{0, 1, 0}}, {{0, -1, 0}}, {{1, 0, 0}}};
  const Judgement still = judge_one(walls, settings({strength(35)}));
  EXPECT_EQ(still.mode, Mode::stable);
  EXPECT_EQ(still.cone_dimension, 1);
  EXPECT_EQ(still.factor_of_safety, infinity);
  const Judgement shaken = judge_one(walls, settings({strength(35)}, {0.3, 0, 0}));
  EXPECT_EQ(shaken.mode, Mode::sliding);
  EXPECT_NEAR(shaken.factor_of_safety, 2.334025, 1e-6);
  Settings strict = settings({strength(35)}, {0.3, 0, 0});
  strict.strict = true;  // the ray (1, 0, 0) is no way out of a rough slot
  Complex complex;
  const auto rock = complex.fixed_block();
  const auto cube = complex.block(1);
  complex.free_face(cube);
  for (const Wall& wall : walls) complex.contact(cube, rock, wall.inward, 1, 0);
  EXPECT_TRUE(analyse_complex(complex.build(), strict).judgements.empty());
}

// Cohesion counts where a wall presses; `parallel_contact` adds walls that are brushed; walls that open give tension
// only.
TEST(ResistanceTest, CohesionAndTension) {
  const std::vector<Wall> walls{{upward(40, 90), 3}, {{0, 1, 0}, 5}, {handmade::dip_vector(40, 90), 7}};
  const double t = 100 * std::sin(radians(40));
  Settings with = settings({strength(0, 2), strength(0, 1), strength(0, 11)});
  EXPECT_NEAR(judge_one(walls, with).resistance.si(), 6, 1e-12);
  EXPECT_FALSE(judge_one(walls, with).resistance_max.has_value()) << "the wall that is brushed adds nothing either way";
  with.parallel_contact = true;
  EXPECT_NEAR(judge_one(walls, with).resistance.si(), 11, 1e-12);
  const Judgement torn = judge_one(walls, settings({strength(0, 0, 1000), strength(0, 0, 1000), strength(0, 0, 4)}));
  EXPECT_NEAR(torn.resistance.si(), 28, 1e-9);
  EXPECT_NEAR(torn.net.si(), t - 28, 1e-9);

  // Falling between vertical walls: nothing, unless parallel contact is asked for.
  const std::vector<Wall> slot{{{1, 0, 0}, 10}, {{-1, 0, 0}, 10}};
  Settings glued = settings({strength(45, 3), strength(45, 3)});
  EXPECT_EQ(judge_one(slot, glued).factor_of_safety, 0);
  glued.parallel_contact = true;
  EXPECT_NEAR(judge_one(slot, glued).factor_of_safety, 0.6, 1e-12);
  // Hanging from the roof by tension.
  const Judgement hung = judge_one({{{0, 0, -1}, 50}}, settings({strength(0, 0, 1.5)}));
  EXPECT_EQ(hung.mode, Mode::falling);
  EXPECT_NEAR(hung.factor_of_safety, 0.75, 1e-12);
}

// A face that opens in a slant pulls aside: what nothing bears of that pull does not hold the block either.
TEST(ResistanceTest, TensionOfASlantFaceIsThatWhichStaysInBalance) {
  const auto roof = [](double slant, double sense = 1) {
    return Vec3{sense * std::sin(radians(slant)), 0, -std::cos(radians(slant))};
  };
  const auto held = [](const std::vector<Wall>& walls, std::initializer_list<JointStrength> strengths) {
    return judge_one(walls, settings(strengths)).resistance.si();
  };
  // One slant roof joint: its shear p tan(slant) is that of cohesion alone.
  EXPECT_NEAR(held({{roof(40)}}, {strength(30, 0, 1000)}), 0, 1e-3)
      << "a millionth of it, by the slant that counts as none";
  for (const double cohesion : {1.0, 5.0, 20.0}) {
    const double t = std::tan(radians(40)), c = std::cos(radians(40));
    EXPECT_NEAR(held({{roof(40)}}, {strength(30, cohesion, 8)}), std::min(8 * c, std::min(8.0, cohesion / t) / c),
                1e-9);
  }
  // Lifted off a slant joint by 1.2 times its weight, the net force is 20.
  const Settings lifting = settings({strength(30, 0, 1000)}, {0, 0, 1.2});
  const Judgement lifted = judge_one({{upward(40, 90)}}, lifting);
  EXPECT_EQ(lifted.mode, Mode::lifting);
  EXPECT_NEAR(lifted.factor_of_safety, 0, 1e-4) << "it slides off";
  EXPECT_TRUE(lifted.key);
  // Two that lean on each other: the same slant bears all, else the lesser pull aside bounds both.
  EXPECT_NEAR(held({{roof(40)}, {roof(40, -1)}}, {strength(30, 0, 8), strength(30, 0, 8)}), 16 * std::cos(radians(40)),
              1e-9);
  const double a = radians(20), b = radians(50), first = 8 * std::sin(a) / std::sin(b);
  EXPECT_NEAR(held({{roof(20)}, {roof(50, -1)}}, {strength(30, 0, 8), strength(30, 0, 8)}),
              8 * std::cos(a) + first * std::cos(b), 1e-7);
  // A crack behind a block on a plane that overhangs by 30 degrees more: its pull takes friction away.
  const Vec3 crack{std::cos(radians(70)), 0, -std::sin(radians(70))};
  const double friction = std::tan(radians(20)), angle = radians(30), reaction = 100 * std::cos(radians(40));
  EXPECT_NEAR(held({{upward(40, 90)}, {crack}}, {strength(20), strength(20, 0, 8)}),
              friction * reaction + 8 * (std::cos(angle) - friction * std::sin(angle)), 1e-7);
}

TEST(ResistanceTest, SteppedBaseAddsAreasAndAveragesFriction) {
  const std::vector<Wall> steps{{upward(30, 90), 1}, {upward(30, 90), 3}};
  const double n = 100 * std::cos(radians(30));
  Settings with = settings({strength(10, 2), strength(40, 5)});
  const double mean = (std::tan(radians(10)) + 3 * std::tan(radians(40))) / 4;
  EXPECT_NEAR(judge_one(steps, with).resistance.si(), n * mean + 2 + 15, 1e-10);
  with.group_friction = GroupFriction::smallest;
  EXPECT_NEAR(judge_one(steps, with).resistance.si(), n * std::tan(radians(10)) + 2 + 15, 1e-10);
}

// Three planes through one sliding line: statics leaves the reactions open. Bounds by linear programming (theory
// check).
TEST(ResistanceTest, ThreeCoplanarNormalsGiveAnInterval) {
  const double tilt = radians(30);
  const auto turned = [&](Vec3 v) {
    return Vec3{v.x, std::cos(tilt) * v.y - std::sin(tilt) * v.z, std::sin(tilt) * v.y + std::cos(tilt) * v.z};
  };
  // Exactly coplanar for the lattice: small integers in the plane of u and w.
  const Vec3 u{1, 0, 0}, w = turned({0, 0, 1});
  const auto exact_direction = [&](double dip, double sense) {
    return geometry::normalized(sense * std::sin(radians(dip)) * u + std::cos(radians(dip)) * w);
  };
  const std::vector<Wall> walls{{exact_direction(60, 1)}, {exact_direction(20, 1)}, {exact_direction(50, -1)}};
  // As built the three are coplanar to 1e-14 only, so the exact test sees a pair; both pairs of the interval are close.
  const Judgement j = judge_one(walls, settings({strength(20), strength(35), strength(30)}));
  EXPECT_EQ(j.mode, Mode::wedge);
  EXPECT_NEAR(j.driving.si(), 50, 1e-9);
  const double r = j.resistance.si() / 100;
  EXPECT_TRUE(std::abs(r - 0.676325) < 1e-6 || std::abs(r - 0.717762) < 1e-6) << r;

  // The same with integer normals: sliding line (0, 1, -1), rows a (1, 1, 1), b (-1, 1, 1), c (0, 1, 1).
  const std::vector<Wall> lattice{{{1, 1, 1}}, {{-1, 1, 1}}, {{0, 1, 1}}};
  const double reaction = 100 / std::sqrt(2.0);       // on c alone
  const double each = reaction / 2 * std::sqrt(1.5);  // on a and b: (1, 1, 1) / sqrt 3 has 2 / sqrt 6 along c
  const Judgement smooth_sides = judge_one(lattice, settings({strength(10), strength(10), strength(30)}));
  EXPECT_EQ(smooth_sides.mode, Mode::sliding);
  EXPECT_NEAR(smooth_sides.resistance.si(), 2 * each * std::tan(radians(10)), 1e-10);
  ASSERT_TRUE(smooth_sides.resistance_max.has_value());
  EXPECT_NEAR(smooth_sides.resistance_max->si(), reaction * std::tan(radians(30)), 1e-10);
  EXPECT_EQ(smooth_sides.pressing.size(), 2U);
  const Judgement smooth_base = judge_one(lattice, settings({strength(30), strength(30), strength(10)}));
  EXPECT_NEAR(smooth_base.resistance.si(), reaction * std::tan(radians(10)), 1e-10);
  EXPECT_NEAR(smooth_base.resistance_max->si(), 2 * each * std::tan(radians(30)), 1e-10);
  EXPECT_EQ(smooth_base.pressing.size(), 1U);
}

TEST(ResistanceTest, PartialFactors) {
  Settings with = settings({strength(30, 4)});
  with.partial = PartialFactors::make(1.25, 1.6, 1.1).value();
  const Judgement j = judge_one({{upward(40, 90), 10}}, with);
  EXPECT_NEAR(j.weight.si(), 110, 1e-12);
  EXPECT_NEAR(j.resistance.si(), 110 * std::cos(radians(40)) * std::tan(radians(30)) / 1.25 + 40 / 1.6, 1e-10);
}

TEST(ResistanceTest, NoGravityMovesNothing) {
  Settings with = settings({strength(0)});
  with.loads = Loads::make({}).value();
  const Judgement j = judge_one({{upward(40, 90)}}, with);
  EXPECT_EQ(j.mode, Mode::stable);
  EXPECT_EQ(j.factor_of_safety, infinity);
}

}  // namespace
}  // namespace cleave::stability
