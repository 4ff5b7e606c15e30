#include <nlohmann/json.hpp>

#include <utility>

#include "program.hpp"

// What is noted stands in the terminal, in log.txt, in the report and in summary.json: the same texts in the same
// order.
namespace cleave::cli::test {
namespace {

using Notes = std::vector<std::string>;

/// The lines of a text that begin so, without the beginning.
Notes lines_after(std::string_view begin, std::string_view text) {
  Notes lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    if (text.starts_with(begin)) lines.emplace_back(text.substr(begin.size(), end - begin.size()));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::string in_html(const std::string& text) {
  std::string out;
  for (const char c : text) {
    out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : std::string{c};
  }
  return out;
}

/// Each with a friction in radians or a stiffness in GPa, so that one note at least comes of the scene itself.
const std::vector<std::pair<std::string, std::string>>& scenes() {
  static const std::string wedge =
      "[domain]\nbox = { min = [0, 0, 0], max = [8, 8, 6] }\n"
      "[[joint]]\nplane = { through = [4, 4, 2], dip = 40, dip_direction = 90 }\n"
      "[[joint]]\nplane = { through = [90, 4, 2], dip = 40, dip_direction = 90 }\n"
      "[rock]\ndensity = 2600\n";
  static const std::string weak = "[joints.default]\nfriction = 0.6\n";
  static const std::string free = weak + "[stability]\nfree = [\"top\", \"east\"]\n";
  static const std::vector<std::pair<std::string, std::string>> all{
      {"blocks", wedge + free},
      {"motion", wedge + free + "[motion]\nerror = false\nduration = 0.01\n"},
      {"flow", wedge + weak + "aperture = 1e-4\n[flow]\nlevel = 5\n"},
      {"monte_carlo", wedge + free +
                          "[[joint_set]]\nname = \"A\"\nintensity = { count = 8 }\n"
                          "orientation = { dip = 45, dip_direction = 90, distribution = \"fisher\", kappa = 5 }\n"
                          "size = { distribution = \"constant\", mean = 12 }\n[monte_carlo]\nrealizations = 3\n"},
      {"elastic",
       "[rock]\nyoung = 40\npoisson = 0.25\n[elastic]\ngravity = 9.81\n[[body]]\nname = \"slab\"\n"
       "outline = [[0, 0], [2, 0], [2, 0.5], [0, 0.5]]\nsupport = [{ side = 4, kind = \"fixed\" }]\n"},
      {"contact",
       "[joints.default]\nfriction = 0.6\n[contact]\nduration = 0.05\nframes = 2\n"
       "[[body]]\nname = \"ground\"\nfixed = true\nrectangle = { corner = [-5, -1], width = 10, height = 1 }\n"
       "[[body]]\nname = \"block\"\nrectangle = { corner = [-0.5, 0], width = 1, height = 1 }\n"},
  };
  return all;
}

class NotesTest : public ProgramTest {
 protected:
  [[nodiscard]] nlohmann::ordered_json summary(const std::string& out) const {
    nlohmann::ordered_json all = nlohmann::ordered_json::parse(read(out + "/summary.json"));
    for (const char* cost : {"cost", "realization_cost"}) all.erase(cost);
    return all;
  }
};

TEST_F(NotesTest, EveryKindOfRunHasItsNotesEverywhere) {
  fs::create_directories(path("in"));
  for (const auto& [kind, scene] : scenes()) {
    write("in/" + kind + ".toml", scene);
    const Ended ended = cleave("run in/" + kind + ".toml -o " + kind);
    ASSERT_EQ(ended.code, 0) << kind << ended.err;
    const nlohmann::ordered_json whole = summary(kind);
    const Notes notes = whole["notes"].get<Notes>();
    ASSERT_FALSE(notes.empty()) << kind;
    EXPECT_TRUE(notes.front().starts_with(kind + ".toml:")) << notes.front();
    EXPECT_EQ(lines_after("note: ", ended.out), notes) << kind;
    const std::string log = read(kind + "/log.txt");
    const std::size_t list = log.find("\nnotes\n");
    EXPECT_EQ(list == std::string::npos ? lines_after("note: ", log) : lines_after("  ", log.substr(list + 1)), notes)
        << kind;
    const std::string page = read(kind + "/report.html");
    std::size_t at = page.find("id=\"notes\"");
    for (const std::string& note : notes) {
      at = page.find(in_html(note), at);
      ASSERT_NE(at, std::string::npos) << kind << ": " << note;
    }
    if (kind == "monte_carlo") {
      for (const auto& note : whole["monte_carlo"]["notes"]) {
        EXPECT_NE(std::ranges::find(notes, note.get<std::string>()), notes.end()) << note;
      }
    }
    // Where the scene lies is no matter.
    ASSERT_EQ(shell("cd in && cleave run " + kind + ".toml --quiet -o ../again").code, 0);
    EXPECT_EQ(summary("again"), whole) << kind;
  }
}

}  // namespace
}  // namespace cleave::cli::test
