#include "cleave/io/mesh.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cleave/geometry/polygon.hpp"
#include "io_testing.hpp"

namespace cleave::io {
namespace {

using geometry::Vec3;
using Parser = std::function<std::expected<Surfaces, ReadError>(std::string_view, std::string_view)>;

Surfaces read(const Parser& parse, std::string_view text) {
  auto surfaces = parse(text, "a");
  EXPECT_TRUE(surfaces.has_value()) << text << (surfaces ? "" : describe(surfaces.error()));
  return surfaces ? *surfaces : Surfaces{};
}

void expect_refused(const Parser& parse, std::string_view text, ReadFault fault, std::optional<std::uint32_t> line) {
  const auto surfaces = parse(text, "a.x");
  ASSERT_FALSE(surfaces.has_value()) << text;
  EXPECT_EQ(surfaces.error().fault, fault) << text << describe(surfaces.error());
  EXPECT_EQ(surfaces.error().line, line) << text << describe(surfaces.error());
  EXPECT_EQ(surfaces.error().file, "a.x");
  EXPECT_FALSE(surfaces.error().remedy.empty());
}

/// Every beginning of a file that is whole is refused, and nothing else happens.
void expect_every_start_is_refused(const Parser& parse, std::string_view text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.remove_suffix(1);
  ASSERT_TRUE(parse(text, "a").has_value());
  for (std::size_t n = 0; n + 1 < text.size(); ++n) {
    EXPECT_FALSE(parse(text.substr(0, n), "a").has_value()) << text.substr(0, n);
  }
}

bool has_note(const Surfaces& surfaces, std::string_view part) {
  return std::ranges::any_of(surfaces.notes,
                             [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

// ---- DXF

/// "10 1.5;20 2" as pairs of lines.
std::string pairs(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::string_view pair = text.substr(0, text.find(';'));
    text.remove_prefix(std::min(text.size(), pair.size() + 1));
    const std::size_t blank = pair.find(' ');
    result += fmt::format("{:>3}\n{}\n", pair.substr(0, blank), pair.substr(blank + 1));
  }
  return result;
}
std::string entities(std::string_view text) {
  return pairs(fmt::format("0 SECTION;2 ENTITIES;{};0 ENDSEC;0 EOF", text));
}
std::string face(std::string_view layer, const std::array<Vec3, 4>& c) {
  std::string text = fmt::format("0 3DFACE;8 {}", layer);
  for (std::size_t i = 0; i < 4; ++i) {
    text += fmt::format(";{} {};{} {};{} {}", 10 + i, c[i].x, 20 + i, c[i].y, 30 + i, c[i].z);
  }
  return text;
}
std::string box_dxf() {
  std::string text;
  const std::array<std::array<int, 4>, 6> quads{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& quad : quads) {
    std::array<Vec3, 4> c;
    for (std::size_t i = 0; i < 4; ++i) c[i] = {quad[i] & 1 ? 2. : 0, quad[i] & 2 ? 3. : 0, quad[i] & 4 ? 4. : 0};
    if (!text.empty()) text += ';';
    text += face("BOX", c);
  }
  return entities(text);
}

TEST(DxfTest, FacesOfALayerAreOneSurface) {
  const Surfaces box = read(parse_dxf, box_dxf());
  EXPECT_EQ(box.surfaces.faces(), 6U);
  EXPECT_EQ(box.surfaces.vertices.size(), 8U);
  EXPECT_EQ(box.surfaces.groups, (std::vector<std::string>{"BOX"}));
  EXPECT_EQ(box.polygons.faces(), 0U);
  EXPECT_DOUBLE_EQ(testing::volume_of(box.surfaces), 24);
  EXPECT_TRUE(has_note(box, "metres are taken"));
  // with Windows line ends, comments and another section before it
  std::string windows;
  for (const char c : std::string{"999\nmade by hand\n"} +
                          pairs("0 SECTION;2 HEADER;9 $ACADVER;1 AC1009;9 $INSUNITS;70 6;0 ENDSEC") + box_dxf()) {
    windows += c == '\n' ? std::string{"\r\n"} : std::string{c};
  }
  Surfaces same = read(parse_dxf, windows);
  EXPECT_TRUE(same.notes.empty());
  EXPECT_EQ(same.surfaces.vertices, box.surfaces.vertices);
}

TEST(DxfTest, TrianglesBentQuadsAndFacesWithoutArea) {
  const Surfaces result =
      read(parse_dxf,
           entities(face("A", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}}}) + ";" +     // corner 3 again: a triangle
                    face("A", {{{0, 0, 0}, {1, 0, 0}, {1, 1, 1}, {0, 1, 0}}}) + ";" +     // bent
                    face("A", {{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 0, 0}}}) + ";" +     // the first again
                    face("B", {{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 0, 0}}}) + ";" +     // no area
                    "0 3DFACE;8 B;10 0;20 0;30 5;11 1;21 0;31 5;12 0;22 1;32 5;70 15"));  // no fourth corner
  EXPECT_EQ(result.surfaces.faces(), 4U);
  EXPECT_EQ(result.surfaces.corners_of(1), (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 1}}));
  EXPECT_EQ(result.surfaces.corners_of(2), (std::vector<Vec3>{{0, 0, 0}, {1, 1, 1}, {0, 1, 0}}));
  EXPECT_EQ(result.surfaces.groups, (std::vector<std::string>{"A", "B"}));
  EXPECT_EQ(result.surfaces.group, (std::vector<std::uint32_t>{0, 0, 0, 1}));
  EXPECT_TRUE(has_note(result, "cut along corners 1-3"));
  EXPECT_TRUE(has_note(result, "without area"));
  EXPECT_TRUE(has_note(result, "more than once"));
}

