// Scenes cut by the cutter, audited, analysed: published and derived answers from geometry to factor of safety.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include "audited.hpp"
#include "cleave/core/rng.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/geometry/tunnel.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"
#include "statics.hpp"

namespace cleave::stability {
namespace {

using geometry::Attitude;
using geometry::norm;
using geometry::Vec3;
using statics::audited;
using statics::find;
using statics::strength;
using topology::BlockId;

Attitude plane(double dip, double direction) { return {Dip::degrees(dip), DipDirection::degrees(direction)}; }

topology::PersistentJoint persistent(Vec3 through, double dip, double direction) {
  return {through, geometry::upward_normal(plane(dip, direction))};
}

topology::Joint polygon(std::vector<Vec3> corners) { return {{geometry::Polygon::make(std::move(corners)).value()}}; }

/// Density 2700, g 9.81.
Settings rock(std::initializer_list<JointStrength> strengths) {
  Settings with = statics::settings(strengths);
  with.rock = RockMass::make(kilograms_per_cubic_metre(2700)).value();
  with.loads = Loads::make({0, 0, -9.81}).value();
  return with;
}

// Thesis 4.5.1 with slope 70/090, horizontal top, joints 60/045 and 60/135 that meet on the face 1 m above the toe.
TEST(ScenesTest, WedgeOnASlope) {
  const double run = 1 / std::tan(70 * std::numbers::pi / 180);  // the face recedes this much a metre of height
  const std::array<std::array<double, 2>, 6> profile{
      {{-30, -10}, {10, -10}, {10, 0}, {0, 0}, {-10 * run, 10}, {-30, 10}}};
  std::vector<Vec3> vertices;
  for (const double y : {-20.0, 20.0}) {
    for (const auto& [x, z] : profile) vertices.push_back({x, y, z});
  }
  // Seen from the south the profile turns counter-clockwise.
  std::vector<geometry::SolidFace> faces{{{0, 1, 2, 3, 4, 5}, 0}, {{11, 10, 9, 8, 7, 6}, 0}};
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t j = (i + 1) % 6;
    faces.push_back({{j, i, i + 6, j + 6}, i >= 2 && i <= 4 ? 1U : 0U});  // bench, slope and top are free
  }
  auto domain = geometry::Solid::make(vertices, faces, {"rock", "ground"});
  ASSERT_TRUE(domain.has_value()) << describe(domain.error());
  const Vec3 toe{-run, 0, 1};
  const topology::CutInput input{.domain = *domain,
                                 .joints = {persistent(toe, 60, 45), persistent(toe, 60, 135)},
                                 .excavations = {},
                                 .free_domain_tags = {1}};
  const auto complex = audited(input);
  const Analysis a = analyse(complex, rock({strength(30)}));
  ASSERT_EQ(a.batches.size(), 1U);
  ASSERT_EQ(a.batches[0].blocks.size(), 1U);
  const Judgement& wedge = *find(a, a.batches[0].blocks[0]);
  EXPECT_EQ(wedge.mode, Mode::wedge);
  EXPECT_NEAR(norm(wedge.direction - Vec3{0.632455532034, 0, -0.774596669241}), 0, 1e-10);
  EXPECT_NEAR(wedge.factor_of_safety, 0.596284794, 1e-9);
  // Tetrahedron: apex at the toe, base on the top between the crest and the end of the line of intersection.
  const double reach = 9 * std::sqrt(2.0 / 3.0);  // the line runs this far back while it climbs 9 m
  const double depth = reach - 9 * run;
  EXPECT_NEAR(complex.complex().blocks()[wedge.block].volume.si(), depth * depth * 9 / 3, 1e-9);
  // Critical friction.
  EXPECT_TRUE(analyse(complex, rock({strength(44.0757)})).judgements.at(0).key);
  EXPECT_FALSE(analyse(complex, rock({strength(44.0758)})).judgements.at(0).key);
}

TEST(ScenesTest, RoofTetrahedronFalls) {
  std::vector<std::variant<topology::Joint, topology::PersistentJoint>> joints;
  for (const double direction : {0.0, 120.0, 240.0}) {
    const Vec3 n = geometry::upward_normal(plane(90, direction));  // horizontal, outwards: inradius 1
    joints.emplace_back(persistent(n, 60, direction));
  }
  const topology::CutInput input{.domain = geometry::make_box({-10, -10, 0}, {10, 10, 10}).value(),
                                 .joints = joints,
                                 .excavations = {},
                                 .free_domain_tags = {4}};
  const auto complex = audited(input);
  for (const double friction : {0.0, 45.0, 89.0}) {
    const Analysis a = analyse(complex, rock({strength(friction, 1e6)}));
    ASSERT_EQ(a.batches.size(), 1U);
    ASSERT_EQ(a.batches[0].blocks.size(), 1U);
    const Judgement& j = *find(a, a.batches[0].blocks[0]);
    EXPECT_EQ(j.mode, Mode::falling);
    EXPECT_NEAR(complex.complex().blocks()[j.block].volume.si(), 3, 1e-12);
    EXPECT_EQ(j.net, j.weight);
    EXPECT_EQ(j.factor_of_safety, 0);
    EXPECT_EQ(j.direction, (Vec3{0, 0, -1}));
  }
  // The same pyramid under a floor stands; turned over it hangs: gravity upwards is the same as a roof turned round.
  Settings upwards = rock({strength(0)});
  upwards.loads = Loads::make({0, 0, 9.81}).value();
  const Analysis floor = analyse(complex, upwards);
  ASSERT_EQ(floor.judgements.size(), 1U);
  EXPECT_EQ(floor.judgements[0].mode, Mode::stable);
  EXPECT_TRUE(floor.batches.empty());
}

/// Integration scene of the theory: three slabs in line on a plane of 30 degrees leave one after the other. The
/// rectangles between them end `beyond` metres past the base plane and the sides of the domain.
void expect_three_slabs(bool persistent_base, double beyond, Length snap) {
  const double s = 0.5, c = std::sqrt(0.75);
  const auto at = [&](double x, double y, double z) { return Vec3{c * x + s * z, y, -s * x + c * z}; };
  std::array<Vec3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    corners[i] = at((i & 1) != 0 ? 30 : 0, (i & 2) != 0 ? 10 : 0, (i & 4) != 0 ? 5 : -5);
  }
  const auto wall = [&](double x) {
    return polygon({at(x, -beyond, -beyond), at(x, 10 + beyond, -beyond), at(x, 10 + beyond, 5 + beyond),
                    at(x, -beyond, 5 + beyond)});
  };
  std::variant<topology::Joint, topology::PersistentJoint> base = topology::PersistentJoint{{0, 0, 0}, {s, 0, c}};
  if (!persistent_base) base = polygon({at(-1, -1, 0), at(31, -1, 0), at(31, 11, 0), at(-1, 11, 0)});
  const topology::CutInput input{.domain = geometry::make_hexahedron(corners).value(),
                                 .joints = {base, wall(10), wall(20)},
                                 .excavations = {},
                                 .free_domain_tags = {0, 1, 2, 3, 5},
                                 .snap = snap};
  const auto complex = audited(input);
  ASSERT_EQ(complex.complex().blocks().size(), 4U);
  const Analysis a = analyse(complex, rock({strength(20)}));
  ASSERT_EQ(a.batches.size(), 3U);
  const std::array net_after{7341899.649, 4894599.766, 2447299.883};
  for (std::size_t k = 0; k < 3; ++k) {
    ASSERT_EQ(a.batches[k].blocks.size(), 1U);
    const Judgement& j = *find(a, a.batches[k].blocks[0]);
    EXPECT_EQ(j.mode, Mode::sliding);
    EXPECT_NEAR(j.weight.si(), 13243500, 1e-3);
    EXPECT_NEAR(j.net.si(), 2447299.883, 1e-2);
    EXPECT_NEAR(j.factor_of_safety, 0.630415, 1e-6);
    EXPECT_NEAR(norm(j.direction - Vec3{c, 0, -s}), 0, 1e-10);
    EXPECT_NEAR(j.transferred->net.si(), net_after[k], 1e-2);
    // The lowest slab, x in [20, 30], is the first.
    const Vec3 centroid = complex.complex().blocks()[j.block].centroid;
    EXPECT_NEAR(norm(centroid - at(25 - 10 * static_cast<double>(k), 5, 2.5)), 0, 1e-9);
  }
  EXPECT_LT(a.equilibrium_residual, 1e-12);
}

