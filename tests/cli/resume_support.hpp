#pragma once

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "signals.hpp"

namespace cleave::cli::test {

using nlohmann::json;

/// Runs that are interrupted and gone on with.
class ResumeTest : public ProgramTest {
 protected:
  /// All that a run says but what it cost and which file it came from.
  [[nodiscard]] json summary(const std::string& out) const {
    json all = json::parse(read(out + "/summary.json"));
    for (const std::string key : {"cost", "scene_sha256", "scene_file", "title"}) all.erase(key);
    return all;
  }
  void expect_same(const std::string& a, const std::string& b, std::size_t at_least) const {
    std::size_t files = 0;
    for (const auto& entry : fs::directory_iterator{path(a)}) {
      const std::string name = entry.path().filename().string();
      if (name == "log.txt" || name == "summary.json" || name == "report.html") continue;
      EXPECT_TRUE(read(a + "/" + name) == read(b + "/" + name)) << name;
      ++files;
    }
    EXPECT_GE(files, at_least);
    EXPECT_EQ(summary(a), summary(b));
  }
  /// Starts the program in the folder and interrupts it as soon as it works.
  [[nodiscard]] int interrupted(const std::string& scene_file, const std::string& out, int yields,
                                std::chrono::microseconds later = {}) const {
    const std::size_t before = names().size();
    const auto works = [&] {
      if (names().size() <= before) return false;
      for (int k = 0; k < yields; ++k) ::sched_yield();
      std::this_thread::sleep_for(later);
      return true;
    };
    return signalled(folder(), {"run", scene_file, "-o", out, "--quiet"}, SIGINT, works).code;
  }
};

}  // namespace cleave::cli::test
