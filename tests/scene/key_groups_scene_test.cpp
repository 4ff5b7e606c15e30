#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "cleave/realize/run.hpp"
#include "parse_support.hpp"

// Groups of blocks through a whole scene.

namespace cleave::scene::test {
namespace {

/// Key groups of a scene.
stability::KeyGroups groups_of(const std::string& text) {
  const Scene scene = scene_of(text);
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  auto result = run(scene, {.threads = 1}, timer, progress);
  if (!result || !result->key_groups) {
    ADD_FAILURE() << "the scene does not run";
    return {};
  }
  EXPECT_EQ(result->figures.key_blocks->count, 0U);
  return std::move(*result->key_groups);
}

/// A block of 233 m3 on 55 degrees behind one of 322 m3 on 10 degrees, an upright joint between them, 1 m thick.
std::string active_and_passive(double friction) {
  const double steep = std::tan(55 * std::numbers::pi / 180), flat = std::tan(10 * std::numbers::pi / 180);
  const double tall = 20, wide = 2 * 233 / tall, length = 20, front = 0.02;
  // The passive block's corners: (0, 0), (0, tall), (front - length, z), (-length, -length flat).
  const double z = (2 * 322 - tall * (length - front) - length * flat * (length - front)) / length;
  std::string text = fmt::format(
      "[domain]\nbox = {{ min = [-30, 0, -20], max = [40, 1, 60] }}\n[[excavation]]\nkind = \"slope\"\n"
      "profile = {{ direction = 90, points = [[-28, {0}], [{1}, {0}], [{2}, {3}], [{4}, {5}], [0, {6}], [{7}, {8}]] "
      "}}\n",
      -length * flat - 2, -length - 0.5, -length, -length * flat, front - length, z, tall, wide, wide * steep);
  const auto joint = [&](double x1, double z1, double x2, double z2) {
    text += fmt::format("[[joint]]\npolygon = [[{0}, -1, {1}], [{2}, -1, {3}], [{2}, 2, {3}], [{0}, 2, {1}]]\n", x1, z1,
                        x2, z2);
  };
  joint(-length - 0.01, -(length + 0.01) * flat, 0.01, 0.01 * flat);
  joint(-0.01, -0.01 * steep, wide + 0.01, (wide + 0.01) * steep);
  joint(0, -0.001, 0, tall + 1);
  return text + fmt::format(
                    "[joints.default]\nfriction = {}\ncohesion = 0\n[rock]\ndensity = 2700\n[stability]\n"
                    "free = [\"top\", \"south\", \"north\"]\n",
                    friction);
}

// Neither moves by itself: the steep one is barred, the flat one has a factor of 2.06. With all friction spent, m =
// tan(20)/F, the steep one pushes with P = W1 (sin 55 - m cos 55) / ((1 - m m) cos 55 + 2 m sin 55).
TEST(KeyGroupsScene, AnActiveBlockPushesAPassiveOneOut) {
  const double a = 55 * std::numbers::pi / 180, b = 10 * std::numbers::pi / 180;
  const auto spare = [&](double factor) {
    const double m = std::tan(20 * std::numbers::pi / 180) / factor;
    const double push = 233 * (std::sin(a) - m * std::cos(a)) / ((1 - m * m) * std::cos(a) + 2 * m * std::sin(a));
    const double down = 322 + m * push;
    return m * (down * std::cos(b) - push * std::sin(b)) - push * std::cos(b) - down * std::sin(b);
  };
  double low = 0.5, high = 1;
  for (int k = 0; k < 50; ++k) {
    const double middle = (low + high) / 2;
    (spare(middle) > 0 ? low : high) = middle;
  }
  EXPECT_NEAR(low, 0.761, 5e-4);
  const stability::KeyGroups found = groups_of(active_and_passive(20));
  ASSERT_EQ(found.groups.size(), 1U);
  EXPECT_EQ(found.groups[0].verdict, assembly::Verdict::certain);
  EXPECT_EQ(found.groups[0].blocks.size(), 2U);
  EXPECT_NEAR(found.groups[0].volume.si(), 233 + 322, 1e-6);
  EXPECT_NEAR(found.groups[0].factor_move, low, 1e-5);
  // By its factor stronger they stay; within 5 % of it they are in doubt.
  const auto stronger = [&](double share) {
    return std::atan(std::tan(20 * std::numbers::pi / 180) * share / low) * 180 / std::numbers::pi;
  };
  for (const stability::KeyGroup& group : groups_of(active_and_passive(stronger(1.06))).groups) {
    EXPECT_TRUE(group.moments);
  }
  const stability::KeyGroups close = groups_of(active_and_passive(stronger(1.02)));
  ASSERT_FALSE(close.groups.empty());
  for (const stability::KeyGroup& group : close.groups) {
    EXPECT_TRUE(group.moments || group.verdict == assembly::Verdict::in_doubt);
  }
}

// With groups off, what only lesser neighbours hold is said: here a larger one that could slide but does not.
TEST(KeyGroupsScene, WhereOffBarredBlocksAreANote) {
  const auto notes_with = [](double friction, const char* groups) {
    const Scene scene = scene_of(active_and_passive(friction) + fmt::format("groups = \"{}\"\n", groups));
    StageTimer timer;
    Progress progress{ProgressStyle::quiet};
    auto result = run(scene, {.threads = 1}, timer, progress);
    if (!result) ADD_FAILURE() << "the scene does not run";
    std::string found;
    for (const std::string& note : result ? result->notes : std::vector<std::string>{}) {
      if (note.contains("smaller or removable")) found += note;
    }
    return found;
  };
  const double factor = std::tan(20 * std::numbers::pi / 180) / std::tan(55 * std::numbers::pi / 180);
  const std::string note = notes_with(20, "off");
  EXPECT_TRUE(note.starts_with("1 block (233 m3) at free faces stays only because of neighbours")) << note;
  EXPECT_TRUE(note.contains(fmt::format("least factor of safety is {:.3g} (block", factor))) << note;
  // Judged together there is nothing to add; on rough joints it holds by itself.
  EXPECT_EQ(notes_with(20, "note"), "");
  EXPECT_EQ(notes_with(56, "off"), "");
}

}  // namespace
}  // namespace cleave::scene::test
