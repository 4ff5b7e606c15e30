#include <cmath>
#include <numbers>

#include "survey_program.hpp"

namespace cleave::cli::test {
namespace {

using nlohmann::json;

using SurveyRowsTest = SurveyProgramTest;

// A million rows, of orientations and of traces.
TEST_F(SurveyRowsTest, AMillionOrientationsAndTraces) {
  std::string poles = "dip,dip_direction\n", traces = "x1,y1,x2,y2\n";
  double east = 0, north = 0, up = 0;  // sum of the unit normals
  for (int i = 0; i < 1'000'000; ++i) {
    constexpr double degree = std::numbers::pi / 180;
    const double dip = degree * (50 + i % 9), direction = degree * (100 + i % 23);
    east += std::sin(dip) * std::sin(direction);
    north += std::sin(dip) * std::cos(direction);
    up += std::cos(dip);
    poles += std::to_string(50 + i % 9) + "," + std::to_string(100 + i % 23) + "\n";
    const int x = i % 997, y = i / 997;
    traces += std::to_string(x) + "," + std::to_string(y) + ".5," + std::to_string(x + 1 + i % 3) + "," +
              std::to_string(y + i % 2) + ".5\n";
  }
  write("poles.csv", poles);
  write("traces.csv", traces);
  const json many = survey("[[orientations]]\nfile = \"poles.csv\"\n");
  EXPECT_EQ(many["sets"][0]["joints"], 1'000'000);
  EXPECT_NEAR(many["sets"][0]["orientation"]["dip"], std::atan2(std::hypot(east, north), up) * 180 / std::numbers::pi,
              1e-6);
  const json mapped = survey("[[window]]\ntraces = \"traces.csv\"\nrectangle = { min = [0, 0], max = [1000, 1004] }\n");
  EXPECT_EQ(mapped["windows"][0]["traces"], 1'000'000);
}

}  // namespace
}  // namespace cleave::cli::test
