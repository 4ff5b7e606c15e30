// Water, surcharges, point and line forces: integrals against closed forms, wedges of the literature with water.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "analyse_complex.hpp"
#include "audited.hpp"
#include "cleave/core/rng.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"
#include "handmade.hpp"
#include "statics.hpp"
#include "surface_loads.hpp"
#include "water.hpp"

namespace cleave::stability {
namespace {

using geometry::cross;
using geometry::dot;
using geometry::norm;
using geometry::normalized;
using geometry::Vec3;
using handmade::radians;
using handmade::upward;
using statics::audited;
using statics::find;
using statics::strength;
using topology::BlockId;

geometry::Solid box(Vec3 low, Vec3 high) { return geometry::make_box(low, high).value(); }

Actions actions(ActionSpec spec) { return Actions::make(std::move(spec)).value(); }

/// Random planes and rectangles through a box with a notch: convex and concave blocks, faces with several patches.
topology::CutInput random_rock(std::uint64_t seed) {
  Rng rng{{.seed = seed, .realization = 0, .purpose = 7, .index = 0}};
  topology::CutInput input{.domain = box({0, 0, 0}, {10, 10, 10}),
                           .joints = {},
                           .excavations = {box({3, -1, 4}, {6, 11, 7})},
                           .free_domain_tags = {5}};
  const auto vec = [&](double low, double high) {
    return Vec3{low + (high - low) * rng.uniform(), low + (high - low) * rng.uniform(),
                low + (high - low) * rng.uniform()};
  };
  for (int i = 0; i < 5; ++i) input.joints.emplace_back(topology::PersistentJoint{vec(1, 9), normalized(vec(-1, 1))});
  for (int i = 0; i < 8; ++i) {
    const Vec3 c = vec(0, 10), n = normalized(vec(-1, 1)), u = normalized(cross(n, {0.3, 0.5, 0.7})), v = cross(n, u);
    input.joints.emplace_back(topology::Joint{
        {geometry::Polygon::make({c + 4 * u + 4 * v, c - 4 * u + 4 * v, c - 4 * u - 4 * v, c + 4 * u - 4 * v})
             .value()}});
  }
  return input;
}

TEST(WaterTest, SubmergedBlockIsLiftedByItsVolumeThroughItsCentroid) {
  std::size_t concave = 0, checked = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const auto complex = audited(random_rock(seed));
    const auto& c = complex.complex();
    const Actions water = actions(
        {.water = WaterTable{.level = 20, .unit_weight = newtons_per_cubic_metre(9810), .on_free_faces = true}});
    for (const BlockId id : c.blocks().ids()) {
      const auto& block = c.blocks()[id];
      if (block.fixed) continue;  // what presses on the domain's outside is not counted
      const ForceSum sum = water_forces(c, water, {0, 0, -9.81}, id, [](BlockId) { return true; });
      const double lift = 9810 * block.volume.si();
      EXPECT_LT(norm(sum.force - Vec3{0, 0, lift}), 1e-9 * sum.scale);
      EXPECT_LT(norm(sum.moment), 1e-9 * sum.scale * 10);
      concave += block.convex ? 0U : 1U;
      ++checked;
    }
  }
  EXPECT_GT(checked, 20U);
  EXPECT_GT(concave, 2U);
}

// The part below the table is what a horizontal joint at the table's level cuts off.
TEST(WaterTest, LiftIsTheVolumeBelowTheTable) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const auto input = random_rock(seed);
    auto halved = input;
    halved.joints.emplace_back(topology::PersistentJoint{{0, 0, 5.3}, {0, 0, 1}});
    const auto whole = audited(input), parts = audited(halved);
    double below = 0, lift = 0, scale = 0;
    for (const auto& block : parts.complex().blocks()) {
      if (block.centroid.z < 5.3) below += block.volume.si();
    }
    const auto& c = whole.complex();
    const Actions water =
        actions({.water = WaterTable{.level = 5.3, .unit_weight = newtons_per_cubic_metre(1), .on_free_faces = true}});
    for (const BlockId id : c.blocks().ids()) {
      const ForceSum sum = water_forces(c, water, {0, 0, -1}, id, [](BlockId) { return true; });
      lift += sum.force.z;
      scale += sum.scale;
    }
    // The domain's bottom is no joint: there the pressure 5.3 on 100 m2 is missing; its sides carry no vertical part.
    EXPECT_NEAR(lift + 530, below, 1e-9 * scale) << seed;
  }
}

