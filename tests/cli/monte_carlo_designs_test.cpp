#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "program.hpp"

namespace cleave::cli::test {
namespace {

using nlohmann::json;

/// What Monte Carlo runs compare: strengths on one geometry, levels of water, supports, orders of excavation.
class DesignsTest : public ProgramTest {
 protected:
  [[nodiscard]] json section(const std::string& out) const {
    return json::parse(read(out + "/summary.json"))["monte_carlo"];
  }
  /// Runs a scene into the folder of its name.
  void run(const std::string& name, const std::string& text) const {
    write(name + ".toml", text);
    const Ended ended = cleave("run " + name + ".toml -o " + name + " --quiet");
    ASSERT_EQ(ended.code, 0) << name << ": " << ended.err;
  }
  [[nodiscard]] double mean_volume(const std::string& out) const {
    return section(out)["quantities"]["key_block_volume_m3"]["mean"];
  }
  void expect_replayed(const std::string& out, int realization) const {
    const Ended replay = cleave("replay " + out + " --realization " + std::to_string(realization));
    EXPECT_EQ(replay.code, 0) << replay.err;
    EXPECT_TRUE(replay.out.contains("is reproduced to the last digit")) << replay.out;
  }
  /// Quantities of the comparison of two results.
  [[nodiscard]] json compared(const std::string& one, const std::string& other) const {
    const Ended ended = cleave("compare-designs " + one + " " + other + " -o difference.json");
    EXPECT_EQ(ended.code, 0) << ended.err;
    return json::parse(read("difference.json"))["quantities"];
  }
  static std::string with_friction_law() {
    std::string text = crowded_scene();
    text.replace(text.find("friction = 20"), 13, "friction = { distribution = \"uniform\", min = 15, max = 45 }");
    return text;
  }
  /// Columns of realizations.csv by name, row by row.
  [[nodiscard]] std::vector<std::string> column(const std::string& out, const std::string& name) const {
    std::istringstream lines{read(out + "/realizations.csv")};
    std::string line;
    std::getline(lines, line);
    std::getline(lines, line);
    const auto cells = [](const std::string& row) {
      std::vector<std::string> found{""};
      for (const char c : row) {
        if (c == ',') {
          found.emplace_back();
        } else {
          found.back() += c;
        }
      }
      return found;
    };
    const auto names = cells(line);
    const auto at = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
    std::vector<std::string> values;
    while (std::getline(lines, line)) values.push_back(cells(line).at(at));
    return values;
  }
};

TEST_F(DesignsTest, NestedDesignsCutEachGeometryOnce) {
  const std::string text = with_friction_law() + "[monte_carlo]\nrealizations = 30\n";
  write("s.toml", text + "strengths_per_geometry = 3\n");
  ASSERT_EQ(cleave("run s.toml -o one --threads 1 --quiet").code, 0);
  ASSERT_EQ(cleave("run s.toml -o two --threads 2 --quiet").code, 0);
  EXPECT_EQ(read("one/realizations.csv"), read("two/realizations.csv"));
  const auto blocks = column("one", "blocks"), keys = column("one", "volume_m3");
  bool strengths_differ = false, geometries_differ = false;
  for (std::size_t k = 0; k < 30; k += 3) {
    EXPECT_EQ(blocks[k], blocks[k + 1]);
    EXPECT_EQ(blocks[k], blocks[k + 2]);
    strengths_differ |= keys[k] != keys[k + 1] || keys[k] != keys[k + 2];
    geometries_differ |= blocks[k] != blocks[0];
  }
  EXPECT_TRUE(strengths_differ);
  EXPECT_TRUE(geometries_differ);
  const json mc = section("one");
  EXPECT_EQ(mc["realizations"], 30);
  EXPECT_EQ(mc["quantities"]["block_count"]["realizations"], 10);
  EXPECT_EQ(mc["nested"]["strengths_per_geometry"], 3);
  EXPECT_GT(mc["nested"]["variances"]["key_block_volume_m3"]["strength"], 0);
  EXPECT_TRUE(read("one/report.html").contains("<section id=\"variances\">"));
  // Geometry g is that of realization g of the plain scene.
  write("plain.toml", text);
  ASSERT_EQ(cleave("run plain.toml -o plain --quiet").code, 0);
  const auto plain = column("plain", "blocks");
  for (std::size_t g = 0; g < 10; ++g) EXPECT_EQ(blocks[3 * g], plain[g]);
  // Shards take whole geometries; replays find the record; an interrupted run stops inside a geometry, too.
  for (const std::string k : {"1", "2"}) {
    ASSERT_EQ(cleave("run s.toml -o part" + k + " --shard " + k + "/2 --quiet").code, 0);
  }
  ASSERT_EQ(cleave("merge part1 part2 -o all --quiet").code, 0);
  EXPECT_EQ(read("all/realizations.csv"), read("one/realizations.csv"));
  EXPECT_EQ(cleave("replay one --realization 7 --quiet").code, 0);
  const std::string records = read("one/realizations.csv");
  std::size_t end = 0;
  for (int line = 0; line < 2 + 7; ++line) end = records.find('\n', end) + 1;
  fs::create_directory(path("broken"));
  write("broken/realizations.csv.part", records.substr(0, end + 20));
  ASSERT_EQ(cleave("run s.toml -o broken --quiet").code, 0);
  EXPECT_EQ(read("broken/realizations.csv"), records);
  write("odd.toml", text + "strengths_per_geometry = 4\n");
  const Ended odd = cleave("run odd.toml -o odd");
  EXPECT_EQ(odd.code, 2);
  EXPECT_TRUE(odd.err.contains("monte_carlo.strengths_per_geometry: 4 does not divide the 30 realizations")) << odd.err;
}

TEST_F(DesignsTest, StopsCountGeometries) {
  write("s.toml", with_friction_law() +
                      "[monte_carlo]\nstrengths_per_geometry = 2\nstop = { quantity = \"block_count\", "
                      "relative_half_width = 0.3, max = 600 }\n");
  ASSERT_EQ(cleave("run s.toml -o out --quiet").code, 0);
  EXPECT_EQ(section("out")["stopped_by"], "precision");
  EXPECT_EQ(section("out")["realizations"], 200);
}

// The same joints in each realization, another level of the water: more water, no fewer key blocks on average.
TEST_F(DesignsTest, WaterLevelsAreDrawnOnceARealization) {
  const std::string mc = "[monte_carlo]\nrealizations = 40\n";
  run("dry", std::string{small_scene} + mc);
  run("wet", std::string{small_scene} + "water = { table = { distribution = \"uniform\", min = 0, max = 6 } }\n" + mc);
  run("high", std::string{small_scene} + "water = { table = 6 }\n" + mc);
  EXPECT_LT(mean_volume("dry"), mean_volume("wet"));
  EXPECT_LT(mean_volume("wet"), mean_volume("high"));
  expect_replayed("wet", 11);
  // A single run is realization 0.
  write("one.toml",
        std::string{small_scene} + "water = { table = { distribution = \"normal\", mean = 3, std = 1 } }\n");
  EXPECT_EQ(cleave("run one.toml -o one --quiet").code, 0);
  write("bad.toml", std::string{small_scene} + "water = { table = { distribution = \"uniform\", min = 3 } }\n");
  const Ended bad = cleave("check bad.toml");
  EXPECT_EQ(bad.code, 2);
  EXPECT_TRUE(bad.err.contains("stability.water.table")) << bad.err;
}

TEST_F(DesignsTest, ComparesDesignsOnCommonRandomNumbers) {
  const std::string mc = "[monte_carlo]\nrealizations = 60\n";
  std::string text{small_scene};
  text.replace(text.find("friction = 20"), 13, "friction = 24");
  run("weak", std::string{small_scene} + mc);
  run("strong", text + mc);
  const json volume = compared("weak", "strong")["key_block_volume_m3"];
  EXPECT_EQ(volume["pairs"], 60);
  EXPECT_LE(volume["difference"], 0);  // nothing gets weaker
  EXPECT_NEAR(volume["difference"].get<double>(), mean_volume("strong") - mean_volume("weak"), 1e-9);
  EXPECT_GT(volume["gain"], 3);
  EXPECT_GT(volume["correlation"], 0.5);
  const std::string same = cleave("compare-designs weak strong").out;
  EXPECT_FALSE(same.contains("not the same rock")) << same;
  EXPECT_FALSE(same.contains("inflow")) << "neither has [flow]\n" << same;
  // Other random numbers or no Monte Carlo result: no comparison.
  ASSERT_EQ(cleave("run strong.toml -o other --seed 5 --quiet").code, 0);
  EXPECT_TRUE(cleave("compare-designs weak other").err.contains("has the seed 5"));
  EXPECT_EQ(cleave("compare weak other").code, 2);
  EXPECT_TRUE(cleave("compare weak other").out.starts_with("note: cleave compare is now cleave compare-designs"));
  EXPECT_EQ(cleave("compare weak nowhere").code, 2);
  ASSERT_EQ(cleave("run weak.toml -o part --shard 1/2 --quiet").code, 0);
  EXPECT_TRUE(cleave("compare weak part").err.contains("is a shard"));
}

// Sets draw by their place among [[joint_set]]: in another order they are another rock, of as many joints.
TEST_F(DesignsTest, SetsInAnotherOrderAreSaidToBeAnotherRock) {
  const auto scene = [](const std::string& first, const std::string& second) {
    return "[domain]\nbox = { min = [0, 0, 0], max = [8, 8, 6] }\n" + first + second +
           "[[excavation]]\nkind = \"polyhedron\"\nbox = { min = [2, 0, 1], max = [6, 8, 2] }\n"
           "[monte_carlo]\nrealizations = 4\n";
  };
  const auto set = [](const std::string& name, const std::string& direction) {
    return "[[joint_set]]\nname = \"" + name + "\"\norientation = { dip = 60, dip_direction = " + direction +
           " }\nsize = \"persistent\"\nintensity = { count = 3 }\n";
  };
  run("ab", scene(set("A", "90"), set("B", "270")));
  run("ba", scene(set("B", "270"), set("A", "90")));
  run("ac", scene(set("A", "90"), set("C", "270")));
  run("more", scene(set("A", "90"), set("B", "250")));
  const auto said = [&](const std::string& other) { return cleave("compare-designs ab " + other).out; };
  EXPECT_TRUE(
      said("ba").contains("note: the joints of realization 0 are not the same in both: they are not the same rock"))
      << said("ba");
  EXPECT_TRUE(said("ba").contains("(A is [[joint_set]] 1 in the first and 2 in the second)")) << said("ba");
  EXPECT_TRUE(said("more").contains("not the same rock")) << said("more");
  EXPECT_FALSE(said("ac").contains("not the same rock")) << "another name draws the same\n" << said("ac");
}

constexpr std::string_view two_stages = R"toml(schema = 1
[domain]
box = { min = [0, 0, 0], max = [16, 10, 12] }
[[joint_set]]
name = "A"
orientation = { dip = 50, dip_direction = 90, distribution = "fisher", kappa = 10 }
size = { distribution = "constant", mean = 14 }
intensity = { count = 12 }
[[joint_set]]
name = "B"
orientation = { dip = 60, dip_direction = 230, distribution = "fisher", kappa = 10 }
size = { distribution = "constant", mean = 14 }
intensity = { count = 12 }
[joints.default]
friction = 20
[[excavation]]
name = "left"
kind = "tunnel"
section = { shape = "rectangle", width = 4, height = 4 }
axis = [[5, 0, 5], [5, 10, 5]]
stage = 1
[[excavation]]
name = "right"
kind = "tunnel"
section = { shape = "rectangle", width = 4, height = 4 }
axis = [[11, 0, 5], [11, 10, 5]]
stage = 2
[stability]
groups = "off"
)toml";

TEST_F(DesignsTest, OrdersOfExcavationInEveryRealization) {
  write("s.toml",
        std::string{two_stages} + "[sequence]\ncompare_orders = [[1, 2], [2, 1]]\n[monte_carlo]\nrealizations = 12\n");
  ASSERT_EQ(cleave("run s.toml -o out --quiet").code, 0);
  const json orders = section("out")["orders"];
  ASSERT_EQ(orders.size(), 2U);
  EXPECT_EQ(orders[0]["stages"], json({1, 2}));
  EXPECT_EQ(orders[1]["stages"], json({2, 1}));
  EXPECT_GT(orders[0]["key_volume_m3"]["mean"], 0);
  EXPECT_NEAR(orders[1]["key_volume_minus_first_m3"]["mean"].get<double>(),
              orders[1]["key_volume_m3"]["mean"].get<double>() - orders[0]["key_volume_m3"]["mean"].get<double>(),
              1e-9);
  EXPECT_NEAR(orders[0]["share_best"].get<double>() + orders[1]["share_best"].get<double>(), 1, 1e-12);
  EXPECT_TRUE(read("out/report.html").contains("<section id=\"orders\">"));
  expect_replayed("out", 5);
}

TEST_F(DesignsTest, SupportDesignsComparedOnTheSameRock) {
  const auto design = [](const std::string& spacing) {
    return std::string{two_stages} + "[support]\n[[support.bolts]]\ntunnel = \"left\"\nlength = 3\nspacing = [" +
           spacing + ", " + spacing +
           "]\ntendon = 100e3\nbond = 200e3\nplate = 50e3\nanchorage = 0.2\n[monte_carlo]\nrealizations = 10\n";
  };
  run("wide", design("3"));
  run("tight", design("1.2"));
  const json wide = section("wide")["quantities"];
  EXPECT_GT(wide["support_blocks_needing"]["mean"], 0);
  EXPECT_LE(wide["support_blocks_not_held"]["mean"], wide["support_blocks_needing"]["mean"]);
  const json difference = compared("wide", "tight");
  EXPECT_EQ(difference["support_blocks_needing"]["difference"], 0);
  EXPECT_LT(difference["support_not_held_m3"]["difference"], 0);
  expect_replayed("wide", 3);
}

// What bolts change is not read off a run that was not asked; load cases of the same name are compared too.
TEST_F(DesignsTest, RunsWithoutSupportAreNotComparedWithBolts) {
  const std::string rock = std::string{two_stages} + "[monte_carlo]\nrealizations = 6\n[[load]]\nname = \"quake\"\n" +
                           "seismic = [0.2, 0, 0]\n";
  const std::string bolts =
      "[support]\n[[support.bolts]]\ntunnel = \"left\"\nlength = 3\nspacing = [2, 2]\ntendon = 100e3\n"
      "bond = 200e3\nplate = 50e3\nanchorage = 0.2\n";
  run("bare", rock);
  run("bolted", rock + bolts);
  const Ended ended = cleave("compare-designs bare bolted -o difference.json");
  EXPECT_EQ(ended.code, 0) << ended.err;
  // A support has a target, and figures of what reaches it only by what may not be there.
  EXPECT_TRUE(ended.out.contains("note: only bolted has domain_held_at_target_count, ")) << ended.out;
  EXPECT_TRUE(ended.out.contains(", support_blocks_needing, ")) << ended.out;
  EXPECT_TRUE(ended.out.contains("\nunder quake:\n")) << ended.out;
  const json difference = json::parse(read("difference.json"));
  EXPECT_FALSE(difference["quantities"].contains("support_fails"));
  const json& quake = difference["load_cases"]["quake"]["quantities"];
  EXPECT_FALSE(quake.contains("support_fails"));
  EXPECT_EQ(quake["key_block_volume_m3"]["difference"], 0);
  EXPECT_GT(quake["key_block_volume_m3"]["first"], 0);
}

// Two and three ranks (one hands out work) give the bytes of one process.
TEST_F(DesignsTest, RanksGiveTheSameBytes) {
  const fs::path program = fs::path{CLEAVE_PROGRAM}.parent_path() / "cleave_mpi";
  if (!fs::exists(program) || std::system("command -v mpirun > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "cleave_mpi or mpirun is not here";
  }
  write("s.toml", with_friction_law() + "[monte_carlo]\nrealizations = 24\nstrengths_per_geometry = 2\n");
  ASSERT_EQ(cleave("run s.toml -o one --quiet").code, 0);
  for (const std::string n : {"2", "3"}) {
    const Ended run = shell("OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpirun --oversubscribe -n " + n +
                            " '" + program.string() + "' s.toml -o ranks" + n + " --quiet; echo code $?");
    if (!run.out.contains("code 0")) GTEST_SKIP() << "mpirun does not run here: " << run.err;
    EXPECT_EQ(read("ranks" + n + "/realizations.csv"), read("one/realizations.csv"));
    EXPECT_TRUE(section("ranks" + n) == section("one")) << n;
  }
}

// How long each of two real ranks had nothing to do is said when they end. How much it is depends on what else the
// machine does: docs/dev/monte_carlo_checks.md has it measured, tests/stochastic has it simulated.
TEST_F(DesignsTest, RanksSayHowLongTheyWaited) {
  const fs::path program = fs::path{CLEAVE_PROGRAM}.parent_path() / "cleave_mpi";
  if (!fs::exists(program) || std::system("command -v mpirun > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "cleave_mpi or mpirun is not here";
  }
  write("s.toml", with_friction_law() + "[monte_carlo]\nrealizations = 40\n");
  const Ended run = shell("OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpirun --oversubscribe -n 2 '" +
                          program.string() + "' s.toml -o ranks; echo code $?");
  if (!run.out.contains("code 0")) GTEST_SKIP() << "mpirun does not run here: " << run.err;
  const std::string words = "ranks waited for work (share of the time):";
  const std::size_t at = run.err.find(words);
  ASSERT_NE(at, std::string::npos) << run.err;
  std::istringstream shares{run.err.substr(at + words.size())};
  for (int rank = 0; rank < 2; ++rank) {
    double share = -1;
    char percent = 0;
    ASSERT_TRUE(shares >> share >> percent) << run.err;
    EXPECT_EQ(percent, '%');
    EXPECT_GE(share, 0);
    EXPECT_LE(share, 100);
  }
}

}  // namespace
}  // namespace cleave::cli::test
