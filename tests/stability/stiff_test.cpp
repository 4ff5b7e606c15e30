// Very small beside very large, very flat, nearly parallel: the stated answer, never a NaN; and scaling of length and
// density under all loads at once.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "audited.hpp"
#include "cleave/geometry/solid.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"
#include "handmade.hpp"
#include "statics.hpp"
#include "verdict.hpp"

namespace cleave::stability::stiff_test {
namespace {

using geometry::Vec3;
using handmade::radians;
using statics::audited;
using statics::strength;

/// Axes down the dip (to the east), along strike and up from the plane.
struct Frame {
  Vec3 d, y, n;
  explicit Frame(double dip)
      : d{std::cos(radians(dip)), 0, -std::sin(radians(dip))},
        y{0, 1, 0},
        n{std::sin(radians(dip)), 0, std::cos(radians(dip))} {}
  [[nodiscard]] Vec3 at(double a, double b, double c) const { return a * d + b * y + c * n; }
  [[nodiscard]] geometry::Solid box(std::array<double, 3> low, std::array<double, 3> high) const {
    std::array<Vec3, 8> corners;
    for (std::size_t i = 0; i < 8; ++i) {
      corners[i] =
          at((i & 1U) != 0 ? high[0] : low[0], (i & 2U) != 0 ? high[1] : low[1], (i & 4U) != 0 ? high[2] : low[2]);
    }
    auto solid = geometry::make_hexahedron(corners);
    EXPECT_TRUE(solid.has_value()) << (solid ? std::string{} : describe(solid.error()));
    return *std::move(solid);
  }
};

void expect_finite(const Analysis& a) {
  for (const Judgement& j : a.judgements) {
    EXPECT_TRUE(geometry::is_finite(j.direction));
    EXPECT_TRUE(std::isfinite(j.net.si()) && std::isfinite(j.driving.si()) && std::isfinite(j.resistance.si()));
    EXPECT_FALSE(std::isnan(j.factor_of_safety));
    if (!j.transferred) continue;
    EXPECT_TRUE(std::isfinite(j.transferred->net.si()) && geometry::is_finite(j.transferred->received));
    EXPECT_FALSE(std::isnan(j.transferred->factor_of_safety));
  }
}

// A slab of 1e5 m3 on a plane that dips 40 degrees, and in its lower corner a cube of 1 mm on a joint of the same dip.
TEST(StiffTest, TinyBlockBesideAHugeOne) {
  const Frame f{40};
  topology::CutInput input{.domain = f.box({0, 0, -1}, {100, 100, 10}),
                           .joints = {},
                           .excavations = {},
                           .free_domain_tags = {0, 1, 2, 3, 5}};
  input.joints.emplace_back(topology::PersistentJoint{{}, f.n});
  const double e = 1e-3, far = 2e-3;
  const auto add = [&](std::array<Vec3, 4> corners) {
    input.joints.emplace_back(topology::Joint{{geometry::Polygon::make({corners.begin(), corners.end()}).value()}});
  };
  add({f.at(100 - far, -1e-3, 10 - e), f.at(100 + e, -1e-3, 10 - e), f.at(100 + e, far, 10 - e),
       f.at(100 - far, far, 10 - e)});
  add({f.at(100 - e, -1e-3, 10 - far), f.at(100 - e, far, 10 - far), f.at(100 - e, far, 10 + e),
       f.at(100 - e, -1e-3, 10 + e)});
  add({f.at(100 - far, e, 10 - far), f.at(100 + e, e, 10 - far), f.at(100 + e, e, 10 + e), f.at(100 - far, e, 10 + e)});
  const auto complex = audited(input);
  ASSERT_EQ(complex.complex().blocks().size(), 3U);
  for (const double friction : {0.0, 20.0, 40.5, 89.9}) {
    const Analysis a = analyse(complex, statics::settings({strength(friction)}));
    expect_finite(a);
    ASSERT_EQ(a.judgements.size(), 2U);
    const double factor = std::tan(radians(friction)) / std::tan(radians(40));
    for (const Judgement& j : a.judgements) {
      const double volume = complex.complex().blocks()[j.block].volume.si();
      const bool cube = volume < 1;
      EXPECT_NEAR(volume, cube ? 1e-9 : 1e5, 1e-6 * volume);
      // Blocks are judged one by one: a block that stays is a wall to the one behind it, however small it is.
      if (!cube && factor >= 1) {
        EXPECT_EQ(j.mode, Mode::stable);
        continue;
      }
      EXPECT_EQ(j.mode, Mode::sliding);
      EXPECT_EQ(j.key, factor < 1);
      EXPECT_NEAR(j.factor_of_safety, factor, 1e-6 * (1 + factor));
      EXPECT_NEAR(j.driving.si() / volume, std::sin(radians(40)), 1e-6);
      if (!j.key) continue;
      EXPECT_EQ(j.batch, cube ? 1U : 2U);
      ASSERT_TRUE(j.transferred.has_value());
      // The slab leans on the cube, and on nothing else that left before.
      const double slab = 1e5 * (std::sin(radians(40)) - std::cos(radians(40)) * std::tan(radians(friction)));
      EXPECT_NEAR(j.transferred->net.si(), slab, 1e-6 * slab);
    }
  }
}

TEST(StiffTest, NeedlesAndPlatesOfAMillionToOne) {
  for (const auto& size : {std::array{1000.0, 1e-3, 1e-3}, std::array{1e-3, 1000.0, 1e-3},
                           std::array{1000.0, 1000.0, 1e-3}, std::array{1e-3, 1000.0, 1000.0}}) {
    // The box stands straight and gravity leans, so that thin sides are flat to the last bit.
    topology::CutInput input{.domain = geometry::make_box({0, 0, -1}, {size[0], size[1], size[2]}).value(),
                             .joints = {},
                             .excavations = {},
                             .free_domain_tags = {0, 1, 2, 3, 5}};
    input.joints.emplace_back(topology::PersistentJoint{{}, {0, 0, 1}});
    const auto complex = audited(input);
    for (const double friction : {0.0, 30.0, 89.9}) {
      Settings with = statics::settings({strength(friction)});
      with.loads = Loads::make({std::sin(radians(40)), 0, -std::cos(radians(40))}).value();
      with.rotation = RotationCheck::flag;
      const Analysis a = analyse(complex, with);
      expect_finite(a);
      ASSERT_EQ(a.judgements.size(), 1U);
      const Judgement& j = a.judgements[0];
      const double factor = std::tan(radians(friction)) / std::tan(radians(40));
      EXPECT_EQ(j.mode, Mode::sliding);
      EXPECT_NEAR(j.factor_of_safety, factor, 1e-9 * (1 + factor));
      if (j.key) continue;
      ASSERT_TRUE(j.rotation.has_value());
      EXPECT_EQ(j.rotation->turns, size[0] / size[2] < std::tan(radians(40)));
    }
  }
}

// Two planes that open by 1e-9 about the dip line make a trough: one plane could as well carry the block, and the
// factor of safety is that of the plane. Cut by the cutter, and by hand with exact reactions.
TEST(StiffTest, TroughOfNearlyParallelPlanes) {
  for (const double angle : {1e-9, 1e-8, 1e-6}) {
    const Frame f{50};
    topology::CutInput input{
        .domain = f.box({0, -5, -1}, {10, 5, 2}), .joints = {}, .excavations = {}, .free_domain_tags = {0, 1, 2, 3, 5}};
    for (const double side : {-0.5, 0.5}) {
      input.joints.emplace_back(topology::PersistentJoint{{}, geometry::normalized(f.n + side * angle * f.y)});
    }
    const auto complex = audited(input);
    Settings with = statics::settings({strength(30)});
    with.rotation = RotationCheck::flag;
    const Analysis a = analyse(complex, with);
    expect_finite(a);
    const auto large = std::ranges::max_element(
        a.judgements, {}, [&](const Judgement& j) { return complex.complex().blocks()[j.block].volume.si(); });
    ASSERT_NE(large, a.judgements.end());
    EXPECT_NEAR(complex.complex().blocks()[large->block].volume.si(), 200, 1e-3);
    EXPECT_TRUE(large->mode == Mode::wedge || large->mode == Mode::sliding);
    EXPECT_NEAR(large->factor_of_safety, std::tan(radians(30)) / std::tan(radians(50)), 1e-6);
    EXPECT_NEAR(geometry::norm(large->direction - f.d), 0, 1e-6);

    const std::vector<Direction> rows{handmade::direction(geometry::normalized(f.n - 0.5 * angle * f.y)),
                                      handmade::direction(geometry::normalized(f.n + 0.5 * angle * f.y))};
    const Motion m = project(Cone{rows}, Resultant::along({0, 0, -1}, newtons(1)));
    EXPECT_TRUE(m.kind == MotionKind::two_planes || m.tie);
    EXPECT_NEAR(m.reactions[0] + m.reactions[1], std::cos(radians(50)), 1e-6);
    EXPECT_GE(std::min(m.reactions[0], m.reactions[1]), 0);
  }
}

// The resultant exactly along the line of two planes touches both and presses neither; exactly into a plane it is held;
// zero moves nothing. Each with and without a remainder of rounding, which must be a tie or the same answer.
TEST(StiffTest, ResultantAlongAnEdgeIntoAPlaneAndZero) {
  const std::vector<Direction> rows{handmade::direction({1, 0, 1}), handmade::direction({-1, 0, 1})};
  const Settings with = statics::settings({strength(30, 1e3)});
  const auto contacts = [&] {
    Contacts c{.cone = Cone{rows}, .groups = {}, .exposed = true};
    for (std::uint32_t i = 0; i < 2; ++i) {
      Contact contact{.face = topology::FaceId{i}};
      contact.area = contact.straight_area = 1;
      contact.tan_friction = std::tan(radians(30));
      contact.cohesion = 1e3;
      c.groups.push_back(std::move(contact));
    }
    return c;
  }();
  for (const double dust : {0.0, 1e-17, -1e-17}) {
    const auto under = [&](Vec3 direction) {
      Resultant r = Resultant::along(direction, newtons(5));
      r.add(dust * Vec3{1, 1, 1}, std::abs(dust));
      if (dust != 0) r.add({0, 0, 0}, 1);
      return judge(contacts, r, with);
    };
    const Verdict edge = under({0, 1, 0});
    EXPECT_TRUE(edge.mode == Mode::falling || edge.tie) << dust;
    EXPECT_NEAR(edge.driving, 5, 1e-12);
    EXPECT_EQ(edge.resistance.least, 0);  // brushed, not pressed
    EXPECT_EQ(edge.factor_of_safety, 0);
    EXPECT_TRUE(edge.key);
    for (const Vec3 held : {Vec3{0, 0, -1}, Vec3{-1, 0, -1}, Vec3{1, 0, -1}}) {
      const Verdict v = under(held);
      EXPECT_EQ(v.mode, Mode::stable);
      EXPECT_TRUE(std::isinf(v.factor_of_safety));
      EXPECT_FALSE(v.key);
    }
  }
  Resultant nothing = Resultant::along({0, 0, -1}, newtons(7));
  nothing.add({0, 0, 7}, 7);
  const Verdict none = judge(contacts, nothing, with);
  EXPECT_EQ(none.mode, Mode::stable);
  EXPECT_TRUE(std::isinf(none.factor_of_safety));
}

// A slab between two joints that are parallel but for the last bit: its friction counts, whichever way the bit falls.
TEST(StiffTest, SlotWhoseWallsAreParallelButForRounding) {
  for (const double skew : {0.0, 1e-17, -1e-17, 1e-16, -1e-16, 1e-15, -1e-15, 1e-12}) {
    const std::vector<Direction> rows{handmade::direction({0, 0, 1}), handmade::direction({-1, 0, 0}),
                                      handmade::direction({1, 0, skew})};
    Contacts contacts{.cone = Cone{rows}, .groups = {}, .exposed = true};
    for (std::uint32_t i = 0; i < 3; ++i) {
      Contact contact{.face = topology::FaceId{i}};
      contact.area = contact.straight_area = 1;
      contact.tan_friction = 0.3;
      contacts.groups.push_back(std::move(contact));
    }
    Resultant r = Resultant::along({0, 0, -1}, newtons(1));
    r.add({0.4, 0.1, 0}, 0.5);  // against the second wall, and along the slot
    const Verdict v = judge(contacts, r, statics::settings({strength(30)}));
    EXPECT_EQ(v.mode, Mode::wedge);
    EXPECT_NEAR(v.driving, 0.1, 1e-12);
    EXPECT_NEAR(v.resistance.least, 0.3 * 1.4, 1e-9) << skew;
    EXPECT_FALSE(v.key);
  }
}

/// Three slabs in line with every load there is, in metres times `length`, density times `density`.
Analysis loaded_slabs(double length, double density) {
  const double l = length, k = density;
  const Frame f{30};
  topology::CutInput input{.domain = f.box({0, 0, -5 * l}, {30 * l, 10 * l, 5 * l}),
                           .joints = {},
                           .excavations = {},
                           .free_domain_tags = {0, 1, 2, 3, 5}};
  input.joints.emplace_back(topology::PersistentJoint{{}, f.n});
  for (const double cut : {10 * l, 20 * l}) {
    input.joints.emplace_back(topology::Joint{{geometry::Polygon::make({f.at(cut, -l, -l), f.at(cut, 11 * l, -l),
                                                                        f.at(cut, 11 * l, 6 * l), f.at(cut, -l, 6 * l)})
                                                   .value()}});
  }
  const auto complex = audited(input);
  Settings with = statics::settings({strength(20, 2e3 * k * l, 1e2 * k * l)});
  with.rock = RockMass::make(kilograms_per_cubic_metre(2700 * k)).value();
  with.loads = Loads::make({0, 0, -9.81}, {0.05, 0.02, 0}).value();
  with.rotation = RotationCheck::flag;
  ActionSpec spec;
  spec.water = WaterTable{.level = -6 * l, .unit_weight = newtons_per_cubic_metre(9810 * k)};
  spec.joint_pressure = {std::nullopt, 5e3 * k * l};
  spec.surcharges = {{.on = AnyFreeFace{},
                      .within = Box{f.at(0, 0, 5 * l) - Vec3{l, l, l}, f.at(0, 0, 5 * l) + 6 * l * Vec3{1, 1, 1}},
                      .traction = {1e3 * k * l, 0, 0},
                      .pressure = pascals(4e3 * k * l)}};
  spec.points = {{.at = f.at(25 * l, 5 * l, 5 * l), .force = k * l * l * l * Vec3{2e5, 1e5, -3e5}}};
  spec.lines = {{.from = f.at(12 * l, 2 * l, 5 * l),
                 .to = f.at(18 * l, 8 * l, 5 * l),
                 .per_metre = k * l * l * Vec3{3e4, 0, -2e4}}};
  with.actions = Actions::make(std::move(spec)).value();
  return analyse(complex, with);
}

TEST(StiffTest, LengthAndDensityScaleUnderAllLoads) {
  const Analysis one = loaded_slabs(1, 1);
  ASSERT_EQ(one.judgements.size(), 3U);
  ASSERT_GE(one.batches.size(), 2U);
  for (const double length : {1e-2, 0.37, 1e2, 1e3}) {
    for (const double density : {0.5, 1.0, 7.0}) {
      const Analysis other = loaded_slabs(length, density);
      ASSERT_EQ(other.judgements.size(), one.judgements.size());
      ASSERT_EQ(other.batches.size(), one.batches.size()) << length << ' ' << density;
      const double force = density * length * length * length;
      for (std::size_t i = 0; i < one.judgements.size(); ++i) {
        const Judgement& p = one.judgements[i];
        const Judgement& q = other.judgements[i];
        EXPECT_EQ(p.mode, q.mode);
        EXPECT_EQ(p.batch, q.batch);
        EXPECT_NEAR(q.factor_of_safety, p.factor_of_safety, 1e-7 * p.factor_of_safety);
        EXPECT_NEAR(q.net.si() / force, p.net.si(), 1e-7 * p.weight.si());
        EXPECT_LT(geometry::norm(q.direction - p.direction), 1e-7);
        ASSERT_EQ(p.transferred.has_value(), q.transferred.has_value());
        if (p.transferred) {
          EXPECT_NEAR(q.transferred->net.si() / force, p.transferred->net.si(), 1e-7 * p.weight.si());
        }
        ASSERT_EQ(p.rotation.has_value(), q.rotation.has_value());
        if (p.rotation) {
          EXPECT_EQ(p.rotation->turns, q.rotation->turns);
        }
      }
    }
  }
}

}  // namespace
}  // namespace cleave::stability::stiff_test
