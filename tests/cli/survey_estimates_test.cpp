#include <cmath>
#include <numbers>
#include <string>

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

// Six joints of A and two of B are known, four are not: three to one. B cannot be met by the second line, so that its
// five are of A. The interval is narrower than that of the known ones, wider than if all had been
// known.
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

}  // namespace
}  // namespace cleave::cli::test
