// What random joints end at: sets above or below in the scene, and given joints.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include "cleave/realize/run.hpp"
#include "parse_support.hpp"

namespace cleave::scene::test {
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
  ASSERT_EQ(ended.size(), whole.size());
  ASSERT_GT(ended.size(), 20U);
  EXPECT_LT(area_of(ended), 0.9 * area_of(whole));
  // What they end at is drawn as if nothing ended there.
  EXPECT_EQ(area_of(joints_of(std::string{box} + a + b, "B")), area_of(joints_of(std::string{box} + free_a + b, "B")));
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
}  // namespace cleave::scene::test