// Half of a wall's neighbours are gone, and the table crosses what is left: the overlap of the two blocks' faces
// counts.
TEST(WaterTest, OnlyContactsThatStandCarryWater) {
  topology::CutInput input{
      .domain = box({0, 0, 0}, {4, 2, 2}), .joints = {}, .excavations = {}, .free_domain_tags = {5}};
  input.joints.emplace_back(topology::PersistentJoint{{2, 0, 0}, {1, 0, 0}});
  input.joints.emplace_back(topology::Joint{
      {geometry::Polygon::make({Vec3{2, 1, -1}, Vec3{5, 1, -1}, Vec3{5, 1, 3}, Vec3{2, 1, 3}}).value()}});
  const auto complex = audited(input);
  const auto& c = complex.complex();
  ASSERT_EQ(c.blocks().size(), 3U);
  const auto at = [&](Vec3 x) {
    for (const BlockId id : c.blocks().ids()) {
      if (norm(c.blocks()[id].centroid - x) < 1e-9) return id;
    }
    ADD_FAILURE();
    return BlockId{0U};
  };
  const BlockId west = at({1, 1, 1}), south = at({3, 0.5, 1}), north = at({3, 1.5, 1});
  const Actions water = actions({.water = WaterTable{.level = 1.5, .unit_weight = newtons_per_cubic_metre(10)}});
  const auto force = [&](auto there) { return water_forces(c, water, {0, 0, -9}, west, there).force; };
  const double full = 10 * 1.5 * 1.5 / 2 * 2;
  EXPECT_LT(norm(force([](BlockId) { return true; }) - Vec3{-full, 0, 0}), 1e-12);
  EXPECT_LT(norm(force([&](BlockId b) { return b != south; }) - Vec3{-full / 2, 0, 0}), 1e-12);
  EXPECT_LT(norm(force([&](BlockId b) { return b == west; })), 1e-12);
  const ForceSum part = water_forces(c, water, {0, 0, -9}, west, [&](BlockId b) { return b != south; });
  // Centre of pressure: a third of the depth above the bottom, in the northern half.
  const Vec3 arm{1, 0.5, 0.5 - 1};
  EXPECT_LT(norm(part.moment - cross(arm, Vec3{-full / 2, 0, 0})), 1e-12);
  static_cast<void>(north);
}

TEST(WaterTest, WorkedExample) {  // W = 5000 kN, 40 m2 of 35/090, phi 30, c = 20 kPa, u = 15 kPa, 0.1 g to the east
  handmade::Complex hand;
  const auto block = hand.block(5e6);
  const auto base = hand.fixed_block();
  hand.contact(block, base, upward(35, 90), 40, 0);
  hand.free_face(block);
  Settings with = statics::settings({strength(30, 20e3)}, {0.1, 0, 0});
  with.actions = actions({.joint_pressure = {15e3}});
  const Analysis a = analyse_complex(hand.build(), with);
  ASSERT_EQ(a.judgements.size(), 1U);
  EXPECT_NEAR(a.judgements[0].factor_of_safety, 0.809377, 5e-7);
}

// Hoek, Practical Rock Engineering, Sau Mau Ping, per metre: kN.
TEST(WaterTest, PlaneFailureWithTensionCrack) {
  const double z = 14.0091531562, area = 80.1825945578, weight = 23923.7830693;
  const std::array<std::array<double, 3>, 5> cases{{{0, 0, 1.584331028},
                                                    {0.5, 0, 1.41315862664},
                                                    {1, 0, 1.19879295534},
                                                    {0, 0.08, 1.37160592367},
                                                    {1, 0.08, 1.03425003496}}};
  for (const auto& [share, quake, factor] : cases) {
    handmade::Complex hand;
    const auto block = hand.block(weight);
    const auto base = hand.fixed_block();
    hand.contact(block, base, upward(35, 90), area, 0);
    hand.contact(block, base, {1, 0, 0}, z, 1);
    hand.free_face(block);
    Settings with = statics::settings({strength(35, 100), strength(0)}, {quake, 0, 0});
    const double zw = share * z;
    with.actions = actions({.joint_pressure = {10 * zw / 2, 10 * zw * zw / 2 / z}});
    const Analysis a = analyse_complex(hand.build(), with);
    ASSERT_EQ(a.judgements.size(), 1U);
    EXPECT_NEAR(a.judgements[0].factor_of_safety, factor, 1e-9);
  }
}

