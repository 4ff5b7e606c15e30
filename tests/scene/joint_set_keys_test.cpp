#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "cleave/dfn/sample.hpp"
#include "parse_support.hpp"

// Keys of orientation laws, of counts and of regular spacing.

namespace cleave::scene::test {
namespace {

const std::string endless = "[[joint_set]]\nsize = \"persistent\"\nintensity = { count = 3 }\n";

const dfn::JointSetSpec& spec_of(const Scene& scene) { return scene.joint_sets.front().law.spec(); }

TEST(JointSetKeys, PolesByTrendAndPlunge) {
  const Scene by_pole =
      scene_of("north = 10\n" + with_box("[[joint]]\nplane = { through = [4, 4, 3], trend = 220, plunge "
                                         "= 55 }\n"));
  const Scene by_dip = scene_of("north = 10\n" + with_box("[[joint]]\nplane = { through = [4, 4, 3], dip = 35, "
                                                          "dip_direction = 40 }\n"));
  const auto normal = [](const Scene& scene) {
    return std::get<topology::PersistentJoint>(scene.joints.front().geometry).normal;
  };
  EXPECT_NEAR(norm(normal(by_pole) - normal(by_dip)), 0, 1e-15);
  const Scene set = scene_of(with_box(endless + "orientation = { trend = 220, plunge = 55, distribution = \"fisher\", "
                                                "kappa = 20 }\n"));
  const auto& law = std::get<dfn::FisherOrientation>(spec_of(set).orientation);
  EXPECT_EQ(law.dip.degrees(), 35);
  EXPECT_EQ(law.dip_direction.degrees(), 40);
  EXPECT_EQ(error_of(with_box("[[joint]]\nplane = { through = [4, 4, 3], dip = 35, plunge = 55, trend = 1 }\n")),
            "s.toml:4: joint[1].plane.dip: stands beside the pole's trend and plunge; give dip and dip_direction, or "
            "trend and plunge");
  EXPECT_TRUE(error_of(with_box("[[joint]]\nplane = { through = [4, 4, 3], trend = 35 }\n"))
                  .contains("plane.plunge: is missing"));
}

TEST(JointSetKeys, BinghamAndTheBivariateNormalLaw) {
  const Scene bingham = scene_of(with_box(
      endless +
      "orientation = { dip = 50, dip_direction = 120, distribution = \"bingham\", k1 = -60, k2 = -15, axis = 30 "
      "}\n"));
  const auto& law = std::get<dfn::BinghamOrientation>(spec_of(bingham).orientation);
  EXPECT_EQ(law.k1, -60);
  EXPECT_EQ(law.k2, -15);
  EXPECT_EQ(law.axis.degrees(), 30);
  EXPECT_EQ(law.cumulative.back(), 1);
  const Scene normal = scene_of(with_box(
      endless +
      "orientation = { dip = 50, dip_direction = 120, distribution = \"normal\", dip_std = 5, dip_direction_std "
      "= 9, correlation = -0.4 }\n"));
  EXPECT_EQ(std::get<dfn::NormalOrientation>(spec_of(normal).orientation).correlation, -0.4);
  EXPECT_EQ(
      error_of(with_box(endless + "orientation = { dip = 50, dip_direction = 120, distribution = \"fisher\", kappa "
                                  "= 3, k1 = -2 }\n")),
      "s.toml:6: joint_set[1].orientation.k1: has no meaning for the distribution \"fisher\"; remove it, or set "
      "distribution = \"bingham\"");
  EXPECT_TRUE(
      error_of(with_box(endless + "orientation = { dip = 50, dip_direction = 120, distribution = \"bingham\", k1 "
                                  "= -2 }\n"))
          .contains("orientation.k2: is missing"));
  EXPECT_TRUE(
      error_of(with_box(endless + "orientation = { dip = 50, dip_direction = 120, distribution = \"bingham\", k1 "
                                  "= 2, k2 = 0 }\n"))
          .contains("orientation.k1"));
}

TEST(JointSetKeys, CountsOfTheLargerBox) {
  const std::string set = "[[joint_set]]\norientation = { dip = 30, dip_direction = 30 }\nsize = 2\nbuffer = 2\n";
  const auto drawn = [&](const std::string& intensity) {
    const Scene scene = scene_of(with_box(set + intensity));
    return dfn::expected_draws(scene.joint_sets.front().law, {{0, 0, 0}, {8, 8, 6}});
  };
  EXPECT_EQ(drawn("intensity = { count = 40 }\n"), 320);
  EXPECT_EQ(drawn("intensity = { count = 40, count_in = \"domain\" }\n"), 320);
  EXPECT_EQ(drawn("intensity = { count = 40, count_in = \"buffer\" }\n"), 40);
  const Scene scene = scene_of(with_box(set + "intensity = { count = 40, count_in = \"buffer\" }\n"));
  EXPECT_DOUBLE_EQ(scene.joint_sets.front().law.expected_p32(384), 40 * 4 / (8 * 384.0));
  EXPECT_TRUE(
      error_of(with_box("[[joint_set]]\norientation = { dip = 30, dip_direction = 30 }\nsize = 2\nintensity = { "
                        "count = 40, count_in = \"buffer\" }\n"))
          .contains("count_in: needs a box that is larger"));
  EXPECT_TRUE(error_of(with_box(set + "intensity = { p32 = 0.4, count_in = \"buffer\" }\n"))
                  .contains("count_in: has no meaning for \"p32\""));
}

// Regular planes: equal distances, one of them through the point that is given.
TEST(JointSetKeys, RegularSpacing) {
  const std::string beds =
      "[[joint_set]]\nsize = \"persistent\"\nintensity = { spacing = 1.5 }\norientation = { dip = 20, "
      "dip_direction = 90 }\ngaps = \"constant\"\n";
  const auto offsets = [](const Scene& scene, std::uint64_t realization) {
    const dfn::JointSet& law = scene.joint_sets.front().law;
    const auto joints = dfn::sample(law, 0, {{0, 0, 0}, {8, 8, 6}}, 1, realization).value();
    std::vector<double> at;
    for (const dfn::SampledJoint& joint : joints) {
      at.push_back(dot(std::get<dfn::InfinitePlane>(joint.shape).through, law.mean_normal()));
    }
    std::ranges::sort(at);
    return at;
  };
  const Scene free = scene_of(with_box(beds));
  double first = 0, second = 0;
  for (std::uint64_t k = 0; k < 400; ++k) {
    const auto at = offsets(free, k);
    ASSERT_GE(at.size(), 7U);
    for (std::size_t i = 1; i < at.size(); ++i) EXPECT_NEAR(at[i] - at[i - 1], 1.5, 1e-12);
    const double phase = at[0] / 1.5 - std::floor(at[0] / 1.5);
    first += std::cos(2 * std::numbers::pi * phase) / 400;
    second += std::sin(2 * std::numbers::pi * phase) / 400;
  }
  EXPECT_LT(400 * (first * first + second * second), 9.2) << "the first plane lies anywhere";  // Rayleigh, 1e-4
  const Scene fixed = scene_of(with_box(beds + "through = [3, 4, 2.2]\n"));
  const double known = dot({3, 4, 2.2}, fixed.joint_sets.front().law.mean_normal());
  for (std::uint64_t k = 0; k < 3; ++k) {
    const auto at = offsets(fixed, k);
    EXPECT_TRUE(std::ranges::any_of(at, [&](double a) { return std::abs(a - known) < 1e-12; }));
    EXPECT_EQ(at.size(), offsets(fixed, 0).size());
  }
  EXPECT_TRUE(error_of(with_box(beds + "through = [3, 4, 2.2]\ngaps = \"poisson\"\n")).contains("gaps"));
  const std::string random =
      "[[joint_set]]\nsize = \"persistent\"\nintensity = { spacing = 1.5 }\norientation = { dip = "
      "20, dip_direction = 90 }\ngaps = \"poisson\"\nthrough = [1, 1, 1]\n";
  EXPECT_TRUE(error_of(with_box(random)).contains("through: fixes the place of planes whose distances are random"));
  EXPECT_TRUE(error_of(with_box("[[joint_set]]\nsize = 3\nintensity = { spacing = 1.5 }\norientation = { dip = 20, "
                                "dip_direction = 90 }\ngaps = \"constant\"\n"))
                  .contains("gaps: has no meaning for the model \"baecher\""));
}

}  // namespace
}  // namespace cleave::scene::test
