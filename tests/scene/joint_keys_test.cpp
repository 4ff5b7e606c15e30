#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>

#include "cleave/realize/run.hpp"
#include "run_scene.hpp"

// Keys of [[joint]] beyond its shape: holes, terminates_at, surface; and keep_dangling. Domain: 8 x 8 x 6 m.

namespace cleave::scene::test::joint_keys_test {
namespace {

std::size_t blocks_of(const std::string& text, const Files& files = {}) {
  return run_of(with_box(text), files).complex.value().complex().blocks().size();
}

constexpr std::string_view level = "[[joint]]\npolygon = [[-1, -1, 3], [9, -1, 3], [9, 9, 3], [-1, 9, 3]]\n";
constexpr std::string_view hole = "holes = [[[2, 2, 3], [4, 2, 3], [3, 4, 3]]]\n";

TEST(JointKeys, Holes) {
  EXPECT_EQ(blocks_of(std::string{level}), 2U);
  EXPECT_EQ(blocks_of(std::string{level} + std::string{hole}), 1U);
  const auto wrong = [&](std::string_view holes) {
    return error_of(with_box(std::string{level} + std::string{holes}));
  };
  EXPECT_EQ(
      wrong("holes = [[[2, 2, 3], [4, 2, 3], [3, 9, 3]]]\n"),
      "s.toml:5: joint[1].holes: hole 1 does not lie wholly inside the polygon; a hole may not touch its outline");
  EXPECT_EQ(wrong("holes = [[[2, 2, 3], [4, 2, 3], [3, 4, 3]], [[3, 2.5, 3], [6, 3, 3], [6, 4, 3]]]\n"),
            "s.toml:5: joint[1].holes: hole 2 meets another hole; join them to one outline");
  EXPECT_EQ(
      wrong("holes = [[[2, 2, 3], [4, 2, 3], [3, 4, 3.1]]]\n"),
      "s.toml:5: joint[1].holes: hole 1 lies up to 0.1 m off the polygon's plane; move its corners into the plane");
  EXPECT_EQ(wrong("holes = [[2, 2, 3]]\n").substr(0, 24), "s.toml:5: joint[1].holes");
}

TEST(JointKeys, EndsOn) {
  const std::string flat = "[[joint]]\nname = \"bed\"\nplane = { through = [4, 4, 3], dip = 0, dip_direction = 0 }\n";
  const std::string upright = "[[joint]]\nplane = { through = [4, 4, 5], dip = 90, dip_direction = 90 }\n";
  EXPECT_EQ(blocks_of(flat + upright), 4U);
  EXPECT_EQ(blocks_of(flat + upright + "terminates_at = [\"bed\"]\n"), 3U);
  EXPECT_EQ(blocks_of(upright + "terminates_at = [\"bed\"]\n" + flat), 3U) << "names may come later";
  EXPECT_EQ(error_of(with_box(upright + "terminates_at = [\"bad\"]\n" + flat)),
            "s.toml:4: joint.terminates_at: no joint has the name \"bad\"; give a joint that name, or remove it");
  EXPECT_EQ(error_of(with_box(flat + flat)),
            "s.toml:7: joint[2].name: \"bed\" is the name of another joint; choose another");
  const Scene through = scene_of(with_box(
      flat + "[[joint]]\nplane = { through = [4, 4, 3], dip = 90, dip_direction = 90 }\nterminates_at = [\"bed\"]\n"));
  StageTimer timer;
  Progress progress{ProgressStyle::quiet};
  const auto refused = run(through, {.threads = 1}, timer, progress);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().front().line, 7U);
  EXPECT_EQ(refused.error().front().key, "joint.terminates_at");
}

/// Six sides of a box as faces of an OBJ file.
void append_box(std::string& obj, std::size_t& vertices, std::array<double, 3> lo, std::array<double, 3> hi) {
  for (unsigned k = 0; k < 8; ++k) {
    obj += fmt::format("v {} {} {}\n", (k & 1U) != 0 ? hi[0] : lo[0], (k & 2U) != 0 ? hi[1] : lo[1],
                       (k & 4U) != 0 ? hi[2] : lo[2]);
  }
  constexpr std::array<std::array<std::size_t, 4>, 6> sides{
      {{1, 5, 7, 3}, {2, 4, 8, 6}, {1, 2, 6, 5}, {3, 7, 8, 4}, {1, 3, 4, 2}, {5, 6, 8, 7}}};
  for (const auto& [a, b, c, d] : sides) {
    obj += fmt::format("f {} {} {} {}\n", vertices + a, vertices + b, vertices + c, vertices + d);
  }
  vertices += 8;
}

// As cleave writes a block with cavities: cut open, the face between its parts inside it.
TEST(JointKeys, FacesBetweenPartsOfOneBlockAreNoJoints) {
  const auto halves = [](std::string_view one, std::string_view other) {
    std::string obj = fmt::format("g {}\n", one);
    std::size_t vertices = 0;
    append_box(obj, vertices, {1, 1, 1}, {3, 3, 3});
    obj += fmt::format("g {}\n", other);
    append_box(obj, vertices, {3, 1, 1}, {5, 3, 3});
    return Files{{"b.obj", obj}};
  };
  const std::string file = "[[joint]]\nfile = \"b.obj\"\n";
  EXPECT_EQ(blocks_of(file, halves("block_4", "block_4_part_2")), 2U);
  EXPECT_EQ(blocks_of(file, halves("block_4_part_2", "block_4_part_3")), 2U);
  EXPECT_EQ(blocks_of(file + "surface = true\n", halves("block_4", "block_4_part_2")), 2U);
  EXPECT_EQ(blocks_of(file, halves("block_4", "block_5")), 3U);
  EXPECT_EQ(blocks_of(file, halves("block_4", "block_5_part_2")), 3U);
  EXPECT_EQ(blocks_of(file, halves("block_4", "block_4_part_")), 3U);
  // Names of others that end so say nothing about blocks.
  EXPECT_EQ(blocks_of(file, halves("fault", "fault_part_2")), 3U);
  EXPECT_EQ(blocks_of(file, halves("block_a", "block_a_part_2")), 3U);
  EXPECT_EQ(blocks_of(file, halves("", "")), 3U);
  const Scene scene = scene_of(with_box(file), halves("block_4", "block_4_part_2"));
  ASSERT_EQ(scene.notes.size(), 1U);
  EXPECT_NE(describe(scene.notes.front()).find("2 of 12 faces lie between the parts"), std::string::npos)
      << describe(scene.notes.front());
}

TEST(JointKeys, ASurfaceOfAnObjFile) {
  const Files files{{"fault.obj", "v -1 -1 2\nv 4 -1 4\nv 9 -1 2\nv -1 9 2\nv 4 9 4\nv 9 9 2\nf 1 2 5 4\nf 2 3 6 5\n"}};
  const std::string file = "[[joint]]\nfile = \"fault.obj\"\n";
  EXPECT_EQ(scene_of(with_box(file), files).joints.size(), 2U);
  EXPECT_EQ(scene_of(with_box(file + "surface = true\n"), files).joints.size(), 1U);
  EXPECT_EQ(blocks_of(file + "surface = true\n", files), 2U);
  EXPECT_EQ(
      error_of(with_box("[[joint]]\nplane = { through = [4, 4, 5], dip = 90, dip_direction = 90 }\nsurface = true\n")),
      "s.toml:5: joint[1].surface: has a meaning for files only; remove it");
}

// Drawn joints end inside the rock as often as not: told where nearly none separates anything. Given ones always.
TEST(JointKeys, GivenJointsThatSeparateNothingAreNamed) {
  const auto drawn = [](double size) {
    return fmt::format(
        "[[joint_set]]\nname = \"A\"\norientation = {{ dip = 30, dip_direction = 90 }}\nshape = \"disc\"\n"
        "size = {{ distribution = \"constant\", mean = {} }}\nintensity = {{ count = 20 }}\n",
        size);
  };
  const std::string stub = "[[joint]]\npolygon = [[-1, -1, 3], [3, -1, 3], [3, 9, 3], [-1, 9, 3]]\n";
  const RunResult mixed = run_of(with_box(drawn(15)));
  EXPECT_GT(mixed.cut.dangling.size(), 0U);
  EXPECT_LT(mixed.cut.dangling.size(), 20U);
  EXPECT_EQ(notes_with(mixed, "inside the rock"), 0U);
  EXPECT_EQ(notes_with(run_of(with_box(drawn(1))), "drawn joints end inside the rock and separate nothing"), 1U);
  EXPECT_EQ(notes_with(run_of(with_box(drawn(1) + stub)), "1 of 1 given joints ends inside the rock"), 1U);
  EXPECT_EQ(notes_with(run_of(with_box(stub)), "1 of 1 joints ends inside the rock"), 1U);
}

TEST(JointKeys, KeepDangling) {
  const std::string stub = "[[joint]]\npolygon = [[-1, -1, 3], [3, -1, 3], [3, 9, 3], [-1, 9, 3]]\n";
  EXPECT_FALSE(run_of(with_box(stub)).complex.value().complex().dangling().has_value());
  const auto kept = run_of("keep_dangling = true\n" + with_box(stub));
  ASSERT_TRUE(kept.complex.value().complex().dangling().has_value());
  EXPECT_DOUBLE_EQ(kept.complex.value().complex().dangling()->area.si(), 24);
}

// A clamped size and a box of centres; where they mean nothing they are refused.
TEST(JointKeys, BufferAndClamp) {
  const std::string set = "[[joint_set]]\norientation = { dip = 30, dip_direction = 30 }\nintensity = { count = 40 }\n";
  const auto sizes = [](std::string_view more) {
    return "size = { distribution = \"exponential\", mean = 80, min = 40, max = 120" + std::string{more} + " }\n";
  };
  const Scene clamped = scene_of(with_box(set + "shape = \"square\"\nbuffer = 1.5\n" + sizes(", clamp = true")));
  const dfn::JointSetSpec& spec = clamped.joint_sets.front().law.spec();
  EXPECT_EQ(spec.buffer, 1.5);
  EXPECT_NEAR(std::get<dfn::Square>(spec.shape).size.moment(1), 70.672040, 1e-6);
  const Scene cut = scene_of(with_box(set + "shape = \"square\"\n" + sizes("")));
  EXPECT_NEAR(std::get<dfn::Square>(cut.joint_sets.front().law.spec().shape).size.moment(1), 73.441863, 1e-6);
  EXPECT_FALSE(cut.joint_sets.front().law.spec().buffer.has_value());
  EXPECT_EQ(error_of(with_box(set + "size = \"persistent\"\nbuffer = 2\n")),
            "s.toml:7: joint_set[1].buffer: has no meaning where joints are not drawn by their centres; remove it: "
            "planes are drawn throughout the domain");
  EXPECT_NE(error_of(with_box(set + "size = 3\nbuffer = 0.9\n")).find("joint_set[1].buffer"), std::string::npos);
  EXPECT_NE(error_of(with_box(set + "size = { distribution = \"uniform\", min = 2 }\n")).find("size.max"),
            std::string::npos);
}

// A constant size with a standard deviation was a constant size.
TEST(JointKeys, KeysOfOtherLawsAreRefused) {
  const std::string set = "[[joint_set]]\norientation = { dip = 30, dip_direction = 30 }\nintensity = { count = 40 }\n";
  const auto of_size = [&](std::string_view law) {
    return error_of(with_box(set + "size = { distribution = " + std::string{law} + " }\n"));
  };
  EXPECT_EQ(of_size("\"constant\", mean = 5, std = 3"),
            "s.toml:6: joint_set[1].size.std: has no meaning for the distribution \"constant\"; remove it, or set "
            "distribution = \"normal\"");
  EXPECT_TRUE(of_size("\"constant\", mean = 5, clamp = true").contains("size.clamp: has no meaning"));
  EXPECT_TRUE(
      of_size("\"exponential\", mean = 5, std = 3").contains("size.std: has no meaning for the distribution \"exp"));
  for (const std::string law :
       {"exponential\", mean = 5", "normal\", mean = 5, std = 3", "lognormal\", mean = 5, std = 3",
        "gamma\", mean = 5, std = 3", "uniform\", min = 5, max = 7", "constant\", mean = 5"}) {
    EXPECT_TRUE(of_size("\"" + law + ", exponent = 3").contains("size.exponent: has no meaning")) << law;
    EXPECT_NO_FATAL_FAILURE(scene_of(with_box(set + "size = { distribution = \"" + law + " }\n")));
  }
  EXPECT_TRUE(of_size("\"power\", exponent = 3, min = 1, mean = 5").contains("size.mean: has no meaning"));
  EXPECT_TRUE(of_size("\"power\", exponent = 3, min = 1, std = 5").contains("size.std: has no meaning"));
  EXPECT_TRUE(of_size("\"uniform\", min = 1, max = 3, mean = 2").contains("size.mean: has no meaning"));
  EXPECT_TRUE(of_size("\"uniform\", min = 1, max = 3, std = 2").contains("size.std: has no meaning"));
  const auto of_rotation = [&](std::string_view law) {
    return error_of(with_box(set + "size = 5\nrotation = { distribution = " + std::string{law} + " }\n"));
  };
  EXPECT_TRUE(of_rotation("\"uniform\", min = 0, max = 90, std = 5").contains("rotation.std: has no meaning"));
  EXPECT_TRUE(of_rotation("\"normal\", mean = 0, std = 5, max = 90").contains("rotation.max: has no meaning"));
  EXPECT_TRUE(of_rotation("\"constant\", mean = 0, std = 5").contains("rotation.std: has no meaning"));
  EXPECT_TRUE(
      error_of(with_box("[[joint_set]]\norientation = { distribution = \"bootstrap\", file = \"p.csv\", kappa = 5 "
                        "}\nintensity = { p32 = 1 }\nsize = 5\n"))
          .contains("orientation.kappa: has no meaning for the distribution \"bootstrap\""));
}

}  // namespace
}  // namespace cleave::scene::test::joint_keys_test
