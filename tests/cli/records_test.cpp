#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "program.hpp"
#include "sanitized.hpp"

namespace cleave::cli::test {
namespace {

/// The records kept of the studies of docs/monte_carlo_results.md.
class KeptRecordsTest : public ProgramTest {
 protected:
  static std::vector<std::string> cells(const std::string& row) {
    std::vector<std::string> found;
    std::istringstream line{row};
    for (std::string cell; std::getline(line, cell, ',');) found.push_back(cell);
    return found;
  }
  [[nodiscard]] static std::vector<std::vector<std::string>> rows(const std::string& text) {
    std::vector<std::vector<std::string>> found;
    std::istringstream lines{text};
    for (std::string line; std::getline(lines, line);) {
      if (!line.starts_with('#')) found.push_back(cells(line));
    }
    return found;
  }

  /// As many rows as stated, with the means of the tables, and the first of them as cleave makes them today.
  void look(const std::string& folder, const std::string& name, std::size_t realizations, double blocks,
            double key_blocks, double key_m3) const {
    const std::string at = std::string{CLEAVE_SOURCE_DIR} + "/examples/" + folder + "/";
    const Ended unpacked = shell("gzip -dc '" + at + "records/" + name + ".csv.gz'");
    ASSERT_EQ(unpacked.code, 0) << unpacked.err;
    const auto kept = rows(unpacked.out);
    ASSERT_EQ(kept.size(), realizations + 1) << name;
    const auto column = [&](const std::vector<std::string>& header, const std::string& wanted) {
      return static_cast<std::size_t>(std::ranges::find(header, wanted) - header.begin());
    };
    std::array<double, 3> sums_of{};
    const std::array<std::string, 3> names{"blocks", "count", "volume_m3"};
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t c = column(kept[0], names.at(i));
      for (std::size_t k = 1; k < kept.size(); ++k) sums_of.at(i) += std::stod(kept[k].at(c));
    }
    const auto n = static_cast<double>(realizations);
    EXPECT_NEAR(sums_of[0] / n, blocks, 5e-3 * blocks) << name;
    EXPECT_NEAR(sums_of[1] / n, key_blocks, 5e-3 * key_blocks) << name;
    EXPECT_NEAR(sums_of[2] / n, key_m3, 5e-3 * key_m3) << name;
    std::string scene = text_of(at + name + ".toml");
    const std::size_t number = scene.find("realizations = ");
    ASSERT_NE(number, std::string::npos);
    scene.replace(number, scene.find('\n', number) - number, "realizations = 3");
    write(name + ".toml", scene);
    ASSERT_EQ(cleave("run " + name + ".toml -o " + name + " --quiet").code, 0);
    const auto today = rows(read(name + "/realizations.csv"));
    ASSERT_EQ(today.size(), 4U);
    for (std::size_t c = 0; c < kept[0].size(); ++c) {
      const std::size_t full = column(today[0], kept[0][c]);
      ASSERT_LT(full, today[0].size()) << kept[0][c];
      for (std::size_t k = 1; k <= 3; ++k) {
        const double then = std::stod(kept[k].at(c)), now = std::stod(today[k].at(full));
        EXPECT_NEAR(now, then, 1e-9 * std::abs(then)) << name << ' ' << kept[0][c] << ' ' << k - 1;
      }
    }
  }
};

TEST_F(KeptRecordsTest, TunnelOfTheSource) {
  look("thesis_tunnel", "small", 2000, 519, 21.1, 372);
  look("thesis_tunnel", "medium", 10000, 587, 24.4, 454);
  look("thesis_tunnel", "infinite", 2000, 5700, 625, 11700);
}
// Ten realizations with the second largest block system of the medium scene among them, and 640: no more memory.
TEST_F(KeptRecordsTest, MemoryDoesNotGrowWithTheRealizations) {
  if (support::sanitized) GTEST_SKIP() << "sanitizers keep what was freed";
  std::string scene = text_of(std::string{CLEAVE_SOURCE_DIR} + "/examples/thesis_tunnel/medium.toml");
  scene.replace(scene.find("realizations = 10000"), 20, "realizations = 640");
  write("s.toml", scene);
  const auto peak = [&](const std::string& out, const std::string& shard) {
    const Ended run = cleave("run s.toml -o " + out + " --threads 1 --quiet" + shard);
    EXPECT_EQ(run.code, 0) << run.err;
    return nlohmann::json::parse(read(out + "/summary.json"))["cost"]["peak_rss_mb"].get<double>();
  };
  const double few = peak("few", " --shard 57/64");  // 56, 120, ... 632
  EXPECT_LT(peak("many", ""), 1.1 * few);
  EXPECT_EQ(rows(read("few/realizations.csv")).size(), 11U);
}

TEST_F(KeptRecordsTest, EntranceOfJinping) { look("jinping_entrance", "jinping_entrance", 2000, 492, 55.7, 2640); }

}  // namespace
}  // namespace cleave::cli::test
