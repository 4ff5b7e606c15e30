#include <string>
#include <vector>

#include "program.hpp"

namespace cleave::cli::test {
namespace {

class DiffTest : public ProgramTest {
 protected:
  void run(const std::string& name, const std::string& more) const {
    write(name + ".toml",
          "title = \"wedge\"\n[domain]\nbox = { min = [0, 0, 0], max = [8, 8, 6] }\n"
          "[[joint]]\nplane = { through = [3.5, 4, 2], dip = 60, dip_direction = 90 }\n"
          "[[joint]]\nplane = { through = [5, 4, 2], dip = 30, dip_direction = 90 }\n"
          "[[joint]]\nplane = { through = [4, 3, 3], dip = 90, dip_direction = 0 }\n"
          "[[joint]]\nplane = { through = [4, 5, 3], dip = 90, dip_direction = 0 }\n"
          "[[excavation]]\nkind = \"polyhedron\"\nbox = { min = [2, 0, 1], max = [6, 8, 2] }\n" +
              more);
    ASSERT_EQ(cleave("run " + name + ".toml --quiet -o " + name).code, 0);
  }
};

TEST_F(DiffTest, TheSameResultHasNoDifference) {
  run("a", "");
  run("b", "");
  const Ended same = cleave("diff a b");
  EXPECT_EQ(same.code, 0) << same.err;
  EXPECT_EQ(same.out, "first   a\nsecond  b\nno difference in scene, plan, counts, volumes, key blocks and notes\n");
}

TEST_F(DiffTest, StrengthChangesKeyBlocksOneByOne) {
  run("weak", "[joints.default]\nfriction = 10\n");
  run("strong", "[joints.default]\nfriction = 80\n");
  const Ended ended = cleave("diff weak strong");
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.out.find("scene_sha256"), std::string::npos) << ended.out;
  EXPECT_EQ(ended.out.find("\nblocks\n"), std::string::npos) << "the block systems are the same\n" << ended.out;
  EXPECT_NE(ended.out.find("\nkey blocks\n  key_blocks.count "), std::string::npos) << ended.out;
  EXPECT_NE(ended.out.find("\nkey blocks, one by one\n  changed ("), std::string::npos) << ended.out;
}

// Numbers of blocks hang on the order of the joints, though the blocks are the same and so is their hash.
TEST_F(DiffTest, BlocksAreKnownByTheirPlaceNotByTheirNumber) {
  const std::vector<std::string> planes{
      "{ through = [3.5, 4, 2], dip = 60, dip_direction = 90 }",
      "{ through = [5, 4, 2], dip = 30, dip_direction = 90 }", "{ through = [4, 2, 3], dip = 90, dip_direction = 0 }",
      "{ through = [4, 5, 3], dip = 90, dip_direction = 0 }", "{ through = [4, 6, 3], dip = 90, dip_direction = 0 }"};
  const auto scene = [&](const std::string& name, bool reversed, const std::string& friction) {
    std::string text = "title = \"wedges\"\n[domain]\nbox = { min = [0, 0, 0], max = [8, 8, 6] }\n";
    for (std::size_t k = 0; k < planes.size(); ++k) {
      text += "[[joint]]\nplane = " + planes[reversed ? planes.size() - 1 - k : k] + "\n";
    }
    write(name + ".toml", text + "[[excavation]]\nkind = \"polyhedron\"\nbox = { min = [2, 0, 1], max = [6, 8, 2] }\n" +
                              "[stability]\ngroups = \"off\"\n[joints.default]\nfriction = " + friction + "\n");
    ASSERT_EQ(cleave("run " + name + ".toml --quiet -o " + name).code, 0);
  };
  scene("one", false, "10");
  scene("other", true, "10");
  ASSERT_NE(read("one/key_blocks.csv"), read("other/key_blocks.csv")) << "the numbers are to differ";
  const std::string same = cleave("diff one other").out;
  EXPECT_FALSE(same.contains("key blocks, one by one")) << same;
  EXPECT_FALSE(same.contains("e-1")) << "last digits are no change\n" << same;
  std::string table = read("other/key_blocks.csv");
  const std::size_t factor = table.find(",0.1018");
  ASSERT_NE(factor, std::string::npos) << table;
  table.replace(factor, table.find(',', factor + 1) - factor, ",inf");
  write("other/key_blocks.csv", table);
  EXPECT_TRUE(cleave("diff one other").out.contains(" -> sliding, batch 1, factor inf\n"));
  scene("strong", true, "80");
  const std::string changed = cleave("diff one strong").out;
  EXPECT_TRUE(changed.contains("\nkey blocks, one by one\n  changed (")) << changed;
  EXPECT_TRUE(changed.contains(" in the second), ")) << changed;
}

TEST_F(DiffTest, AnotherBlockSystem) {
  run("four", "");
  run("five", "[[joint]]\nplane = { through = [1, 4, 3], dip = 90, dip_direction = 90 }\n[output]\nreport = false\n");
  const Ended ended = cleave("diff four five");
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.out.find("  input.joints                                 4 -> 5 (+1, +25 %)\n"), std::string::npos)
      << ended.out;
  EXPECT_NE(ended.out.find("\nplan\n"), std::string::npos) << ended.out;
  EXPECT_NE(ended.out.find("\n  report       runs (report.html) -> left out (output.report = false)\n"),
            std::string::npos)
      << ended.out;
  EXPECT_NE(ended.out.find("\nblocks\n  blocks.count "), std::string::npos) << ended.out;
}

