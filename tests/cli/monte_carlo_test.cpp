#include <cmath>
#include <nlohmann/json.hpp>

#include <sstream>

#include "signals.hpp"

namespace cleave::cli::test {
namespace {

using nlohmann::json;

class MonteCarloTest : public ProgramTest {
 protected:
  static std::string scene(const std::string& monte_carlo) {
    std::string text = crowded_scene();
    text.replace(text.find("friction = 20"), 13,
                 "friction = { distribution = \"uniform\", min = 15, max = 35 }\n"
                 "cohesion = { distribution = \"exponential\", mean = 2000 }");
    // Groups are none of an ensemble's business; replays would look for them.
    return text + "groups = \"off\"\nseismic = [0.1, 0, 0]\n[monte_carlo]\n" + monte_carlo +
           "\nseismic_factor = { distribution = "
           "\"uniform\", min = 0, max = 2 }\n[[excavation]]\nname = \"t\"\nkind = \"tunnel\"\nsection = { shape = "
           "\"rectangle\", width = 2, height = 2 }\naxis = [[4, 0, 3], [4, 8, 3]]\n";
  }
  [[nodiscard]] json section(const std::string& out) const {
    return json::parse(read(out + "/summary.json"))["monte_carlo"];
  }
  [[nodiscard]] std::string section_text(const std::string& out) const {
    const std::string text = read(out + "/summary.json");
    return text.substr(text.find("\"monte_carlo\": {"));
  }
};

// The same realizations under a [[load]]: figures of an ensemble that has this load in [stability].
TEST_F(MonteCarloTest, LoadCasesAreAnEnsembleOfTheirOwn) {
  const auto put = [](std::string& text, std::string_view old, const std::string& now) {
    const std::size_t at = text.find(old);
    ASSERT_NE(at, std::string::npos) << old;
    text.replace(at, old.size(), now);
  };
  // What a load adds to [stability], and both together.
  const std::string quake = "seismic = [0.4, 0, -0.3]\n", both = "seismic = [0.5, 0, -0.3]\n";
  for (const std::string kind : {"whole", "key", "groups", "support"}) {
    SCOPED_TRACE(kind);
    std::string text = scene("realizations = 12\nstrength_draws_per_network = 3");
    if (kind == "key") text += "[output]\nblocks = \"key\"\n";
    if (kind == "groups") {
      put(text, "groups = \"off\"", "groups = \"decide\"");
      put(text, "count = 12", "count = 5");
    }
    if (kind == "support" || kind == "groups") {
      text += "[support]\nshotcrete = { thickness = 0.05, strength = 2e4, on = \"all\" }\n";
    }
    write("s.toml", text + "[[load]]\nname = \"quake\"\n" + quake);
    const Ended shaken = cleave("run s.toml -o out");
    ASSERT_EQ(shaken.code, 0) << shaken.err;
    EXPECT_TRUE(shaken.out.contains("load case     quake"));
    EXPECT_TRUE(shaken.out.contains("what moves under each [[load]] stands in load_cases"));
    EXPECT_TRUE(read("out/report.html").contains("id=\"load-cases\""));
    const json base = section("out"), cases = base["load_cases"];
    ASSERT_EQ(cases.size(), 1U);
    EXPECT_EQ(cases[0]["name"], "quake");
    put(text, "seismic = [0.1, 0, 0]\n", both);
    write("s.toml", text);
    ASSERT_EQ(cleave("run s.toml -o alone").code, 0);
    const json alone = section("alone");
    EXPECT_FALSE(alone.contains("load_cases"));
    const json& found = cases[0]["quantities"];
    ASSERT_EQ(found.size(), kind == "groups" ? 42U : kind == "support" ? 34U : 19U);
    for (const auto& [name, figures] : found.items()) {
      for (const char* part : {"mean", "standard_error", "low", "high"}) {
        EXPECT_EQ(figures[part], alone["quantities"][name][part]) << name << " " << part;
      }
    }
    const auto blocks = [](const json& quantities) { return quantities["key_block_count"]["mean"].get<double>(); };
    EXPECT_GE(blocks(found), blocks(base["quantities"]));
    if (kind == "whole") {
      EXPECT_GT(blocks(found), blocks(base["quantities"]));
    }
    // What a record says of a case, a full run says again.
    const Ended again = cleave("replay out --realization 4");
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(again.out.contains("DOES NOT PASS"), again.out.contains("\nverdict: the support ")) << again.out;
  }
}

// Stages before the last are not in the figures of ensembles: that is said.
TEST_F(MonteCarloTest, StagesThatAreNotCountedAreSaid) {
  const std::string stages = "what moves only in a stage before the last is not in these figures";
  write("s.toml", scene("realizations = 3"));
  ASSERT_EQ(cleave("run s.toml -o out").code, 0);
  EXPECT_FALSE(read("out/log.txt").contains(stages));
  const std::string second =
      "[[excavation]]\nname = \"u\"\nkind = \"tunnel\"\nsection = { shape = \"rectangle\", width = 1, height = 1 }\n"
      "axis = [[6, 0, 3], [6, 8, 3]]\nstage = 2\n";
  write("s.toml", scene("realizations = 3") + second);
  ASSERT_EQ(cleave("run s.toml -o out").code, 0);
  EXPECT_TRUE(read("out/log.txt").contains(stages + "; a replay"));
  write("s.toml", scene("realizations = 3") + second + "[support]\n");
  ASSERT_EQ(cleave("run s.toml -o out").code, 0);
  EXPECT_TRUE(
      read("out/log.txt")
          .contains(stages + ", and what the support leaves after one is in support_fails_at_a_stage alone; a replay"));
}

// A slab of 1 m in the floor, dry and under a table 3 m above it. The scene has no excavation.
const std::string slab_in_the_floor = R"([domain]
box = { min = [0, 0, 0], max = [8, 8, 6] }
[[joint]]
plane = { through = [4, 4, 5], dip = 0, dip_direction = 0 }
[[joint]]
plane = { through = [2, 4, 5], dip = 90, dip_direction = 90 }
[[joint]]
plane = { through = [6, 4, 5], dip = 90, dip_direction = 90 }
[[joint]]
plane = { through = [4, 2, 5], dip = 90, dip_direction = 0 }
[[joint]]
plane = { through = [4, 6, 5], dip = 90, dip_direction = 0 }
[joints.default]
friction = 30
[rock]
density = 2700
[stability]
free = ["top"]
)";

// Ensembles say what water lifts, as single runs do: of the base case and of each load case.
TEST_F(MonteCarloTest, WaterThatLiftsKeyBlocksIsSaid) {
  const auto run = [&](const std::string& loads) {
    write("s.toml", slab_in_the_floor + loads + "[monte_carlo]\nrealizations = 2\n");
    EXPECT_EQ(cleave("run s.toml -o out --quiet").code, 0);
    return section("out");
  };
  const std::string said = "water lifts in the mean 1 key blocks a realization: it presses in the joints behind them";
  const json flood = run("[[load]]\nname = \"flood\"\nwater = { table = 9 }\n");
  EXPECT_EQ(flood["quantities"]["lifted_count"]["mean"], 0);
  EXPECT_EQ(flood["load_cases"][0]["quantities"]["lifted_count"]["mean"], 1);
  // Weight alone lifts nothing; of water it is not known when no realization shows it.
  EXPECT_EQ(flood["quantities"]["lifted_count"]["high"], 0);
  EXPECT_FALSE(flood["notes"].dump().contains("lifted_count"));
  EXPECT_TRUE(run("water = { table = 1 }\n")["quantities"]["lifted_count"]["high"].is_null());
  EXPECT_TRUE(flood["notes"].dump().contains("\"load case flood: " + said));
  EXPECT_FALSE(flood["notes"].dump().contains("\"" + said));
  EXPECT_TRUE(run("water = { table = 9 }\n")["notes"].dump().contains("\"" + said));
  // What an earthquake lifts is no matter of water.
  const json quake = run("seismic = [0, 0, 1.5]\n");
  EXPECT_EQ(quake["quantities"]["lifted_count"]["mean"], 1);
  EXPECT_FALSE(quake["notes"].dump().contains("water lifts"));
}

// A column of 1 x 4 m beside a crack, under 0.3 g: it cannot slide and topples.
TEST_F(MonteCarloTest, BlocksThatTurnAreSaid) {
  const auto run = [&](const std::string& stability) {
    write("s.toml",
          "[domain]\nbox = { min = [0, 0, 0], max = [20, 10, 14] }\n"
          "[[joint]]\nset = \"B\"\npolygon = [[18.95, 1.9, 10], [20.05, 1.9, 10], [20.05, 8.1, 10], [18.95, 8.1, 10]]\n"
          "[[joint]]\nset = \"C\"\npolygon = [[19, 1.9, 9.95], [19, 1.9, 14.05], [19, 8.1, 14.05], [19, 8.1, 9.95]]\n"
          "[[joint]]\nset = \"C\"\npolygon = [[18.95, 2, 9.9], [20.1, 2, 9.9], [20.1, 2, 15], [18.95, 2, 15]]\n"
          "[[joint]]\nset = \"C\"\npolygon = [[18.95, 8, 9.9], [20.1, 8, 9.9], [20.1, 8, 15], [18.95, 8, 15]]\n"
          "[joints.B]\nfriction = 40\n[joints.C]\nfriction = 0\n[rock]\ndensity = 2700\n"
          "[stability]\nfree = [\"top\", \"east\"]\n" +
              stability + "[monte_carlo]\nrealizations = 2\n");
    EXPECT_EQ(cleave("run s.toml -o out --quiet").code, 0);
    return section("out");
  };
  const std::string said = "in 100 % of the realizations blocks turn or topple though they cannot slide: they ";
  const json flagged = run("seismic = [0.3, 0, 0]\n");
  EXPECT_EQ(flagged["quantities"]["probability_of_failure"]["mean"], 0);
  EXPECT_EQ(flagged["quantities"]["probability_of_turning"]["mean"], 1);
  EXPECT_TRUE(flagged["notes"].dump().contains("\"" + said + "count as key blocks only with rotation"));
  const json decided = run("rotation = \"decide\"\nseismic = [0.3, 0, 0]\n");
  EXPECT_EQ(decided["quantities"]["probability_of_failure"]["mean"], 1);
  EXPECT_TRUE(decided["notes"].dump().contains("\"" + said + "are key blocks, but factors and forces"));
  const json quake = run("[[load]]\nname = \"quake\"\nseismic = [0.3, 0, 0]\n");
  EXPECT_EQ(quake["load_cases"][0]["quantities"]["probability_of_turning"]["mean"], 1);
  EXPECT_TRUE(quake["notes"].dump().contains("\"load case quake: " + said));
  EXPECT_FALSE(quake["notes"].dump().contains("\"" + said));
}

// A pressure over the area of excavations is none, with a reason, where there are none.
TEST_F(MonteCarloTest, WithoutExcavationsNoPressureIsOverTheirArea) {
  write("s.toml", slab_in_the_floor + "seismic = [0, 0, 1.5]\n[monte_carlo]\nrealizations = 2\n");
  ASSERT_EQ(cleave("run s.toml -o out --quiet").code, 0);
  const json bare = section("out");
  EXPECT_FALSE(bare["quantities"].contains("support_pressure_pa"));
  EXPECT_GT(bare["quantities"]["largest_support_pressure_pa"]["mean"].get<double>(), 1e4);
  EXPECT_TRUE(bare["notes"].dump().contains("no opening over whose area")) << bare["notes"];
  for (const json& row : bare["pressure_exceedance"]) {
    for (const char* name : {"probability", "low", "high"}) EXPECT_TRUE(row[name].is_null()) << row;
    EXPECT_EQ(row["reason"], "no opening over whose area it would be");
    EXPECT_TRUE(row["block_probability"].is_number());
  }
  EXPECT_FALSE(bare.contains("free_area_fixed_share"));
  write("t.toml",
        slab_in_the_floor +
            "[monte_carlo]\nstop = { quantity = \"support_pressure\", relative_half_width = 0.2, max = 9 }\n");
  const Ended stop = cleave("check t.toml");
  EXPECT_EQ(stop.code, 2);
  EXPECT_TRUE(stop.err.contains("is over the area of excavations, and there are none")) << stop.err;
  // With an excavation and no key block it is 0.
  write("u.toml", scene("realizations = 2"));
  ASSERT_EQ(cleave("run u.toml -o opened --quiet").code, 0);
  EXPECT_TRUE(section("opened")["quantities"]["support_pressure_pa"]["mean"].is_number());
  EXPECT_FALSE(section("opened")["notes"].dump().contains("no opening"));
}

// What the openings take is the same in all realizations: told once, with the share that misses the rock.
TEST_F(MonteCarloTest, OpeningsAreToldWithTheShareThatMissesTheRock) {
  const auto with = [&](const std::string& axis) {
    std::string text = scene("realizations = 12");
    text.replace(text.rfind("axis = "), std::string::npos, "axis = " + axis + "\n");
    text.replace(text.find("groups = \"off\""), 14, "groups = \"note\"");
    write("s.toml", text);
    return cleave("run s.toml -o out");
  };
  const Ended whole = with("[[4, 0, 3], [4, 8, 3]]");
  ASSERT_EQ(whole.code, 0) << whole.err;
  json summary = json::parse(read("out/summary.json"));
  EXPECT_NEAR(summary["openings"][0]["volume_m3"].get<double>(), 32, 1e-9);
  EXPECT_EQ(summary["openings"][0]["outside_share"], 0);
  EXPECT_FALSE(whole.out.contains("lies outside the domain"));
  EXPECT_TRUE(whole.out.contains("excavated    t, 32 m3")) << whole.out;
  const Ended half = with("[[4, -4, 3], [4, 4, 3]]");
  ASSERT_EQ(half.code, 0) << half.err;
  summary = json::parse(read("out/summary.json"));
  EXPECT_NEAR(summary["openings"][0]["volume_m3"].get<double>(), 16, 1e-9);
  EXPECT_NEAR(summary["openings"][0]["outside_share"].get<double>(), 0.5, 1e-9);
  const std::string note = "t: 50 % of it lies outside the domain; it removes 16 m3 of rock";
  EXPECT_TRUE(half.out.contains(note)) << half.out;
  EXPECT_TRUE(read("out/log.txt").contains(note));
  EXPECT_TRUE(read("out/report.html").contains(note));
  EXPECT_TRUE(summary["monte_carlo"]["notes"].dump().contains(note));
  // Nor is what was not counted left unsaid.
  EXPECT_TRUE(summary["monte_carlo"]["notes"].dump().contains("what only moves together (key groups) is not counted"));
  const Ended none = with("[[4, -9, 3], [4, -1, 3]]");
  EXPECT_EQ(none.code, 2);
  EXPECT_TRUE(none.err.contains("removes no rock")) << none.err;
}

TEST_F(MonteCarloTest, WritesRecordsEstimatesAndAReport) {
  write("s.toml", scene("realizations = 40\nvolumes = [0.1, 5]"));
  const Ended run = cleave("run s.toml -o out --threads 2");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(names(), (std::vector<std::string>{"out", "s.toml"}));
  const json mc = section("out");
  EXPECT_EQ(mc["realizations"], 40);
  EXPECT_EQ(mc["seed"], 1);
  EXPECT_EQ(mc["stopped_by"], "realizations");
  for (const char* name : {"key_block_volume_m3", "key_block_count", "block_count"}) {
    const json& q = mc["quantities"][name];
    EXPECT_LT(q["low"], q["mean"]) << name;
    EXPECT_LT(q["mean"], q["high"]) << name;
    EXPECT_GT(q["std"], 0) << name;
    EXPECT_EQ(q["confidence"], 0.95);
  }
  EXPECT_EQ(mc["exceedance"].size(), 2U);
  EXPECT_EQ(mc["exceedance"][0]["by_chainage"].size(), 20U);
  EXPECT_GT(mc["quantities"]["key_block_volume_m3_per_metre"]["mean"], 0);
  EXPECT_EQ(std::ranges::count(read("out/realizations.csv"), '\n'), 42);
  // What the stages of the realizations cost is reported.
  std::vector<std::string> stages;
  double seconds = 0;
  const json summary = json::parse(read("out/summary.json"));
  for (const json& row : summary["realization_cost"]) {
    stages.push_back(row["stage"]);
    seconds += row["thread_s"].get<double>();
  }
  EXPECT_EQ(stages, (std::vector<std::string>{"draw", "cut", "audit", "stability"}));
  EXPECT_GT(seconds, 0);
  const std::string page = read("out/report.html");
  for (const char* part : {"<section id=\"estimates\">", "<section id=\"figures\">", "<section id=\"probability\">",
                           "<section id=\"quantiles\">", "<section id=\"pressures\">", "<section id=\"stages\">",
                           "<section id=\"extremes\">", "<section id=\"inputs\">", "chainage (m)", "replay",
                           "cleave 0.1.0</td>", "Assumptions and limits"}) {
    EXPECT_TRUE(page.contains(part)) << part;
  }
  // Quantities of summary.json have their rows.
  for (const char* name :
       {">key block volume, m³</td>", ">key block count</td>", ">block count</td>", ">support pressure, Pa</td>"}) {
    EXPECT_TRUE(page.contains(name)) << name;
  }
  EXPECT_EQ(page.find("http://"), std::string::npos);
}

TEST_F(MonteCarloTest, ThreadsShardsAndMergesGiveTheSameBytes) {
  write("s.toml", scene("realizations = 31"));
  ASSERT_EQ(cleave("run s.toml -o one --threads 1 --quiet").code, 0);
  ASSERT_EQ(cleave("run s.toml -o two --threads 2 --quiet").code, 0);
  EXPECT_EQ(section_text("one"), section_text("two"));
  EXPECT_EQ(read("one/realizations.csv"), read("two/realizations.csv"));
  for (const std::string k : {"1", "2", "3"}) {
    ASSERT_EQ(cleave("run s.toml -o part" + k + " --shard " + k + "/3 --quiet").code, 0);
  }
  const Ended gap = cleave("merge part1 part3 -o all");
  EXPECT_EQ(gap.code, 2);
  EXPECT_NE(gap.err.find("shard 2 of 3 is missing; run it and merge again"), std::string::npos) << gap.err;
  EXPECT_TRUE(cleave("merge part2 -o all").err.contains("shards 1, 3 of 3 are missing; run them and merge again"));
  EXPECT_FALSE(exists("all"));
  const Ended twice = cleave("merge part1 part2 part3 part2 -o all");
  EXPECT_EQ(twice.code, 2);
  // The whole took the place of the part.
  const Ended over = cleave("merge part1 part2 part3 -o ./part2");
  EXPECT_EQ(over.code, 2);
  EXPECT_NE(over.err.find("./part2:1: OUT: is part2, one of the parts"), std::string::npos) << over.err;
  ASSERT_EQ(cleave("merge part3 part1 part2 -o all --quiet").code, 0);
  EXPECT_EQ(section_text("all"), section_text("one"));
  EXPECT_EQ(read("all/realizations.csv"), read("one/realizations.csv"));
  ASSERT_EQ(cleave("run s.toml -o other --shard 2/3 --seed 9 --quiet").code, 0);
  EXPECT_EQ(cleave("merge part1 other part3 -o mixed").code, 2);
}

// The script for job arrays, as a cluster would call it: the last task merges.
TEST_F(MonteCarloTest, JobArrayGivesTheSameBytes) {
  write("s.toml", scene("realizations = 20"));
  ASSERT_EQ(cleave("run s.toml -o one --quiet").code, 0);
  const std::string script = std::string{CLEAVE_SOURCE_DIR} + "/examples/cluster/monte_carlo.sbatch";
  const Ended tasks = shell("mkdir bin && ln -s '" CLEAVE_PROGRAM
                            "' bin/cleave && export PATH=\"$PWD/bin:$PATH\" SLURM_ARRAY_TASK_COUNT=3 "
                            "SLURM_CPUS_PER_TASK=1; for k in 2 3 1; do SLURM_ARRAY_TASK_ID=$k bash '" +
                            script + "' s.toml all || exit 1; [ $k = 1 ] || [ ! -e all ] || exit 2; done");
  ASSERT_EQ(tasks.code, 0) << tasks.err;
  EXPECT_EQ(section_text("all"), section_text("one"));
  EXPECT_EQ(read("all/realizations.csv"), read("one/realizations.csv"));
}

/// Bytes of a file that may not be there yet: 0 then.
std::uintmax_t bytes_of(const fs::path& file) {
  std::error_code none;
  const std::uintmax_t size = fs::file_size(file, none);
  return none ? 0 : size;
}

// Killed at several moments, the same command goes on and ends with the bytes of an uninterrupted run.
TEST_F(MonteCarloTest, KilledRunsResumeToTheSameBytes) {
  write("s.toml", scene("realizations = 400"));
  ASSERT_EQ(cleave("run s.toml -o whole --threads 2 --quiet").code, 0);
  const std::uintmax_t all = fs::file_size(path("whole/realizations.csv"));
  for (const std::uintmax_t sixteenths : {1U, 2U, 4U, 8U}) {
    const Ended ended =
        signalled(folder(), {"run", "s.toml", "-o", "broken", "--threads", "2", "--quiet"}, SIGKILL,
                  [&] { return bytes_of(folder() / "broken/realizations.csv.part") * 16 > all * sixteenths; });
    EXPECT_EQ(ended.code, 128 + SIGKILL) << ended.err;
    ASSERT_FALSE(exists("broken/summary.json"));
  }
  // Another seed or a single run may not take the place of what is kept.
  EXPECT_EQ(cleave("run s.toml -o broken --seed 5 --quiet").code, 2);
  write("t.toml", small_scene);
  EXPECT_EQ(cleave("run t.toml -o broken --quiet").code, 2);
  ASSERT_EQ(cleave("run s.toml -o broken --threads 1 --quiet").code, 0);
  EXPECT_EQ(section_text("broken"), section_text("whole"));
  EXPECT_EQ(read("broken/realizations.csv"), read("whole/realizations.csv"));
  EXPECT_FALSE(exists("broken/realizations.csv.part"));
}

// A scene without a title goes by the name of its file, also when only its copy is left.
TEST_F(MonteCarloTest, MergesAndReplaysKnowTheScenesName) {
  std::string text = scene("realizations = 6");
  text.erase(text.find("title"), text.find("[domain]") - text.find("title"));
  write("untitled.toml", text);
  for (const std::string k : {"1", "2"}) {
    ASSERT_EQ(cleave("run untitled.toml -o part" + k + " --shard " + k + "/2 --quiet").code, 0);
  }
  fs::remove(path("untitled.toml"));
  ASSERT_EQ(cleave("merge part1 part2 -o all --quiet").code, 0);
  for (const std::string out : {"part1", "all"}) {
    const json summary = json::parse(read(out + "/summary.json"));
    EXPECT_EQ(summary["title"], "untitled.toml") << out;
    EXPECT_EQ(summary["scene_file"], "untitled.toml") << out;
    EXPECT_TRUE(read(out + "/report.html").contains("untitled.toml")) << out;
  }
  EXPECT_EQ(cleave("replay all --realization 2 --quiet").code, 0);
  const Ended before = cleave("replay all --realization -1 --quiet");
  EXPECT_EQ(before.code, 2);
  EXPECT_NE(before.err.find("--realization: \"-1\" is not a whole number from 0"), std::string::npos) << before.err;
  EXPECT_EQ(json::parse(read("all/realization_2/summary.json"))["title"], "untitled.toml (realization 2)");
}

TEST_F(MonteCarloTest, ShardsAndSeedsThatCannotBeAreRefused) {
  write("s.toml", scene("realizations = 5"));
  EXPECT_EQ(cleave("run s.toml -o out --quiet --shard 2/6").code, 2);
  EXPECT_EQ(cleave("run s.toml -o out --quiet --shard 2/5").code, 0);
  for (const std::string seed : {"9223372036854775808", "99999999999999999999", "-1", "1.5", "1e3", "x"}) {
    const Ended ended = cleave("run s.toml -o seeded --quiet --seed " + seed);
    EXPECT_EQ(ended.code, 2) << seed;
    EXPECT_TRUE(ended.err.contains("--seed")) << ended.err;
  }
  EXPECT_EQ(cleave("run s.toml -o seeded --quiet --seed 9223372036854775807").code, 0);
}

TEST_F(MonteCarloTest, InterruptKeepsWhatIsDone) {
  write("s.toml", scene("realizations = 100000"));
  const Ended ended = signalled(folder(), {"run", "s.toml", "-o", "out", "--quiet"}, SIGINT,
                                [&] { return bytes_of(folder() / "out/realizations.csv.part") > 0; });
  EXPECT_EQ(ended.code, 130);
  EXPECT_NE(ended.err.find("goes on from there"), std::string::npos) << ended.err;
  EXPECT_TRUE(exists("out/realizations.csv.part"));
  EXPECT_FALSE(exists("out/summary.json"));
}

// The slab alone and the toe alone stay; both together leave in every realization, and in the replay of one.
TEST_F(MonteCarloTest, GroupsThatDecideCountInEveryRealizationAndItsReplay) {
  const std::string example = text_of(fs::path{CLEAVE_SOURCE_DIR} / "examples/slab_behind_toe/slab_behind_toe.toml");
  write("s.toml", example + "\ngroups = \"decide\"\n[monte_carlo]\nrealizations = 2\n");
  write("note.toml", example + "\n[monte_carlo]\nrealizations = 2\n");
  ASSERT_EQ(cleave("run s.toml -o out --quiet").code, 0);
  ASSERT_EQ(cleave("run note.toml -o alone --quiet").code, 0);
  const auto mean = [&](const std::string& folder, const std::string& name) {
    const json summary = json::parse(read(folder + "/summary.json"));
    return summary["monte_carlo"]["quantities"][name]["mean"].get<double>();
  };
  EXPECT_EQ(mean("alone", "probability_of_failure"), 0);
  EXPECT_EQ(mean("out", "probability_of_failure"), 1);
  EXPECT_EQ(mean("out", "key_group_count"), 1);
  EXPECT_NEAR(mean("out", "key_group_volume_m3"), mean("out", "key_block_volume_m3"), 1e-9);
  EXPECT_GT(mean("out", "key_group_volume_m3"), 300);
  EXPECT_EQ(mean("out", "groups_leave_doubt"), 0);
  EXPECT_FALSE(read("out/summary.json").contains("what only moves together"));
  EXPECT_TRUE(read("out/summary.json").contains("what it takes to hold a group is not in them"));
  EXPECT_TRUE(read("alone/summary.json").contains("what only moves together"));
  // Sprayed concrete too weak for both together: no block needs it alone.
  write("held.toml",
        example + "\ngroups = \"decide\"\n[support]\nshotcrete = { thickness = 0.05, strength = 1e4, on = \"all\" }\n" +
            "[monte_carlo]\nrealizations = 2\n");
  ASSERT_EQ(cleave("run held.toml -o held --quiet").code, 0);
  EXPECT_EQ(mean("held", "support_groups_not_held"), 1);
  EXPECT_NEAR(mean("held", "support_groups_not_held_m3"), mean("out", "key_group_volume_m3"), 1e-9);
  EXPECT_EQ(mean("held", "support_fails"), 1);
  EXPECT_EQ(mean("held", "support_leaves_doubt"), 0);
  const Ended replay = cleave("replay out --realization 1");
  EXPECT_EQ(replay.code, 0) << replay.err;
  EXPECT_NE(replay.out.find("is reproduced to the last digit"), std::string::npos) << replay.out;
}

// A force on no free face is refused realization by realization, as a single run refuses it.
TEST_F(MonteCarloTest, ForcesOffTheFreeFacesAreRefused) {
  write("s.toml",
        text_of(fs::path{CLEAVE_SOURCE_DIR} / "examples/slab_behind_toe/slab_behind_toe.toml") +
            "\n[[stability.point]]\nat = [10, 5, 10]\nforce = [0, 0, -1e6]\n[monte_carlo]\nrealizations = 2\n");
  const Ended run = cleave("run s.toml -o out --quiet");
  EXPECT_EQ(run.code, 4) << run.err;
  EXPECT_NE(run.err.find("2 realizations could not be done"), std::string::npos) << run.err;
}

TEST_F(MonteCarloTest, ReplayReproducesAnyRealization) {
  write("s.toml", scene("realizations = 20"));
  ASSERT_EQ(cleave("run s.toml -o out --seed 3 --quiet").code, 0);
  fs::remove(path("s.toml"));  // the result alone is enough
  for (const std::string k : {"0", "7", "19"}) {
    const Ended replay = cleave("replay out --realization " + k);
    ASSERT_EQ(replay.code, 0) << replay.err;
    EXPECT_NE(replay.out.find("is reproduced to the last digit"), std::string::npos) << replay.out;
    const json single = json::parse(read("out/realization_" + k + "/summary.json"));
    const std::string records = read("out/realizations.csv");
    const auto fields_at = [&](std::string_view start) {
      std::istringstream line{records.substr(records.find(start) + 1)};
      std::vector<std::string> fields;
      for (std::string field; std::getline(line, field, ',') && !field.contains('\n');) fields.push_back(field);
      return fields;
    };
    const auto columns = fields_at("\nrealization,"), fields = fields_at("\n" + k + ",0,");
    const auto value = [&](std::string_view column) {
      return fields.at(static_cast<std::size_t>(std::ranges::find(columns, column) - columns.begin()));
    };
    EXPECT_EQ(std::to_string(single["blocks"]["count"].get<int>()), value("blocks"));
    EXPECT_EQ(std::to_string(single["key_blocks"]["count"].get<int>()), value("count"));
    EXPECT_EQ(single["seed"], 3);
  }
  EXPECT_EQ(cleave("replay out --realization 20").code, 2);
  EXPECT_EQ(cleave("replay nowhere --realization 1").code, 2);
  // A file of the user's in one of them is not taken away.
  write("s.toml", scene("realizations = 5"));
  write("out/realization_7/thesis.doc", "precious");
  EXPECT_EQ(cleave("run s.toml -o out --quiet").code, 2);
  EXPECT_EQ(read("out/realization_7/thesis.doc"), "precious");
  fs::remove(path("out/realization_7/thesis.doc"));
  // The result with its replays is replaced as a whole, in one step: the folder is another one.
  ASSERT_EQ(shell("stat -c %i out > before; cleave run s.toml -o out --quiet").code, 0);
  EXPECT_EQ(shell("test $(stat -c %i out) != $(cat before)").code, 0);
  fs::remove(path("before"));
  EXPECT_FALSE(exists("out/realization_7"));
  write("t.toml", small_scene);
  ASSERT_EQ(cleave("run t.toml -o out --quiet").code, 0);
  EXPECT_FALSE(exists("out/realizations.csv"));
}

TEST_F(MonteCarloTest, RealizationZeroIsTheSingleRun) {
  write("one.toml", small_scene);
  write("many.toml", std::string{small_scene} + "[monte_carlo]\nrealizations = 2\n");
  ASSERT_EQ(cleave("run one.toml -o one --quiet").code, 0);
  ASSERT_EQ(cleave("run many.toml -o many --quiet").code, 0);
  ASSERT_EQ(cleave("replay many --realization 0 -o again --quiet").code, 0);
  EXPECT_EQ(json::parse(read("one/summary.json"))["blocks"]["hash"],
            json::parse(read("again/summary.json"))["blocks"]["hash"]);
}

TEST_F(MonteCarloTest, StopsAtTheStatedPrecisionOrSaysThatItDidNot) {
  write("s.toml", scene("stop = { quantity = \"block_count\", relative_half_width = 0.2, max = 300 }"));
  ASSERT_EQ(cleave("run s.toml -o out --quiet").code, 0);
  const json mc = section("out");
  EXPECT_EQ(mc["stopped_by"], "precision");
  EXPECT_EQ(mc["realizations"], 100);
  const json& stop = mc["stop"];
  EXPECT_EQ(stop["rule"], "fixed_looks");
  EXPECT_EQ(mc["interval_kind"], "sequential, fixed looks");
  const double mean = mc["quantities"]["block_count"]["mean"],
               error = mc["quantities"]["block_count"]["standard_error"];
  EXPECT_NEAR(stop["half_width_at_stop"], 1.959964 * error, 1e-5 * error);
  EXPECT_NEAR(stop["relative_half_width_at_stop"], 1.959964 * error / mean, 1e-5);
  EXPECT_LE(stop["relative_half_width_at_stop"], stop["relative_half_width"]);
  EXPECT_TRUE(read("out/log.txt").contains(" % of the mean by fixed_looks, 20 % asked for")) << read("out/log.txt");
  write("v.toml", scene("stop = { quantity = \"block_count\", relative_half_width = 0.2, max = 300, rule = "
                        "\"always_valid\" }"));
  ASSERT_EQ(cleave("run v.toml -o valid --quiet").code, 0);
  const json valid = section("valid");
  EXPECT_EQ(valid["stop"]["rule"], "always_valid");
  EXPECT_EQ(valid["interval_kind"], "of a fixed number, stopped by a confidence sequence");
  EXPECT_GT(valid["stop"]["half_width_at_stop"].get<double>(),
            1.5 * 1.959964 * valid["quantities"]["block_count"]["standard_error"].get<double>());
  write("t.toml", scene("stop = { quantity = \"block_count\", relative_half_width = 1e-6, max = 120 }"));
  const Ended far = cleave("run t.toml -o far --quiet");
  EXPECT_EQ(far.code, 4);
  EXPECT_NE(far.err.find("precision is not reached after 120"), std::string::npos) << far.err;
  EXPECT_EQ(section("far")["status"], "not converged");
  const Ended shard = cleave("run s.toml -o shard --shard 1/3");
  EXPECT_EQ(shard.code, 2);
  EXPECT_FALSE(exists("shard"));
  write("u.toml", small_scene);
  EXPECT_EQ(cleave("run u.toml -o u --shard 1/3").code, 2);
  for (const std::string bad : {"0/3", "4/3", "1", "1/", "a/b", "1/3x"}) {
    EXPECT_EQ(cleave("run s.toml -o shard --shard " + bad).code, 2) << bad;
  }
}

// A scene without random parts gives the same realization again and again.
TEST_F(MonteCarloTest, NothingRandomNoSpread) {
  write("s.toml",
        "[domain]\nbox = { min = [0, 0, 0], max = [8, 8, 6] }\n[[joint]]\nplane = { through = [4, 4, 3], dip = 40, "
        "dip_direction = 90 }\n[joints.default]\nfriction = 20\n[stability]\nfree = [\"top\", "
        "\"east\"]\n[monte_carlo]\nrealizations = 5\n");
  ASSERT_EQ(cleave("run s.toml -o out --quiet").code, 0);
  const json q = section("out")["quantities"];
  EXPECT_EQ(q["block_count"]["mean"], 2);
  EXPECT_EQ(q["block_count"]["std"], 0);
  EXPECT_EQ(q["block_count"]["low"], q["block_count"]["high"]);
  // Seen in none of five: 1 - (0.025)^(1/5) of them may have some, of 384 m3 at the most; of how many nothing is known.
  EXPECT_EQ(q["key_block_volume_m3"]["mean"], 0);
  EXPECT_NEAR(q["key_block_volume_m3"]["high"], 384 * (1 - std::pow(0.025, 0.2)), 1e-6);
  EXPECT_TRUE(q["key_block_count"]["high"].is_null());
}

// The files a scene names are kept with the result, so that it can be replayed elsewhere.
TEST_F(MonteCarloTest, NamedFilesAreKept) {
  write("j.csv", "dip,dip_direction,x,y,z\n40,90,4,4,3\n60,250,4,4,3\n");
  write(
      "s.toml",
      "[domain]\nbox = { min = [0, 0, 0], max = [8, 8, 6] }\n[[joint]]\nfile = \"j.csv\"\n[joints.default]\nfriction = "
      "{ distribution = \"uniform\", min = 5, max = 60 }\n[stability]\nfree = [\"top\", "
      "\"east\"]\n[monte_carlo]\nrealizations = 9\n");
  ASSERT_EQ(cleave("run s.toml -o out --quiet").code, 0);
  EXPECT_EQ(section("out")["status"], "done");
  fs::remove(path("s.toml"));
  fs::remove(path("j.csv"));
  EXPECT_EQ(cleave("replay out --realization 4 --quiet").code, 0);
}

}  // namespace
}  // namespace cleave::cli::test