TEST(ScenesTest, SlabsInLineAndForceTransfer) {
  expect_three_slabs(true, 0.25, metres(0));
  expect_three_slabs(false, 0.25, metres(0));  // what reaches into the base separates nothing
}

// As stated, ending on the base plane: on the lattice they end a site short of it, and `snap` closes the gap.
TEST(ScenesTest, SlabsWhoseJointsEndOnTheBasePlane) { expect_three_slabs(false, 0, metres(1e-6)); }

// A cube in a vertical wall that faces east: five joint faces, one way out.
TEST(ScenesTest, CubeInAWall) {
  const auto rectangle = [](Vec3 a, Vec3 b, Vec3 c) { return polygon({a, b, c, a + c - b}); };
  const std::vector<std::variant<topology::Joint, topology::PersistentJoint>> joints{
      rectangle({-1, 0, 0}, {0, 0, 0}, {0, 1, 0}),  // floor
      rectangle({-1, 0, 1}, {0, 0, 1}, {0, 1, 1}),  // roof
      rectangle({-1, 0, 0}, {0, 0, 0}, {0, 0, 1}),  // sides
      rectangle({-1, 1, 0}, {0, 1, 0}, {0, 1, 1}), rectangle({-1, 0, 0}, {-1, 1, 0}, {-1, 1, 1})};
  const topology::CutInput input{.domain = geometry::make_box({-4, -4, -4}, {0, 4, 4}).value(),
                                 .joints = joints,
                                 .excavations = {},
                                 .free_domain_tags = {1}};
  const auto complex = audited(input);
  ASSERT_EQ(complex.complex().blocks().size(), 2U);
  Settings with = rock({strength(35)});
  const Analysis still = analyse(complex, with);
  ASSERT_EQ(still.judgements.size(), 1U);
  EXPECT_EQ(still.judgements[0].mode, Mode::stable);
  EXPECT_EQ(still.judgements[0].cone_dimension, 1);
  with.loads = Loads::make({0, 0, -9.81}, {0.3, 0, 0}).value();
  const Analysis shaken = analyse(complex, with);
  ASSERT_EQ(shaken.judgements.size(), 1U);
  EXPECT_EQ(shaken.judgements[0].mode, Mode::sliding);
  EXPECT_NEAR(shaken.judgements[0].factor_of_safety, 2.334025, 1e-6);
  EXPECT_EQ(shaken.judgements[0].direction, (Vec3{1, 0, 0}));
}

