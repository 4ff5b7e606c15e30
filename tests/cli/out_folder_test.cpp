#include "program.hpp"

// What may stand at OUT, and what is left there.
namespace cleave::cli::test {
namespace {

class OutFolderTest : public ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    write("s.toml", small_scene);
  }
  [[nodiscard]] Ended run(const std::string& out) const { return cleave("run s.toml --quiet -o " + out); }
};

const std::vector<std::string> result_files{"blocks.vtu", "border_blocks.csv", "key_blocks.csv", "key_groups.csv",
                                            "log.txt",    "report.html",       "scene.toml",     "summary.json"};

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> result;
  for (const auto& entry : fs::directory_iterator{folder}) result.push_back(entry.path().filename().string());
  std::ranges::sort(result);
  return result;
}

TEST_F(OutFolderTest, MissingFoldersAboveAreMade) {
  EXPECT_EQ(run("a/b/out/").code, 0);
  EXPECT_EQ(names_in(path("a/b/out")), result_files);
  EXPECT_EQ(names_in(path("a/b")), (std::vector<std::string>{"out"}));
}

TEST_F(OutFolderTest, EmptyFolderIsReplaced) {
  fs::create_directory(path("out"));
  EXPECT_EQ(run("out").code, 0);
  EXPECT_EQ(names_in(path("out")), result_files);
  EXPECT_EQ(names(), (std::vector<std::string>{"out", "s.toml"}));
}

TEST_F(OutFolderTest, FinishedResultIsReplacedAsAWhole) {
  ASSERT_EQ(run("out").code, 0);
  write("s.toml", std::string{small_scene} + "[output]\nvtu = false\n");
  ASSERT_EQ(run("out").code, 0);
  EXPECT_FALSE(exists("out/blocks.vtu"));
  EXPECT_EQ(names(), (std::vector<std::string>{"out", "s.toml"}));
}

TEST_F(OutFolderTest, FolderWithOtherFilesIsRefusedAndUntouched) {
  fs::create_directory(path("out"));
  write("out/thesis.doc", "precious");
  const Ended ended = run("out");
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(ended.err.starts_with("error: out:1: -o: the folder holds \"thesis.doc\"")) << ended.err;
  EXPECT_EQ(names_in(path("out")), (std::vector<std::string>{"thesis.doc"}));
  EXPECT_EQ(read("out/thesis.doc"), "precious");
}

TEST_F(OutFolderTest, ResultWithAStrangersFileIsRefused) {
  ASSERT_EQ(run("out").code, 0);
  write("out/notes.txt", "mine");
  EXPECT_EQ(run("out").code, 2);
  EXPECT_EQ(read("out/notes.txt"), "mine");
}

TEST_F(OutFolderTest, OurNamesWithoutOurSummaryAreRefused) {
  fs::create_directory(path("out"));
  write("out/log.txt", "somebody else's log");
  EXPECT_EQ(run("out").code, 2);
  write("out/summary.json", "{ \"other\": 1 }");
  EXPECT_EQ(run("out").code, 2);
  EXPECT_EQ(read("out/log.txt"), "somebody else's log");
}

TEST_F(OutFolderTest, FilesAndDeadLinksAreRefused) {
  write("out", "a file");
  EXPECT_EQ(run("out").code, 2);
  EXPECT_EQ(read("out"), "a file");
  fs::create_symlink("nowhere", path("link"));
  EXPECT_EQ(run("link").code, 2);
  EXPECT_EQ(run("''").code, 2);
}

TEST_F(OutFolderTest, LinkToAFolderKeepsTheLink) {
  fs::create_directory(path("real"));
  fs::create_symlink("real", path("link"));
  EXPECT_EQ(run("link").code, 0);
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(names_in(path("real")), result_files);
}

