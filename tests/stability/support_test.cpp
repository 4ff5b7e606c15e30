// Bolts, shotcrete and the two-step check against worked examples.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "audited.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/stability/bolt_patterns.hpp"
#include "cleave/stability/sensitivity.hpp"
#include "cleave/stability/support.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"
#include "handmade.hpp"
#include "statics.hpp"

namespace cleave::stability {
namespace {

using geometry::norm;
using geometry::Vec3;
using handmade::radians;
using statics::audited;
using statics::strength;
using topology::BlockId;

/// A slab of `height` m on a plane that dips `dip` to the east; x' down the dip from 0 to `length`, 2 m wide. Cuts
/// across the slab at `cuts`. All sides but the base are free.
struct Slope {
  Vec3 d, y, n;
  topology::AuditedComplex complex;

  [[nodiscard]] Vec3 at(double along, double across, double up) const { return along * d + across * y + up * n; }
  static Slope make(double dip, double length, double height, const std::vector<double>& cuts) {
    const double a = radians(dip);
    Slope s{{std::cos(a), 0, -std::sin(a)}, {0, 1, 0}, {std::sin(a), 0, std::cos(a)}, cut_one()};
    std::array<Vec3, 8> corners;
    for (std::size_t i = 0; i < 8; ++i) {
      corners[i] = s.at((i & 1U) != 0 ? length : 0, (i & 2U) != 0 ? 2 : 0, (i & 4U) != 0 ? height : -40);
    }
    topology::CutInput input{.domain = geometry::make_hexahedron(corners).value(),
                             .joints = {},
                             .excavations = {},
                             .free_domain_tags = {0, 1, 2, 3, 5}};
    input.joints.emplace_back(topology::PersistentJoint{{}, s.n});
    for (const double cut : cuts) {
      input.joints.emplace_back(
          topology::Joint{{geometry::Polygon::make({s.at(cut, -1, -1), s.at(cut, 3, -1), s.at(cut, 3, height + 1),
                                                    s.at(cut, -1, height + 1)})
                               .value()}});
    }
    s.complex = audited(input);
    return s;
  }