/// Slope of Hoek and Bray's wedges: face 65/185 below upper ground 12/195 (feet, pounds), a prism along the crest.
geometry::Solid slope(Vec3 crest) {
  const Vec3 face = upward(65, 185), top = upward(12, 195), line = cross(face, top);
  const Vec3 h = normalized({line.x, line.y, 0}), along = normalized(line);
  const auto towards = [](Vec3 v, bool up) { return (v.z > 0) == up ? v : -v; };
  const Vec3 f = normalized(towards(cross(face, h), false)), t = normalized(towards(cross(top, h), true));
  const std::array<Vec3, 5> section{crest, crest + 600.0 * t, crest + 600.0 * t - Vec3{0, 0, 900},
                                    crest + 500.0 * f - Vec3{0, 0, 300}, crest + 500.0 * f};
  std::vector<Vec3> vertices;
  for (const double side : {-900.0, 900.0}) {
    for (const Vec3 p : section) vertices.push_back(p + side * along);
  }
  std::vector<geometry::SolidFace> faces{{{0, 1, 2, 3, 4}, 0}, {{9, 8, 7, 6, 5}, 0}};
  for (std::uint32_t i = 0; i < 5; ++i) {
    const std::uint32_t j = (i + 1) % 5;
    faces.push_back({{j, i, i + 5, j + 5}, i == 0 || i == 4 ? 1U : 0U});
  }
  auto solid = geometry::Solid::make(vertices, faces, {"rock", "ground"});
  if (solid) return *solid;
  for (auto& f2 : faces) std::ranges::reverse(f2.corners);
  return geometry::Solid::make(vertices, faces, {"rock", "ground"}).value();
}

double wedge_factor(bool crack, double phi1, double phi2, double u) {
  const Vec3 n1 = upward(45, 105), n2 = upward(70, 235), n3 = upward(12, 195), n4 = upward(65, 185);
  const auto rising = [](Vec3 v) { return v.z > 0 ? v : -v; };
  Vec3 on_crest;  // the toe, where planes 1, 2 and the face meet, is the origin
  topology::CutInput input{
      .domain = box({0, 0, 0}, {1, 1, 1}), .joints = {}, .excavations = {}, .free_domain_tags = {1}};
  input.joints.emplace_back(topology::PersistentJoint{{}, n1});
  input.joints.emplace_back(topology::PersistentJoint{{}, n2});
  if (crack) {
    const Vec3 up_face = rising(cross(n1, n4));
    on_crest = (100 / up_face.z) * up_face;
    Vec3 back = normalized(cross(n1, n3));
    if (dot(back, n4) > 0) back = -back;
    input.joints.emplace_back(topology::PersistentJoint{on_crest + 40.0 * back, upward(70, 165)});
  } else {
    const Vec3 line = rising(cross(n1, n2));
    const Vec3 head = (130 / line.z) * line;
    // Where the trace of plane 1 on the face reaches the upper ground, which goes through the wedge's head.
    const Vec3 up_face = rising(cross(n1, n4));
    on_crest = (dot(n3, head) / dot(n3, up_face)) * up_face;
  }
  input.domain = slope(on_crest);
  const auto complex = audited(input);
  Settings with = statics::settings({strength(phi1, 500), strength(phi2, 1000), strength(0)});
  with.rock = RockMass::make(kilograms_per_cubic_metre(160)).value();
  with.actions = actions({.joint_pressure = {u, u, u}});
  const Analysis a = analyse(complex, with);
  double factor = -1;
  for (const Judgement& j : a.judgements) {
    const auto& block = complex.complex().blocks()[j.block];
    if (j.mode != Mode::wedge || block.faces.size() != (crack ? 5U : 4U)) continue;
    if (crack) {
      EXPECT_NEAR(block.volume.si() / 176701.221, 1, 1e-8);
    }
    factor = j.factor_of_safety;
  }
  return factor;
}

TEST(WaterTest, HoekAndBrayWedgeFromItsGeometry) {
  EXPECT_NEAR(wedge_factor(true, 20, 30, 0), 1.73557674673, 1e-9);
  EXPECT_NEAR(wedge_factor(true, 20, 30, 62.5 * 52.0447891 / 3), 1.13782292336, 2e-9);
  EXPECT_NEAR(wedge_factor(true, 30, 20, 0), 1.862466, 1e-6);
  EXPECT_NEAR(wedge_factor(false, 20, 30, 0), 1.846356, 1e-6);
  EXPECT_NEAR(wedge_factor(false, 20, 30, 62.5 * 130 / 6), 1.217984, 1e-6);
  EXPECT_NEAR(wedge_factor(false, 30, 20, 62.5 * 130 / 6), 1.345974, 1e-6);
}

