#include <nlohmann/json.hpp>
#include <regex>

#include "program.hpp"

namespace cleave::cli::test {
namespace {

using CommandsTest = ProgramTest;

TEST_F(CommandsTest, VersionAndHelp) {
  const Ended version = cleave("--version");
  EXPECT_EQ(version.code, 0);
  EXPECT_EQ(version.out, "cleave 0.1.0\n");
  const Ended help = cleave("--help");
  EXPECT_EQ(help.code, 0);
  for (const std::string_view command :
       {"run", "plan", "check", "merge", "replay", "survey", "init", "diff", "convert"}) {
    EXPECT_NE(help.out.find(command), std::string::npos) << command;
    EXPECT_EQ(cleave(std::string{command} + " --help").code, 0) << command;
  }
}

TEST_F(CommandsTest, WrongCallsAreWrongInput) {
  write("s.toml", small_scene);
  for (const std::string call :
       {"", "rum s.toml", "run", "run s.toml", "run s.toml -o", "run s.toml -o out --threads 0",
        "run s.toml -o out --threads x", "run s.toml -o out --seed -1", "run s.toml -o out --seed 1.5",
        "run s.toml -o out --what", "check", "init", "init castle", "run s.toml -o out --shard 1/3", "merge a b -o c",
        "replay out --realization 3", "survey d.toml -o out", "diff a b"}) {
    const Ended ended = cleave(call);
    EXPECT_EQ(ended.code, 2) << call;
    EXPECT_TRUE(ended.err.starts_with("error: ")) << call << ": " << ended.err;
    EXPECT_EQ(ended.out, "") << call;
  }
  EXPECT_EQ(names(), (std::vector<std::string>{"s.toml"}));
  const Ended help = cleave("help");
  EXPECT_EQ(help.code, 0);
  EXPECT_EQ(help.out, cleave("--help").out);
}

// tests/plan_is_run.py runs them.
TEST_F(CommandsTest, ScenesOfInitPassCheck) {
  for (const std::string kind : {"tunnel", "slope", "wedge", "network", "monte-carlo", "bodies", "contact", "support",
                                 "bench", "water", "motion"}) {
    ASSERT_EQ(shell("cleave init " + kind + " > " + kind + ".toml").code, 0);
    const Ended check = cleave("check " + kind + ".toml");
    EXPECT_EQ(check.code, 0) << check.err;
    EXPECT_EQ(check.out, kind + ".toml: no error found\n");
  }
}

TEST_F(CommandsTest, SceneOfATunnelHasKeyBlocksAndTheTableIsReadByBoth) {
  ASSERT_EQ(
      shell("cleave init tunnel > tunnel.toml && cleave init csv > joints.csv && cleave init survey > survey.toml")
          .code,
      0);
  EXPECT_EQ(cleave("run tunnel.toml --quiet -o out").code, 0);
  EXPECT_GT(nlohmann::json::parse(read("out/summary.json"))["key_blocks"]["count"].get<int>(), 0);
  EXPECT_EQ(cleave("survey survey.toml --quiet -o sets").code, 0);
  write("table.toml", "[domain]\nbox = { min = [0, 0, 0], max = [30, 30, 20] }\n[[joint]]\nfile = \"joints.csv\"\n");
  EXPECT_EQ(cleave("run table.toml --quiet -o of_table").code, 0);
  EXPECT_EQ(nlohmann::json::parse(read("of_table/summary.json"))["input"]["joints"].get<int>(), 15);
}

// Each kind of survey with its table: sets that a scene can take.
TEST_F(CommandsTest, SurveysOfEachKindGiveSets) {
  for (const std::string kind : {"scanline", "borehole", "window"}) {
    SCOPED_TRACE(kind);
    ASSERT_EQ(
        shell("cleave init " + kind + " > " + kind + ".toml && cleave init " + kind + "-csv > " + kind + ".csv").code,
        0);
    const Ended survey = cleave("survey " + kind + ".toml -o " + kind);
    ASSERT_EQ(survey.code, 0) << survey.err;
    write("scene.toml",
          "include = [\"" + kind + "/sets.toml\"]\n[domain]\nbox = { min = [0, 0, 0], max = [10, 10, 10] }\n");
    EXPECT_EQ(cleave("run scene.toml --quiet -o out").code, 0);
    EXPECT_GT(nlohmann::json::parse(read("out/summary.json"))["input"]["joints"].get<int>(), 10);
  }
}

TEST_F(CommandsTest, AWrongOptionIsNamedBeforeAMissingOne) {
  EXPECT_NE(cleave("run --what").err.find("--what"), std::string::npos);
  EXPECT_NE(cleave("run s.toml --out-folder out").err.find("--out-folder"), std::string::npos);
}

// What check and run refuse had a plan.
TEST_F(CommandsTest, PlanRefusesWhatNoRunCouldDo) {
  write("none.toml",
        "[domain]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n[[excavation]]\nkind = \"polyhedron\"\n"
        "box = { min = [-1, -1, -1], max = [2, 2, 2] }\n");
  const Ended plan = cleave("plan none.toml"), check = cleave("check none.toml");
  EXPECT_EQ(plan.code, 2) << plan.out;
  EXPECT_NE(plan.err.find("leave no rock"), std::string::npos) << plan.err;
  EXPECT_EQ(plan.err, check.err);
}

TEST_F(CommandsTest, PlanNamesEveryStageAndWritesNothing) {
  write("s.toml", small_scene);
  const Ended plan = cleave("plan s.toml");
  EXPECT_EQ(plan.code, 0);
  for (const std::string_view stage : {"read", "draw", "cut", "audit", "stability", "write", "report"}) {
    EXPECT_TRUE(std::regex_search(plan.out, std::regex{"\n  " + std::string{stage} + " +run "})) << stage << plan.out;
  }
  for (const std::string_view stage : {"support", "monte_carlo", "elastic", "contact"}) {
    EXPECT_TRUE(std::regex_search(plan.out, std::regex{"\n  " + std::string{stage} + " +left out +no "}))
        << stage << plan.out;
  }
  EXPECT_NE(plan.out.find("estimated size: 8 joints"), std::string::npos) << plan.out;
  EXPECT_EQ(names(), (std::vector<std::string>{"s.toml"}));
}

TEST_F(CommandsTest, RunWritesAWholeResult) {
  write("s.toml", small_scene);
  const Ended run = cleave("run s.toml -o out --threads 2");
  ASSERT_EQ(run.code, 0) << run.err;
  for (const std::string_view file : {"summary.json", "blocks.vtu", "key_blocks.csv", "report.html", "log.txt"}) {
    EXPECT_FALSE(text_of(path("out") / file).empty()) << file;
  }
  EXPECT_EQ(names(), (std::vector<std::string>{"out", "s.toml"}));
  const auto summary = nlohmann::json::parse(read("out/summary.json"));
  EXPECT_EQ(summary["cleave"], "0.1.0");
  EXPECT_EQ(summary["title"], "small");
  EXPECT_EQ(summary["input"]["joints"], 8);
  EXPECT_EQ(summary["cost"]["threads"], 2);
  EXPECT_TRUE(summary["blocks"]["certificate"]["passed"]);
  EXPECT_TRUE(summary.contains("key_blocks"));
  std::vector<std::string> planned, booked;
  for (const auto& stage : summary["plan"]) planned.push_back(stage["stage"]);
  for (const auto& stage : summary["cost"]["stages"]) booked.push_back(stage["stage"]);
  EXPECT_EQ(planned, (std::vector<std::string>{"read", "draw", "cut", "audit", "stability", "support", "monte_carlo",
                                               "elastic", "contact", "write", "report"}));
  EXPECT_EQ(booked, (std::vector<std::string>{"read", "draw", "cut", "audit", "stability", "write", "report"}));
}

TEST_F(CommandsTest, CheckRefusesWhatRunRefusesForItsMemory) {
  const std::string scene =
      "[domain]\nbox = { min = [0, 0, 0], max = [40, 40, 40] }\n[[joint_set]]\nname = \"A\"\n"
      "orientation = { dip = 45, dip_direction = 90, distribution = \"fisher\", kappa = 0.5 }\n"
      "size = \"persistent\"\nintensity = { count = 6000 }\n[joints.default]\nfriction = 30\n"
      "[rock]\ndensity = 2700\n[stability]\nfree = [\"top\", \"east\"]\n";
  write("s.toml", scene);
  const Ended run = cleave("run s.toml -o out --quiet"), check = cleave("check s.toml");
  EXPECT_EQ(run.code, 2);
  EXPECT_TRUE(run.err.contains("s.toml:1: domain: about ")) << run.err;
  EXPECT_EQ(check.code, 2) << check.out;
  EXPECT_EQ(check.err, run.err);
  // Near free faces alone the run has no such estimate.
  write("s.toml", scene + "[output]\nblocks = \"key\"\n");
  EXPECT_EQ(cleave("check s.toml").code, 0);
}

TEST_F(CommandsTest, QuietSaysNothing) {
  write("s.toml", small_scene);
  const Ended run = cleave("run s.toml -o out --quiet");
  EXPECT_EQ(run.code, 0);
  EXPECT_EQ(run.out + run.err, "");
}

TEST_F(CommandsTest, HashFollowsTheSeedAndNothingElse) {
  write("s.toml", small_scene);
  const auto hash = [&](const std::string& options) {
    EXPECT_EQ(cleave("run s.toml --quiet -o out " + options).code, 0);
    return nlohmann::json::parse(read("out/summary.json"))["blocks"]["hash"].get<std::string>();
  };
  const std::string first = hash("--threads 1");
  EXPECT_EQ(hash("--threads 2"), first);
  EXPECT_EQ(hash("--threads 3 --seed 1"), first);
  EXPECT_NE(hash("--seed 2"), first);
}

TEST_F(CommandsTest, OutputSettingsLeaveFilesOut) {
  write("s.toml", std::string{small_scene} + "[output]\nvtu = false\ncsv = false\nreport = false\n");
  ASSERT_EQ(cleave("run s.toml --quiet -o out").code, 0);
  EXPECT_TRUE(exists("out/summary.json") && exists("out/log.txt"));
  EXPECT_FALSE(exists("out/blocks.vtu") || exists("out/key_blocks.csv") || exists("out/report.html"));
}

// Only key blocks asked for: less is cut, and what is asked for is the same.
TEST_F(CommandsTest, KeyBlocksAloneAreThoseOfTheWholeScene) {
  const std::string scene =
      "schema = 1\nseed = 5\n[domain]\nbox = { min = [0, 0, 0], max = [120, 120, 120] }\n"
      "[[joint_set]]\nname = \"A\"\norientation = { dip = 30, dip_direction = 30, distribution = \"fisher\", kappa = "
      "80 }\n"
      "shape = \"rectangle\"\nsize = { distribution = \"constant\", mean = 75 }\nintensity = { count = 40 }\n"
      "[[joint_set]]\nname = \"B\"\norientation = { dip = 80, dip_direction = 120, distribution = \"fisher\", kappa = "
      "80 }\n"
      "shape = \"rectangle\"\nsize = { distribution = \"constant\", mean = 75 }\nintensity = { count = 40 }\n"
      "[[joint_set]]\nname = \"C\"\norientation = { dip = 75, dip_direction = 250, distribution = \"fisher\", kappa = "
      "80 }\n"
      "shape = \"rectangle\"\nsize = { distribution = \"constant\", mean = 75 }\nintensity = { count = 40 }\n"
      "[joints.default]\nfriction = 20\n"
      "[[excavation]]\nname = \"tunnel\"\nkind = \"tunnel\"\nsection = { shape = \"circle\", diameter = 8 }\n"
      "axis = [[60, 0, 60], [60, 120, 60]]\n";
  write("all.toml", scene);
  write("key.toml", scene + "[output]\nblocks = \"key\"\n");
  ASSERT_EQ(cleave("run --quiet all.toml -o all").code, 0);
  ASSERT_EQ(cleave("run --quiet key.toml -o key").code, 0);
  const std::string all = read("all/summary.json"), key = read("key/summary.json");
  const auto whole = nlohmann::json::parse(all), near = nlohmann::json::parse(key);
  for (const char* section : {"key_blocks", "micro_blocks"}) EXPECT_EQ(whole[section], near[section]);
  // Groups that reach the edge of the box may stay undecided in one of the two, which is said; those that move are
  // equal.
  for (const char* figure : {"judged", "count", "volume_m3", "certain", "unsafe"}) {
    EXPECT_EQ(whole["key_groups"][figure], near["key_groups"][figure]) << figure;
  }
  if (whole["key_groups"] != near["key_groups"]) {
    EXPECT_NE(read("key/log.txt").find("key groups reach the edge of the box that was cut"), std::string::npos);
  }
  EXPECT_NE(all.find("\"hash\""), std::string::npos);
  EXPECT_EQ(all.find("\"window\""), std::string::npos);
  // A group that moves reaches far here: the box grows with it. Blocks by themselves need less.
  write("single.toml", scene + "[stability]\ngroups = \"off\"\n[output]\nblocks = \"key\"\n");
  ASSERT_EQ(cleave("run --quiet single.toml -o single").code, 0);
  const std::string single = read("single/summary.json");
  EXPECT_EQ(nlohmann::json::parse(single)["key_blocks"], whole["key_blocks"]);
  EXPECT_NE(single.find("\"window\""), std::string::npos);
  EXPECT_NE(cleave("plan key.toml").out.find("only near free faces"), std::string::npos);
}

TEST_F(CommandsTest, StabilityIsAbsentWhenNothingIsFree) {
  write("s.toml", "[domain]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n");
  ASSERT_EQ(cleave("run s.toml --quiet -o out").code, 0);
  EXPECT_FALSE(exists("out/key_blocks.csv"));
  const auto summary = nlohmann::json::parse(read("out/summary.json"));
  EXPECT_FALSE(summary.contains("key_blocks"));
  EXPECT_EQ(summary["blocks"]["count"], 1);
}

TEST_F(CommandsTest, ConvertGoesRound) {
  write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  for (const std::string call : {"a.obj b.ply", "b.ply c.stl", "c.stl d.obj"})
    EXPECT_EQ(cleave("convert " + call).code, 0) << call;
  // STL keeps no shared vertices; the four faces survive all the same.
  write("s.toml", "[domain]\nmesh = \"d.obj\"\n");
  EXPECT_EQ(cleave("run s.toml --quiet -o out").code, 0);
  EXPECT_NEAR(nlohmann::json::parse(read("out/summary.json"))["blocks"]["volume_m3"].get<double>(), 1.0 / 6, 1e-12);
}

TEST_F(CommandsTest, ConvertMakesBlocksOfClosedFaces) {
  const std::string box =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n"
      "g stone\nf 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\n";
  write("open.obj", box);
  write("box.obj", box + "f 2 4 8 6\n");
  write("d.csv", "dip,dip_direction,x,y,z,radius,set\n60,90,0,0,0,5,A\n");
  for (const std::string out : {"b.vtu", "b.k", "b.3ddat", "b.3dec", "b.nmm3d", "b.dda"}) {
    EXPECT_EQ(cleave("convert box.obj " + out).code, 0) << out;
    const Ended ended = cleave("convert open.obj no." + out);
    EXPECT_EQ(ended.code, 2) << out;
    EXPECT_TRUE(ended.err.starts_with("error: open.obj:10: group \"stone\": is no block: ")) << ended.err;
  }
  EXPECT_EQ(cleave("convert b.vtu again.obj").code, 0);
  EXPECT_NE(read("again.obj").find("g block_0\n"), std::string::npos);
  EXPECT_EQ(cleave("convert d.csv d.obj").code, 0);
  EXPECT_NE(read("d.obj").find("g A\n"), std::string::npos);
  write("p.csv", "dip,dip_direction,x,y,z\n60,90,0,0,0\n");
  EXPECT_EQ(cleave("convert p.csv p.obj").code, 2);
}

TEST_F(CommandsTest, ResultsWithExportsAreReplaced) {
  write("s.toml", std::string{small_scene} + "\n[output]\nreport = false\nexports = [\"obj\", \"nmm3d\"]\n");
  EXPECT_EQ(cleave("run s.toml --quiet -o out").code, 0);
  EXPECT_FALSE(read("out/blocks.obj").empty());
  EXPECT_FALSE(read("out/blocks.nmm3d").empty());
  const Ended again = cleave("run s.toml --quiet -o out");
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(cleave("convert out c.obj").code, 0);
}

TEST_F(CommandsTest, ConvertRefusesBodiesThatOverlapAndSaysWhatIsBent) {
  const auto corners = [](const std::string& top) {
    return "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 " + top + "\nv 0 1 1\n";
  };
  const std::string faces = "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  const std::string others = "f 12 11 10 9\nf 13 14 15 16\nf 9 10 14 13\nf 10 11 15 14\nf 11 12 16 15\nf 12 9 13 16\n";
  write("twice.obj", corners("1") + corners("1") + faces + others);
  const Ended twice = cleave("convert twice.obj b.vtu");
  EXPECT_EQ(twice.code, 2);
  EXPECT_TRUE(twice.err.starts_with("error: twice.obj:17: group \"\": is no block: ")) << twice.err;
  write("bent.obj", corners("1.2") + faces);
  const Ended bent = cleave("convert bent.obj b.vtu");
  EXPECT_EQ(bent.code, 0) << bent.err;
  EXPECT_TRUE(bent.out.contains("1 faces of bodies are bent, with corners up to 0.0495 m off their plane")) << bent.out;
  EXPECT_EQ(cleave("convert b.vtu again.obj").code, 0);
}

TEST_F(CommandsTest, ConvertRefusesWhatItCannotDo) {
  write("a.obj", "v 0 0 0\nf 1 2 3\n");
  for (const std::string call : {"a.obj b.ply", "none.obj b.ply", "a.txt b.ply", "a.obj b.dxf"}) {
    const Ended ended = cleave("convert " + call);
    EXPECT_EQ(ended.code, 2) << call;
    EXPECT_TRUE(ended.err.starts_with("error: ")) << ended.err;
  }
  EXPECT_EQ(names(), (std::vector<std::string>{"a.obj"}));
}

}  // namespace
}  // namespace cleave::cli::test