TEST_F(OutFolderTest, TheTextOfTheSceneIsKept) {
  EXPECT_EQ(run("out").code, 0);
  EXPECT_EQ(read("out/scene.toml"), small_scene);
  write("s.toml", std::string{small_scene} + "# another day\n");
  EXPECT_EQ(run("out").code, 0);
  EXPECT_EQ(read("out/scene.toml"), read("s.toml"));
  EXPECT_EQ(names_in(path("out")), result_files);
  // It is a scene: it gives the same result where it lies.
  EXPECT_EQ(cleave("run out/scene.toml --quiet -o again").code, 0);
  EXPECT_EQ(read("again/key_blocks.csv"), read("out/key_blocks.csv"));
  write("plane.toml",
        "[rock]\nyoung = 1e9\npoisson = 0.2\n[[body]]\noutline = [[0, 0], [1, 0], [1, 1], [0, 1]]\n"
        "support = [{ side = 1, kind = \"fixed\" }]\nload = [{ side = 3, pressure = 1e5 }]\n");
  const Ended plane = cleave("run plane.toml --quiet -o plane");
  EXPECT_EQ(plane.code, 0) << plane.err;
  EXPECT_EQ(read("plane/scene.toml"), read("plane.toml"));
}

TEST_F(OutFolderTest, TheFolderOneStandsInStaysTheSame) {
  fs::create_directory(path("out"));
  EXPECT_EQ(
      shell("cd out && cleave run ../s.toml --quiet -o . && cleave run ../s.toml --quiet -o . && ls > ../list").code,
      0);
  EXPECT_EQ(read("list"),
            "blocks.vtu\nborder_blocks.csv\nkey_blocks.csv\nkey_groups.csv\nlog.txt\nreport.html\nscene.toml\nsummary."
            "json\n");
  EXPECT_EQ(names_in(path("out")), result_files);
}

TEST_F(OutFolderTest, NotWritableIsTheMachinesFault) {
  const Ended ended = run("/proc/cleave-out");
  EXPECT_EQ(ended.code, 3);
  EXPECT_TRUE(ended.err.starts_with("error: /proc/cleave-out:1: -o: ")) << ended.err;
  if (::geteuid() == 0) return;  // root writes everywhere else
  fs::create_directory(path("closed"));
  fs::permissions(path("closed"), fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_EQ(run("closed/out").code, 3);
  fs::permissions(path("closed"), fs::perms::owner_all);
}

// What a killed run leaves is taken away by the next one, also where both have the same process number, as in a
// container; what a living run still writes to is not.
TEST_F(OutFolderTest, FoldersOfKilledRunsAreTakenAway) {
  for (const char* left : {"out.cleave-1", "out.cleave-77-0", "out.cleave-77-1.dead"}) {
    fs::create_directory(path(left));
    write(std::string{left} + "/blocks.vtu", "half");
    // More names than one look at a folder tells, and folders in it.
    for (int k = 0; k < 300; ++k) write(std::string{left} + "/section_" + std::to_string(k) + ".toml", "");
    fs::create_directories(path(left) / "realization_1" / "deeper");
    write(std::string{left} + "/realization_1/deeper/summary.json", "half");
  }
  fs::create_directory(path("out.cleave-mine"));
  fs::create_directory(path("other.cleave-1-0"));
  EXPECT_EQ(shell("mkdir out.cleave-$$-0; exec '" CLEAVE_PROGRAM "' run s.toml --quiet -o out").code, 0);
  EXPECT_EQ(names(), (std::vector<std::string>{"other.cleave-1-0", "out", "out.cleave-mine", "s.toml"}));
  // One that was killed inside its folder.
  fs::create_directory(path("out/.cleave-5-0"));
  EXPECT_EQ(run("out").code, 0);
  EXPECT_EQ(names_in(path("out")), result_files);
}

TEST_F(OutFolderTest, FoldersOfLivingRunsStay) {
  fs::create_directory(path("out.cleave-1-0"));
  const Ended ended = shell("exec 9<out.cleave-1-0; flock 9; cleave run s.toml --quiet -o out");
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(exists("out.cleave-1-0"));
  EXPECT_EQ(run("out").code, 0);
  EXPECT_FALSE(exists("out.cleave-1-0"));
}

TEST_F(OutFolderTest, WrongInputTakesFoldersAboveAwayAgain) {
  write("s.toml",
        "[domain]\nbox = { min = [0, 0, 0], max = [8, 8, 6] }\n[[excavation]]\nkind = \"polyhedron\"\nbox = { min = "
        "[-1, -1, -1], "
        "max = [9, 9, 9] }\n");
  EXPECT_EQ(run("a/b/out").code, 2);
  EXPECT_EQ(names(), (std::vector<std::string>{"s.toml"}));
}

}  // namespace
}  // namespace cleave::cli::test
