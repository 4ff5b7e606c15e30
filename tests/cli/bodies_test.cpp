#include <nlohmann/json.hpp>

#include "program.hpp"

namespace cleave::cli::test {
namespace {

class BodiesTest : public ProgramTest {};

TEST_F(BodiesTest, InitRunsAndRunsAgain) {
  const Ended init = cleave("init bodies");
  ASSERT_EQ(init.code, 0);
  write("b.toml", init.out);
  EXPECT_EQ(cleave("check b.toml").code, 0);
  const Ended plan = cleave("plan b.toml");
  EXPECT_NE(plan.out.find("elastic      run"), std::string::npos) << plan.out;
  for (int k = 0; k < 2; ++k) {
    const Ended run = cleave("run b.toml --quiet -o out");
    ASSERT_EQ(run.code, 0) << run.err;
    const auto elastic = nlohmann::json::parse(read("out/summary.json"))["elastic"];
    EXPECT_EQ(elastic["status"], "converged");
    EXPECT_EQ(elastic["points"].size(), 2U);
    EXPECT_LT(elastic["bodies"][0]["estimated_error"].get<double>(), 1e-3);
    EXPECT_LT(elastic["points"][0]["displacement"][1].get<double>(), 0);
  }
  const std::string page = read("out/report.html");
  EXPECT_EQ(page.find("http://"), std::string::npos);
  EXPECT_NE(page.find("id=\"scale\""), std::string::npos);
  EXPECT_NE(read("out/bodies.vtu").find("stress_xx"), std::string::npos);
}

TEST_F(BodiesTest, MovingSceneWritesASeriesAndThreadsChangeNothing) {
  write(
      "m.toml",
      "[rock]\nyoung = 1e8\npoisson = 0.25\n[elastic]\ngravity = 9.81\ntime = { end = 0.1, step = 1e-3, frames = 4 }\n"
      "points = [{ name = \"end\", at = [2, 0] }]\n"
      "[[body]]\noutline = [[0, 0], [2, 0], [2, 0.5], [0, 0.5]]\nsupport = [{ kind = \"pin\", at = [0, 0] }]\n");
  ASSERT_EQ(cleave("run m.toml --quiet -o a --threads 1").code, 0);
  ASSERT_EQ(cleave("run m.toml --quiet -o b --threads 2").code, 0);
  EXPECT_EQ(read("a/points.csv"), read("b/points.csv"));
  EXPECT_EQ(read("a/bodies_0004.vtu"), read("b/bodies_0004.vtu"));
  EXPECT_NE(read("a/bodies.pvd").find("bodies_0003.vtu"), std::string::npos);
  ASSERT_EQ(cleave("run m.toml --quiet -o a").code, 0);
}

TEST_F(BodiesTest, UnsupportedBodyIsWrongInputAndWritesNothing) {
  write("f.toml", "[[body]]\nyoung = 1\npoisson = 0.2\noutline = [[0, 0], [1, 0], [1, 1]]\n");
  const Ended run = cleave("run f.toml -o out");
  EXPECT_EQ(run.code, 2);
  EXPECT_NE(run.err.find("error: f.toml:1: body[1]: the supports do not hold the body against translation"),
            std::string::npos)
      << run.err;
}

}  // namespace
}  // namespace cleave::cli::test
