// Slips that would change a verdict without a word: what is stated twice, what nothing reads, what is counted in per
// cent. Each is refused, or noted.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cleave/scene2d/contact.hpp"
#include "run_scene.hpp"

namespace cleave::scene::test::silent_slips_test {
namespace {

/// A wedge between two joints at the top of a slope.
std::string wedge(const std::string& more, const std::string& third = "") {
  return "[domain]\ncorners = [[0, 0, 0], [20, 0, 0], [0, 20, 0], [20, 20, 0], [0, 0, 10], [16.360298, 0, 10], "
         "[0, 20, 10], [16.360298, 20, 10]]\n"
         "[[joint]]\nplane = { through = [19.5, 10, 1], dip = 60, dip_direction = 45 }\nset = \"north-east\"\n"
         "[[joint]]\nplane = { through = [19.5, 10, 1], dip = 60, dip_direction = 135 }\n" +
         third + "[rock]\ndensity = 2700\n[joints.default]\nfriction = 50\n" + more;
}
const std::string second = "set = \"south-east\"\n";
const std::string free_faces = "[stability]\nfree = [\"top\", \"east\"]\n";

TEST(SilentSlips, DefaultOfPressuresIsThatOfSetsNotNamed) {
  const auto counted = [](const std::string& water, const std::string& third) {
    return run_of(wedge(free_faces + "groups = \"off\"\nwater = { pressures = { " + water + " } }\n", third))
        .figures.key_blocks->count;
  };
  const std::string both = "north-east = \"50 kPa\", south-east = \"50 kPa\"";
  EXPECT_EQ(counted("north-east = 0", second), 0U);
  EXPECT_EQ(counted(both, second), 1U);
  EXPECT_EQ(counted("default = \"50 kPa\"", second), 1U);
  EXPECT_EQ(counted("default = \"50 kPa\"", ""), 1U) << "a joint of no set, and one that has a set";
  const auto pressures = [](const std::string& text) {
    const Scene scene = scene_of(text);
    std::vector<std::vector<std::optional<double>>> of{scene.stability->loads.actions.spec().joint_pressure};
    for (const LoadCase& load : scene.stability->cases) of.push_back(load.loads.actions.spec().joint_pressure);
    return of;
  };
  using Of = std::vector<std::vector<std::optional<double>>>;
  // Sets: of no name, north-east, south-east.
  EXPECT_EQ(pressures(wedge(free_faces + "water = { pressures = { default = 50e3, north-east = 1e3 } }\n", second)),
            (Of{{50e3, 1e3, 50e3}}));
  EXPECT_EQ(pressures(wedge(free_faces + "water = { pressures = { north-east = 1e3 } }\n"
                                         "[[load]]\nname = \"wet\"\nwater = { pressures = { default = 50e3 } }\n",
                            second)),
            (Of{{std::nullopt, 1e3, std::nullopt}, {50e3, 50e3, 50e3}}));
}

}  // namespace
}  // namespace cleave::scene::test::silent_slips_test
