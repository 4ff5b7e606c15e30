#include "survey_program.hpp"

namespace cleave::cli::test {
namespace {

using nlohmann::json;

class SurveyTest : public SurveyProgramTest {
 protected:
  static double estimate(const json& list, const std::string& name, const std::string& method) {
    for (const json& e : list) {
      if (e["name"] == name && e["method"] == method) return e["value"];
    }
    ADD_FAILURE() << name;
    return 0;
  }
};

// Figures of an independent script: 707 traces, ends inside 3/69/635, length inside 1563.5765329223 m.
TEST_F(SurveyTest, OutcropOfTheExampleGivesItsKnownFiguresAndSetsForATunnel) {
  const std::string example = std::string{CLEAVE_SOURCE_DIR} + "/examples/outcrop/";
  const Ended run = cleave("survey '" + example + "outcrop.toml' -o out");
  ASSERT_EQ(run.code, 0) << run.err;
  const json result = json::parse(read("out/survey.json"));
  const json& window = result["windows"][0];
  EXPECT_EQ(window["traces"], 707);
  // The end of trace 55 lies exactly on the border (rational arithmetic): it is not seen.
  EXPECT_EQ(window["ends_0"], 3);
  EXPECT_EQ(window["ends_1"], 69);
  EXPECT_EQ(window["ends_2"], 635);
  EXPECT_NEAR(window["length_inside_m"], 1563.5765329223, 1e-6);
  EXPECT_NEAR(window["area_m2"], 1237.9003657531, 1e-6);
  EXPECT_NEAR(estimate(window["estimates"], "P21", "S/A"), 1.2630875442, 1e-9);
  EXPECT_NEAR(estimate(window["estimates"], "P20", "N/A"), 0.5711283554, 1e-9);
  EXPECT_EQ(result["sets"].size(), 3U);
  const std::string page = read("out/report.html");
  EXPECT_NE(page.find("Simulated: one realization"), std::string::npos);
  EXPECT_EQ(page.find("http://"), std::string::npos);
  const std::string inputs = page.substr(page.find("<section id=\"inputs\">"));
  EXPECT_TRUE(inputs.contains(result["survey_sha256"].get<std::string>())) << inputs;
  EXPECT_TRUE(inputs.contains(" bytes <code>")) << inputs;  // of the traces
  EXPECT_TRUE(inputs.contains("cleave 0.1.0") && inputs.contains("Assumptions and limits")) << inputs;
  // What comes out goes into a scene as it is.
  write("s.toml",
        "include = [\"out/sets.toml\"]\n[domain]\nbox = { min = [0, 0, 0], max = [3, 3, 3] "
        "}\n[joints.northeast]\nfriction "
        "= 20\n");
  const Ended cut = cleave("run s.toml --quiet -o cut");
  EXPECT_EQ(cut.code, 0) << cut.err;
  EXPECT_GT(json::parse(read("cut/summary.json"))["input"]["joints"], 20);
}

TEST_F(SurveyTest, ScanlinesGiveSetsOrientationsAndIntensities) {
  std::string rows = "distance,dip,dip_direction,set\n";
  for (int i = 0; i < 20; ++i) {
    rows += std::to_string(0.5 + i) + "," + std::to_string(58 + i % 5) + "," + std::to_string(88 + i % 7) + ",J1\n";
  }
  write("line.csv", rows);
  const json result = survey("[[scanline]]\nname = \"S1\"\ntrend = 90\nplunge = 0\nlength = 20\nfile = \"line.csv\"\n");
  EXPECT_NEAR(result["lines"][0]["frequency"]["value"], 1.0, 1e-12);
  const json& set = result["sets"][0];
  EXPECT_EQ(set["name"], "J1");
  EXPECT_NEAR(set["orientation"]["dip"], 60, 1.0);
  EXPECT_NEAR(set["orientation"]["dip_direction"], 91, 1.5);
  // Line at 30 degrees to the normal of the mean: P32 = N / (L cos 30).
  EXPECT_NEAR(set["p32"]["value"], 1 / 0.866, 0.02);
  const std::string sets = read("out/sets.toml");
  EXPECT_NE(sets.find("size = \"persistent\""), std::string::npos) << sets;
}

TEST_F(SurveyTest, ListsOfPolesAreClustered) {
  std::string rows = "dip,dip_direction\n";
  for (int i = 0; i < 60; ++i) {
    const int a = i % 3;
    rows += std::to_string((a == 0   ? 20
                            : a == 1 ? 80
                                     : 75) +
                           i % 4) +
            "," +
            std::to_string((a == 0   ? 100
                            : a == 1 ? 10
                                     : 270) +
                           i % 9) +
            "\n";
  }
  write("p.csv", rows);
  const json result = survey("clusters = 3\n[[orientations]]\nfile = \"p.csv\"\n");
  EXPECT_EQ(result["sets"].size(), 3U);
  for (const json& set : result["sets"]) EXPECT_GE(set["joints"], 15);
  double best = 0;
  int at = 0;
  for (const json& s : result["silhouettes"]) {
    if (s["silhouette"] > best) {
      best = s["silhouette"];
      at = s["sets"];
    }
  }
  EXPECT_EQ(at, 3);
}

TEST_F(SurveyTest, PoorDataGiveAnAnswerOrAReason) {
  write("one.csv", "dip,dip_direction\n40,100\n");
  EXPECT_EQ(survey("[[orientations]]\nfile = \"one.csv\"\n")["sets"][0]["joints"], 1);
  // Without a line or a window nothing is known of how many there are.
  EXPECT_FALSE(read("out/sets.toml").contains("[[joint_set]]"));
  EXPECT_TRUE(read("out/survey.json").contains("the intensity is not known, and sets.toml leaves the set out"));
  EXPECT_TRUE(read("out/report.html").contains("0 of them in sets.toml"));
  write("same.csv", "strike,dip\n10,40\n10,40\n10,40\n");
  const json same = survey("[[orientations]]\nfile = \"same.csv\"\n");
  EXPECT_TRUE(same["sets"][0]["orientation"]["kappa"].is_null());  // infinite
  EXPECT_NEAR(same["sets"][0]["orientation"]["dip_direction"], 100, 1e-9);
  write("flat.csv", "x1,y1,x2,y2\n1,1,1,1\n0,0,2,2\n");
  const json flat = survey("[[window]]\ntraces = \"flat.csv\"\nrectangle = { min = [0, 0], max = [4, 4] }\n");
  EXPECT_EQ(flat["windows"][0]["traces"], 1);

  write("bare.csv", "40,100\n50,110\n");
  EXPECT_NE(refusal("[[orientations]]\nfile = \"bare.csv\"\n").find("bare.csv:1: columns: the table has no header"),
            std::string::npos);
  EXPECT_EQ(survey("[[orientations]]\nfile = \"bare.csv\"\ncolumns = [\"dip\", \"dip_direction\"]\n")["orientations"],
            2);
  write("odd.csv", "dip,colour\n40,red\n");
  EXPECT_NE(refusal("[[orientations]]\nfile = \"odd.csv\"\n").find("lacks the columns of an orientation"),
            std::string::npos);
  write("wide.csv", "dip,dip_direction\n40,364\n");
  EXPECT_NE(refusal("[[orientations]]\nfile = \"wide.csv\"\n").find("wide.csv:2: dip_direction: is 364"),
            std::string::npos);
  EXPECT_NEAR(survey("[[orientations]]\nfile = \"wide.csv\"\nwrap = true\n")["sets"][0]["orientation"]["dip_direction"],
              4, 1e-9);
  write("text.csv", "dip,dip_direction\nsteep,100\n");
  EXPECT_NE(refusal("[[orientations]]\nfile = \"text.csv\"\n").find("\"steep\" is not a number"), std::string::npos);
  write("far.csv", "distance\n25\n");
  EXPECT_NE(refusal("[[scanline]]\ntrend = 0\nplunge = 0\nlength = 20\nfile = \"far.csv\"\n").find("outside the line"),
            std::string::npos);
  write("pixels.txt", "1\t1\t5\t5\r\n");
  EXPECT_NE(refusal("[[window]]\ntraces = \"pixels.txt\"\nrectangle = { min = [0, 0], max = [9, 9] }\n").find("pixels"),
            std::string::npos);
  write("deg.geojson",
        R"({"type":"Feature","geometry":{"type":"LineString","coordinates":[[20.1,60.2],[20.2,60.3]]}})");
  EXPECT_NE(
      refusal("[[window]]\ntraces = \"deg.geojson\"\nrectangle = { min = [0, 0], max = [9, 9] }\n").find("degrees"),
      std::string::npos);
  EXPECT_NE(refusal("title = \"x\"\n").find("holds no data"), std::string::npos);
  EXPECT_NE(refusal("[[window]]\ntraces = \"no.geojson\"\n").find("does not exist"), std::string::npos);
}

// Conventions that do not belong together in one table, or a set that nothing belongs to.
TEST_F(SurveyTest, MixedConventionsAreRefusedOrAnswered) {
  // Twice the same plane is no contradiction; a left-hand strike and a line taken for a pole are.
  write("both.csv", "dip,dip_direction,strike\n40,100,10\n");
  EXPECT_EQ(survey("[[orientations]]\nfile = \"both.csv\"\n")["orientations"], 1);
  write("left.csv", "dip,dip_direction,strike\n40,100,10\n40,100,190\n");
  const std::string left = refusal("[[orientations]]\nfile = \"left.csv\"\n");
  EXPECT_TRUE(left.contains("left.csv:3: strike: 190 does not belong to dip_direction 100")) << left;
  write("poles.csv", "trend,plunge,dip,dip_direction\n280,50,40,100\n");
  EXPECT_EQ(survey("[[orientations]]\nfile = \"poles.csv\"\n")["orientations"], 1);
  write("lines.csv", "trend,plunge,dip,dip_direction\n100,40,40,100\n");
  const std::string lines = refusal("[[orientations]]\nfile = \"lines.csv\"\n");
  EXPECT_TRUE(lines.contains("lines.csv:2: trend: trend and plunge and dip and dip_direction")) << lines;
  // Each table by itself may have its own: the same plane three times.
  write("a.csv", "dip,dip_direction\n40,100\n");
  write("b.csv", "strike,dip\n10,40\n");
  write("c.csv", "trend,plunge\n280,50\n");
  const json three = survey(
      "[[orientations]]\nfile = \"a.csv\"\n[[orientations]]\nfile = \"b.csv\"\n[[orientations]]\nfile = \"c.csv\"\n");
  EXPECT_EQ(three["sets"][0]["joints"], 3);
  EXPECT_NEAR(three["sets"][0]["orientation"]["dip"], 40, 1e-9);
  EXPECT_NEAR(three["sets"][0]["orientation"]["dip_direction"], 100, 1e-9);
  write("semi.csv", "dip;dip_direction\n40,5;100,25\n41,5;101,25\n");
  EXPECT_NEAR(survey("[[orientations]]\nfile = \"semi.csv\"\n")["sets"][0]["orientation"]["dip"], 41, 0.01);
  write("torn.csv", "dip,dip_direction\n40\n");
  EXPECT_TRUE(
      refusal("[[orientations]]\nfile = \"torn.csv\"\n").contains("torn.csv:2: row: 1 cells, the header has 2"));
  write("half.csv", "dip,dip_direction\n40,\n");
  EXPECT_TRUE(refusal("[[orientations]]\nfile = \"half.csv\"\n").contains("holds no data"));
  write("flat.csv", "x1,y1,x2,y2\n1,1,1,1\n2,2,2,2\n");
  const json none = survey("[[window]]\ntraces = \"flat.csv\"\nrectangle = { min = [0, 0], max = [4, 4] }\n");
  EXPECT_EQ(none["windows"][0]["traces"], 0);
  EXPECT_TRUE(none["windows"][0]["estimates"][0]["value"].is_null());
}

// Traces cut at the border of a map: the survey says so, and takes them so when told.
TEST_F(SurveyTest, EndsAtTheBorderAreTold) {
  std::string rows = "x1,y1,x2,y2\n";
  for (int i = 1; i < 10; ++i) rows += "2," + std::to_string(i) + ",9.9999999," + std::to_string(i) + "\n";
  write("t.csv", rows);
  const std::string window =
      "[[window]]\nname = \"W\"\ntraces = \"t.csv\"\nrectangle = { min = [0, 0], max = [10, 10] }\n";
  const json plain = survey(window);
  EXPECT_EQ(plain["windows"][0]["ends_2"], 9);
  EXPECT_TRUE(plain["notes"].dump().contains("9 ends of traces lie within")) << plain["notes"];
  const json told = survey(window + "border = 0.001\n");
  EXPECT_EQ(told["windows"][0]["ends_1"], 9);
  EXPECT_FALSE(told["notes"].dump().contains("ends of traces lie within"));
}

}  // namespace
}  // namespace cleave::cli::test
