#pragma once

#include <sched.h>
#include <signal.h>
#include <spawn.h>

#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "program.hpp"

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
    const std::string from = path(scene_file).string(), to = path(out).string();
    std::array<std::string, 6> words{"cleave", "run", from, "-o", to, "--quiet"};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const std::size_t before = names().size();
    pid_t child = 0;
    EXPECT_EQ(::posix_spawn(&child, CLEAVE_PROGRAM, nullptr, nullptr, arguments.data(), environ), 0);
    while (names().size() <= before && ::waitpid(child, nullptr, WNOHANG) == 0) ::sched_yield();
    for (int k = 0; k < yields; ++k) ::sched_yield();
    std::this_thread::sleep_for(later);
    EXPECT_EQ(::kill(child, SIGINT), 0);
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
};

}  // namespace cleave::cli::test
