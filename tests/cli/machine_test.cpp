#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>

#include <array>

#include "program.hpp"
#include "sanitized.hpp"

// What happens when the machine fails or the user interrupts.
namespace cleave::cli::test {
namespace {

using support::sanitized;

class MachineTest : public ProgramTest {
 protected:
  /// `planes` an axis: (planes + 1)^3 blocks.
  void write_grid(int planes) const {
    std::string table = "dip,dip_direction,x,y,z\n";
    for (int i = 1; i <= planes; ++i) {
      const std::string at = std::to_string(i);
      table += "0,0,0,0," + at + "\n90,0,0," + at + ",0\n90,90," + at + ",0,0\n";
    }
    const std::string side = std::to_string(planes + 1);
    write("g.csv", table);
    write("g.toml", "[domain]\nbox = { min = [0, 0, 0], max = [" + side + ", " + side + ", " + side +
                        "] }\n[[joint]]\nfile = \"g.csv\"\n");
  }
};

TEST_F(MachineTest, FullDiskLeavesNothing) {
  write("s.toml", small_scene);
  const Ended ended = shell("ulimit -f 1; cleave run s.toml -o a/out");
  EXPECT_EQ(ended.code, 3);
  EXPECT_NE(ended.err.find("error: "), std::string::npos) << ended.err;
  EXPECT_EQ(names(), (std::vector<std::string>{"s.toml"}));
}

TEST_F(MachineTest, FullDiskKeepsTheOldResult) {
  write("s.toml", std::string{small_scene} + "groups = \"off\"\n");
  ASSERT_EQ(cleave("run s.toml --quiet -o out").code, 0);
  const std::string before = read("out/summary.json");
  EXPECT_EQ(shell("ulimit -f 1; cleave run s.toml --quiet --seed 5 -o out").code, 3);
  EXPECT_EQ(read("out/summary.json"), before);
  EXPECT_EQ(names(), (std::vector<std::string>{"out", "s.toml"}));
}

TEST_F(MachineTest, MemoryLimitIsTheMachinesFault) {
  if (sanitized) GTEST_SKIP() << "sanitizers reserve terabytes";
  write_grid(59);
  const Ended ended = shell("ulimit -v 250000; cleave run g.toml --threads 1 --quiet -o out");
  EXPECT_EQ(ended.code, 3);
  EXPECT_TRUE(ended.err.starts_with("error: memory: ")) << ended.err;
  EXPECT_FALSE(exists("out"));
}

TEST_F(MachineTest, TheLimitAskedForIsHonoured) {
  if (!sanitized) {
    write_grid(59);
    const Ended refused = shell("cleave run g.toml -o out --threads 2 --quiet --memory '100 MB'");
    EXPECT_EQ(refused.code, 3) << refused.err;
    EXPECT_TRUE(refused.err.starts_with("error: memory: ")) << refused.err;
    EXPECT_EQ(names(), (std::vector<std::string>{"g.csv", "g.toml"}));
  }
  write("s.toml", small_scene);
  if (!sanitized) {
    EXPECT_EQ(cleave("run s.toml -o out --threads 2 --quiet --memory 1GB").code, 0);
  }
  for (const std::string wrong : {"4", "-1", "much", "'10 MB'"}) {
    const Ended ended = cleave("run s.toml -o other --quiet --memory " + wrong);
    EXPECT_EQ(ended.code, 2) << wrong;
    EXPECT_TRUE(ended.err.contains("--memory")) << ended.err;
  }
}

TEST_F(MachineTest, OutputThatCannotBePrintedIsTheMachinesFault) {
  EXPECT_EQ(shell("cleave init tunnel > /dev/full").code, 3);
}

// A reader that goes away leaves no folder behind.
TEST_F(MachineTest, ABrokenPipeLeavesAWholeResult) {
  write_grid(3);
  const Ended ended = shell("(cleave run g.toml -o out; echo $? > code) | true");
  EXPECT_EQ(ended.code, 0);
  EXPECT_TRUE(exists("out/summary.json"));
  EXPECT_EQ(names(), (std::vector<std::string>{"code", "g.csv", "g.toml", "out"}));
}

TEST_F(MachineTest, InterruptEndsWith130AndLeavesNothing) {
  write_grid(sanitized ? 19 : 59);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    const std::string scene = path("g.toml").string(), out = path("out").string();
    std::array<std::string, 6> words{"cleave", "run", scene, "-o", out, "--quiet"};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_t child = 0;
    ASSERT_EQ(::posix_spawn(&child, CLEAVE_PROGRAM, nullptr, nullptr, arguments.data(), environ), 0);
    // It works as soon as its temporary folder stands beside OUT.
    while (names().size() < 3 && ::waitpid(child, nullptr, WNOHANG) == 0) ::sched_yield();
    ASSERT_EQ(::kill(child, signal), 0);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 130);
    EXPECT_EQ(names(), (std::vector<std::string>{"g.csv", "g.toml"}));
  }
}

}  // namespace
}  // namespace cleave::cli::test
