#include <gtest/gtest.h>

#include "complexes.hpp"

// What the cutter tells about joints that do nothing, and what it refuses.

namespace cleave::testing::refusals_test {
namespace {

using topology::JointId;

geometry::Solid cube() { return box({0, 0, 0}, {4, 4, 4}); }

TEST(Report, NamesJointsOutsideAndDanglingOnes) {
  const auto audited = certified(scene(cube(), {rectangle(2, 2, {-1, -1}, {5, 5}),      // cuts
                                                rectangle(2, 9, {-1, -1}, {5, 5}),      // above the domain
                                                rectangle(2, 1, {1, 1}, {2, 2}),        // in the middle of a block
                                                rectangle(0, -3, {-1, -1}, {5, 5})}));  // west of the domain
  const auto& report = audited.complex().report();
  EXPECT_EQ(audited.complex().blocks().size(), 2U);
  EXPECT_EQ(report.joints_outside, 2U);
  EXPECT_EQ(report.outside, (std::vector{JointId{1U}, JointId{3U}}));
  EXPECT_EQ(report.dangling, (std::vector{JointId{2U}}));
  EXPECT_GT(report.predicate_calls, 0U);
  EXPECT_EQ(report.largest_snap_m, 0);
}

TEST(Report, AJointBesideTheDomainThatOnlyItsBoxMeetsDoesNotCut) {
  // Cuts the corner of the bounding box, not the domain.
  const auto audited = certified(scene(cube(), {joint({{4.5, 3, 2}, {3, 4.5, 2}, {4.5, 4.5, 3}})}));
  EXPECT_EQ(audited.complex().blocks().size(), 1U);
}

TEST(Report, PersistentJointThatMissesTheDomain) {
  auto input = scene(cube());
  input.joints.emplace_back(topology::PersistentJoint{{0, 0, 9}, {0, 0, 1}});
  EXPECT_EQ(count_blocks(input), 1U);
}

TEST(Report, PitchIsAPowerOfTwoAndFine) {
  const double pitch = certified(scene(cube())).complex().report().lattice_pitch_m;
  int exponent = 0;
  EXPECT_EQ(std::frexp(pitch, &exponent), 0.5);
  EXPECT_LT(pitch, 4 * 0x1p-44);
}

template <class Error>
void expect_error(const topology::CutInput& input) {
  const auto complex = topology::cut(input);
  ASSERT_FALSE(complex);
  EXPECT_TRUE(std::holds_alternative<Error>(complex.error())) << describe(complex.error());
}

TEST(Refusals, NumbersThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf}) {
    for (const topology::PersistentJoint& plane :
         {topology::PersistentJoint{{bad, 0, 0}, {0, 0, 1}}, topology::PersistentJoint{{0, 0, bad}, {0, 0, 1}},
          topology::PersistentJoint{{0, 0, 0}, {0, bad, 1}}}) {
      auto input = scene(cube());
      input.joints.emplace_back(plane);
      expect_error<topology::NotFinite>(input);
    }
    auto input = scene(cube());
    input.snap = metres(bad);
    expect_error<topology::NotFinite>(input);
    input.snap = metres(0);
    input.window = topology::Window{{0, 0, bad}, {1, 1, 1}};
    expect_error<topology::NotFinite>(input);
    input.window = topology::Window{{0, 0, 0}, {1, bad, 1}};
    expect_error<topology::NotFinite>(input);
  }
  for (const Vec3 normal : {Vec3{0, 0, 0}, Vec3{1e-320, 0, 0}, Vec3{1e200, 0, 0}}) {
    auto input = scene(cube());
    input.joints.emplace_back(topology::PersistentJoint{{0, 0, 0}, normal});
    expect_error<topology::NotFinite>(input);
  }
}

TEST(Refusals, NamesOfWhatIsNotThere) {
  auto input = scene(cube(), {rectangle(2, 0.5, {-9, -9}, {9, 9})});
  input.free_domain_tags = {0, 6};
  expect_error<topology::UnknownTag>(input);
  input.free_domain_tags = {0, 5};
  EXPECT_TRUE(topology::cut(input));
  input.snap = metres(-1e-9);
  expect_error<topology::SnapNegative>(input);
  input.snap = metres(0);
  input.terminations = {{JointId{0U}, JointId{1U}}};
  expect_error<topology::UnknownJoint>(input);
  input.terminations = {{JointId{7U}, JointId{0U}}};
  expect_error<topology::UnknownJoint>(input);
}

TEST(Refusals, AJointTooSmallForTheLattice) {
  const double d = 1e-17;
  const auto input =
      scene(cube(), {rectangle(2, 2, {-1, -1}, {5, 5}), joint({{0, 0, 0}, {d, 0, 0}, {d, d, 0}, {0, d, 0}})});
  const auto complex = topology::cut(input);
  ASSERT_FALSE(complex);
  const auto* error = std::get_if<topology::JointCollapsed>(&complex.error());
  ASSERT_NE(error, nullptr);
  EXPECT_EQ(error->joint, JointId{1U});
  EXPECT_GT(error->pitch.si(), d);
  EXPECT_NE(describe(complex.error()).find("joint 1"), std::string::npos);
}

TEST(Refusals, ADomainTooSmallForTheLattice) {
  // A joint a thousand kilometres long beside a domain of a nanometre.
  const auto input = scene(box({0, 0, 0}, {1e-9, 1e-9, 1e-9}), {rectangle(2, 0, {-1e9, -1e9}, {1e9, 1e9})});
  const auto complex = topology::cut(input);
  ASSERT_FALSE(complex);
  const auto* error = std::get_if<topology::SolidCollapsed>(&complex.error());
  ASSERT_NE(error, nullptr);
  EXPECT_FALSE(error->excavation.has_value());
}

TEST(Refusals, AnExcavationTooSmallForTheLattice) {
  const auto input = scene(box({0, 0, 0}, {1e6, 1e6, 1e6}), {}, {box({1, 1, 1}, {1 + 1e-12, 2, 2})});
  const auto complex = topology::cut(input);
  ASSERT_FALSE(complex);
  const auto* error = std::get_if<topology::SolidCollapsed>(&complex.error());
  ASSERT_NE(error, nullptr);
  EXPECT_EQ(error->excavation, 0U);
}

TEST(Refusals, AnExcavationThatSwallowsTheDomain) {
  for (const auto& excavation : {box({-1, -1, -1}, {5, 5, 5}), cube()}) {
    const auto complex = topology::cut(scene(cube(), {rectangle(2, 2, {-1, -1}, {5, 5})}, {excavation}));
    ASSERT_FALSE(complex);
    EXPECT_TRUE(std::holds_alternative<topology::DomainSwallowed>(complex.error()));
  }
  const auto two_halves = topology::cut(scene(cube(), {}, {box({-1, -1, -1}, {2, 5, 5}), box({2, -1, -1}, {5, 5, 5})}));
  ASSERT_FALSE(two_halves);
  EXPECT_TRUE(std::holds_alternative<topology::DomainSwallowed>(two_halves.error()));
}

}  // namespace
}  // namespace cleave::testing::refusals_test
