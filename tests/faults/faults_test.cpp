/// What fails under a run: memory, files, disks, and the run itself, killed. The n-th call of a kind fails, for many n:
/// exit code 0 with the whole result or 3 with a message, never half a result, never a folder left behind.

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "../cli/program.hpp"

namespace cleave::cli::test {
namespace {

struct Kind {
  std::string name, scene;
  std::string command = "run s.toml -o out --threads 1 --quiet";
};

void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

std::string blocks() { return std::string{small_scene} + "groups = \"off\"\n"; }

constexpr std::string_view two_blocks = R"toml(schema = 1
[contact]
duration = 0.05
[[body]]
name = "floor"
outline = [[-2, -1], [2, -1], [2, 0], [-2, 0]]
fixed = true
[[body]]
name = "block"
outline = [[-0.5, 0.01], [0.5, 0.01], [0.5, 1], [-0.5, 1]]
)toml";

constexpr std::string_view plate = R"toml(schema = 1
[rock]
young = 10e9
poisson = 0.2
[elastic]
element = 0.5
[[body]]
name = "plate"
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
support = [{ side = 1, kind = "roller" }, { side = 4, kind = "roller" }]
load = [{ side = 3, pressure = 1e6 }]
)toml";

class FaultsTest : public ProgramTest, public testing::WithParamInterface<Kind> {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    write("s.toml", GetParam().scene);
    ASSERT_EQ(cleave(GetParam().command).code, 0);
    whole_ = result();
    fs::remove_all(path("out"));
  }

  /// Runs with one fault, see shim.cpp.
  [[nodiscard]] Ended with(const std::string& fault) const {
    return shell("LD_PRELOAD='" CLEAVE_FAULTS_SHIM "' CLEAVE_FAULT=" + fault + " CLEAVE_FAULT_COUNT='" +
                 folder().string() + ".count' '" CLEAVE_PROGRAM "' " + GetParam().command);
  }
  [[nodiscard]] long count_of(const std::string& call) const {
    fs::remove_all(path("out"));
    EXPECT_EQ(with(call + ":0:EIO").code, 0);
    const long n = counted();
    fs::remove_all(path("out"));
    return n;
  }
  /// Calls of the run that ended last.
  [[nodiscard]] long counted() const {
    const fs::path count = folder().string() + ".count";
    const long n = std::strtol(text_of(count).c_str(), nullptr, 10);
    fs::remove(count);
    return n;
  }
  /// What a finished run left, without what tells of time and memory.
  [[nodiscard]] std::map<std::string, std::string> result() const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::directory_iterator{path("out")}) {
      std::string name = entry.path().filename().string();
      if (name.ends_with(".part")) continue;  // what a run has done so far stands beside the result it will replace
      std::string text = text_of(entry.path());
      if (name == "log.txt" || name == "report.html") text = text.empty() ? "empty" : "there";
      if (name == "summary.json") {
        nlohmann::json summary = nlohmann::json::parse(text);
        summary.erase("cost");
        summary.erase("realization_cost");
        text = summary.dump();
      }
      files.emplace(std::move(name), std::move(text));
    }
    return files;
  }

  /// Files that are not those of a finished run.
  [[nodiscard]] std::vector<std::string> differing() const {
    const auto now = result();
    std::vector<std::string> names;
    for (const auto& [name, text] : whole_) {
      if (!now.contains(name) || now.at(name) != text) names.push_back(name);
    }
    for (const auto& [name, text] : now) {
      if (!whole_.contains(name)) names.push_back(name);
    }
    return names;
  }

  /// All n of few; of many, the first and a spread of the rest. CLEAVE_FAULTS=all takes all.
  [[nodiscard]] static std::vector<long> numbers(long count) {
    constexpr long first = 10, spread = 24;
    std::vector<long> out;
    const char* all = std::getenv("CLEAVE_FAULTS");
    const long step = all != nullptr && std::string{all} == "all" ? 1 : std::max(1L, (count - first) / spread);
    for (long n = 1; n <= count; n += n < first ? 1 : step) out.push_back(n);
    return out;
  }

  void expect_whole_or_refused(const std::string& fault, const Ended& ended) const {
    SCOPED_TRACE(GetParam().name + ", " + fault + ": " + ended.err);
    ASSERT_TRUE(ended.code == 0 || ended.code == 3) << ended.code;
    if (ended.code == 0) {
      EXPECT_TRUE(differing().empty()) << differing().front();
    } else {
      EXPECT_TRUE(ended.err.starts_with("error: "));
    }
    // Where memory runs out inside functions of the standard library that let no exception out, a temporary folder may
    // stay; the next run takes it away.
    for (const std::string& name : names()) {
      const bool temporary = fault.starts_with("malloc") && name.starts_with("out.cleave-");
      EXPECT_TRUE(name == "s.toml" || name == "out" || temporary) << "left behind: " << name;
    }
  }

  std::map<std::string, std::string> whole_;
};