TEST(DxfTest, ClosedPolylinesArePolygons) {
  const Surfaces result = read(
      parse_dxf, entities("0 LWPOLYLINE;8 J;90 3;70 1;38 7;10 0;20 0;10 2;20 0;42 0.5;10 0;20 2;"
                          "0 POLYLINE;8 K;66 1;70 9;0 VERTEX;10 0;20 0;30 0;0 VERTEX;10 0;20 4;30 1;0 VERTEX;10 5;20 0;"
                          "30 2;0 SEQEND;"
                          "0 POLYLINE;66 1;70 8;0 VERTEX;10 0;20 0;30 0;0 VERTEX;10 9;20 4;30 1;0 SEQEND;"
                          "0 LINE;8 L;10 0;20 0;11 1;21 1;0 INSERT;2 X;0 LINE;8 M;10 0;20 0"));
  ASSERT_EQ(result.polygons.faces(), 2U);
  EXPECT_EQ(result.polygons.corners_of(0), (std::vector<Vec3>{{0, 0, 7}, {2, 0, 7}, {0, 2, 7}}));
  EXPECT_EQ(result.polygons.corners_of(1), (std::vector<Vec3>{{0, 0, 0}, {0, 4, 1}, {5, 0, 2}}));
  EXPECT_EQ(result.polygons.groups, (std::vector<std::string>{"J", "K"}));
  EXPECT_TRUE(has_note(result, "1 arcs"));
  EXPECT_TRUE(has_note(result, "1 open polylines"));
  EXPECT_TRUE(has_note(result, "1 \"INSERT\", 2 \"LINE\""));
}

