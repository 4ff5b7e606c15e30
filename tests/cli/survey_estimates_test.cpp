#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "survey_program.hpp"

// What rows and traces are counted for, and what is said of those that are not.

namespace cleave::cli::test {
namespace {

using nlohmann::json;

class SurveyEstimatesTest : public SurveyProgramTest {
 protected:
  static std::string line(const std::string& file, const std::string& name, int trend, int length) {
    return "[[scanline]]\nname = \"" + name + "\"\nfile = \"" + file + "\"\ntrend = " + std::to_string(trend) +
           "\nplunge = 0\nlength = " + std::to_string(length) + "\n";
  }
};

// Nine joints on 10 m, four of them without an orientation: there are nine all the same.
TEST_F(SurveyEstimatesTest, JointsWithoutAnOrientationCountOnLines) {
  write("l.csv",
        "distance,dip,dip_direction,set\n1,90,90,A\n2,,,A\n3,90,90,A\n4,,,A\n5,90,90,A\n6,,,A\n7,90,90,A\n"
        "8,,,A\n9,90,90,A\n");
  const json stated = survey(line("l.csv", "L", 90, 10));
  EXPECT_NEAR(stated["lines"][0]["frequency"]["value"], 0.9, 1e-12);
  EXPECT_NEAR(stated["sets"][0]["p32"]["value"], 0.9, 1e-9);
  EXPECT_TRUE(stated["notes"].dump().contains("line L: 4 of 9 joints have no orientation")) << stated["notes"];
  // Positions of the core's pieces are those of all joints.
  std::string core = "depth,alpha,beta\n";
  for (int i = 0; i < 100; ++i) core += std::to_string(i * 0.05) + (i % 2 == 0 ? ",,\n" : ",60,20\n");
  write("core.csv", core);
  const json hole = survey("[[borehole]]\nname = \"B\"\ntrend = 0\nplunge = 60\nlength = 5\nfile = \"core.csv\"\n");
  EXPECT_NEAR(hole["lines"][0]["frequency"]["value"], 20, 1e-12);
  EXPECT_EQ(hole["lines"][0]["rqd_measured"], 0);  // pieces of 5 cm; those between every second joint are 10 cm
}

// Equal readings and single ones say nothing of the spread, one trace nothing of the mean: null, and why.
TEST_F(SurveyEstimatesTest, WhatSaysNothingOfItsErrorHasNoInterval) {
  for (const int joints : {1, 5}) {
    std::string rows = "distance,dip,dip_direction,set\n";
    for (int i = 1; i <= joints; ++i) rows += std::to_string(i) + ",60,90,A\n";
    write("l.csv", rows);
    const json set = survey(line("l.csv", "L", 90, 20))["sets"][0];
    const json& orientation = set["orientation"];
    EXPECT_TRUE(orientation["cone_degrees"].is_null());
    EXPECT_TRUE(orientation["cone_degrees_reason"].get<std::string>().contains("nothing tells"));
    EXPECT_EQ(orientation["fisher"], false);
    EXPECT_TRUE(orientation["statistic"].is_null());
    EXPECT_TRUE(set["notes"].dump().contains("no spread can be had from")) << set["notes"];
  }
  write("l.csv", "distance,dip,dip_direction,set\n1,60,90,A\n2,62,95,A\n4,58,85,A\n");
  const json few = survey(line("l.csv", "L", 90, 20))["sets"][0]["orientation"];
  EXPECT_GT(few["cone_degrees"], 1);
  EXPECT_FALSE(few.contains("cone_degrees_reason"));
  EXPECT_EQ(few["fisher"], false);  // not tested
  write("t.csv", "x1,y1,x2,y2\n1,1,2,3\n");
  const json face = survey(
      "[[window]]\ntraces = \"t.csv\"\nrectangle = { min = [0, 0], max = [5, 5] }\ndip = 90\ndip_direction = 180\n"
      "[[set]]\nname = \"A\"\ndip = 70\ndip_direction = 90\nkappa = 20\n");
  int means = 0;
  for (const json& e : face["sets"][0]["estimates"]) {
    if (e["name"] != "mean trace length" || e["value"].is_null()) continue;
    ++means;
    EXPECT_TRUE(e["low"].is_null() && e["high"].is_null()) << e;
    EXPECT_TRUE(e["note"].get<std::string>().contains("one trace says nothing")) << e;
  }
  EXPECT_EQ(means, 1);
  for (const json& e : face["sets"][0]["estimates"]) {
    if (!e["name"].get<std::string>().starts_with("E L^")) continue;
    ++means;
    EXPECT_TRUE(e["low"].is_null() && e["high"].is_null()) << e;
    EXPECT_TRUE(e["note"].get<std::string>().contains("all alike")) << e;
  }
  EXPECT_EQ(means, 3);
}

// Joints exactly along the line are met by chance alone; that is why there is no intensity.
TEST_F(SurveyEstimatesTest, JointsAlongTheLineAreSaid) {
  write("l.csv", "distance,dip,dip_direction,set\n3,90,0,A\n5,90,0,A\n8,90,0,A\n");
  const json set = survey(line("l.csv", "L", 90, 20))["sets"][0];
  EXPECT_TRUE(set["notes"].dump().contains("the lines run along the joints of this set")) << set["notes"];
  EXPECT_FALSE(set["notes"].dump().contains("no joint on a line")) << set["notes"];
}

// Six joints of A and two of B are known, four are not: three to one. B cannot be met by the second line, so that its
// five are of A. The interval is narrower than that of the known ones, wider than if all had been known.
TEST_F(SurveyEstimatesTest, JointsOfUnknownSetAreSharedOut) {
  const std::string known =
      "distance,dip,dip_direction,set\n1,90,45,A\n2,90,45,A\n3,90,45,A\n4,90,45,A\n5,90,45,A\n6,90,45,A\n"
      "7,90,315,B\n8,90,315,B\n";
  write("l.csv", known);
  write("n.csv", known + "1.5,,,\n2.5,,,\n3.5,,,\n4.5,,,\n");
  write("m.csv", "distance\n1\n2\n3\n4\n5\n");
  const json before = survey(line("l.csv", "L", 0, 10))["sets"];
  const json result = survey(line("n.csv", "L", 0, 10));
  const auto p32 = [](const json& set) { return set["p32"]["value"].get<double>(); };
  for (std::size_t k = 0; k < 2; ++k) {
    const json &one = before[k]["p32"], &all = result["sets"][k]["p32"];
    EXPECT_NEAR(p32(result["sets"][k]), 1.5 * p32(before[k]), 1e-6);
    EXPECT_LT(all["high"].get<double>() / all["low"].get<double>(),
              one["high"].get<double>() / one["low"].get<double>());
  }
  // 1/(1/6 - 1/8 + 1/12) = 8 joints: chi-squared of 18 and 16 degrees.
  const json& interval = result["sets"][0]["p32"];
  EXPECT_NEAR(interval["high"].get<double>() / interval["low"].get<double>(), 31.5264 / 6.9077, 1e-3);
  const std::string notes = result["sets"][0]["notes"].dump();
  EXPECT_TRUE(notes.contains("3.0 of the 4 that have neither orientation nor set")) << notes;
  EXPECT_TRUE(result["notes"].dump().contains("4 are shared out among the sets")) << result["notes"];
  const json both = survey(line("l.csv", "L", 0, 10) + line("m.csv", "M", 45, 5))["sets"];
  EXPECT_NEAR(p32(both[0]), 11 / (10 * std::numbers::sqrt2 / 2 + 5), 1e-6);
  EXPECT_NEAR(p32(both[1]), 2 / (10 * std::numbers::sqrt2 / 2), 1e-6);
}

// On a vertical face all traces have one azimuth: they go to sets by their angle in it. Wall to the south (000/90), x
// to the west: a plane 45/270 leaves traces at -45 degrees, 45/090 at 45, 90/090 upright ones.
TEST_F(SurveyEstimatesTest, TracesOnAVerticalFaceGoToTheirSets) {
  write("o.csv", "dip,dip_direction,set\n44,270,W\n45,268,W\n45,272,W\n46,270,W\n44,90,E\n45,88,E\n45,92,E\n46,90,E\n");
  std::string rows = "x1,y1,x2,y2\n";
  for (int i = 0; i < 12; ++i) {
    const double x = 2 + i, rise = i % 3 == 0 ? 1 : -1;
    rows += std::to_string(x) + ",4," + std::to_string(x + 1) + "," + std::to_string(4 + rise) + "\n";
  }
  write("t.csv", rows);
  const std::string wall =
      "[[window]]\nname = \"wall\"\ntraces = \"t.csv\"\nrectangle = { min = [0, 0], max = [20, 10] }\n"
      "dip = 90\ndip_direction = 0\n";
  const json sets = survey("[[orientations]]\nfile = \"o.csv\"\n" + wall)["sets"];
  EXPECT_EQ(sets[0]["traces"], 8);
  EXPECT_EQ(sets[1]["traces"], 4);
  EXPECT_NEAR(sets[0]["p32"]["value"].get<double>(), 2 * sets[1]["p32"]["value"].get<double>(), 1e-9);
  // An azimuth says nothing there.
  const json by_azimuth = survey(wall + "[[set]]\nname = \"A\"\nazimuth = [0, 180]\ndip = 45\n")["sets"][0];
  EXPECT_TRUE(by_azimuth["notes"].dump().contains("on vertical windows all traces have one azimuth")) << by_azimuth;
  EXPECT_EQ(by_azimuth["notes"].dump().find("no [[window]]"), std::string::npos);
}

// A plane of dip 60 that holds a trace of an inclined wall: 60/300 on a wall 45/350, or 60/049.7 (worked out by hand).
TEST_F(SurveyEstimatesTest, DipDirectionsFollowFromTracesAndTheirWall) {
  const double turn = std::numbers::pi / 180, strike = 260 * turn, wall = 45 * turn, dip = 60 * turn;
  const std::array<double, 3> x{std::sin(strike), std::cos(strike), 0};
  const std::array<double, 3> y{-std::sin(350 * turn) * std::cos(wall), -std::cos(350 * turn) * std::cos(wall),
                                std::sin(wall)};
  const std::array<double, 3> normal{std::sin(dip) * std::sin(300 * turn), std::sin(dip) * std::cos(300 * turn),
                                     std::cos(dip)};
  const auto along = [&](const std::array<double, 3>& axis) {
    return axis[0] * normal[0] + axis[1] * normal[1] + axis[2] * normal[2];
  };
  const double right = -along(y), up = along(x), length = std::hypot(right, up);
  std::string rows = "x1,y1,x2,y2\n";
  for (int i = 0; i < 12; ++i) {
    const double spread = (i % 3 - 1) * 0.02, dx = (right - spread * up) / length, dy = (up + spread * right) / length;
    rows += std::to_string(5 + i) + ",5," + std::to_string(5 + i + dx) + "," + std::to_string(5 + dy) + "\n";
  }
  write("t.csv", rows);
  const std::string map = "[[window]]\ntraces = \"t.csv\"\nrectangle = { min = [0, 0], max = [22, 10] }\n";
  const std::string inclined = map + "dip = 45\ndip_direction = 350\n";
  const std::string set = "[[set]]\nname = \"A\"\nazimuth = [0, 180]\ndip = 60\n";
  const json one = survey(inclined + set)["sets"][0];
  EXPECT_NEAR(one["orientation"]["dip_direction"], 49.7, 0.5);
  EXPECT_TRUE(one["notes"].dump().contains("dip_direction = 300.0")) << one["notes"];
  EXPECT_LT(one["orientation"]["dip_direction_low"], 49.7);
  EXPECT_GT(one["orientation"]["dip_direction_high"], 49.7);
  // A level map of the same joints, traces along 030: it has to be 300, not 120, nor 49.7.
  write("m.csv", "x1,y1,x2,y2\n4,4,5,5.732\n6,4,7,5.732\n8,4,9,5.732\n");
  const std::string level = "[[window]]\ntraces = \"m.csv\"\nrectangle = { min = [0, 0], max = [22, 10] }\n";
  const json both = survey(inclined + level + set)["sets"][0];
  EXPECT_NEAR(both["orientation"]["dip_direction"], 300, 0.5);
  EXPECT_EQ(both["notes"].dump().find("leave the same traces"), std::string::npos) << both["notes"];
  // On level ground alone it may be either, which is said.
  const json flat = survey(level + set)["sets"][0];
  EXPECT_NEAR(flat["orientation"]["dip_direction"], 120, 0.1);
  EXPECT_TRUE(flat["notes"].dump().contains("dip_direction = 300.0")) << flat["notes"];
  // A dip that no plane through the traces has.
  const json gentle = survey(inclined + "[[set]]\nname = \"A\"\nazimuth = [0, 180]\ndip = 10\n")["sets"][0];
  EXPECT_TRUE(gentle["notes"].dump().contains("steeper than planes of dip 10")) << gentle["notes"];
}

// Two sets with a wide spread: a trace 40 degrees off one and 50 off the other belongs to the nearer one. What is far
// off all of narrow ones is of no set, and that is said. So are traces outside the window.
TEST_F(SurveyEstimatesTest, TracesOfNoSetAndOutsideTheWindowAreSaid) {
  write("t.csv", "x1,y1,x2,y2\n5,4,5,6\n6,5,8,5\n7,5,9,6.678\n30,5,32,5\n");
  const std::string map =
      "[[window]]\nname = \"map\"\ntraces = \"t.csv\"\nrectangle = { min = [0, 0], max = [20, 10] }\n";
  const auto sets = [](int kappa) {
    const std::string of = "\ndip = 90\nkappa = " + std::to_string(kappa) + "\ndip_direction = ";
    return "[[set]]\nname = \"N\"" + of + "90\n[[set]]\nname = \"E\"" + of + "0\n";
  };
  const json wide = survey(map + sets(10));
  EXPECT_EQ(wide["sets"][0]["traces"], 1);
  EXPECT_EQ(wide["sets"][1]["traces"], 2);
  EXPECT_TRUE(wide["notes"].dump().contains("window map: 1 of 4 traces (25 %) lie outside it")) << wide["notes"];
  EXPECT_TRUE(wide["notes"].dump().contains("of 3 are of another")) << wide["notes"];
  const json narrow = survey(map + sets(100));
  EXPECT_EQ(narrow["notes"].dump().find("are of another"), std::string::npos) << narrow["notes"];
  EXPECT_EQ(narrow["sets"][1]["traces"], 1);
  EXPECT_TRUE(narrow["notes"].dump().contains("1 of 3 traces belong to no set; their P21, 0.0131 1/m"))
      << narrow["notes"];
  write("t.csv", "x1,y1,x2,y2\n100,500,300,500\n");
  const json out = survey(map + sets(10));
  EXPECT_TRUE(out["notes"].dump().contains("are both in the same units?")) << out["notes"];
  EXPECT_EQ(out.dump().find("no [[scanline]]"), std::string::npos);
}

TEST_F(SurveyEstimatesTest, WindowOfInitIsTheOneItSays) {
  for (const char* file : {"window.toml", "window.csv"}) {
    write(file, cleave(std::string{"init window"} + (std::string{file}.ends_with("csv") ? "-csv" : "")).out);
  }
  const json sets = survey(read("window.toml"))["sets"];
  EXPECT_EQ(sets[0]["traces"], 28);
  EXPECT_EQ(sets[1]["traces"], 14);
  for (const json& set : sets) EXPECT_TRUE(set.contains("p32") && set.contains("size")) << set["name"];
}

// Lines of 4 m with a joint a metre see only gaps that fit on them: y = 4, (y - 2 + (y + 2) e^-y)/(y - 1 + e^-y) = 0.70
// of the whole ones. On one of 40 m it is 0.97: nothing to say.
TEST_F(SurveyEstimatesTest, LinesShortForTheirSpacingsAreSaid) {
  const std::string head = "distance,dip,dip_direction\n";
  write("s.csv", head + "0.2,90,90\n0.9,90,90\n1.2,90,90\n3.4,90,90\n");
  std::string two;
  for (const char* name : {"a", "b"}) two += line("s.csv", name, 90, 4);
  const std::string notes = survey(two)["sets"][0]["notes"].dump();
  EXPECT_TRUE(notes.contains("on average 0.70 of the whole ones")) << notes;
  EXPECT_TRUE(notes.contains("a mean of 1.53 m, not of 1.07 m")) << notes;
  std::string rows = head;
  for (int i = 0; i < 40; ++i) rows += std::to_string(i + 0.2 * (i % 3)) + ",90,90\n";
  write("l.csv", rows);
  const std::string quiet = survey(line("l.csv", "L", 90, 40))["sets"][0]["notes"].dump();
  EXPECT_EQ(quiet.find("short for them"), std::string::npos) << quiet;
}

// With y 20 degrees west of north a compass reads 40: sets.toml has it so, and a scene with that north turns it once.
TEST_F(SurveyEstimatesTest, SetsAreFromTrueNorthAsTheCompassReadThem) {
  write("l.csv", "distance,dip,dip_direction,set\n1,60,40,A\n2,60,40,A\n3,60,40,A\n4,60,40,A\n");
  const json result = survey("north = 20\n" + line("l.csv", "L", 40, 10));
  EXPECT_EQ(result["north"], 20);
  EXPECT_NEAR(result["sets"][0]["orientation"]["dip_direction"], 40, 1e-9);
  EXPECT_TRUE(read("out/sets.toml").contains("the scene needs north = 20."));
  write("s.toml",
        "north = 20\ninclude = [\"out/sets.toml\"]\n[domain]\nbox = { min = [0, 0, 0], max = [10, 10, 10] }\n");
  const Ended cut = cleave("run s.toml --quiet -o cut");
  EXPECT_EQ(cut.code, 0) << cut.err;
  const json drawn = json::parse(read("cut/summary.json"));
  EXPECT_GT(drawn["input"]["joints"], 0);
  // In space the joints dip to 60 degrees from y: corners of a joint lie on sin 60 sin 60 x + sin 60 cos 60 y + z/2.
  const Ended net = cleave("convert s.toml net.obj");
  EXPECT_EQ(net.code, 0) << net.err;
  std::istringstream obj{read("net.obj")};
  std::vector<std::array<double, 3>> corners;
  for (std::string row; std::getline(obj, row);) {
    if (row.starts_with("v ")) {
      std::array<double, 3> p{};
      std::istringstream{row.substr(2)} >> p[0] >> p[1] >> p[2];
      corners.push_back(p);
    }
    if (!row.starts_with("f ")) continue;
    std::istringstream face{row.substr(2)};
    std::vector<double> along;
    for (std::string corner; face >> corner;) {
      const auto& p = corners[std::stoul(corner) - 1];
      along.push_back(0.75 * p[0] + std::sqrt(3.0) / 4 * p[1] + 0.5 * p[2]);
    }
    for (const double a : along) EXPECT_NEAR(a, along.front(), 1e-4) << row;
  }
  EXPECT_GT(corners.size(), 3U);
  // Stated directions and azimuths of traces are from true north, too.
  write("t.csv", "x1,y1,x2,y2\n4,4,5,5.7320508\n6,4,7,5.7320508\n");
  const std::string map = "north = 20\n[[window]]\ntraces = \"t.csv\"\nrectangle = { min = [0, 0], max = [20, 10] }\n";
  const json traced = survey(map + "[[set]]\nname = \"A\"\nazimuth = [5, 15]\ndip = 60\n");
  EXPECT_NEAR(traced["sets"][0]["orientation"]["dip_direction"], 100, 1e-4);  // traces along 030 of the map, 010 true
  EXPECT_NEAR(traced["windows"][0]["map"]["direction"], 10, 1e-4);
  EXPECT_TRUE(traced["sets"][0]["notes"].dump().contains("dip_direction = 280.0")) << traced["sets"][0]["notes"];
  const json stated = survey(map + "[[set]]\nname = \"A\"\ndip = 90\ndip_direction = 100\nkappa = 500\n");
  EXPECT_NEAR(stated["sets"][0]["orientation"]["dip_direction"], 100, 1e-9);
  EXPECT_NEAR(stated["sets"][0]["p32"]["value"], 4 / 200.0, 1e-4);  // it holds the traces: sin V = 1
}

}  // namespace
}  // namespace cleave::cli::test