TEST_P(FaultsTest, CallsThatFailEndWithAMessageOrTheWholeResult) {
  for (const std::string fault :
       {"malloc:ENOMEM", "open:EMFILE", "write:ENOSPC", "write:EDQUOT", "fsync:EIO", "rename:EIO", "mkdir:ENOSPC"}) {
    const std::string call = fault.substr(0, fault.find(':')), reason = fault.substr(fault.find(':'));
    const long count = count_of(call);
    ASSERT_GT(count, 0) << call;
    bool refused = false;
    for (const long n : numbers(count)) {
      const std::string one = call + ":" + std::to_string(n) + reason;
      const Ended ended = with(one);
      expect_whole_or_refused(one, ended);
      refused = refused || ended.code == 3;
      // What is there counts as a result only with its summary; records of an ensemble may stay to go on from.
      if (ended.code == 3 && exists("out/summary.json")) {
        EXPECT_TRUE(differing().empty()) << differing().front() << one;
      }
      fs::remove_all(path("out"));
    }
    EXPECT_TRUE(refused || call == "rename") << call << " was never missed";
    ASSERT_EQ(cleave(GetParam().command).code, 0);
    EXPECT_EQ(names(), (std::vector<std::string>{"out", "s.toml"}));
    fs::remove_all(path("out"));
  }
}

// The old result is there until the new one is whole: whatever fails, one of the two can be read.
TEST_P(FaultsTest, TheOldResultStaysUntilTheNewOneIsWhole) {
  for (const std::string call : {"write", "rename", "fsync", "mkdir"}) {
    for (const std::string reason : {":EIO", ":KILL"}) {
      for (const long n : numbers(count_of(call))) {
        const std::string one = call + ":" + std::to_string(n) + reason;
        SCOPED_TRACE(one);
        ASSERT_EQ(cleave(GetParam().command).code, 0);
        (void)with(one);
        EXPECT_TRUE(differing().empty()) << differing().front();
        // What a killed run left is taken away by the next.
        ASSERT_EQ(cleave(GetParam().command).code, 0);
        EXPECT_EQ(names(), (std::vector<std::string>{"out", "s.toml"}));
        EXPECT_TRUE(differing().empty()) << differing().front();
        fs::remove_all(path("out"));
      }
    }
  }
}

// Killed at any of its calls, the same command ends with the bytes of a run that was left alone.
TEST_P(FaultsTest, AKilledRunIsMadeAgainWithTheSameBytes) {
  for (const std::string call : {"malloc", "open", "write", "fsync", "rename", "mkdir"}) {
    for (const long n : numbers(count_of(call))) {
      const std::string one = call + ":" + std::to_string(n) + ":KILL";
      SCOPED_TRACE(one);
      // What a run says of its time may take an allocation more or less: the last of one need not come in the next.
      if (with(one).code == 0) {
        EXPECT_LT(counted(), n);
      }
      if (exists("out/summary.json")) {
        EXPECT_TRUE(differing().empty()) << differing().front();
      }
      ASSERT_EQ(cleave(GetParam().command).code, 0);
      EXPECT_TRUE(differing().empty()) << differing().front();
      EXPECT_EQ(names(), (std::vector<std::string>{"out", "s.toml"}));
      fs::remove_all(path("out"));
    }
  }
}

// By the shell's word, or by a signal in the loader: the program's own first line is to catch those.
bool is_loaded(const Ended& ended) { return ended.code != 127 && ended.code != 128 + SIGSEGV; }

// A limit of memory, ever smaller, until the program is not even loaded: the machine's fault, said so.
TEST_P(FaultsTest, LessAndLessMemory) {
  bool refused = false;
  for (int megabytes = 80; megabytes > 0; megabytes -= 2) {
    const std::string limit = "ulimit -v " + std::to_string(megabytes * 1000);
    const Ended ended = shell(limit + "; cleave " + GetParam().command);
    if (!is_loaded(ended)) break;
    expect_whole_or_refused(limit, ended);
    refused = refused || ended.code == 3;
    fs::remove_all(path("out"));
  }
  EXPECT_TRUE(refused);
}

INSTANTIATE_TEST_SUITE_P(Runs, FaultsTest,
                         testing::Values(Kind{"blocks", blocks()},
                                         Kind{"ensemble", blocks() + "[monte_carlo]\nrealizations = 4\n"},
                                         Kind{"contact", std::string{two_blocks}}, Kind{"elastic", std::string{plate}}),
                         [](const auto& of) { return of.param.name; });

// From the least memory with which the program is loaded, in steps of two pages: what is made ahead of main comes
// first.
using MemoryTest = ProgramTest;
TEST_F(MemoryTest, WhatIsMissingAtTheStartIsSaid) {
  const auto with = [&](int kilobytes) {
    return shell("ulimit -v " + std::to_string(kilobytes) + "; cleave --version");
  };
  int loaded = 80'000, too_little = 2'000;
  while (loaded - too_little > 4) {
    const int middle = (loaded + too_little) / 2;
    (is_loaded(with(middle)) ? loaded : too_little) = middle;
  }
  for (int more = 0; more < 2'400; more += 8) {
    SCOPED_TRACE(loaded + more);
    const Ended ended = with(loaded + more);
    EXPECT_TRUE(ended.code == 0 || (ended.code == 3 && ended.err.starts_with("error: memory"))) << ended.err;
  }
}

}  // namespace
}  // namespace cleave::cli::test
