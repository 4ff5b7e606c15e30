#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <optional>
#include <string>

#include "cleave/realize/monte_carlo.hpp"
#include "parse_support.hpp"

// An ensemble that goes on from the records of earlier calls.

namespace cleave::scene::test::ensemble_resume_test {
namespace {

TEST(EnsembleResume, RecordsOfEarlierCallsAreToldBeforeAnyIsMade) {
  const Scene scene = scene_of(
      "schema = 1\nseed = 5\n[domain]\nbox = { min = [0, 0, 0], max = [20, 20, 20] }\n[[joint_set]]\nname = \"A\"\n"
      "orientation = { dip = 30, dip_direction = 60 }\nshape = \"square\"\nsize = 5\nintensity = { count = 4 }\n"
      "[monte_carlo]\nrealizations = 8\n");
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("cleave-resume-" + std::to_string(::getpid()));
  std::filesystem::remove(file);
  const auto run = [&](std::uint64_t end) {
    std::optional<std::uint64_t> found;
    const MakeRecords make = [&](std::uint64_t first, std::uint64_t, std::uint64_t, const auto& commit) {
      for (std::uint64_t k = first; k < end; ++k) {
        EXPECT_TRUE(found.has_value());
        stochastic::Record record;
        record.realization = k;
        EXPECT_TRUE(commit(record));
      }
    };
    const MonteCarloWatch watch{.progress = {}, .found = [&](std::uint64_t records) { found = records; }};
    EXPECT_TRUE(run_monte_carlo(scene, make, file, {}, watch).has_value());
    return found;
  };
  EXPECT_EQ(run(5), 0U);
  EXPECT_EQ(run(5), 5U);  // nothing is made
  EXPECT_EQ(run(8), 5U);
  EXPECT_EQ(run(8), 8U);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace cleave::scene::test::ensemble_resume_test