TEST(DxfTest, PlaneEntitiesStandInTheirOwnPlane) {
  // Normal along x: the plane's axes are y and z (arbitrary axis algorithm).
  const Surfaces east =
      read(parse_dxf, entities("0 LWPOLYLINE;90 3;70 1;38 5;10 0;20 0;10 2;20 0;10 0;20 3;210 1;220 0;230 0"));
  EXPECT_EQ(east.polygons.corners_of(0), (std::vector<Vec3>{{5, 0, 0}, {5, 2, 0}, {5, 0, 3}}));
  // Upside down: x turns round.
  const Surfaces down = read(parse_dxf, entities("0 POLYLINE;66 1;70 1;10 0;20 0;30 4;210 0;220 0;230 -1;"
                                                 "0 VERTEX;10 0;20 0;0 VERTEX;10 1;20 0;0 VERTEX;10 0;20 1;0 SEQEND"));
  EXPECT_EQ(down.polygons.corners_of(0), (std::vector<Vec3>{{0, 0, -4}, {-1, 0, -4}, {0, 1, -4}}));
}

TEST(DxfTest, MeshesOfPolylines) {
  // 3 x 2 points, closed along the first direction: a triangular tube of three quads
  const Surfaces tube =
      read(parse_dxf,
           entities("0 POLYLINE;8 T;66 1;70 17;71 3;72 2;0 VERTEX;10 0;20 0;30 0;0 VERTEX;10 0;20 0;30 1;"
                    "0 VERTEX;10 1;20 0;30 0;0 VERTEX;10 1;20 0;30 1;0 VERTEX;10 0;20 1;30 0;0 VERTEX;10 0;20 1;30 1;"
                    "0 SEQEND"));
  EXPECT_EQ(tube.surfaces.faces(), 3U);
  EXPECT_EQ(tube.surfaces.vertices.size(), 6U);
  // the tetrahedron as a polyface, edges hidden
  const std::string head = "0 POLYLINE;8 P;66 1;70 64;71 4;72 4;";
  const std::string points =
      "0 VERTEX;70 192;10 0;20 0;30 0;0 VERTEX;70 192;10 1;20 0;30 0;0 VERTEX;70 192;10 0;20 1;30 0;0 VERTEX;70 192;10 "
      "0;20 "
      "0;30 1;";
  const auto record = [](int a, int b, int c) {
    return fmt::format("0 VERTEX;10 0;20 0;30 0;70 128;71 {};72 {};73 {};", a, b, c);
  };
  const Surfaces solid = read(parse_dxf, entities(head + points + record(1, -3, 2) + record(1, 2, 4) +
                                                  record(-1, 4, 3) + record(2, 3, -4) + "0 SEQEND"));
  EXPECT_DOUBLE_EQ(testing::volume_of(solid.surfaces), 1.0 / 6);
  expect_refused(parse_dxf, entities(head + points + record(1, 2, 5) + "0 SEQEND"), ReadFault::out_of_range, 58);
}

TEST(DxfTest, UnitsAreConverted) {
  const std::string drawing = entities(face("0", {{{0, 0, 0}, {1000, 0, 0}, {0, 1000, 0}, {0, 1000, 0}}}));
  const Surfaces millimetres = read(parse_dxf, pairs("0 SECTION;2 HEADER;9 $INSUNITS;70 4;0 ENDSEC") + drawing);
  EXPECT_EQ(millimetres.surfaces.vertices[1], (Vec3{1, 0, 0}));
  EXPECT_TRUE(has_note(millimetres, "0.001 m"));
  expect_refused(parse_dxf, pairs("0 SECTION;2 HEADER;9 $INSUNITS;70 20;0 ENDSEC") + drawing, ReadFault::out_of_range,
                 8);
}