TEST_F(DiffTest, AChangedInputFileIsNamed) {
  write("j.csv", "dip,dip_direction,x,y,z\n30,90,4,4,3\n");
  run("before", "[[joint]]\nfile = \"j.csv\"\n");
  write("j.csv", "dip,dip_direction,x,y,z\n31,90,4,4,3\n");
  run("after", "[[joint]]\nfile = \"j.csv\"\n");
  const Ended ended = cleave("diff before after");
  EXPECT_NE(ended.out.find("\ninput files\n  j.csv is not the same file in both\n"), std::string::npos) << ended.out;
}

TEST_F(DiffTest, NotesThatCameOrWentAreNamed) {
  const auto weak = [](const std::string& friction) { return "[joints.default]\nfriction = " + friction + "\n"; };
  const std::string far = "[[joint]]\nplane = { through = [90, 4, 3], dip = 90, dip_direction = 90 }\n";
  run("a", weak("20"));
  run("b", far + weak("20"));
  run("c", weak("0.6"));
  run("d", "# The name and the line are others.\n" + weak("0.6"));
  run("e", weak("0.7"));
  const std::string come = cleave("diff a b").out, gone = cleave("diff b a").out;
  const std::string outside = "    b.toml:16: joint: lies wholly outside the domain; it cuts nothing and is left out\n";
  EXPECT_TRUE(come.contains("\nnotes\n  only in the second (2):\n" + outside)) << come;
  EXPECT_TRUE(gone.contains("\nnotes\n  only in the first (2):\n" + outside)) << gone;
  EXPECT_FALSE(cleave("diff c d").out.contains("notes\n"));
  const std::string other = cleave("diff c e").out;
  EXPECT_TRUE(other.contains("\nnotes\n  with other figures:\n    c.toml:16: joints.default.friction: is 0.6 degrees"))
      << other;
  EXPECT_TRUE(other.contains("\n    -> e.toml:16: joints.default.friction: is 0.7 degrees")) << other;
  // A result of before there were notes in it.
  std::string old = read("a/summary.json");
  const std::size_t notes = old.find("\"notes\"");
  ASSERT_NE(notes, std::string::npos);
  old.replace(notes, 7, "\"nothing\"");
  write("a/summary.json", old);
  EXPECT_TRUE(cleave("diff a b").out.contains("\nnotes\n  only the second was written with its notes\n"));
}

TEST_F(DiffTest, WhatIsNoResultIsRefused) {
  run("a", "");
  fs::create_directories(path("empty"));
  fs::create_directories(path("other"));
  write("other/summary.json", "{ \"name\": 1 }");
  for (const std::string wrong : {"empty", "other", "missing", "a.toml"}) {
    const Ended ended = cleave("diff a " + wrong);
    EXPECT_EQ(ended.code, 2) << wrong;
    EXPECT_TRUE(ended.err.starts_with("error: " + wrong + ":1: OUT: ")) << ended.err;
    EXPECT_EQ(ended.out, "");
  }
}

}  // namespace
}  // namespace cleave::cli::test