struct Ground {
  topology::AuditedComplex complex = audited([] {
    topology::CutInput input{
        .domain = box({0, 0, 0}, {10, 10, 4}), .joints = {}, .excavations = {}, .free_domain_tags = {5}};
    input.joints.emplace_back(topology::PersistentJoint{{3, 0, 0}, {1, 0, 0}});
    input.joints.emplace_back(topology::PersistentJoint{{7, 0, 0}, {1, 0, 0}});
    return input;
  }());
  [[nodiscard]] ForceSum at(const Actions& with, double x) const {
    const auto sums = surface_forces(complex.complex(), with);
    for (const BlockId id : complex.complex().blocks().ids()) {
      if (std::abs(complex.complex().blocks()[id].centroid.x - x) < 1e-6) return sums[id];
    }
    return {};
  }
};

TEST(SurfaceLoadTest, SurchargeOnTheAreaInsideTheBox) {
  const Ground ground;
  const Actions load = actions({.surcharges = {{.on = DomainSide{5},
                                                .within = Box{{1, 2, 3}, {5, 6, 5}},
                                                .traction = {0, 100, 0},
                                                .pressure = pascals(50)}}});
  EXPECT_LT(norm(ground.at(load, 1.5).force - Vec3{0, 800, -400}), 1e-9);  // x 1..3, y 2..6
  EXPECT_LT(norm(ground.at(load, 5).force - Vec3{0, 800, -400}), 1e-9);    // x 3..5
  EXPECT_LT(norm(ground.at(load, 8.5).force), 1e-12);
  const Vec3 arm = Vec3{4, 4, 4} - Vec3{5, 5, 2};
  EXPECT_LT(norm(ground.at(load, 5).moment - cross(arm, Vec3{0, 800, -400})), 1e-9);
  EXPECT_LT(norm(ground.at(actions({.surcharges = {{.on = ExcavationWall{0}, .pressure = pascals(1)}}}), 5).force),
            1e-12);
}

TEST(SurfaceLoadTest, PointAndLineForcesGoToTheBlocksUnderThem) {
  const Ground ground;
  const Actions load = actions({.points = {{.at = {8, 1, 4.01}, .force = {1, 2, -3}}},
                                .lines = {{.from = {1, 5, 4}, .to = {9, 5, 4}, .per_metre = {0, 0, -10}}}});
  EXPECT_LT(norm(ground.at(load, 1.5).force - Vec3{0, 0, -20}), 1e-9);
  EXPECT_LT(norm(ground.at(load, 5).force - Vec3{0, 0, -40}), 1e-9);
  EXPECT_LT(norm(ground.at(load, 8.5).force - Vec3{1, 2, -23}), 1e-9);
  EXPECT_TRUE(misplaced(ground.complex.complex(), load).empty());
  const Actions off = actions({.points = {{.at = {8, 1, 4.5}, .force = {1, 0, 0}}},
                               .lines = {{.from = {5, 5, 4}, .to = {15, 5, 4}, .per_metre = {0, 0, -10}}}});
  const auto wrong = misplaced(ground.complex.complex(), off);
  ASSERT_EQ(wrong.size(), 2U);
  EXPECT_NEAR(wrong[0].off.si(), 0.5, 1e-9);
  EXPECT_NEAR(wrong[1].off.si(), 5, 1e-9);
}

TEST(SurfaceLoadTest, WrongActionsAreRefused) {
  EXPECT_FALSE(Actions::make({.water = WaterTable{.level = std::nan("")}}).has_value());
  EXPECT_FALSE(Actions::make({.joint_pressure = {-1.0}}).has_value());
  EXPECT_FALSE(Actions::make({.surcharges = {{.within = Box{{1, 1, 1}, {0, 2, 2}}}}}).has_value());
  EXPECT_FALSE(Actions::make({.lines = {{.from = {1, 1, 1}, .to = {1, 1, 1}, .per_metre = {}}}}).has_value());
}

TEST(BartonBandisTest, FrictionFollowsTheNormalStress) {
  const auto joint = JointStrength::barton_bandis(FrictionAngle::degrees(28), 8, pascals(50e6)).value();
  for (const double area : {2.0, 40.0, 900.0}) {
    handmade::Complex hand;
    const auto block = hand.block(5e6);
    hand.contact(block, hand.fixed_block(), upward(50, 90), area, 0);
    hand.free_face(block);
    const Analysis a = analyse_complex(hand.build(), statics::settings({joint}));
    const double stress = 5e6 * std::cos(radians(50)) / area;
    const double angle = std::min(70.0, 28 + 8 * std::log10(50e6 / stress));
    EXPECT_NEAR(a.judgements.at(0).factor_of_safety, std::tan(radians(angle)) / std::tan(radians(50)), 1e-12);
  }
  EXPECT_NEAR(joint.tan_friction(pascals(1e9)), std::tan(radians(28)), 1e-15);
  EXPECT_NEAR(joint.tan_friction(pascals(0)), std::tan(radians(70)), 1e-12);
  EXPECT_FALSE(JointStrength::barton_bandis(FrictionAngle::degrees(28), 21, pascals(1)).has_value());
  EXPECT_FALSE(JointStrength::barton_bandis(FrictionAngle::degrees(28), 8, pascals(0)).has_value());
}