TEST(DxfTest, FaultsNameTheLine) {
  expect_refused(parse_dxf, "", ReadFault::empty, {});
  expect_refused(parse_dxf, "AutoCAD Binary DXF\r\n\x1a", ReadFault::unknown_format, {});
  expect_refused(parse_dxf, "AC1027\1\2", ReadFault::unknown_format, {});
  expect_refused(parse_dxf, "solid x\nfacet\n", ReadFault::syntax, 1);
  expect_refused(parse_dxf, "0\nLINE\n", ReadFault::unknown_format, 2);
  expect_refused(parse_dxf, entities("0 LINE;8 0"), ReadFault::empty, {});
  expect_refused(parse_dxf, pairs("0 SECTION;2 ENTITIES;0 ENDSEC"), ReadFault::truncated, 6);
  expect_refused(parse_dxf, entities("0 3DFACE;10 0;20 nan;30 0;11 1;21 1;31 1;12 1;22 2;32 2"), ReadFault::bad_number,
                 10);
  expect_refused(parse_dxf, entities("0 3DFACE;10 0;20 1e999;30 0;11 1;21 1;31 1;12 1;22 2;32 2"),
                 ReadFault::bad_number, 10);
  expect_refused(parse_dxf, entities("0 3DFACE;10 0;20 0;30 0;11 1;21 1;31 1"), ReadFault::syntax, 6);
  expect_refused(parse_dxf, entities("0 POLYLINE;70 1;0 VERTEX;10 0;20 0"), ReadFault::truncated, 6);
  expect_refused(parse_dxf, entities("0 POLYLINE;70 1;0 LINE;10 0;20 0;0 SEQEND"), ReadFault::truncated, 6);
  expect_refused(parse_dxf, entities("0 VERTEX;10 0;20 0"), ReadFault::syntax, 6);
  expect_refused(parse_dxf, entities("0 LWPOLYLINE;90 4000000000;70 1;10 0;20 0"), ReadFault::syntax, 6);
  expect_refused(parse_dxf, entities("0 LWPOLYLINE;90 2;70 1;10 0;20 0;10 1;20 1"), ReadFault::out_of_range, 6);
  expect_refused(parse_dxf, entities("0 LWPOLYLINE;90 3;70 1;10 0;20 0;10 1;20 1;10 0;20 1;210 0;220 0;230 0"),
                 ReadFault::out_of_range, 6);
  expect_refused(parse_dxf, entities("0 POLYLINE;70 16;71 100000;72 100000;0 SEQEND"), ReadFault::out_of_range, 6);
  expect_refused(parse_dxf, pairs("0 SECTION;2 ENTITIES") + "x\ny\n", ReadFault::syntax, 5);
  expect_refused(parse_dxf,
                 pairs("0 SECTION;2 HEADER;9 $INSUNITS;70 1;0 ENDSEC;0 SECTION;2 ENTITIES;0 3DFACE;10 1e308;20 "
                       "1e308;30 0;11 1;21 1;31 1;12 1;22 2;32 2;0 ENDSEC;0 EOF"),
                 ReadFault::empty, {});  // so far out that no face there has an area
  std::string garbage;
  for (int i = 0; i < 1000; ++i) garbage += static_cast<char>(i * 37 + i / 7);
  EXPECT_FALSE(parse_dxf(garbage, "a").has_value());
  expect_every_start_is_refused(parse_dxf, box_dxf());
}

// ---- TSurf

const std::string tsurf =
    "GOCAD TSurf 1\nHEADER {\nname:fault_1\n*solid*color:#ff0000\n}\n"
    "GOCAD_ORIGINAL_COORDINATE_SYSTEM\nNAME Default\nAXIS_NAME \"X\" \"Y\" \"Z\"\nAXIS_UNIT \"m\" \"m\" \"m\"\n"
    "ZPOSITIVE Elevation\nEND_ORIGINAL_COORDINATE_SYSTEM\n"
    "PROPERTIES thickness\nTFACE\nVRTX 10 0 0 0\nPVRTX 20 1 0 0 3.5\nVRTX 7 0 1 0 CNXYZ\nTRGL 10 7 20\n"
    "TFACE\nVRTX 30 0 0 1\nPATOM 40 10\nATOM 41 20\nTRGL 40 41 30\nTRGL 40 30 7\nTRGL 20 7 30\nBSTONE 10\nBORDER 31 10 "
    "20\n"
    "END\n";

