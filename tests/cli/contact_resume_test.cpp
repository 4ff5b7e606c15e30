#include "resume_support.hpp"

// Runs in contact that were stopped: what they leave, and how a later run goes on.
namespace cleave::cli::test {
namespace {

class ContactResumeTest : public ResumeTest {
 protected:
  static constexpr std::size_t files = 12;  // seven frames and their list, four tables, the state
  [[nodiscard]] static std::string scene(const std::string& duration, const std::string& more = {}) {
    return "[rock]\nyoung = 2e8\npoisson = 0.25\n[joints.default]\nfriction = 35\ncohesion = 2e3\n[contact]\nstep = "
           "0.002\nrigid = false\nmodes = 8\nframes = 6\npoints = [{ name = \"p\", at = [0.5, 1] }]\nduration = " +
           duration + "\n" + more +
           "[[body]]\nname = \"ground\"\nfixed = true\nrectangle = { corner = [-5, -1], width = 10, height = 1 }\n"
           "[[body]]\nname = \"block\"\nrectangle = { corner = [-0.5, 0], width = 1, height = 1 }\n"
           "[[body]]\nname = \"above\"\nvelocity = [0.4, 0]\nrectangle = { corner = [-0.4, 1.01], width = 0.8, height "
           "= 0.5 }\n";
  }
};

TEST_F(ContactResumeTest, AnInterruptedRunGoesOnByTheSameCommandAndEndsTheSame) {
  // A ground that moves lets nothing fall asleep: seconds of processor time.
  write("s.toml", scene("4", "ground = { acceleration = [1, 0], time = { kind = \"harmonic\", frequency = 3 } }\n"));
  ASSERT_EQ(cleave("run s.toml --quiet -o whole").code, 0);
  double before = -1;
  for (int round = 0; round < 3; ++round) {
    const int code = interrupted("s.toml", "out", 100 * round);
    if (round > 0 && code == 0) break;  // it was through before
    ASSERT_EQ(code, 130);
    EXPECT_EQ(names(), (std::vector<std::string>{"out", "s.toml", "whole"}));
    const json contact = json::parse(read("out/summary.json"))["contact"];
    EXPECT_EQ(contact["status"], "stopped");
    EXPECT_TRUE(contact["reason"].get<std::string>().starts_with("interrupted at "));
    EXPECT_GE(contact["end_time_s"].get<double>(), before);
    before = contact["end_time_s"].get<double>();
    EXPECT_LE(before, 4);
    EXPECT_TRUE(exists("out/contact.state"));
  }
  const Ended ended = cleave("run s.toml --quiet -o out");
  ASSERT_EQ(ended.code, 0) << ended.err;
  expect_same("whole", "out", files);
  // What came to its end begins again.
  const std::string first = read("out/contact.state");
  ASSERT_EQ(cleave("run s.toml --quiet -o out").code, 0);
  EXPECT_TRUE(read("out/contact.state") == first);
}

TEST_F(ContactResumeTest, ARunThatStoppedByItsStatusGoesOnWhereMoreIsAllowed) {
  write("s.toml", scene("0.3"));
  ASSERT_EQ(cleave("run s.toml --quiet -o whole").code, 0);
  const double work = summary("whole")["contact"]["work"].get<double>();
  write("half.toml", scene("0.3", "work = " + std::to_string(work / 2) + "\n"));
  ASSERT_EQ(cleave("run half.toml --quiet -o half").code, 4);
  ASSERT_LT(summary("half")["contact"]["end_time_s"].get<double>(), 0.29);
  // From its folder, from its file, and into the folder it comes from.
  for (const std::string where : {"half -o a", "half/contact.state -o b", "half -o half"}) {
    const Ended ended = cleave("run s.toml --quiet --resume " + where);
    ASSERT_EQ(ended.code, 0) << ended.err;
  }
  for (const std::string out : {"a", "b", "half"}) expect_same("whole", out, files);
}

TEST_F(ContactResumeTest, StatesThatCannotBeGoneOnFromAreRefused) {
  write("s.toml", scene("0.02"));
  ASSERT_EQ(cleave("run s.toml --quiet -o whole").code, 0);
  const auto refused = [&](const std::string& scene_file, const std::string& from, const std::string& why) {
    const Ended ended = cleave("run " + scene_file + " --quiet -o out --resume " + from);
    EXPECT_EQ(ended.code, 2) << from;
    EXPECT_TRUE(ended.err.starts_with("error: ")) << ended.err;
    EXPECT_NE(ended.err.find(why), std::string::npos) << ended.err;
    EXPECT_FALSE(exists("out"));
  };
  refused("s.toml", "nowhere", "nowhere:1: state: ");
  refused("s.toml", "s.toml", "s.toml:1: state: is no state of a run in contact");
  const std::string state = read("whole/contact.state");
  write("short.state", state.substr(0, state.size() / 2));
  refused("s.toml", "short.state", "short.state:1: state: is cut short or damaged");
  write("other.toml", scene("0.02", "gravity = 5\n"));
  refused("other.toml", "whole", "is of another scene");
  write("blocks.toml", small_scene);
  refused("blocks.toml", "whole", "--resume: the scene has no bodies in contact");
  // An interrupted run whose state is damaged is not thrown away.
  ASSERT_EQ(cleave("run s.toml --quiet -o kept").code, 0);
  json summary = json::parse(read("kept/summary.json"));
  summary["contact"]["reason"] = "interrupted at 0.01 s";
  write("kept/summary.json", summary.dump());
  write("kept/contact.state", state.substr(0, state.find('\n') + 1));
  const Ended ended = cleave("run s.toml --quiet -o kept");
  EXPECT_EQ(ended.code, 2);
  EXPECT_NE(ended.err.find("kept/contact.state:1: state: is cut short or damaged"), std::string::npos) << ended.err;
}

}  // namespace
}  // namespace cleave::cli::test