// Two joints on one plane, one straight and one curved: the mean by area.
TEST(BartonBandisTest, SharesAPlaneWithAStraightJoint) {
  const auto curved = JointStrength::barton_bandis(FrictionAngle::degrees(30), 10, pascals(100e6)).value();
  handmade::Complex hand;
  const auto block = hand.block(1e6);
  const auto base = hand.fixed_block();
  hand.contact(block, base, upward(45, 90), 3, 0);
  hand.contact(block, base, upward(45, 90), 1, 1);
  hand.free_face(block);
  Settings with = statics::settings({strength(20), curved});
  with.partial = PartialFactors::make(1.25, 1, 1).value();
  const double stress = 1e6 * std::cos(radians(45)) / 4;
  const double mean = (3 * std::tan(radians(20)) + std::tan(radians(30 + 10 * std::log10(100e6 / stress)))) / 4;
  EXPECT_NEAR(analyse_complex(hand.build(), with).judgements.at(0).factor_of_safety, mean / 1.25, 1e-12);
  with.group_friction = GroupFriction::smallest;
  EXPECT_NEAR(analyse_complex(hand.build(), with).judgements.at(0).factor_of_safety, std::tan(radians(20)) / 1.25,
              1e-12);
}

// What acts on blocks in motion, force by force, is what the verdict has in sum; a lake about all blocks is left out.
TEST(SingleLoadsTest, AddUpToWhatTheVerdictHas) {
  const Vec3 gravity{1, -0.5, -9.81};
  std::size_t looked_at = 0, pairs = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const topology::CutInput input = random_rock(seed);
    const auto audited_complex = topology::audit(topology::cut(input).value());
    ASSERT_TRUE(audited_complex.has_value());
    const topology::BlockComplex& complex = audited_complex->complex();
    std::vector<BlockId> all;
    for (const BlockId id : complex.blocks().ids()) all.push_back(id);
    for (const bool lake : {false, true}) {
      ActionSpec spec{.water = WaterTable{.level = 5.5, .on_free_faces = lake}};
      spec.joint_pressure.resize(input.joints.size());
      spec.or_table.resize(input.joints.size());
      for (std::size_t j = 0; j < input.joints.size(); ++j) {
        if (j % 3 == 0) spec.joint_pressure[j] = 20e3;
        spec.or_table[j] = j % 2 == 0 ? 1 : 0;
      }
      spec.surcharges.push_back({.traction = {1e3, 5e3, -20e3}, .pressure = pascals(3e3)});
      spec.points.push_back({.at = {4.5, 5, 4}, .force = {1e4, 0, -1e5}});
      spec.lines.push_back({.from = {3, 2, 7}, .to = {6, 2, 7}, .per_metre = {0, 2e3, 1e4}});
      const Actions acting = actions(spec);
      const Actions still = actions({.water = WaterTable{.level = 5.5, .on_free_faces = true}});
      const auto there = [](BlockId) { return true; };
      const auto on_surface = surface_forces(complex, acting);
      IdVector<BlockId, ForceSum> sums(complex.blocks().size());
      for (const LoadOnBlock& load : loads_on(complex, acting, gravity, all)) {
        sums[load.block].add(load.force, load.at - complex.blocks()[load.block].centroid);
        EXPECT_EQ(load.neighbour.has_value(), load.contact.si() > 0);
        pairs += load.neighbour ? 1U : 0U;
      }
      for (const BlockId id : all) {
        ForceSum wanted = water_forces(complex, acting, gravity, id, there);
        wanted.force += on_surface[id].force;
        wanted.moment += on_surface[id].moment;
        ForceSum got = sums[id];
        if (lake) {
          const ForceSum about = water_forces(complex, still, gravity, id, there);
          got.force += about.force;
          got.moment += about.moment;
        }
        const double scale = 1 + wanted.scale + on_surface[id].scale;
        EXPECT_LT(norm(got.force - wanted.force), 1e-10 * scale) << seed << lake;
        EXPECT_LT(norm(got.moment - wanted.moment), 1e-9 * scale) << seed << lake;
        looked_at += norm(wanted.force) > 0 ? 1U : 0U;
      }
    }
  }
  EXPECT_GT(looked_at, 100U);
  EXPECT_GT(pairs, 500U);
}

}  // namespace
}  // namespace cleave::stability