TEST(TsurfTest, VertexNumbersAndPartsOfASurface) {
  const Surfaces result = read(parse_tsurf, tsurf);
  EXPECT_EQ(result.polygons.faces(), 0U);
  EXPECT_EQ(result.surfaces.groups, (std::vector<std::string>{"fault_1"}));
  EXPECT_EQ(result.surfaces.lines, (std::vector<std::uint32_t>{17, 22, 23, 24}));
  EXPECT_DOUBLE_EQ(testing::volume_of(result.surfaces), 1.0 / 6);
  EXPECT_TRUE(result.notes.empty());
}

TEST(TsurfTest, ObjectsOfAFileAreSurfacesOfTheirOwn) {
  std::string other = tsurf;
  other.replace(other.find("HEADER {\nname:fault_1\n*solid*color:#ff0000\n}"), 44, "HEADER{name:fault 2}");
  const Surfaces result = read(parse_tsurf, std::string{"\xEF\xBB\xBF"} + tsurf +
                                                "\r\nGOCAD VSet 1\nHEADER {name:p}\nVRTX 1 0 0 0\nEND\n" + other);
  EXPECT_EQ(result.surfaces.groups, (std::vector<std::string>{"fault_1", "fault 2"}));
  EXPECT_EQ(result.surfaces.faces(), 8U);
  EXPECT_TRUE(has_note(result, "VSet"));
}

TEST(TsurfTest, DepthTurnsTheSurfaceOver) {
  std::string depth = tsurf;
  depth.replace(depth.find("Elevation"), 9, "Depth");
  const Surfaces result = read(parse_tsurf, depth);
  EXPECT_DOUBLE_EQ(testing::volume_of(result.surfaces), 1.0 / 6);  // still outwards
  EXPECT_TRUE(std::ranges::any_of(result.surfaces.vertices, [](Vec3 p) { return p.z == -1; }));
  std::string feet = tsurf;
  feet.replace(feet.find("\"m\" \"m\" \"m\""), 11, "\"ft\" \"ft\" \"ft\"");
  EXPECT_NEAR(testing::volume_of(read(parse_tsurf, feet).surfaces), 0.3048 * 0.3048 * 0.3048 / 6, 1e-15);
}

TEST(TsurfTest, FaultsNameTheLine) {
  const std::string head = "GOCAD TSurf 1\nHEADER {name:a}\nTFACE\n";
  expect_refused(parse_tsurf, "", ReadFault::empty, {});
  expect_refused(parse_tsurf, "ply\n", ReadFault::unknown_format, 1);
  expect_refused(parse_tsurf, head + "END\n", ReadFault::empty, {});
  expect_refused(parse_tsurf, head + "VRTX 1 0 0 0\n", ReadFault::truncated, 4);
  expect_refused(parse_tsurf, head + "VRTX 1 0 0\nEND", ReadFault::bad_number, 4);
  expect_refused(parse_tsurf, head + "VRTX 1 0 0 nan\nEND", ReadFault::bad_number, 4);
  expect_refused(parse_tsurf, head + "VRTX 1 0 0 1e400\nEND", ReadFault::bad_number, 4);
  expect_refused(parse_tsurf, head + "VRTX x 0 0 0\nEND", ReadFault::syntax, 4);
  expect_refused(parse_tsurf, head + "VRTX 99999999999999999999 0 0 0\nEND", ReadFault::syntax, 4);
  expect_refused(parse_tsurf, head + "VRTX 1 0 0 0\nVRTX 1 0 0 1\nEND", ReadFault::out_of_range, 5);
  expect_refused(parse_tsurf, head + "VRTX 1 0 0 0\nTRGL 1 2 3\nEND", ReadFault::out_of_range, 5);
  expect_refused(parse_tsurf, head + "PATOM 2 1\nEND", ReadFault::out_of_range, 4);
  expect_refused(parse_tsurf, head + "AXIS_UNIT \"km\" \"km\" \"km\"\nEND", ReadFault::out_of_range, 4);
  expect_refused(parse_tsurf, head + "AXIS_UNIT m m ft\nEND", ReadFault::out_of_range, 4);
  expect_refused(parse_tsurf, head + "AXIS_NAME Y X Z\nEND", ReadFault::out_of_range, 4);
  expect_refused(parse_tsurf, head + "ZPOSITIVE up\nEND", ReadFault::syntax, 4);
  expect_refused(parse_tsurf, tsurf + "garbage\n", ReadFault::syntax, 28);
  expect_every_start_is_refused(parse_tsurf, tsurf);
}

