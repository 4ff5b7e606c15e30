#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/io/mesh.hpp"
#include "dxf_pairs.hpp"
#include "face_cleaner.hpp"
#include "text.hpp"

namespace cleave::io {
namespace {

using geometry::Vec3;

constexpr std::size_t most_corners = 4096;

/// Units of $INSUNITS in metres.
std::optional<double> metres_of_unit(std::int64_t unit) {
  switch (unit) {
    case 1: return 0.0254;
    case 2: return 0.3048;
    case 3: return 1609.344;
    case 4: return 1e-3;
    case 5: return 1e-2;
    case 0:
    case 6: return 1.0;
    case 7: return 1e3;
    case 10: return 0.9144;
    case 14: return 0.1;
    case 21: return 1200.0 / 3937;
    default: return std::nullopt;
  }
}

/// Flags of a POLYLINE and of its vertices (group code 70).
enum PolylineFlag : std::uint8_t { closed = 1, in_space = 8, mesh = 16, mesh_closed_n = 32, polyface = 64 };
enum VertexFlag : std::uint8_t { spline_frame = 16, polyface_vertex = 64, polyface_record = 128 };

struct PolylineVertex {
  Vec3 at;
  std::array<std::int64_t, 4> face{};  ///< numbers from 1, negative: the edge is not drawn; 0: none
  std::uint32_t line = 0;
  bool is_face = false;
};

struct Polyline {
  std::string layer;
  std::int64_t flags = 0;
  std::int64_t m = 0, n = 0;
  double elevation = 0;
  Vec3 extrusion{0, 0, 1};
  std::uint32_t line = 0;
  std::vector<PolylineVertex> vertices;
};

/// From the coordinates of a plane entity to those of space: the axes follow from the normal alone (DXF reference,
/// "arbitrary axis algorithm").
std::optional<std::array<Vec3, 3>> plane_axes(Vec3 normal) {
  const double length = std::sqrt(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z);
  if (!(length > 1e-12) || !std::isfinite(length)) return std::nullopt;
  const Vec3 n = normal * (1 / length);
  const bool steep = std::abs(n.x) < 1.0 / 64 && std::abs(n.y) < 1.0 / 64;
  const Vec3 across = cross(steep ? Vec3{0, 1, 0} : Vec3{0, 0, 1}, n);
  const Vec3 ax = across * (1 / std::sqrt(dot(across, across)));
  return std::array{ax, cross(n, ax), n};
}

class DxfReader final {
 public:
  DxfReader(std::string_view bytes, std::string_view file) : records_{bytes, file}, file_{file} {}

  std::expected<Surfaces, ReadError> run() {
    std::string_view section;
    while (true) {
      CLEAVE_TRY(const bool any, records_.next(record_));
      if (!any) break;
      if (record_.type == "SECTION") {
        const DxfPair* name = record_.find(2);
        section = name == nullptr ? std::string_view{} : name->value;
        if (section == "HEADER") CLEAVE_CHECK(read_unit());
      } else if (record_.type == "ENDSEC") {
        CLEAVE_CHECK(need_no_polyline());
        section = {};
      } else if (section == "ENTITIES") {
        CLEAVE_CHECK(read_entity());
      }
    }
    CLEAVE_CHECK(need_no_polyline());
    return finish();
  }

 private:
  [[nodiscard]] ReadError whole(ReadFault fault, std::string what, std::string remedy) const {
    return whole_file(fault, file_, std::move(what), std::move(remedy));
  }

  std::expected<void, ReadError> need_no_polyline() const {
    if (!polyline_) return {};
    return std::unexpected(records_.error(polyline_->line, ReadFault::truncated, "a POLYLINE does not end with SEQEND",
                                          "get or save the whole file again"));
  }

  std::expected<void, ReadError> read_unit() {
    const auto name = std::ranges::find_if(
        record_.pairs, [](const DxfPair& pair) { return pair.code == 9 && pair.value == "$INSUNITS"; });
    if (name == record_.pairs.end() || std::next(name) == record_.pairs.end()) return {};
    CLEAVE_TRY(const double unit, records_.number(*std::next(name)));
    const auto metres = unit == std::floor(unit) && unit >= 0 && unit < 100
                            ? metres_of_unit(static_cast<std::int64_t>(unit))
                            : std::nullopt;
    if (!metres) {
      return std::unexpected(records_.error(std::next(name)->line, ReadFault::out_of_range,
                                            fmt::format("$INSUNITS is {}, a unit that is not known", unit),
                                            "save the drawing in metres ($INSUNITS 6)"));
    }
    unit_stated_ = unit > 0;
    metres_ = *metres;
    return {};
  }