// Random planes through a box with three free sides: what every analysis must satisfy, whatever the scene.
TEST(ScenesTest, LawsOnRandomRock) {
  std::size_t batches = 0, key = 0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    Rng rng{seed};
    topology::CutInput input{.domain = geometry::make_box({0, 0, 0}, {10, 10, 10}).value(),
                             .joints = {},
                             .excavations = {},
                             .free_domain_tags = {1, 3, 5}};
    for (int i = 0; i < 14; ++i) {
      const Vec3 through{10 * rng.uniform(), 10 * rng.uniform(), 10 * rng.uniform()};
      input.joints.emplace_back(topology::PersistentJoint{through, {rng.normal(), rng.normal(), rng.normal()}});
    }
    const auto complex = audited(input);
    const auto& blocks = complex.complex().blocks();
    const Analysis a = analyse(complex, rock({strength(20)}));
    batches += a.batches.size();
    std::vector<std::uint32_t> batch_of(blocks.size(), UINT32_MAX);
    for (const Batch& batch : a.batches) {
      Volume volume;
      for (const BlockId id : batch.blocks) {
        EXPECT_EQ(batch_of[id.index()], UINT32_MAX);
        batch_of[id.index()] = batch.number;
        volume += blocks[id].volume;
        EXPECT_FALSE(blocks[id].fixed);
        ++key;
      }
      EXPECT_NEAR(volume.si(), batch.volume.si(), 1e-9);
    }
    for (const Judgement& j : a.judgements) {
      if (!moves(j.mode)) continue;
      // No motion into rock that is still there; downhill; not more force than weight.
      for (const topology::FaceId id : blocks[j.block].faces) {
        const topology::Face& face = complex.complex().faces()[id];
        for (const topology::Patch& patch : complex.complex().patches(face)) {
          if (!patch.neighbour) continue;
          if (batch_of[patch.neighbour->index()] >= j.batch.value_or(UINT32_MAX)) {
            EXPECT_LE(dot(face.outward, j.direction), 1e-12);
          }
        }
      }
      EXPECT_LT(j.direction.z, 0);
      EXPECT_LE(j.driving.si(), j.weight.si() * (1 + 1e-15));
      EXPECT_NEAR(j.driving.si(), -j.direction.z * j.weight.si(), 1e-12 * j.weight.si());  // s.r = |s|^2
      EXPECT_EQ(j.key, j.factor_of_safety < 1);
      if (j.transferred) {
        EXPECT_EQ(j.batch, batch_of[j.block.index()]);
      }
    }
    EXPECT_LT(a.equilibrium_residual, 1e-12);
  }
  EXPECT_GT(batches, 12U);
  EXPECT_GT(key, 60U);
}

