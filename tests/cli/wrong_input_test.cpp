#include <regex>

#include "program.hpp"

// Wrong input: exit code 2, every line of stderr names file, line, key, what is wrong and what to do, and nothing is
// written.
namespace cleave::cli::test {
namespace {

class WrongInputTest : public ProgramTest {
 protected:
  /// Runs `run` and `check` on the scene and returns what they say, which must be the same.
  [[nodiscard]] std::string refusal(const std::string& scene) const {
    const auto before = names();
    const Ended run = cleave("run '" + scene + "' -o out --quiet");
    EXPECT_EQ(run.code, 2);
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(names(), before);
    std::istringstream lines{run.err};
    const std::regex form{"error: [^:]+:[0-9]+: [^;]+: [^;]+; .+"};
    for (std::string line; std::getline(lines, line);) EXPECT_TRUE(std::regex_match(line, form)) << line;
    EXPECT_NE(run.err, "");
    return run.err;
  }
  void expect_both(const std::string& scene, std::string_view start) const {
    const std::string run = refusal(scene);
    EXPECT_TRUE(run.starts_with(start)) << run;
    const Ended check = cleave("check '" + scene + "'");
    EXPECT_EQ(check.code, 2);
    EXPECT_EQ(check.err, run);
    EXPECT_EQ(cleave("plan '" + scene + "'").code, 2);
  }
  void expect_text(std::string_view text, std::string_view start) const {
    write("s.toml", text);
    expect_both("s.toml", start);
  }
};

constexpr std::string_view box = "[domain]\nbox = { min = [0, 0, 0], max = [8, 8, 6] }\n";
std::string with_box(std::string_view more) { return std::string{box} + std::string{more}; }

TEST_F(WrongInputTest, Empty) { expect_text("", "error: s.toml:1: domain: "); }
TEST_F(WrongInputTest, NotToml) { expect_text("# ok\nsolid cube\n", "error: s.toml:2: TOML: "); }
TEST_F(WrongInputTest, Binary) {
  expect_text(std::string(1000, '\x01') + std::string(10, '\0') + "\xff\xfe", "error: s.toml:1: TOML: ");
}
TEST_F(WrongInputTest, KeysWithoutEnd) {
  std::string endless = "a";
  for (int i = 0; i < 20'000; ++i) endless += ".a";
  const std::string_view refused = "error: s.toml:2: TOML: a dotted key has too many parts";
  expect_text("# ok\n" + endless + " = 1\n", refused);
  expect_text("\n[" + endless + "]\n", refused);
  expect_text("\nx = { " + endless + " = 1 }\n", refused);
  // Dots in strings, comments and numbers are no parts of keys.
  const std::string dots(40, '.');
  const std::string fine =
      "# " + dots + "\ntitle = \"" + dots + "\\\"" + dots + "\"\nseed = '''\n" + dots + "''' # " + dots + "\n";
  expect_text(fine + std::string{box}, "error: s.toml:3: seed: ");
}
TEST_F(WrongInputTest, UnknownKey) {
  expect_text(with_box("[rock]\ndensty = 1\n"), "error: s.toml:4: rock.densty: unknown key; did you mean \"density\"?");
}
TEST_F(WrongInputTest, NotANumber) {
  expect_text(with_box("[rock]\ndensity = nan\n"), "error: s.toml:4: rock.density: ");
}
TEST_F(WrongInputTest, Infinity) {
  expect_text(with_box("[rock]\ndensity = inf\n"), "error: s.toml:4: rock.density: ");
}
TEST_F(WrongInputTest, Enormous) {
  expect_text(with_box("[rock]\ndensity = 1e300\n"), "error: s.toml:4: rock.density: ");
}
TEST_F(WrongInputTest, PolygonOfTwoPoints) {
  expect_text(with_box("[[joint]]\npolygon = [[0,0,0],[1,0,0]]\n"), "error: s.toml:4: joint[1].polygon: ");
}
TEST_F(WrongInputTest, PolygonOnALine) {
  expect_text(with_box("[[joint]]\npolygon = [[0,0,0],[1,1,1],[3,3,3]]\n"), "error: s.toml:4: joint[1].polygon: ");
}
TEST_F(WrongInputTest, PolygonCrossesItself) {
  expect_text(with_box("[[joint]]\npolygon = [[0,0,0],[1,1,0],[1,0,0],[0,1,0]]\n"),
              "error: s.toml:4: joint[1].polygon: ");
}
TEST_F(WrongInputTest, PolygonWithoutArea) {
  expect_text(with_box("[[joint]]\npolygon = [[1,1,1],[1,1,1],[1,1,1]]\n"), "error: s.toml:4: joint[1].polygon: ");
}
TEST_F(WrongInputTest, PolygonNotPlanar) {
  expect_text(with_box("[[joint]]\npolygon = [[0,0,0],[4,0,0],[4,4,1],[0,4,0]]\n"),
              "error: s.toml:4: joint[1].polygon: ");
}
TEST_F(WrongInputTest, DomainOfZeroVolume) {
  expect_text("[domain]\nbox = { min = [0,0,0], max = [8,0,6] }\n", "error: s.toml:2: domain.box: ");
}
TEST_F(WrongInputTest, DomainOfNegativeVolume) {
  expect_text("[domain]\nbox = { min = [0,0,7], max = [8,8,6] }\n", "error: s.toml:2: domain.box: has negative volume");
}
TEST_F(WrongInputTest, CornersOfAFlatDomain) {
  expect_text("[domain]\ncorners = [[0,0,0],[1,0,0],[0,1,0],[1,1,0],[0,0,0],[1,0,0],[0,1,0],[1,1,0]]\n",
              "error: s.toml:2: domain.corners: ");
}
TEST_F(WrongInputTest, NegativeFriction) {
  expect_text(with_box("[joints.A]\nfriction = -1\n"), "error: s.toml:4: joints.A.friction: ");
}
TEST_F(WrongInputTest, DensityZero) {
  expect_text(with_box("[rock]\ndensity = 0\n"), "error: s.toml:4: rock.density: ");
}

TEST_F(WrongInputTest, ExcavationSwallowsTheDomain) {
  write("s.toml", with_box("[[excavation]]\nkind = \"polyhedron\"\nbox = { min = [-1, -1, -1], max = [9, 9, 9] }\n"));
  const std::string told = refusal("s.toml");
  EXPECT_TRUE(told.starts_with("error: s.toml:3: excavation: ")) << told;
}

TEST_F(WrongInputTest, MissingSceneAndFolderAsScene) {
  expect_both("none.toml", "error: none.toml:1: scene: the file does not exist; ");
  fs::create_directory(path("dir.toml"));
  expect_both("dir.toml", "error: dir.toml:1: scene: is a folder; ");
}

TEST_F(WrongInputTest, MissingJointAndMeshFilesAreLookedForBesideTheScene) {
  fs::create_directory(path("sub"));
  write("j.obj", "v 0 0 0\n");  // not there: the scene is in sub
  write("sub/s.toml", with_box("[[joint]]\nfile = \"j.obj\"\n"));
  expect_both("sub/s.toml", "error: sub/s.toml:4: joint[1].file: the file does not exist; ");
}

TEST_F(WrongInputTest, UnreadableFile) {
  if (::geteuid() == 0) GTEST_SKIP() << "root reads everything";
  write("s.toml", box);
  fs::permissions(path("s.toml"), fs::perms::none);
  expect_both("s.toml", "error: s.toml:1: scene: the file cannot be opened; ");
}

TEST_F(WrongInputTest, PipesAreNotWaitedFor) {
  ASSERT_EQ(shell("mkfifo s.toml").code, 0);
  expect_both("s.toml", "error: s.toml:1: scene: is not a regular file; ");
}

TEST_F(WrongInputTest, HugeFilesAreRefusedUnread) {
  write("s.toml", with_box("[[joint]]\nfile = \"j.obj\"\n"));
  write("j.obj", "");
  fs::resize_file(path("j.obj"), 20'000'000'000);  // sparse
  expect_both("s.toml", "error: s.toml:4: joint[1].file: the file has 20000000000 bytes");
  write("big.toml", "");
  fs::resize_file(path("big.toml"), 20'000'000'000);
  expect_both("big.toml", "error: big.toml:1: scene: the file has 20000000000 bytes");
}

TEST_F(WrongInputTest, TruncatedFiles) {
  write("s.toml", "[domain]\nmesh = \"d.stl\"\n");
  write("d.stl", "solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0");
  expect_both("s.toml", "error: d.stl:");
  write("d.stl", std::string(84 + 20, '\0'));
  expect_both("s.toml", "error: d.stl:");
}

TEST_F(WrongInputTest, MeshesThatEncloseNothing) {
  write("s.toml", "[domain]\nmesh = \"d.obj\"\n");
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  write("d.obj", vertices + "f 1 3 2\nf 1 2 4\nf 2 3 4\n");  // open
  expect_both("s.toml", "error: s.toml:2: domain.mesh: d.obj: ");
  write("d.obj", vertices + "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 4\n");  // inside out
  expect_both("s.toml", "error: s.toml:2: domain.mesh: d.obj: ");
  write("d.obj", vertices + "v 1 1 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\nf 1 2 5\n");  // an edge of three faces
  expect_both("s.toml", "error: s.toml:2: domain.mesh: d.obj: ");
  // Two tetrahedra that run through each other.
  write("d.obj",
        vertices +
            "v 0.1 0.1 -0.5\nv 0.3 0.1 -0.5\nv 0.1 0.3 -0.5\nv 0.1 0.1 0.5\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
            "f 5 7 6\nf 5 6 8\nf 6 7 8\nf 5 8 7\n");
  expect_both("s.toml", "error: s.toml:2: domain.mesh: d.obj: ");
}

TEST_F(WrongInputTest, DomeOfMasonryIsNotAManifold) {
  const fs::path dome = fs::path{CLEAVE_SOURCE_DIR} / "tests/data/masonry_meshes/dome_first_block.obj";
  write("s.toml", "[domain]\nmesh = \"" + dome.string() + "\"\n");
  EXPECT_TRUE(refusal("s.toml").starts_with("error: s.toml:2: domain.mesh: "));
}

TEST_F(WrongInputTest, JointOutsideAndNoJointsAreNotesOnly) {
  write("s.toml", with_box("[[joint]]\ndisc = { centre = [100, 4, 3], dip = 60, dip_direction = 270, radius = 2 }\n"));
  const Ended check = cleave("check s.toml");
  EXPECT_EQ(check.code, 0);
  EXPECT_TRUE(check.out.starts_with("note: s.toml:4: joint: lies wholly outside the domain; ")) << check.out;
  EXPECT_EQ(cleave("run s.toml --quiet -o out").code, 0);
  write("t.toml", box);
  EXPECT_EQ(cleave("run t.toml --quiet -o out").code, 0);
}

TEST_F(WrongInputTest, SectionsOfPlaneScenesAreRefusedBesideADomain) {
  for (const std::string section : {"[[contact]]", "[contact]"}) {
    write("s.toml", with_box(section + "\n"));
    const std::string told = refusal("s.toml");
    EXPECT_NE(told.find("belongs to scenes in two dimensions"), std::string::npos) << told;
  }
}

}  // namespace
}  // namespace cleave::cli::test