// ---- FracMan

const std::string fab =
    "BEGIN FORMAT\n    Format = Ascii\n    Length_Unit = Meter\n    XAxis = East\n    Scale = 100.0\n    No_Fractures "
    "= 2\n"
    "    No_TessFractures = 1\n    No_Properties = 1\nEND FORMAT\n\nBEGIN PROPERTIES\n    Prop1 = (Real*4) "
    "\"Transmissivity\"\nEND PROPERTIES\nBEGIN SETS\n    Set1 = \"steep\"\n    Set2 = \"flat lying\"\nEND SETS\n"
    "BEGIN FRACTURE\n  1 4 1 1e-9\n  1 0 0 0\n  2 1 0 0\n  3 1 1 0.0004\n  4 0 1 0\n  0 0 0 1\n"
    "  5 3 2 2e-9\n  1 0 0 1\n  2 1 0 1\n  3 1 1 2\n  0 0 0 0\nEND FRACTURE\n"
    "BEGIN TESSFRACTURE\n  9 4 2 2\n 1 0 0 0\n 2 1 0 0\n 3 0 1 0\n 4 1 1 0.5\n 1 1 2 3\n 2 2 4 3\nEND TESSFRACTURE\n"
    "BEGIN ROCKBLOCK\nEND ROCKBLOCK\n";

TEST(FabTest, FracturesSetsAndTessellations) {
  const Surfaces result = read(parse_fab, fab);
  ASSERT_EQ(result.polygons.faces(), 2U);
  EXPECT_EQ(result.polygons.groups, (std::vector<std::string>{"steep", "flat lying"}));
  EXPECT_EQ(result.polygons.lines, (std::vector<std::uint32_t>{19, 25}));
  EXPECT_EQ(result.polygons.corners_of(1), (std::vector<Vec3>{{0, 0, 1}, {1, 0, 1}, {1, 1, 2}}));
  // corners moved into one plane, by a tenth of a millimetre
  const std::vector<Vec3> first = result.polygons.corners_of(0);
  EXPECT_TRUE(geometry::Polygon::make(first).has_value());
  EXPECT_NEAR(first[2].z, 0.0003, 1e-6);
  EXPECT_TRUE(has_note(result, "1 fractures were not planar"));
  ASSERT_EQ(result.surfaces.faces(), 2U);
  EXPECT_EQ(result.surfaces.groups, (std::vector<std::string>{"flat lying"}));
  EXPECT_EQ(result.surfaces.corners_of(1), (std::vector<Vec3>{{1, 0, 0}, {1, 1, 0.5}, {0, 1, 0}}));
}

std::string replaced(std::string text, std::string_view what, std::string_view with) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), with);
}

TEST(FabTest, TheThirdNumberMayBeTheFirstProperty) {
  const Surfaces result =
      read(parse_fab, replaced(replaced(fab, "  1 4 1 1e-9", "1 4 1e-9"), "5 3 2 2e-9", "5 3 2e-9"));
  EXPECT_EQ(result.polygons.groups, (std::vector<std::string>{""}));
  EXPECT_EQ(result.polygons.faces(), 2U);
}

TEST(FabTest, FacesMayCountTheirCorners) {
  const Surfaces plain = read(parse_fab, fab);
  const Surfaces counted =
      read(parse_fab, replaced(replaced(fab, " 1 1 2 3\n", " 1 3 1 2 3 8\n"), " 2 2 4 3\n", " 2 3 2 4 3 9\n"));
  EXPECT_EQ(plain.surfaces.corners, counted.surfaces.corners);
}