  [[nodiscard]] std::string layer() const {
    const DxfPair* name = record_.find(8);
    return name == nullptr ? "0" : std::string{name->value};
  }

  /// Coordinates under the codes first, first + 10, first + 20; z is 0 when it is not given.
  std::expected<Vec3, ReadError> point(int first) const {
    if (record_.find(first) == nullptr || record_.find(first + 10) == nullptr) {
      return std::unexpected(
          records_.error(record_.line, ReadFault::syntax,
                         fmt::format("a {} has no coordinates {} and {}", shown(record_.type), first, first + 10),
                         "save the drawing again"));
    }
    CLEAVE_TRY(const double x, records_.number(record_, first, 0));
    CLEAVE_TRY(const double y, records_.number(record_, first + 10, 0));
    CLEAVE_TRY(const double z, records_.number(record_, first + 20, 0));
    return scaled({x, y, z});
  }

  std::expected<Vec3, ReadError> scaled(Vec3 p) const {
    const Vec3 at = p * metres_;
    if (geometry::is_finite(at)) return at;
    return std::unexpected(records_.error(record_.line, ReadFault::bad_number, "a coordinate is beyond the numbers",
                                          "correct the coordinate"));
  }

  std::expected<Vec3, ReadError> extrusion() const {
    CLEAVE_TRY(const double x, records_.number(record_, 210, 0));
    CLEAVE_TRY(const double y, records_.number(record_, 220, 0));
    CLEAVE_TRY(const double z, records_.number(record_, 230, 1));
    return Vec3{x, y, z};
  }

  std::expected<void, ReadError> read_entity() {
    if (polyline_ && record_.type != "VERTEX" && record_.type != "SEQEND") return need_no_polyline();
    if (record_.type == "3DFACE") return read_face();
    if (record_.type == "POLYLINE") return begin_polyline();
    if (record_.type == "VERTEX") return read_vertex();
    if (record_.type == "SEQEND") return end_polyline();
    if (record_.type == "LWPOLYLINE") return read_light_polyline();
    if (skipped_.size() < 100) ++skipped_[std::string{record_.type.substr(0, 30)}];
    return {};
  }

  std::expected<void, ReadError> read_face() {
    std::array<Vec3, 4> corners;
    for (int c = 0; c < 3; ++c) {
      CLEAVE_TRY(corners[static_cast<std::size_t>(c)], point(10 + c));
    }
    corners[3] = corners[2];
    if (record_.find(13) != nullptr) {
      CLEAVE_TRY(corners[3], point(13));
    }
    return add_face(corners, layer(), record_.line);
  }

  std::expected<void, ReadError> add_face(std::span<const Vec3> corners, const std::string& layer, std::uint32_t line) {
    if (faces_.builder().full(6)) {
      return std::unexpected(
          records_.error(line, ReadFault::too_large, "there are more than 2^32 - 2 corners", "split the file"));
    }
    faces_.add(corners, faces_.builder().group_named(layer), line);
    return {};
  }

  std::expected<void, ReadError> begin_polyline() {
    Polyline line;
    line.layer = layer();
    line.line = record_.line;
    CLEAVE_TRY(line.flags, records_.integer(record_, 70, 0));
    CLEAVE_TRY(line.m, records_.integer(record_, 71, 0));
    CLEAVE_TRY(line.n, records_.integer(record_, 72, 0));
    CLEAVE_TRY(line.elevation, records_.number(record_, 30, 0));
    CLEAVE_TRY(line.extrusion, extrusion());
    if (line.flags < 0) line.flags = 0;
    polyline_ = std::move(line);
    return {};
  }

  std::expected<void, ReadError> read_vertex() {
    if (!polyline_) {
      return std::unexpected(
          records_.error(record_.line, ReadFault::syntax, "a VERTEX outside a POLYLINE", "save the drawing again"));
    }
    CLEAVE_TRY(const std::int64_t flags, records_.integer(record_, 70, 0));
    if (flags > 0 && (flags & spline_frame) != 0) return {};
    PolylineVertex vertex;
    vertex.line = record_.line;
    vertex.is_face = flags > 0 && (flags & polyface_record) != 0 && (flags & polyface_vertex) == 0;
    if (vertex.is_face) {
      for (int c = 0; c < 4; ++c) {
        CLEAVE_TRY(vertex.face[static_cast<std::size_t>(c)], records_.integer(record_, 71 + c, 0));
      }
    } else {
      CLEAVE_TRY(vertex.at, point(10));
      CLEAVE_CHECK(look_at_bulge());
    }
    polyline_->vertices.push_back(vertex);
    return {};
  }

