#include "resume_support.hpp"

// Blocks in motion that were stopped: what is left, and how a later run goes on.
namespace cleave::cli::test {
namespace {

class MotionResumeTest : public ResumeTest {
 protected:
  static constexpr std::size_t files = 8;  // blocks, key blocks and groups, five frames and their list, the state

  /// A block on a plane that dips 40 degrees east, open at its foot and its top.
  [[nodiscard]] static std::string scene(const std::string& motion, const std::string& friction = "20") {
    return "[domain]\nbox = { min = [0, 0, 0], max = [30, 6, 14] }\n"
           "[[joint]]\nplane = { through = [14, 3, 6], dip = 40, dip_direction = 90 }\n"
           "[[joint]]\nplane = { through = [9, 3, 8], dip = 80, dip_direction = 270 }\n"
           "[[joint]]\nplane = { through = [12, 2, 6], dip = 89, dip_direction = 180 }\n"
           "[[joint]]\nplane = { through = [12, 4, 6], dip = 89, dip_direction = 0 }\n"
           "[joints.default]\nfriction = " +
           friction +
           "\n[rock]\ndensity = 2600\n[[excavation]]\nkind = \"slope\"\n"
           "profile = { direction = 90, points = [[0, 12], [11, 12], [15, 4], [30, 4]] }\n"
           "[stability]\ngroups = \"off\"\n[motion]\nerror = false\n" +
           motion;
  }
};

TEST_F(MotionResumeTest, AnInterruptedRunGoesOnByTheSameCommandAndEndsTheSame) {
  write("s.toml", scene("duration = 0.2\nframe = 0.05\nstep = 0.002\n"));
  ASSERT_EQ(cleave("run s.toml --quiet -o whole").code, 0);
  // What is cut is left at once, with nothing written; from the first step on the run is kept.
  for (auto later = std::chrono::microseconds{2000}; !exists("out"); later += later / 2) {
    ASSERT_EQ(interrupted("s.toml", "out", 0, later), 130) << later.count();
  }
  const json motion = json::parse(read("out/summary.json"))["motion"];
  EXPECT_EQ(motion["status"], "stopped");
  EXPECT_TRUE(motion["reason"].get<std::string>().starts_with("interrupted at "));
  EXPECT_LT(motion["end_s"].get<double>(), 0.2);
  EXPECT_TRUE(exists("out/motion.csv"));
  const Ended ended = cleave("run s.toml --quiet -o out");
  ASSERT_EQ(ended.code, 0) << ended.err;
  expect_same("whole", "out", files);
}

TEST_F(MotionResumeTest, AShortRunGoesOnForLongerAndOthersAreRefused) {
  write("short.toml", scene("frame = 0.05\nduration = 0.05\n"));
  write("long.toml", scene("frame = 0.05\nduration = 0.2\n"));
  write("other.toml", scene("frame = 0.05\nduration = 0.2\n", "21"));
  ASSERT_EQ(cleave("run short.toml --quiet -o short").code, 0);
  ASSERT_EQ(cleave("run long.toml --quiet -o whole").code, 0);
  const Ended ended = cleave("run long.toml --quiet -o out --resume short");
  ASSERT_EQ(ended.code, 0) << ended.err;
  expect_same("whole", "out", files);
  const auto refused = [&](const std::string& scene_file, const std::string& from, const std::string& why) {
    const Ended end = cleave("run " + scene_file + " --quiet -o no --resume " + from);
    EXPECT_EQ(end.code, 2) << from;
    EXPECT_NE(end.err.find(why), std::string::npos) << end.err;
    EXPECT_FALSE(exists("no"));
  };
  refused("other.toml", "short/motion.state", "short/motion.state:1: state: is of another scene");
  refused("long.toml", "nowhere", "nowhere:1: state: ");
  refused("long.toml", "long.toml", "is no state of a run of blocks in motion");
  const std::string state = read("short/motion.state");
  write("cut.state", state.substr(0, state.size() - 100));
  refused("long.toml", "cut.state", "cut.state:1: state: is cut short or damaged");
  refused("short.toml", "whole", "motion.duration");
}

TEST_F(MotionResumeTest, AReplayLetsTheKeyBlocksOfARealizationGo) {
  const std::string motion = scene("duration = 0.05\n"), at = "[motion]\nerror = false\n";
  std::string plain = motion.substr(0, motion.find(at)) + "[monte_carlo]\nrealizations = 3\n";
  const std::string fixed = "friction = 20";
  plain.replace(plain.find(fixed), fixed.size(), "friction = { distribution = \"uniform\", min = 15, max = 45 }");
  write("plain.toml", plain);
  write("near.toml", plain + "[output]\nblocks = \"key\"\n");
  write("moving.toml", plain + "[motion]\nduration = 0.05\nerror = false\n");
  for (const std::string name : {"plain", "near", "moving"}) {
    ASSERT_EQ(cleave("run " + name + ".toml --quiet -o " + name).code, 0) << name;
    const std::string option = name == "moving" ? "" : " --motion 0.05";
    const Ended ended = cleave("replay " + name + " --realization 1" + option);
    ASSERT_EQ(ended.code, 0) << name << ended.err;
    EXPECT_NE(ended.out.find("is reproduced to the last digit"), std::string::npos) << ended.out;
    const json summary = json::parse(read(name + "/realization_1/summary.json"));
    ASSERT_TRUE(summary.contains("motion")) << name;
    EXPECT_EQ(summary["motion"]["status"], "converged");
    EXPECT_EQ(summary["motion"]["end_s"].get<double>(), 0.05);
    EXPECT_EQ(summary["motion"]["released"], summary["key_blocks"]["count"]);
    EXPECT_TRUE(exists(name + "/realization_1/motion.csv"));
  }
  EXPECT_FALSE(json::parse(read("moving/summary.json")).contains("motion"));
  EXPECT_EQ(read("plain/realization_1/motion.csv"), read("moving/realization_1/motion.csv"));
  EXPECT_EQ(read("plain/realization_1/motion.csv"), read("near/realization_1/motion.csv"));
  // Without --motion nothing moves that no [motion] lets go.
  ASSERT_EQ(cleave("replay plain --realization 1 --quiet -o still").code, 0);
  EXPECT_FALSE(json::parse(read("still/summary.json")).contains("motion"));
  EXPECT_EQ(cleave("replay plain --realization 1 --quiet -o no --motion -3").code, 2);
}

}  // namespace
}  // namespace cleave::cli::test
