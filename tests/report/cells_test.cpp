#include "cleave/exchange/exports.hpp"

#include <gtest/gtest.h>

#include <map>
#include <utility>

#include "hand_made.hpp"

namespace cleave::report {
namespace {

using namespace testing;

struct Facts {
  double volume = 0;
  std::size_t shells = 0;
};

// Walks a cell's faces: each edge exactly twice in opposite senses, no corner twice in a face; returns the volume by
// the divergence theorem about the cell's first point.
double expect_closed(const Cells& cells, std::size_t cell) {
  const auto stream = cells.faces_of(cell);
  std::map<std::pair<std::int64_t, std::int64_t>, int> uses;
  std::size_t at = 1;
  double six_volumes = 0;
  const Vec3 o = cells.points[static_cast<std::size_t>(stream[2])];
  for (std::int64_t f = 0; f < stream[0]; ++f) {
    const auto n = static_cast<std::size_t>(stream[at]);
    EXPECT_GE(n, 3U);
    const auto face = stream.subspan(at + 1, n);
    for (std::size_t i = 0; i < n; ++i) {
      ++uses[{face[i], face[(i + 1) % n]}];
      for (std::size_t j = 0; j < i; ++j) EXPECT_NE(face[i], face[j]);
    }
    for (std::size_t i = 1; i + 1 < n; ++i) {
      const auto p = [&](std::size_t k) { return cells.points[static_cast<std::size_t>(face[k])] - o; };
      six_volumes += dot(p(0), cross(p(i), p(i + 1)));
    }
    at += n + 1;
  }
  EXPECT_EQ(at, stream.size());
  for (const auto& [edge, count] : uses) {
    EXPECT_EQ(count, 1) << edge.first << " -> " << edge.second;
    EXPECT_TRUE(uses.contains({edge.second, edge.first})) << edge.first << " -> " << edge.second;
  }
  return six_volumes / 6;
}

void expect_good(const topology::BlockComplex& complex, std::size_t expected_cells) {
  const Cells cells = make_cells(complex);
  EXPECT_EQ(cells.size(), expected_cells);
  EXPECT_TRUE(cells.with_cavities.empty());
  std::map<std::uint32_t, double> by_block, stated;
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    SCOPED_TRACE(cell);
    const double volume = expect_closed(cells, cell);
    EXPECT_NEAR(volume, cells.volume[cell], 1e-12 * volume);
    by_block[cells.block[cell].value()] += volume;
    stated[cells.block[cell].value()] += cells.volume[cell];
  }
  EXPECT_EQ(by_block.size(), complex.blocks().size());
  for (const topology::BlockId id : complex.blocks().ids()) {
    const double volume = complex.blocks()[id].volume.si();
    EXPECT_NEAR(by_block[id.value()], volume, 1e-12 * volume);
    EXPECT_NEAR(stated[id.value()], volume, 1e-12 * volume);
  }
}

TEST(Cells, BoxesShareTheirPoints) {
  const auto complex = grid(3, {100, 200, 300});
  const Cells cells = make_cells(complex);
  EXPECT_EQ(cells.points.size(), 64U);
  EXPECT_EQ(cells.points.front(), (Vec3{100, 200, 300}));
  expect_good(complex, 27);
}

TEST(Cells, FacesWithHolesBecomeTriangles) {
  const auto through = box_with_shafts({{1, 1, 2, 2}}, 0, {16, 24, 10, 12, 1, 1});
  expect_good(through, 1);
  EXPECT_EQ(make_cells(through).face_stream.front(), 8 + 2 * 8);
  expect_good(box_with_shafts({{1, 1, 2, 2}}, 1, {16, 24, 11, 12, 1, 0}), 1);
  expect_good(box_with_shafts({{1, 1, 2, 2}, {2.5, 2.5, 3, 3.5}, {1, 2.5, 1.5, 3.5}}, 0.5, {32, 48, 21, 24, 1, 0}), 1);
}

// Two shafts that touch along a vertical edge: four faces meet there, so the edge's points are doubled.
TEST(Cells, EdgeThatABlockTouchesItselfAlongIsDoubled) {
  const auto complex = box_with_shafts({{1, 1, 2, 2}, {2, 2, 3, 3}}, 0, {24, 36, 14, 16, 1, 1});
  expect_good(complex, 1);
  EXPECT_EQ(make_cells(complex).points.size(), complex.vertices().size() + 2);
}

topology::BlockComplex with_cavities(const std::vector<std::pair<Vec3, Vec3>>& voids) {
  HandMade made{{1000, 2000, -50}};
  auto faces = box_faces({0, 0, 0}, {10, 10, 10});
  std::uint32_t shell = 0;
  for (const auto& [lo, hi] : voids) {
    ++shell;
    for (FaceSpec& wall : void_faces(lo, hi, shell)) faces.push_back(wall);
  }
  const auto n = static_cast<std::uint32_t>(voids.size());
  made.block(faces, {8 + 8 * n, 12 + 12 * n, 6 + 6 * n, 6 + 6 * n, 1 + n, 0});
  for (const auto& [lo, hi] : voids) made.block(box_faces(lo, hi, Role::joint), box_counts, true);
  return std::move(made).complex();
}

TEST(Cells, CavitiesAreCutOpen) {
  expect_good(with_cavities({{{4, 4, 4}, {6, 6, 6}}}), 2 + 1);
  // Three voids over one another, and one beside them: two planes meet them all.
  expect_good(
      with_cavities({{{1, 1, 1}, {2, 3, 2}}, {{1, 1, 3}, {2, 3, 4}}, {{1, 1, 5}, {2, 3, 6}}, {{7, 7, 7}, {8, 8, 8}}}),
      3 + 4);
  // Voids of awkward size, so that nothing is a round number.
  expect_good(with_cavities({{{0.1, 0.3, 0.7}, {1.1, 2.2, 3.3}}, {{5.1, 5.7, 0.9}, {9.3, 9.9, 9.1}}}), 2 + 2);
}

// Cavities that touch each other at a vertex and along edges: there four faces of one block meet.
TEST(Cells, CavitiesThatTouch) {
  expect_good(with_cavities({{{2, 2, 2}, {4, 4, 4}}, {{4, 4, 4}, {6, 6, 6}}}), 3 + 2);  // at a vertex: one plane each
  expect_good(with_cavities({{{2, 2, 2}, {4, 4, 4}}, {{4, 4, 2}, {6, 6, 4}}}), 2 + 2);  // along an edge
  expect_good(with_cavities({{{2, 2, 2}, {4, 4, 4}}, {{4, 4, 2}, {6, 6, 4}}, {{6, 2, 2}, {8, 4, 4}}}), 2 + 3);
}

// As many planes as are worth it; beyond them the block is one cell with all its shells, and that is said.
TEST(Cells, VeryManyCavitiesStayClosed) {
  const auto stacked = [](int count) {
    std::vector<std::pair<Vec3, Vec3>> voids;
    for (int i = 0; i < count; ++i) {
      const double low = 0.5 + 0.125 * i;  // along the diagonal: one plane each, whatever its direction
      voids.push_back({{low, low, low}, {low + 0.0625, low + 0.0625, low + 0.0625}});
    }
    return with_cavities(voids);
  };
  expect_good(stacked(64), 64 + 65);
  const auto complex = stacked(65);
  const Cells cells = make_cells(complex);
  ASSERT_EQ(cells.with_cavities.size(), 1U);
  EXPECT_EQ(cells.size(), complex.blocks().size());
  double volume = 0;
  for (const double v : cells.volume) volume += v;
  EXPECT_NEAR(volume, 1000, 1e-9);
  const Exported exported = export_blocks(cells, ExportFormat::obj, "t");
  ASSERT_EQ(exported.notes.size(), 1U);
  EXPECT_NE(exported.notes.front().find("not cut open"), std::string::npos) << exported.notes.front();
}

TEST(Cells, SameBlocksSameCells) {
  const auto complex = box_with_shafts({{1, 1, 2, 2}, {2, 2, 3, 3}}, 0, {24, 36, 14, 16, 1, 1});
  EXPECT_EQ(make_cells(complex).face_stream, make_cells(complex).face_stream);
}

}  // namespace
}  // namespace cleave::report