TEST(FabTest, FracturesBentMuchStayBent) {
  const Surfaces result = read(parse_fab, replaced(fab, "3 1 1 0.0004", "3 1 1 0.5"));
  EXPECT_EQ(result.polygons.corners_of(0)[2], (Vec3{1, 1, 0.5}));
  EXPECT_FALSE(geometry::Polygon::make(result.polygons.corners_of(0)).has_value());
}

TEST(FabTest, FaultsNameTheLine) {
  const auto expect = [&](std::string_view what, std::string_view with, ReadFault fault,
                          std::optional<std::uint32_t> line) {
    expect_refused(parse_fab, replaced(fab, what, with), fault, line);
  };
  expect_refused(parse_fab, "", ReadFault::empty, {});
  expect_refused(parse_fab, "\n\n", ReadFault::empty, {});
  expect_refused(parse_fab, "GOCAD\n", ReadFault::unknown_format, 1);
  expect_refused(parse_fab, "BEGIN FRACTURE\nEND FRACTURE\n", ReadFault::syntax, 1);
  expect_refused(parse_fab, "BEGIN FORMAT\nEND FORMAT\n", ReadFault::empty, {});
  expect("Ascii", "Binary", ReadFault::unknown_format, 2);
  expect("East", "North", ReadFault::out_of_range, 4);
  expect("Meter", "Mile", ReadFault::out_of_range, 3);
  expect("No_Properties = 1", "No_Properties = -1", ReadFault::out_of_range, 8);
  expect("No_Properties = 1", "No_Properties = 4", ReadFault::syntax, 19);
  expect("1 4 1 1e-9", "1 4000000000 1 1e-9", ReadFault::out_of_range, 19);
  expect("1 4 1 1e-9", "1 2 1 1e-9", ReadFault::out_of_range, 19);
  expect("1 4 1 1e-9", "1 3 1 1e-9", ReadFault::syntax, 23);
  expect("1 4 1 1e-9", "1 5 1 1e-9", ReadFault::syntax, 25);
  expect("2 1 0 0", "2 1 0", ReadFault::syntax, 21);
  expect("2 1 0 0", "2 nan 0 0", ReadFault::bad_number, 21);
  expect("2 1 0 0", "2 1e300 0 0", ReadFault::out_of_range, 21);
  expect("2 2 4 3", "2 2 5 3", ReadFault::out_of_range, 38);
  expect("2 2 4 3", "2 2 1.5 3", ReadFault::out_of_range, 38);
  expect("9 4 2 2", "9 4 999999999 2", ReadFault::bad_number, 39);
  expect("BEGIN ROCKBLOCK", "BOGUS", ReadFault::syntax, 40);
  expect("No_Fractures = 2", "No_Fractures = 3", ReadFault::truncated, 6);
  expect("No_Fractures = 2", "No_Fractures = two", ReadFault::truncated, 6);
  expect("No_TessFractures = 1", "No_TessFractures = 0", ReadFault::truncated, 7);
  const auto more = parse_fab(replaced(fab, "No_Fractures = 2", "No_Fractures = 3"), "a.fab");
  EXPECT_EQ(describe(more.error()),
            "a.fab:6: No_Fractures is \"3\", the file has 2; get the whole file again, or correct No_Fractures");
  EXPECT_EQ(read(parse_fab, replaced(fab, "No_Fractures = 2", "Made = 2024")).polygons.faces(), 2U);
  // cut off anywhere before the surfaces are complete
  const std::string_view all = fab;
  for (std::size_t n = 0; n < all.find("END TESSFRACTURE") + 15; ++n) {
    EXPECT_FALSE(parse_fab(all.substr(0, n), "a").has_value()) << all.substr(0, n);
  }
}

}  // namespace
}  // namespace cleave::io