 private:
  static topology::AuditedComplex cut_one() {
    return audited({.domain = geometry::make_box({0, 0, 0}, {1, 1, 1}).value(),
                    .joints = {},
                    .excavations = {},
                    .free_domain_tags = {}});
  }
};

Settings weighing(double weight, double volume, double friction) {
  Settings with = statics::settings({strength(friction)});
  with.rock = RockMass::make(kilograms_per_cubic_metre(weight / volume)).value();
  return with;
}

constexpr BoltType strong{.tendon = 80e3, .plate = 1e6, .bond = 1e6, .anchorage = 0.5};

SupportPlan plan_with(std::vector<Bolt> bolts, double target = 1) {
  return {.bolts = std::move(bolts), .target_falling = target, .target_sliding = target};
}

TEST(BoltTest, CapacityIsTheLeastOfHeadTendonAndAnchor) {
  const BoltType type{.tendon = 100, .plate = 20, .bond = 50, .anchorage = 0.3};
  const auto at = [&](double t) { return capacity(type, true, t, 3 - t); };
  EXPECT_NEAR(at(0.2).force, 30, 1e-12);
  EXPECT_EQ(at(0.2).limit, BoltLimit::head);
  EXPECT_NEAR(at(1.2).force, 80, 1e-12);
  EXPECT_NEAR(at(1.5).force, 75, 1e-12);
  EXPECT_EQ(at(1.5).limit, BoltLimit::anchor);
  EXPECT_NEAR(at(2.6).force, 20, 1e-12);
  EXPECT_NEAR(at(3).force, 0, 1e-12);
  EXPECT_EQ(capacity({.tendon = 10, .plate = 20, .bond = 50, .anchorage = 0}, true, 1, 2).limit, BoltLimit::tendon);
}

// Plane 40/090, phi 30, 200 kN; bolt 80 kN, 15 degrees below horizontal into the slope.
TEST(SupportTest, BoltOnAPlane) {
  const Slope slope = Slope::make(40, 10, 2, {});
  const Settings with = weighing(200e3, 40, 30);
  const Analysis a = analyse(slope.complex, with);
  const double b = radians(15);
  const Bolt bolt{
      .collar = slope.at(5, 1, 2), .direction = {-std::cos(b), 0, -std::sin(b)}, .length = 8, .type = strong};
  const auto result = check_support(slope.complex, with, a, plan_with({bolt}));
  ASSERT_EQ(result.blocks.size(), 1U);
  const SupportedBlock& block = result.blocks[0];
  EXPECT_NEAR(block.factor_of_safety, 0.688059, 1e-6);
  EXPECT_NEAR(block.factor_with_bolts, 1.339294, 1e-6);
  EXPECT_NEAR(block.mobilised, 0.478999, 1e-6);
  EXPECT_EQ(block.held, Held::bolts);
  EXPECT_EQ(result.bolts[0].status, BoltStatus::holds);
  EXPECT_NEAR(result.bolts[0].used, 38319.9, 0.1);
  EXPECT_EQ(result.bolts[0].limit, BoltLimit::tendon);
  SupportPlan active = plan_with({bolt});
  active.active = true;
  EXPECT_NEAR(check_support(slope.complex, with, a, active).blocks[0].factor_with_bolts, 1.527616, 1e-6);
  // Bolts and friction are both divided by the target, so friction mobilised by bolts is so twice: a target below the
  // printed factor is reached, a little less far.
  EXPECT_TRUE(check_support(slope.complex, with, a, plan_with({bolt}, 1.25)).passes());
  const auto more = check_support(slope.complex, with, a, plan_with({bolt}, 1.4));
  EXPECT_FALSE(more.passes());
  EXPECT_GT(more.blocks[0].missing_force, 0);
  // Best single force at the friction angle to the plane: (T - R) cos(phi).
  const double t = 200e3 * std::sin(radians(40)), r = 200e3 * std::cos(radians(40)) * std::tan(radians(30));
  EXPECT_NEAR(block.required_force, (t - r) * std::cos(radians(30)), 1);
}

TEST(SupportTest, ShortSlackAndSteepBolts) {
  const Slope slope = Slope::make(40, 10, 2, {});
  const Settings with = weighing(200e3, 40, 30);
  const Analysis a = analyse(slope.complex, with);
  const Bolt down{.collar = slope.at(5, 1, 2), .direction = -slope.n, .length = 2.4, .type = strong};
  Bolt with_motion = down;  // pulls the block the way it wants to go
  with_motion.direction = geometry::normalized(slope.d - 0.5 * slope.n);
  with_motion.length = 9;
  Bolt off = down;
  off.collar = slope.at(5, 1, 2.5);
  const auto result = check_support(slope.complex, with, a, plan_with({down, with_motion, off}));
  EXPECT_EQ(result.bolts[0].status, BoltStatus::too_short);
  EXPECT_EQ(result.bolts[1].status, BoltStatus::compression);
  EXPECT_EQ(result.bolts[2].status, BoltStatus::off);
  EXPECT_FALSE(result.passes());
  ASSERT_EQ(result.bolts[0].pierced.size(), 2U);
  EXPECT_NEAR(result.bolts[0].pierced[0].to, 2, 1e-9);
  EXPECT_NEAR(result.bolts[0].pierced[1].to, 2.4, 1e-9);
}

// A bolt of no use beside one that is enough.
TEST(SupportTest, RedundantBoltsAreNamed) {
  const Slope slope = Slope::make(40, 10, 2, {});
  const Settings with = weighing(200e3, 40, 30);
  const Analysis a = analyse(slope.complex, with);
  std::vector<Bolt> bolts;
  for (const double x : {3.0, 5.0, 7.0}) {
    bolts.push_back({.collar = slope.at(x, 1, 2),
                     .direction = -slope.d * std::sqrt(0.5) - slope.n * std::sqrt(0.5),
                     .length = 8,
                     .type = strong});
  }
  const auto all = check_support(slope.complex, with, a, plan_with(bolts));
  for (const BoltResult& bolt : all.bolts) EXPECT_EQ(bolt.status, BoltStatus::redundant);
  bolts.resize(1);
  EXPECT_EQ(check_support(slope.complex, with, a, plan_with(bolts)).bolts[0].status, BoltStatus::holds);
}

// Ceiling block between vertical joints: falls. Bolts of 100 at 0 and 30 degrees from the vertical, W = 120.
struct Ceiling {
  topology::AuditedComplex complex;
  Settings with;
  Analysis analysis;
  static Ceiling make(double side, double height, double weight) {
    topology::CutInput input{.domain = geometry::make_box({-5, -5, 0}, {5, 5, 10}).value(),
                             .joints = {},
                             .excavations = {},
                             .free_domain_tags = {4}};
    for (const double s : {-side / 2, side / 2}) {
      input.joints.emplace_back(topology::PersistentJoint{{s, 0, 0}, {1, 0, 0}});
      input.joints.emplace_back(topology::PersistentJoint{{0, s, 0}, {0, 1, 0}});
    }
    input.joints.emplace_back(topology::PersistentJoint{{0, 0, height}, {0, 0, 1}});
    auto complex = audited(input);
    Settings with = weighing(weight, side * side * height, 35);
    Analysis analysis = analyse(complex, with);
    return {std::move(complex), std::move(with), std::move(analysis)};
  }
};

TEST(SupportTest, FallingBlockHangsOnItsBolts) {
  const Ceiling c = Ceiling::make(2, 2, 120);
  ASSERT_EQ(c.analysis.batches.size(), 1U);
  const BoltType type{.tendon = 100, .plate = 1e6, .bond = 1e6, .anchorage = 0.5};
  const double a = radians(30);
  const std::vector<Bolt> bolts{
      {.collar = {0.1, 0, 0}, .direction = {0, 0, 1}, .length = 4, .type = type},
      {.collar = {-0.5, 0, 0}, .direction = {std::sin(a), 0, std::cos(a)}, .length = 4, .type = type}};
  const auto result = check_support(c.complex, c.with, c.analysis, plan_with(bolts, 1.5));
  ASSERT_EQ(result.blocks.size(), 1U);
  EXPECT_NEAR(result.blocks[0].factor_with_bolts, 1.555021, 1e-6);
  EXPECT_NEAR(result.blocks[0].required_pressure, 1.5 * 120 / 4, 1e-6);
  EXPECT_NEAR(result.blocks[0].required_force, 1.5 * 120, 1e-6);
  EXPECT_EQ(result.blocks[0].free_area, 4);
}

TEST(SupportTest, ShotcreteHoldsSmallFacesByTheirPerimeter) {
  const Ceiling c = Ceiling::make(0.7, 1, 12.46e3);
  SupportPlan plan = plan_with({}, 1.5);
  plan.shotcrete = Shotcrete{.thickness = 0.07, .shear_strength = 1e6};
  const auto result = check_support(c.complex, c.with, c.analysis, plan);
  ASSERT_EQ(result.blocks.size(), 1U);
  EXPECT_NEAR(result.blocks[0].factor_with_shotcrete, 196 / 12.46, 1e-6);
  EXPECT_NEAR(result.blocks[0].needed_thickness, 1.5 * 12.46e3 / (2.8 * 1e6), 1e-9);
  EXPECT_EQ(result.blocks[0].held, Held::shotcrete);
  plan.spot_area = 0.1;  // too large a face for shotcrete alone
  EXPECT_EQ(check_support(c.complex, c.with, c.analysis, plan).blocks[0].held, Held::not_held);
}

TEST(SupportTest, SpotBoltsAreAddedUntilTheBlockHolds) {
  const Ceiling c = Ceiling::make(2, 2, 500e3);
  SupportPlan plan = plan_with({}, 1.5);
  plan.spot = SpotBolts{.type = {.tendon = 200e3, .plate = 200e3, .bond = 300e3, .anchorage = 0.5}, .length = 4};
  const auto result = check_support(c.complex, c.with, c.analysis, plan);
  EXPECT_EQ(result.spot_bolts, 4U);  // 750 kN at 200 kN each
  EXPECT_TRUE(result.passes());
  EXPECT_EQ(result.bolts.size(), 4U);
}

// W1 = 50 at the face, W2 = 100 behind it: the bolt holds the first block, and both slide together.
TEST(SupportTest, SecondStepFindsBlocksThatSlideTogether) {
  const Slope slope = Slope::make(30, 15, 2, {10});
  Settings with = weighing(150, 60, 20);
  with.force_transfer = false;
  const Analysis a = analyse(slope.complex, with);
  ASSERT_EQ(a.batches.size(), 2U);
  const BoltType type{.tendon = 40, .plate = 1e6, .bond = 1e6, .anchorage = 0.5};
  const Bolt bolt{.collar = slope.at(15, 1, 1), .direction = -slope.d, .length = 9, .type = type};
  const auto result = check_support(slope.complex, with, a, plan_with({bolt}));
  ASSERT_FALSE(result.blocks.empty());
  const SupportedBlock& front =
      result.blocks.back().block == a.batches[0].blocks[0] ? result.blocks.back() : result.blocks.front();
  EXPECT_EQ(front.held, Held::bolts);
  EXPECT_NEAR(front.mobilised, 0.230991, 1e-6);
  ASSERT_EQ(result.combined.size(), 1U);
  EXPECT_FALSE(result.combined[0].immovable);
  EXPECT_NEAR(result.combined[0].net_force, 27.718880, 1e-5);
  EXPECT_NEAR(result.combined[0].factor_of_safety, 0.630415, 1e-6);
  EXPECT_FALSE(result.passes());
  // Down into the base: both blocks are stitched to rock that stays.
  const Bolt deep{
      .collar = slope.at(12, 1, 2), .direction = geometry::normalized(-slope.d - slope.n), .length = 9, .type = type};
  const auto better = check_support(slope.complex, with, a, plan_with({deep}));
  ASSERT_EQ(better.combined.size(), 1U);
  EXPECT_TRUE(better.combined[0].immovable);
}

// Transferred forces inside a combined body cancel: with and without transfer the union has the same net force.
TEST(SupportTest, ForcesBetweenMembersAreInternal) {
  const Slope slope = Slope::make(30, 15, 2, {10});
  const Settings with = weighing(150, 60, 20);
  const Analysis a = analyse(slope.complex, with);
  const BoltType type{.tendon = 40, .plate = 1e6, .bond = 1e6, .anchorage = 0.5};
  const Bolt bolt{.collar = slope.at(15, 1, 1), .direction = -slope.d, .length = 9, .type = type};
  const auto result = check_support(slope.complex, with, a, plan_with({bolt}));
  ASSERT_EQ(result.combined.size(), 1U);
  EXPECT_NEAR(result.combined[0].net_force, 27.718880, 1e-5);
}

// Plates of 1 m and 3 m one behind the other: a bolt of 3 m with 0.5 m of anchorage grips both, with 2.5 m only one.
TEST(SupportTest, AnchorageDecidesWhatIsStitched) {
  const Slope slope = Slope::make(30, 4, 2, {3});
  const Settings with = weighing(150, 16, 20);
  const Analysis a = analyse(slope.complex, with);
  for (const auto& [anchorage, bodies] : {std::pair{0.5, std::size_t{1}}, std::pair{2.5, std::size_t{0}}}) {
    const BoltType type{.tendon = 40, .plate = 0, .bond = 1e6, .anchorage = anchorage};
    const Bolt bolt{.collar = slope.at(4, 1, 1), .direction = -slope.d, .length = 3, .type = type};
    EXPECT_EQ(check_support(slope.complex, with, a, plan_with({bolt})).combined.size(), bodies);
  }
}

TEST(PatternTest, RingsOfAHorseshoe) {
  RingPattern ring{.axis = {{40, 0, 30}, {40, 80, 30}}, .outline = {}, .type = {}};
  ring.outline.push_back({-5, -5});
  ring.outline.push_back({5, -5});
  ring.outline.push_back({5, 0});
  for (int i = 1; i < 64; ++i)
    ring.outline.push_back({5 * std::cos(radians(180.0 * i / 64)), 5 * std::sin(radians(180.0 * i / 64))});
  ring.outline.push_back({-5, 0});
  ring.along = 2.5;
  ring.around = 2.86;
  ring.offset_along = 1.25;
  const auto bolts = bolts_of(ring);
  EXPECT_EQ(bolts.size(), 288U);
  // First bolt of the first ring: at the foot of the right wall (east, looking north), into the rock.
  EXPECT_LT(norm(bolts[0].collar - Vec3{45, 1.25, 25}), 1e-9);
  EXPECT_LT(norm(bolts[0].direction - Vec3{1, 0, 0}), 1e-9);
  for (const Bolt& bolt : bolts) EXPECT_NEAR(norm(bolt.direction), 1, 1e-12);
  ring.arc = {-45, 45};
  for (const Bolt& bolt : bolts_of(ring)) EXPECT_GT(bolt.direction.z, std::cos(radians(46)));
  ring.stagger = true;
  EXPECT_LE(bolts_of(ring).size(), 32U * 3U);
}

TEST(PatternTest, GridCounts) {
  GridPattern grid{.corner = {0, 0, 0},
                   .across = {1, 0, 0},
                   .down = {0, 0, -1},
                   .width = 10,
                   .height = 6,
                   .direction = {0, 1, 0},
                   .type = {}};
  grid.spacing_across = 2;
  grid.spacing_down = 1.5;
  EXPECT_EQ(bolts_of(grid).size(), 6U * 5U);
  grid.offset_across = 1;
  EXPECT_EQ(bolts_of(grid).size(), 5U * 5U);
}

TEST(SensitivityTest, FrictionIsInProportion) {
  const Slope slope = Slope::make(40, 10, 2, {});
  const Settings with = weighing(200e3, 40, 30);
  const auto rows = sensitivity(slope.complex, with, analyse(slope.complex, with), 0.2);
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_NEAR(rows[0].friction[0], 0.8 * rows[0].base, 1e-12);
  EXPECT_NEAR(rows[0].friction[1], 1.2 * rows[0].base, 1e-12);
  EXPECT_EQ(rows[0].water[1], rows[0].base);
}

}  // namespace
}  // namespace cleave::stability
