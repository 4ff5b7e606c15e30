#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

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

// A fault, the two walls of a dyke and a measured joint stand in every realization as they were given, whatever is
// drawn around them; random joints end at the fault, and the dyke has a strength of its own.
TEST_F(NetworkTest, NamedFeaturesAndMeasuredJointsStayInEveryRealization) {
  write(
      "s.toml",
      "[domain]\nbox = { min = [0, 0, 0], max = [20, 20, 20] }\n"
      "[[joint]]\nname = \"main fault\"\nset = \"fault\"\nplane = { through = [10, 10, 10], dip = 70, dip_direction = "
      "90 "
      "}\n"
      "[[joint]]\nname = \"west wall\"\nset = \"dyke\"\nplane = { through = [3, 10, 10], dip = 90, dip_direction = 0 "
      "}\n"
      "[[joint]]\nname = \"east wall\"\nset = \"dyke\"\nplane = { through = [3, 12, 10], dip = 90, dip_direction = 0 "
      "}\n"
      "[[joint]]\nset = \"measured\"\ndisc = { centre = [14, 6, 16], dip = 30, dip_direction = 45, radius = 3, sides = "
      "12 }\n"
      "[[joint_set]]\nname = \"A\"\nterminate_at = [\"fault\"]\norientation = { dip = 40, dip_direction = 200, "
      "distribution = \"fisher\", kappa = 5 }\nshape = \"disc(12)\"\nsize = 8\nintensity = { p32 = 0.4 }\n"
      "[joints.dyke]\nfriction = 5\n[joints.default]\nfriction = 35\n[stability]\nfree = [\"top\", \"west\"]\n"
      "[monte_carlo]\nrealizations = 3\n");
  using Row = std::vector<double>;
  const double dip = 70 * std::numbers::pi / 180;
  const auto beyond_fault = [&](double x, double z) { return std::sin(dip) * (x - 10) + std::cos(dip) * (z - 10); };
  std::vector<std::vector<Row>> networks;
  for (const std::string k : {"0", "1", "2"}) {
    const Ended converted = cleave("convert s.toml n" + k + ".dat --realization " + k);
    ASSERT_EQ(converted.code, 0) << converted.err;
    std::string text = read("n" + k + ".dat");
    for (char& c : text) c = c == '{' || c == '}' || c == ',' ? ' ' : c;
    std::istringstream lines{text};
    std::string line;
    std::getline(lines, line);
    std::vector<Row>& rows = networks.emplace_back();
    while (std::getline(lines, line)) {
      std::istringstream numbers{line};
      Row row;
      for (double v = 0; numbers >> v;) row.push_back(v);
      if (!row.empty()) rows.push_back(row);
    }
    ASSERT_GT(rows.size(), 10U);
    int at_fault = 0;
    for (std::size_t i = 4; i < rows.size(); ++i) {
      double low = 0, high = 0;
      for (std::size_t c = 1; c + 2 < rows[i].size(); c += 3) {
        const double side = beyond_fault(rows[i][c], rows[i][c + 2]);
        low = std::min(low, side);
        high = std::max(high, side);
      }
      EXPECT_TRUE(low > -1e-3 || high < 1e-3) << "joint " << i << " crosses the fault by " << low << " and " << high;
      at_fault += (low > -1e-3 && low < 0) || (high < 1e-3 && high > 0) ? 1 : 0;
    }
    EXPECT_GT(at_fault, 0);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(networks[1][i], networks[0][i]) << i;
    EXPECT_EQ(networks[2][i], networks[0][i]) << i;
  }
  EXPECT_EQ(networks[0][3].size(), 37U);  // the measured disc
  EXPECT_NE(networks[1][4], networks[0][4]);
  EXPECT_NE(networks[2][4], networks[0][4]);
  ASSERT_EQ(cleave("run s.toml -o out --quiet").code, 0);
  ASSERT_EQ(cleave("replay out --realization 2 --quiet").code, 0);
  EXPECT_EQ(json::parse(read("out/realization_2/summary.json"))["input"]["joints"], networks[2].size());
  for (const char* set : {"\"fault\"", "\"dyke\"", "\"measured\""}) {
    ASSERT_EQ(cleave("convert s.toml named.fab --realization 1").code, 0);
    EXPECT_TRUE(read("named.fab").contains(set)) << set;
  }
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
