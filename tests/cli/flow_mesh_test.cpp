#include <cmath>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "example_run.hpp"

// The mesh of joints for other programs, from its files: tests/cli/flow_mesh.py looks closer.

namespace cleave::cli::test {
namespace {

class FlowMeshTest : public ProgramTest {
 protected:
  /// The rows that follow "WORD n".
  [[nodiscard]] std::vector<std::vector<double>> rows(const std::string& file, std::string_view word) const {
    std::istringstream lines{read(file)};
    std::vector<std::vector<double>> found;
    std::string line;
    bool on = false;
    while (std::getline(lines, line)) {
      const bool head = line.find_first_of("CL") == 0;
      if (head) on = line.starts_with(word);
      if (head || !on) continue;
      std::istringstream numbers{line};
      auto& row = found.emplace_back();
      for (double x = 0; numbers >> x;) row.push_back(x);
    }
    return found;
  }
};

constexpr double conductivity = 9.81 * 1e-6 / 12 / 1.004e-6;  ///< m/s, of walls 1 mm apart

TEST_F(FlowMeshTest, OneJointIsDarcysLawInItsFiles) {
  write("level.toml",
        "schema = 1\n[domain]\nbox = { min = [0, 0, 0], max = [8, 6, 6] }\n"
        "[[joint]]\nplane = { through = [4, 3, 2], dip = 0, dip_direction = 0 }\n[joints.default]\naperture = 1e-3\n"
        "[flow]\nexports = [\"pflotran\"]\n[[flow.side]]\nface = \"west\"\nlevel = 10\n"
        "[[flow.side]]\nface = \"east\"\nlevel = 7\n");
  const Ended run = cleave("run level.toml --quiet -o out");
  ASSERT_EQ(run.code, 0) << run.err;
  const auto cells = rows("out/flow_mesh.uge", "CELLS"), sides = rows("out/flow_mesh.uge", "CONNECTIONS");
  double volume = 0, through = 0;
  for (const auto& cell : cells) {
    ASSERT_EQ(cell.size(), 5U);
    EXPECT_EQ(cell[3], 2);
    volume += cell[4];
  }
  EXPECT_NEAR(volume, 48e-3, 1e-12);
  // Heads fall evenly from west to east.
  for (const auto& side : sides) {
    ASSERT_EQ(side.size(), 6U);
    const auto &a = cells[static_cast<std::size_t>(side[0]) - 1], &b = cells[static_cast<std::size_t>(side[1]) - 1];
    EXPECT_DOUBLE_EQ(side[2], 0.5 * (a[1] + b[1]));
    through +=
        (a[1] == 0) != (b[1] == 0) ? conductivity * side[5] / std::abs(a[1] - b[1]) * 3 / 8 * std::abs(a[1] - b[1]) : 0;
  }
  const double exact = 1e-3 * conductivity * 6 * 3 / 8;
  EXPECT_NEAR(through, exact, 1e-12 * exact) << "along the sides from the west";
  for (const char* name : {"out/flow_mesh_standing_0.ex", "out/flow_mesh_standing_1.ex"}) {
    const auto faces = rows(name, "CONNECTIONS");
    ASSERT_FALSE(faces.empty()) << name;
    for (const auto& face : faces) {
      const auto& cell = cells[static_cast<std::size_t>(face[0]) - 1];
      EXPECT_GT(face[1], cell[1]);
      EXPECT_EQ(face[3], 2);
      EXPECT_GT(face[4] / (face[1] - cell[1]), 1e5 * 1e-3) << "an area that imposes the head";
    }
  }
  const std::string heads = read("out/flow_mesh_heads.csv"), cards = read("out/flow_mesh.in");
  EXPECT_TRUE(heads.starts_with("node,surface,file,head_m,pressure_head_m\n1,")) << heads;
  EXPECT_TRUE(heads.contains(",west,flow_mesh_standing_0.ex,10,8\n"));
  EXPECT_TRUE(heads.contains(",east,flow_mesh_standing_1.ex,7,5\n"));
  EXPECT_TRUE(cards.contains("DATUM 0 0 10\n  LIQUID_PRESSURE 101325\n"));
  EXPECT_TRUE(cards.contains("FILE flow_mesh_standing_1.ex\n"));
  const std::string ucd = read("out/flow_mesh.inp");
  EXPECT_TRUE(ucd.starts_with(std::to_string(cells.size()) + " ")) << ucd;
  EXPECT_TRUE(ucd.contains("\n1 1 tri ")) << "joint 0 is material 1";
  // High up, where points are kept relative to a place nearby.
  write("high.toml",
        "schema = 1\n[domain]\nbox = { min = [0, 0, 4000], max = [8, 6, 4006] }\n"
        "[[joint]]\nplane = { through = [4, 3, 4002], dip = 0, dip_direction = 0 }\n[joints.default]\naperture = 1e-3\n"
        "[flow]\nexports = [\"pflotran\"]\n[[flow.side]]\nface = \"west\"\nlevel = 4010\n"
        "[[flow.side]]\nface = \"east\"\nlevel = 4007\n");
  const Ended high = cleave("run high.toml --quiet -o high");
  ASSERT_EQ(high.code, 0) << high.err;
  EXPECT_TRUE(read("high/flow_mesh_heads.csv").contains(",west,flow_mesh_standing_0.ex,4010,8\n"));
  EXPECT_TRUE(read("high/flow_mesh.in").contains("DATUM 0 0 4010\n  LIQUID_PRESSURE 101325\n"));
  for (const auto& cell : rows("high/flow_mesh.uge", "CELLS")) EXPECT_EQ(cell[3], 4002);
  // The files are ours: a run may take their place.
  EXPECT_EQ(cleave("run level.toml --quiet -o out").code, 0);
}

}  // namespace
}  // namespace cleave::cli::test