  std::expected<void, ReadError> look_at_bulge() {
    CLEAVE_TRY(const double bulge, records_.number(record_, 42, 0));
    if (bulge != 0) ++arcs_;
    return {};
  }

  std::expected<void, ReadError> end_polyline() {
    if (!polyline_) return {};
    const Polyline line = *std::exchange(polyline_, std::nullopt);
    if ((line.flags & polyface) != 0) return add_polyface(line);
    if ((line.flags & mesh) != 0) return add_mesh(line);
    std::vector<Vec3> corners;
    for (const PolylineVertex& vertex : line.vertices) {
      if (!vertex.is_face) corners.push_back(vertex.at);
    }
    if ((line.flags & in_space) == 0) {
      for (Vec3& p : corners) p.z = line.elevation * metres_;
      CLEAVE_CHECK(to_space(corners, line.extrusion, line.line));
    }
    return add_polygon(std::move(corners), (line.flags & closed) != 0, line.layer, line.line);
  }

  std::expected<void, ReadError> to_space(std::vector<Vec3>& corners, Vec3 normal, std::uint32_t line) const {
    if (normal == Vec3{0, 0, 1}) return {};
    const auto axes = plane_axes(normal);
    if (!axes) {
      return std::unexpected(records_.error(line, ReadFault::out_of_range, "the extrusion direction has no direction",
                                            "correct the group codes 210, 220 and 230"));
    }
    for (Vec3& p : corners) {
      p = (*axes)[0] * p.x + (*axes)[1] * p.y + (*axes)[2] * p.z;
      if (!geometry::is_finite(p)) {
        return std::unexpected(
            records_.error(line, ReadFault::bad_number, "a coordinate is beyond the numbers", "correct it"));
      }
    }
    return {};
  }

  std::expected<void, ReadError> add_polyface(const Polyline& line) {
    std::vector<Vec3> points;
    for (const PolylineVertex& vertex : line.vertices) {
      if (!vertex.is_face) points.push_back(vertex.at);
    }
    for (const PolylineVertex& face : line.vertices) {
      if (!face.is_face) continue;
      std::vector<Vec3> corners;
      for (const std::int64_t number : face.face) {
        if (number == 0) continue;
        const auto index = static_cast<std::uint64_t>(std::abs(number));
        if (index > points.size()) {
          return std::unexpected(records_.error(face.line, ReadFault::out_of_range,
                                                fmt::format("a polyface names vertex {} of {}", index, points.size()),
                                                "save the drawing again"));
        }
        corners.push_back(points[index - 1]);
      }
      CLEAVE_CHECK(add_face(corners, line.layer, face.line));
    }
    return {};
  }

  std::expected<void, ReadError> add_mesh(const Polyline& line) {
    const auto count = static_cast<std::int64_t>(line.vertices.size());
    if (line.m < 2 || line.n < 2 || line.m > count || line.n > count || line.m * line.n != count) {
      return std::unexpected(records_.error(
          line.line, ReadFault::out_of_range,
          fmt::format("a mesh of {} x {} points has {} vertices", line.m, line.n, count), "save the drawing again"));
    }
    const auto m = static_cast<std::size_t>(line.m);
    const auto n = static_cast<std::size_t>(line.n);
    const auto at = [&](std::size_t i, std::size_t j) { return line.vertices[(i % m) * n + j % n].at; };
    const std::size_t rows = (line.flags & closed) != 0 ? m : m - 1;
    const std::size_t columns = (line.flags & mesh_closed_n) != 0 ? n : n - 1;
    for (std::size_t i = 0; i < rows; ++i) {
      for (std::size_t j = 0; j < columns; ++j) {
        CLEAVE_CHECK(
            add_face(std::array{at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)}, line.layer, line.line));
      }
    }
    return {};
  }