/// A prism in a wall that looks `out`: sides through these corners (across, up) along `out`, its back 3 m behind a room
/// before the wall.
struct Frame {
  Vec3 at, out, across, up;
  Vec3 operator()(double a, double b, double c) const { return at + a * out + b * across + c * up; }
};
Frame frame(Vec3 at, double dip, double azimuth) {
  const double d = dip * std::numbers::pi / 180;
  const Vec3 ahead = geometry::upward_normal(plane(90, azimuth));
  const Vec3 out = std::cos(d) * ahead - Vec3{0, 0, std::sin(d)};
  const Vec3 across = cross(out, std::sin(d) * ahead + Vec3{0, 0, std::cos(d)});
  return {at, out, across, cross(across, out)};
}
topology::CutInput prism(const Frame& at, const std::vector<std::array<double, 2>>& corners) {
  topology::CutInput input{.domain = geometry::make_box(at.at - Vec3{10, 10, 10}, at.at + Vec3{10, 10, 10}).value(),
                           .joints = {},
                           .excavations = {},
                           .free_domain_tags = {}};
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const auto [b, c] = corners[k];
    const auto [to_b, to_c] = corners[(k + 1) % corners.size()];
    const double x = 0.3 * (to_b - b), y = 0.3 * (to_c - c);
    input.joints.emplace_back(
        polygon({at(-4, b - x, c - y), at(2, b - x, c - y), at(2, to_b + x, to_c + y), at(-4, to_b + x, to_c + y)}));
  }
  input.joints.emplace_back(polygon({at(-3, -3, -3), at(-3, 3, -3), at(-3, 3, 3), at(-3, -3, 3)}));
  std::vector<Vec3> room;
  for (const double a : {0.0, 3.0}) {
    for (const auto& [b, c] : std::array<std::array<double, 2>, 4>{{{-4, -4}, {4, -4}, {4, 4}, {-4, 4}}}) {
      room.push_back(at(a, b, c));
    }
  }
  std::vector<geometry::SolidFace> faces{{{0, 3, 2, 1}, 0}, {{4, 5, 6, 7}, 0}};
  for (std::uint32_t i = 0; i < 4; ++i) faces.push_back({{i, (i + 1) % 4, (i + 1) % 4 + 4, i + 4}, 0});
  if (dot(cross(at.across, at.up), at.out) < 0) {
    for (auto& face : faces) std::ranges::reverse(face.corners);
  }
  input.excavations.push_back(geometry::Solid::make(std::move(room), std::move(faces)).value());
  return input;
}

// Joints that were drawn parallel, or through one line, in any direction: their doubles are so to a rounding only, and
// whatever that is the prism between them slides out, or falls, with the same factor.
TEST(ScenesTest, WhatIsDrawnParallelDoesNotTaper) {
  Rng draw{11};
  for (int k = 0; k < 100; ++k) {
    const double dip = 10 + 30 * draw.uniform(), x = 40 * draw.uniform();
    const auto cut =
        audited(prism(frame({x, -x, 7}, dip, 360 * draw.uniform()), {{-1, -0.5}, {1, -0.5}, {1, 0.5}, {-1, 0.5}}));
    const Analysis analysis = analyse(cut, rock({strength(5)}));
    ASSERT_EQ(cut.complex().blocks().size(), 2U) << k;
    ASSERT_EQ(analysis.batches.size(), 1U) << k;
    const Judgement& drawer = analysis.judgements.at(0);
    EXPECT_TRUE(drawer.mode == Mode::sliding || drawer.mode == Mode::wedge)
        << k << ": it leans on a side by a rounding";
    EXPECT_NEAR(drawer.factor_of_safety, std::tan(5 * std::numbers::pi / 180) / std::tan(dip * std::numbers::pi / 180),
                1e-9);
  }
}

