// Extreme shapes and strengths through the cutter: everything stays finite, and the answer is the stated one.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "cleave/geometry/solid.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"
#include "handmade.hpp"
#include "statics.hpp"

namespace cleave::stability {
namespace {

using geometry::Vec3;
using handmade::radians;
using statics::strength;

/// A block of `length` x `width` x `height` on a plane that dips 40 degrees, the whole scene turned about z by `turn`.
Judgement slab(double length, double width, double height, double friction, double turn, const ActionSpec& loads) {
  const double a = radians(40), t = radians(turn);
  const auto turned = [&](Vec3 v) {
    return Vec3{std::cos(t) * v.x - std::sin(t) * v.y, std::sin(t) * v.x + std::cos(t) * v.y, v.z};
  };
  const Vec3 d = turned({std::cos(a), 0, -std::sin(a)}), y = turned({0, 1, 0}),
             n = turned({std::sin(a), 0, std::cos(a)});
  std::array<Vec3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    corners[i] =
        ((i & 1U) != 0 ? length : 0) * d + ((i & 2U) != 0 ? width : 0) * y + ((i & 4U) != 0 ? height : -1.0) * n;
  }
  auto domain = geometry::make_hexahedron(corners);
  EXPECT_TRUE(domain.has_value()) << (domain ? std::string{} : describe(domain.error()));
  topology::CutInput input{
      .domain = *std::move(domain), .joints = {}, .excavations = {}, .free_domain_tags = {0, 1, 2, 3, 5}};
  input.joints.emplace_back(topology::PersistentJoint{{}, n});
  auto cut = topology::cut(input);
  EXPECT_TRUE(cut.has_value()) << (cut ? std::string{} : describe(cut.error()));
  auto complex = topology::audit(*std::move(cut));
  EXPECT_TRUE(complex.has_value());
  Settings with = statics::settings({strength(friction)});
  with.actions = Actions::make(loads).value();
  const Analysis analysis = analyse(*complex, with);
  EXPECT_EQ(analysis.judgements.size(), 1U);
  return analysis.judgements.empty() ? Judgement{.block = topology::BlockId{0U}} : analysis.judgements[0];
}

TEST(ExtremesTest, PlatesNeedlesAndFriction) {
  for (const double friction : {0.0, 10.0, 40.5, 89.9}) {
    const double factor = std::tan(radians(friction)) / std::tan(radians(40));
    for (const auto& [length, width, height] : {std::array{100.0, 100.0, 1e-4}, std::array{1000.0, 1e-2, 1e-3},
                                                std::array{1e-3, 1e-3, 1e-3}, std::array{100.0, 100.0, 10.0}}) {
      const Judgement j = slab(length, width, height, friction, 0, {});
      EXPECT_EQ(j.mode, Mode::sliding);
      EXPECT_EQ(j.key, factor < 1);
      // Normals go through lattice points: 1 part in 1e15 of the scene's size, so less exact across thin shapes.
      EXPECT_NEAR(j.factor_of_safety / std::max(factor, 1e-300), factor > 0 ? 1 : 0, 1e-6);
      EXPECT_TRUE(std::isfinite(j.net.si()) && geometry::is_finite(j.direction));
    }
  }
}

// Turned with its loads, a scene has the same factor of safety.
TEST(ExtremesTest, TurningTheSceneTurnsTheLoads) {
  const ActionSpec loads{.water = WaterTable{.level = -1, .unit_weight = newtons_per_cubic_metre(0.3)},
                         .surcharges = {{.on = DomainSide{5}, .pressure = pascals(0.2)}}};
  const Judgement first = slab(8, 3, 2, 30, 0, loads);
  EXPECT_GT(first.factor_of_safety, 0.1);
  for (const double turn : {17.0, 90.0, 211.0}) {
    const Judgement other = slab(8, 3, 2, 30, turn, loads);
    EXPECT_NEAR(other.factor_of_safety, first.factor_of_safety, 1e-9);
    EXPECT_NEAR(other.net.si(), first.net.si(), 1e-8);
  }
}

}  // namespace
}  // namespace cleave::stability
