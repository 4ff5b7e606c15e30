#include "cleave/scene/plan.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/realize/run.hpp"
#include "parse_support.hpp"

namespace cleave::scene {
namespace {

using test::parse_text;

struct Sized {
  std::string name;
  std::string text;
};

std::string regular_grid() {
  std::string text = "schema = 1\n[domain]\nbox = { min = [0, 0, 0], max = [12, 12, 12] }\n";
  for (int i = 1; i < 12; ++i) {
    text += fmt::format(
        "[[joint]]\nplane = {{ through = [{0}, 6, 6], dip = 90, dip_direction = 90 }}\n"
        "[[joint]]\nplane = {{ through = [6, {0}, 6], dip = 90, dip_direction = 0 }}\n"
        "[[joint]]\nplane = {{ through = [6, 6, {0}], dip = 0, dip_direction = 0 }}\n",
        i);
  }
  return text;
}

std::string random_sets(std::string_view shape_and_size, std::string_view intensity) {
  std::string text = "schema = 1\nseed = 5\n[domain]\nbox = { min = [0, 0, 0], max = [40, 30, 20] }\n";
  for (const std::string_view attitude :
       {"dip = 10, dip_direction = 40", "dip = 80, dip_direction = 130", "dip = 70, dip_direction = 220"}) {
    text += fmt::format(
        "[[joint_set]]\norientation = {{ {}, distribution = \"fisher\", kappa = 20 }}\n{}\nintensity = {{ {} }}\n",
        attitude, shape_and_size, intensity);
  }
  return text;
}

class PlannedSize : public testing::TestWithParam<Sized> {};

// The estimate is for people who decide whether to start a run: what comes out lies in the bracket, and its end says
// something.
TEST_P(PlannedSize, BracketHoldsTheBlocksThatComeOut) {
  const auto scene = parse_text(GetParam().text);
  ASSERT_TRUE(scene.has_value()) << describe(scene.error().front());
  const SizeEstimate estimate = make_plan(*scene).estimate;
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  const auto result = run(*scene, {}, timer, progress);
  ASSERT_TRUE(result.has_value());
  const auto blocks = static_cast<double>(result->complex->complex().blocks().size());
  EXPECT_LE(estimate.blocks_low, blocks);
  EXPECT_GE(estimate.blocks_high, blocks);
  EXPECT_LE(estimate.blocks_high, 30 * blocks);
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, PlannedSize,
    testing::Values(Sized{"Grid", regular_grid()}, Sized{"Planes", random_sets("size = \"persistent\"", "spacing = 4")},
                    Sized{"CountedPlanes", random_sets("size = \"persistent\"", "count = 12")},
                    Sized{"LargeRectangles",
                          random_sets("shape = \"rectangle\"\nsize = { distribution = \"normal\", mean = 30, std = 5 }",
                                      "p32 = 0.3")},
                    Sized{"Discs", random_sets("shape = \"disc\"\nsize = 8", "p32 = 0.8")}),
    [](const auto& named) { return named.param.name; });

}  // namespace
}  // namespace cleave::scene