TEST(ScenesTest, WhatIsDrawnThroughOneLineDoesNotTaper) {
  Rng draw{12};
  for (int k = 0; k < 40; ++k) {
    std::vector<std::array<double, 2>> corners;
    const int sides = 3 + k % 3;
    for (int i = 0; i < sides; ++i) {
      const double angle = (i + 0.6 * draw.uniform()) * 2 * std::numbers::pi / sides;
      corners.push_back({1.2 * std::cos(angle), 1.2 * std::sin(angle)});
    }
    const double dip = k % 4 == 0 ? 90 : 50 + 35 * draw.uniform();
    std::optional<double> factor;
    for (int turn = 0; turn < 6; ++turn) {
      const double x = 40 * draw.uniform();
      const auto cut = audited(prism(frame({x, 3, -x}, dip, 360 * draw.uniform()), corners));
      const Analysis analysis = analyse(cut, rock({strength(5)}));
      ASSERT_EQ(cut.complex().blocks().size(), 2U) << k;
      ASSERT_EQ(analysis.batches.size(), 1U) << k << ' ' << turn;
      const double found = analysis.judgements.at(0).factor_of_safety;
      if (!factor) factor = found;
      EXPECT_NEAR(found, *factor, 1e-6) << k << ' ' << turn;
      if (dip == 90) {
        EXPECT_NEAR(found, 0, 1e-6) << "it falls";
      }
    }
  }
}

// Over a tunnel, between joints that were drawn to the corners of its section, which are rounded to a nanometre.
TEST(ScenesTest, WhatEndsOnATunnelDoesNotTaper) {
  Rng draw{13};
  for (int k = 0; k < 40; ++k) {
    const double azimuth = 2 * std::numbers::pi * draw.uniform(), w = 1.5 + 3 * draw.uniform(), roof = 2;
    const Vec3 along{std::sin(azimuth), std::cos(azimuth), 0}, right{along.y, -along.x, 0};
    const Vec3 middle{50 * draw.uniform(), -50 * draw.uniform(), 10 * draw.uniform()};
    const auto p = [&](double x, double y, double z) { return middle + x * right + y * along + Vec3{0, 0, z}; };
    topology::CutInput input{
        .domain = geometry::make_box(middle - Vec3{30, 30, 30}, middle + Vec3{30, 30, 30}).value(),
        .joints = {},
        .excavations = {geometry::make_tunnel(geometry::RectangleSection{metres(2 * w), metres(2 * roof)},
                                              {middle - 20 * along, middle + 20 * along})
                            .value()},
        .free_domain_tags = {}};
    for (const double x : {-w, w}) {
      input.joints.emplace_back(polygon({p(x, -5, roof), p(x, 5, roof), p(x, 5, roof + 3), p(x, -5, roof + 3)}));
    }
    for (const double y : {-1.0, 2.0}) {
      input.joints.emplace_back(
          polygon({p(-w - 1, y, 1), p(w + 1, y, 1), p(w + 1, y, roof + 3), p(-w - 1, y, roof + 3)}));
    }
    input.joints.emplace_back(
        polygon({p(-w - 1, -5, roof + 2), p(w + 1, -5, roof + 2), p(w + 1, 5, roof + 2), p(-w - 1, 5, roof + 2)}));
    const auto cut = audited(input);
    const Analysis analysis = analyse(cut, rock({strength(30)}));
    ASSERT_EQ(cut.complex().blocks().size(), 2U) << k;
    ASSERT_EQ(analysis.batches.size(), 1U) << k;
    EXPECT_NEAR(analysis.judgements.at(0).factor_of_safety, 0, 1e-7) << k;
  }
}

}  // namespace
}  // namespace cleave::stability
