#include <nlohmann/json.hpp>

#include "program.hpp"

namespace cleave::cli::test {
namespace {

using nlohmann::json;

/// Networks that cleave draws, written for other programs and read again.
class NetworkTest : public ProgramTest {
 protected:
  [[nodiscard]] json summary(const std::string& out) const { return json::parse(read(out + "/summary.json")); }
  static std::string scene_of_file(const std::string& file) {
    return "[domain]\nbox = { min = [0, 0, 0], max = [8, 8, 6] }\n[[joint]]\nfile = \"" + file +
           "\"\n[joints.default]\nfriction = 20\n[stability]\nfree = [\"top\", \"east\"]\n";
  }
};

// The blocks of the network that was drawn are those of the network that was read: same joints, to the last bit.
TEST_F(NetworkTest, DrawnNetworksComeBackFromFiles) {
  write("drawn.toml", small_scene);
  ASSERT_EQ(cleave("run drawn.toml -o drawn --quiet").code, 0);
  const json drawn = summary("drawn");
  for (const std::string format : {"fab", "dat", "obj"}) {
    const Ended converted = cleave("convert drawn.toml network." + format);
    ASSERT_EQ(converted.code, 0) << converted.err;
    EXPECT_TRUE(converted.out.contains(std::to_string(drawn["input"]["joints"].get<int>()) + " faces"))
        << converted.out;
    write("read.toml", scene_of_file("network." + format));
    const Ended run = cleave("run read.toml -o read_" + format + " --quiet");
    ASSERT_EQ(run.code, 0) << run.err;
    const json back = summary("read_" + format);
    EXPECT_EQ(back["input"]["joints"], drawn["input"]["joints"]) << format;
    EXPECT_EQ(back["blocks"]["hash"], drawn["blocks"]["hash"]) << format;
    EXPECT_EQ(back["key_blocks"]["volume_m3"], drawn["key_blocks"]["volume_m3"]) << format;
    // Once more around: the same bytes.
    ASSERT_EQ(cleave("convert read.toml again." + format).code, 0);
    if (format != "obj" && format != "fab") {  // those name the set
      EXPECT_EQ(read("again." + format), read("network." + format));
    }
  }
  EXPECT_TRUE(read("network.fab").contains("= \"A\""));
  // From file to file.
  ASSERT_EQ(cleave("convert network.fab other.dat").code, 0);
  EXPECT_EQ(read("other.dat"), read("network.dat"));
  ASSERT_EQ(cleave("convert drawn.toml later.fab --realization 3").code, 0);
  EXPECT_NE(read("later.fab"), read("network.fab"));
}

TEST_F(NetworkTest, EndlessPlanesGoToTheBorderOfTheDomain) {
  write("planes.toml",
        "[domain]\nbox = { min = [0, 0, 0], max = [8, 8, 6] }\n[[joint_set]]\nname = \"P\"\norientation = { dip = 50, "
        "dip_direction = 30, distribution = \"fisher\", kappa = 4 }\nsize = \"persistent\"\nintensity = { spacing = 2 "
        "}\n[joints.default]\nfriction = 20\n[stability]\nfree = [\"top\", \"east\"]\n");
  ASSERT_EQ(cleave("run planes.toml -o planes --quiet").code, 0);
  const Ended converted = cleave("convert planes.toml planes.fab");
  ASSERT_EQ(converted.code, 0) << converted.err;
  EXPECT_TRUE(converted.out.contains("endless planes are written up to 1 % beyond")) << converted.out;
  write("read.toml", scene_of_file("planes.fab"));
  ASSERT_EQ(cleave("run read.toml -o read --quiet").code, 0);
  EXPECT_EQ(summary("read")["blocks"]["count"], summary("planes")["blocks"]["count"]);
  EXPECT_NEAR(summary("read")["key_blocks"]["volume_m3"].get<double>(),
              summary("planes")["key_blocks"]["volume_m3"].get<double>(), 1e-6);
}

TEST_F(NetworkTest, WhatIsNoNetworkIsRefused) {
  write("empty.toml", "[domain]\nbox = { min = [0, 0, 0], max = [8, 8, 6] }\n");
  EXPECT_EQ(cleave("convert empty.toml x.fab").code, 2);
  write("wrong.toml", "[domain]\nbox = 3\n");
  EXPECT_EQ(cleave("convert wrong.toml x.fab").code, 2);
  write("drawn.toml", small_scene);
  EXPECT_EQ(cleave("convert drawn.toml x.vtu").code, 2);  // open polygons are no blocks
  ASSERT_EQ(cleave("run drawn.toml -o drawn --quiet").code, 0);
  const Ended blocks = cleave("convert drawn x.fab");
  EXPECT_EQ(blocks.code, 2);
  EXPECT_TRUE(blocks.err.contains("holds fractures, not blocks")) << blocks.err;
  const auto refused = [&](const std::string& text, const std::string& what) {
    write("n.dat", text);
    const Ended ended = cleave("convert n.dat x.obj");
    EXPECT_EQ(ended.code, 2);
    EXPECT_TRUE(ended.err.contains(what)) << ended.err;
    EXPECT_FALSE(exists("x.obj"));
  };
  refused("1 2 3\n", "n.dat:1");
  refused("nPolygons: 2\n3 {0, 0, 0} {1, 0, 0} {0, 1, 0}\n", "ends in the middle of a polygon");
  refused("nPolygons: 1\n3 {0, 0, 0} {1, 0, 0}\n", "ends in the middle of a polygon");
  refused("nPolygons: 1\n2 {0, 0, 0} {1, 0, 0}\n", "a polygon has 2 corners");
  refused("nPolygons: 1\n3 {0, 0, 0} {1, 0, 0} {0, x, 0}\n", "n.dat:2");
  refused("nPolygons: 1\n3 {0, 0, 0} {1, 0, 0} {0, 1, 0}\n9\n", "stands behind the last polygon");
  write("n.dat", "nPolygons:1\r\n3 {0,0,0} {1,0,0} {0,1,0}\r\n");
  EXPECT_EQ(cleave("convert n.dat x.obj").code, 0);
}

}  // namespace
}  // namespace cleave::cli::test
