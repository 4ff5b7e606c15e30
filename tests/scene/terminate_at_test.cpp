// What random joints end at: sets above or below in the scene, and given joints.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include "cleave/realize/run.hpp"
#include "cleave/scene3d/bounds.hpp"
#include "parse_support.hpp"

namespace cleave::scene::test::terminate_at_test {
namespace {

using geometry::Vec3;

constexpr std::string_view box = "schema = 1\nseed = 9\n[domain]\nbox = { min = [0, 0, 0], max = [20, 20, 20] }\n";

std::string joint_set(std::string_view name, double dip, double direction, std::string_view more) {
  return fmt::format(
      "[[joint_set]]\nname = \"{}\"\norientation = {{ dip = {}, dip_direction = {}, distribution = \"fisher\", kappa = "
      "30 "
      "}}\nshape = \"disc\"\nsize = 9\nintensity = {{ p32 = 0.4 }}\n{}\n",
      name, dip, direction, more);
}

/// Corners of the joints drawn of a set, joint by joint.
std::vector<std::vector<Vec3>> joints_of(const std::string& text, std::string_view set) {
  const auto drawn = sample(scene_of(text));
  EXPECT_TRUE(drawn.has_value());
  std::vector<std::vector<Vec3>> all;
  for (std::size_t j = 0; j < drawn->input.joints.size(); ++j) {
    if (drawn->joints[topology::JointId{j}].origin != JointOrigin::drawn) continue;
    if (drawn->sets[drawn->joints[topology::JointId{j}].set].name != set) continue;
    const auto& joint = std::get<topology::Joint>(drawn->input.joints[j]);
    const auto corners = joint.polygons.front().corners();
    all.emplace_back(corners.begin(), corners.end());
  }
  return all;
}

double area_of(const std::vector<std::vector<Vec3>>& joints) {
  double sum = 0;
  for (const auto& c : joints) {
    Vec3 twice{};
    for (std::size_t i = 1; i + 1 < c.size(); ++i) twice += geometry::cross(c[i] - c[0], c[i + 1] - c[0]);
    sum += geometry::norm(twice) / 2;
  }
  return sum;
}

TEST(TerminateAt, TheSetNamedMayStandBelow) {
  const std::string a = joint_set("A", 70, 100, "terminate_at = [\"B\"]"), b = joint_set("B", 20, 30, "");
  const std::string free_a = joint_set("A", 70, 100, "");
  const auto ended = joints_of(std::string{box} + a + b, "A"), whole = joints_of(std::string{box} + free_a + b, "A");
  ASSERT_GT(whole.size(), 20U);
  // More are drawn, so that what is left has the intensity asked for.
  EXPECT_GT(ended.size(), 1.1 * static_cast<double>(whole.size()));
  const auto mean = [](const auto& joints) { return area_of(joints) / static_cast<double>(joints.size()); };
  EXPECT_LT(mean(ended), 0.9 * mean(whole));
  // What they end at is drawn as if nothing ended there.
  EXPECT_EQ(area_of(joints_of(std::string{box} + a + b, "B")), area_of(joints_of(std::string{box} + free_a + b, "B")));
}

// P32 within the domain, mean over realizations, is what is asked for although joints lose half of their area.
TEST(TerminateAt, IntensitiesAreThoseAskedFor) {
  const std::string text = std::string{box} + joint_set("A", 70, 100, "terminates_at = [\"B\"]") +
                           joint_set("B", 20, 30, "terminates_at = [\"C\"]") + joint_set("C", 80, 200, "");
  const Scene scene = scene_of(text);
  EXPECT_EQ(std::ranges::count_if(scene.notes, [](const Problem& p) { return p.what.contains("of their area"); }), 2);
  EXPECT_LT(scene.joint_sets[0].law.area_share(), 0.8);
  EXPECT_EQ(scene.joint_sets[2].law.area_share(), 1);
  const Box domain{{0, 0, 0}, {20, 20, 20}};
  std::vector<std::vector<double>> p32(3);
  for (std::uint64_t k = 0; k < 60; ++k) {
    const auto drawn = sample(scene, k);
    ASSERT_TRUE(drawn.has_value());
    std::vector<double> sums(3, 0.0);
    for (std::size_t j = 0; j < drawn->input.joints.size(); ++j) {
      const std::string& name = drawn->sets[drawn->joints[topology::JointId{j}].set].name;
      const auto corners = std::get<topology::Joint>(drawn->input.joints[j]).polygons.front().corners();
      sums.at(static_cast<std::size_t>(name[0] - 'A')) +=
          geometry::norm(area_within({corners.begin(), corners.end()}, domain)) / 8000;
    }
    for (std::size_t i = 0; i < 3; ++i) p32[i].push_back(sums[i]);
  }
  for (const std::vector<double>& set : p32) {
    double mean = 0, square = 0;
    for (const double v : set) mean += v / 60;
    for (const double v : set) square += (v - mean) * (v - mean) / 59;
    EXPECT_NEAR(mean, 0.4, 4 * std::sqrt(square / 60) + 0.01 * 0.4);  // and the trials' own error
  }
  // A number of joints, or of centres, is that of joints drawn, whatever is left of them.
  std::string counted = text;
  counted.replace(counted.find("p32 = 0.4"), 9, "count = 40");
  EXPECT_EQ(scene_of(counted).joint_sets[0].law.area_share(), 1);
}

// A small box holds few joints: one trial says little of what is left of them.
TEST(TerminateAt, IntensitiesOfSmallBoxesAreThoseAskedFor) {
  const std::string text =
      "[domain]\nbox = { min = [0, 0, 0], max = [12, 10, 8] }\n"
      "[[joint_set]]\nname = \"P\"\norientation = { dip = 55, dip_direction = 20, distribution = \"fisher\", kappa = 5 "
      "}\n"
      "size = { distribution = \"lognormal\", mean = 4, std = 1.5, max = 12 }\nintensity = { p32 = 0.4 }\n"
      "[[joint_set]]\nname = \"A\"\norientation = { dip = 55, dip_direction = 130, distribution = \"fisher\", kappa = "
      "5 "
      "}\nsize = 4\nmodel = \"enhanced_baecher\"\nterminate_at = [\"P\"]\nintensity = { p32 = 0.8 }\n";
  const Scene scene = scene_of(text);
  const Box domain{{0, 0, 0}, {12, 10, 8}};
  double sum = 0, squares = 0;
  constexpr std::uint64_t realizations = 400;
  for (std::uint64_t k = 0; k < realizations; ++k) {
    const auto drawn = sample(scene, k);
    ASSERT_TRUE(drawn.has_value());
    double p32 = 0;
    for (std::size_t j = 0; j < drawn->input.joints.size(); ++j) {
      if (drawn->sets[drawn->joints[topology::JointId{j}].set].name != "A") continue;
      const auto corners = std::get<topology::Joint>(drawn->input.joints[j]).polygons.front().corners();
      p32 += geometry::norm(area_within({corners.begin(), corners.end()}, domain)) / 960;
    }
    sum += p32;
    squares += p32 * p32;
  }
  const double mean = sum / realizations;
  const double error = std::sqrt((squares / realizations - mean * mean) / realizations);
  EXPECT_NEAR(mean, 0.8, 3 * error + 0.02 * 0.8);  // and twice the trials' own error
}

TEST(TerminateAt, GivenJointsCountToo) {
  const std::string fault =
      "[[joint]]\nset = \"fault\"\nplane = { through = [10, 10, 10], dip = 90, dip_direction = 90 }\n";
  const auto joints = joints_of(std::string{box} + fault + joint_set("A", 30, 90, "terminate_at = [\"fault\"]"), "A");
  const auto crossing = [](const std::vector<Vec3>& corners) {
    const auto [low, high] = std::ranges::minmax(corners, {}, &Vec3::x);
    return low.x < 10 - 1e-4 && high.x > 10 + 1e-4;
  };
  ASSERT_GT(joints.size(), 20U);
  EXPECT_TRUE(std::ranges::none_of(joints, crossing));
  // The fault has work to do: without the key many joints cross it.
  const auto without = joints_of(std::string{box} + fault + joint_set("A", 30, 90, ""), "A");
  EXPECT_GT(std::ranges::count_if(without, crossing), 5);
}

TEST(TerminateAt, EnhancedBaecherEndsAtAllSetsAboveWhenNoneIsNamed) {
  const std::string b = joint_set("B", 20, 30, "");
  const auto named = joints_of(
      std::string{box} + b + joint_set("A", 70, 100, "model = \"enhanced_baecher\"\nterminate_at = [\"B\"]"), "A");
  const auto unnamed = joints_of(std::string{box} + b + joint_set("A", 70, 100, "model = \"enhanced_baecher\""), "A");
  EXPECT_EQ(area_of(named), area_of(unnamed));
  // The first set has nothing to end at.
  EXPECT_EQ(area_of(joints_of(std::string{box} + joint_set("A", 70, 100, "model = \"enhanced_baecher\""), "A")),
            area_of(joints_of(std::string{box} + joint_set("A", 70, 100, ""), "A")));
}

TEST(JointModels, TakeTheKeysOfEverySetAndSayWhatTheyDoNotUse) {
  for (const std::string_view model :
       {"orthogonal", "baecher", "enhanced_baecher", "veneziano", "dershowitz", "mosaic", "hierarchical", "mit"}) {
    std::string text = std::string{box} + joint_set("A", 70, 100, fmt::format("model = \"{}\"", model));
    if (model == "orthogonal") text.replace(text.find("\"disc\""), 6, "\"rectangle\"");
    const auto scene = parse_text(text);
    ASSERT_TRUE(scene.has_value()) << model << describe(scene.error().front());
    EXPECT_TRUE(sample(*scene).has_value()) << model;
    const bool sizeless = model == "dershowitz" || model == "mosaic";
    EXPECT_EQ(std::ranges::count_if(
                  scene->notes,
                  [](const Problem& note) { return note.what.starts_with("is not used: in this model sizes"); }),
              sizeless ? 2 : 0)
        << model;
  }
}

}  // namespace
}  // namespace cleave::scene::test::terminate_at_test
