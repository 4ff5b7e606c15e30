#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/geometry/polygon.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/io/file.hpp"

namespace cleave::io {

/// How far a measured joint reaches.
struct Persistent {
  friend bool operator==(const Persistent&, const Persistent&) = default;
};
struct DiscSize {
  Length radius;
  friend bool operator==(const DiscSize&, const DiscSize&) = default;
};
struct RectangleSize {
  Length side_a, side_b;  ///< whole sides, a along the strike before rotation
  geometry::InPlaneRotation rotation;
  friend bool operator==(const RectangleSize&, const RectangleSize&) = default;
};

/// One row of a table of joints.
struct JointRow {
  std::uint32_t line = 0;                  ///< in the file, from 1
  geometry::Attitude plane;                ///< as written: clockwise from the file's north
  std::optional<geometry::Vec3> position;  ///< m; always present unless JointCsvOptions::need_position is false
  std::variant<Persistent, DiscSize, RectangleSize> size;
  std::optional<FrictionAngle> friction;
  std::optional<Stress> cohesion;
  std::optional<Stress> tension = {};
  std::string set;  ///< "" when not given
  std::string id;
  friend bool operator==(const JointRow&, const JointRow&) = default;
};
struct JointTable {
  std::vector<JointRow> rows;
  std::vector<std::string> notes;  ///< how the columns were read, and those that were not understood and skipped
  /// The header states the unit of the column; without, numbers are degrees and Pa.
  bool friction_unit = false, cohesion_unit = false, tension_unit = false;
};

struct JointCsvOptions {
  /// Accept dips outside 0..90 and directions outside 0..360 and turn them to the same plane inside.
  bool wrap = false;
  /// False for tables of orientations only.
  bool need_position = true;
};

/// Joints from a table with a header. Columns in any order, in either case, blanks and hyphens as underscores: dip
/// (dip_angle), dip_direction (dipdir, dip_dir, dd, azimuth) or strike (right-hand rule), or trend and plunge of the
/// pole (the normal that points down), x (easting), y (northing), z
/// (elevation), radius | diameter | side_a, side_b, rotation | none = persistent, set, friction (degrees), cohesion
/// (Pa), tension (Pa), id; a unit in brackets or after an underscore behind the name ("cohesion (kPa)", "cohesion_kpa")
/// counts. A column that is not understood but holds a
/// number where a joint would be left persistent is an error.
/// Comma or semicolon, found from the header; quotes; decimal comma with semicolons when no number has a point; BOM,
/// CRLF, blank lines and # lines are skipped. Up to 20 problems are collected.
[[nodiscard]] std::expected<JointTable, std::vector<ReadError>> parse_joint_csv(std::string_view bytes,
                                                                                std::string_view name,
                                                                                const JointCsvOptions& options = {});
[[nodiscard]] std::expected<JointTable, std::vector<ReadError>> read_joint_csv(const std::filesystem::path& path,
                                                                               const JointCsvOptions& options = {});

/// The table as parse_joint_csv reads it back: only columns that some row needs.
[[nodiscard]] std::string write_joint_csv(const JointTable& table);

/// One row of a table of traces that were mapped on faces of rock.
struct TraceRow {
  std::uint32_t line = 0;        ///< in the file, from 1
  std::string face, set, joint;  ///< "" when not given
  std::array<geometry::Vec3, 2> ends;
  /// Whether the joint goes on there, out of sight; empty: not said.
  std::array<std::optional<bool>, 2> goes_on;
  std::optional<geometry::Attitude> plane = {};  ///< of the joint, as written: clockwise from the file's north
};
/// One row of a table of joints that were picked in holes.
struct PickRow {
  std::uint32_t line = 0;
  std::string hole, set, joint;
  std::optional<Length> depth;              ///< along the hole; or
  std::optional<geometry::Vec3> position;   ///< m
  std::optional<geometry::Attitude> plane;  ///< as written: clockwise from the file's north
};
template <class Row>
struct MappedTable {
  std::vector<Row> rows;
  std::vector<std::string> notes;  ///< how the columns were read, and those that were not understood and skipped
};

/// Tables with a header, as tables of joints have. Traces: x1, y1, z1, x2, y2, z2; face, set, joint, end1 and end2
/// ("ends" or "goes_on") where they are known. Picks: depth, or x, y, z; hole, set, joint. Both: dip with dip_direction
/// or strike, as measured. A table without rows is a table: nothing was seen.
[[nodiscard]] std::expected<MappedTable<TraceRow>, std::vector<ReadError>> parse_trace_csv(std::string_view bytes,
                                                                                           std::string_view name);
[[nodiscard]] std::expected<MappedTable<PickRow>, std::vector<ReadError>> parse_pick_csv(std::string_view bytes,
                                                                                         std::string_view name);

/// Lines and polygons of a map, coordinates as in the file.
struct TraceMap {
  std::vector<std::vector<std::array<double, 2>>> lines;
  std::vector<std::vector<std::array<double, 2>>> polygons;  ///< outer rings, without the repeated last corner
  bool unit_known = true;                                    ///< false for digitised pixels: the user must give a scale
  std::vector<std::string> notes;                            ///< what was left out
};

/// By the ending of `name`: .geojson/.json (LineString, MultiLineString, Polygon, MultiPolygon; coordinates in degrees
/// are refused, null geometries skipped), .csv with a header (x1,y1,x2,y2, or trace,x,y), .txt as FracPaQ writes it
/// (one trace a line, x1 y1 x2 y2 ... with tabs, pixels).
[[nodiscard]] std::expected<TraceMap, ReadError> parse_trace_map(std::string_view bytes, std::string_view name);

}  // namespace cleave::io