  std::expected<void, ReadError> read_light_polyline() {
    CLEAVE_TRY(const std::int64_t flags, records_.integer(record_, 70, 0));
    CLEAVE_TRY(const std::int64_t stated, records_.integer(record_, 90, -1));
    CLEAVE_TRY(const double elevation, records_.number(record_, 38, 0));
    CLEAVE_TRY(const Vec3 normal, extrusion());
    std::vector<Vec3> corners;
    bool complete = true;
    for (const DxfPair& pair : record_.pairs) {
      if (pair.code != 10 && pair.code != 20 && pair.code != 42) continue;
      CLEAVE_TRY(const double value, records_.number(pair));
      if (pair.code == 10) {
        corners.push_back({value, 0, elevation});
        complete = false;
      } else if (pair.code == 20 && !corners.empty()) {
        corners.back().y = value;
        complete = true;
      } else if (value != 0) {
        ++arcs_;
      }
    }
    if (!complete || (stated >= 0 && static_cast<std::size_t>(stated) != corners.size())) {
      return std::unexpected(
          records_.error(record_.line, ReadFault::syntax,
                         fmt::format("a LWPOLYLINE says it has {} corners and has {}", stated, corners.size()),
                         "save the drawing again"));
    }
    for (Vec3& p : corners) {
      CLEAVE_TRY(p, scaled(p));
    }
    CLEAVE_CHECK(to_space(corners, normal, record_.line));
    return add_polygon(std::move(corners), (flags & 1) != 0, layer(), record_.line);
  }

  std::expected<void, ReadError> add_polygon(std::vector<Vec3> corners, bool is_closed, const std::string& layer,
                                             std::uint32_t line) {
    const bool returns = corners.size() > 3 && corners.front() == corners.back();
    if (returns) corners.pop_back();
    if (!is_closed && !returns) {
      ++open_;
      return {};
    }
    if (corners.size() < 3 || corners.size() > most_corners) {
      return std::unexpected(records_.error(line, ReadFault::out_of_range,
                                            fmt::format("a closed polyline has {} corners", corners.size()),
                                            fmt::format("a polygon has 3 to {}", most_corners)));
    }
    if (polygons_.full(corners.size())) {
      return std::unexpected(
          records_.error(line, ReadFault::too_large, "there are more than 2^32 - 2 corners", "split the file"));
    }
    polygons_.add_face(corners, polygons_.group_named(layer), line);
    return {};
  }

  std::expected<Surfaces, ReadError> finish() {
    Surfaces result;
    if (!unit_stated_) {
      result.notes.emplace_back("the drawing does not state its unit: metres are taken");
    } else if (metres_ != 1) {
      result.notes.push_back(fmt::format("converted to metres: its unit is {} m", metres_));
    }
    faces_.describe(result.notes);
    if (arcs_ > 0) result.notes.push_back(fmt::format("{} arcs of polylines became straight", arcs_));
    if (open_ > 0) result.notes.push_back(fmt::format("{} open polylines are not read", open_));
    std::string others;
    for (const auto& [type, count] : skipped_) {
      others += fmt::format("{}{} {}", others.empty() ? "" : ", ", count, shown(type));
    }
    if (!others.empty()) result.notes.push_back(fmt::format("not read: {}", others));
    result.polygons = std::move(polygons_).finish();
    result.surfaces = std::move(faces_.builder()).finish();
    if (result.faces() > 0) return result;
    return std::unexpected(
        whole(ReadFault::empty,
              fmt::format("holds no 3DFACE, mesh or closed polyline with an area{}{}", others.empty() ? "" : ", only ",
                          others),
              "explode blocks, turn solids into meshes or 3DFACEs, close polylines, and save again"));
  }

  DxfRecords records_;
  std::string_view file_;
  DxfRecord record_;
  std::optional<Polyline> polyline_;
  FaceCleaner faces_;
  MeshBuilder polygons_;
  double metres_ = 1;
  bool unit_stated_ = false;
  std::uint64_t arcs_ = 0;
  std::uint64_t open_ = 0;
  std::map<std::string, std::uint64_t> skipped_;
};

}  // namespace

std::expected<Surfaces, ReadError> parse_dxf(std::string_view bytes, std::string_view name) {
  const auto fail = [&](std::string what, std::string remedy) {
    return std::unexpected(whole_file(ReadFault::unknown_format, name, std::move(what), std::move(remedy)));
  };
  const std::string_view text = without_bom(bytes);
  if (trimmed(text).empty()) {
    return std::unexpected(whole_file(ReadFault::empty, name, "is empty", "give a drawing with faces"));
  }
  if (text.starts_with("AutoCAD Binary DXF")) return fail("is a binary DXF", "save it as DXF text (ASCII)");
  if (text.starts_with("AC10")) return fail("is a DWG drawing", "save it as DXF text (ASCII)");
  return DxfReader{text, name}.run();
}

}  // namespace cleave::io
