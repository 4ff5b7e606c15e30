#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/nearest.hpp"
#include "cleave/core/text.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/io/field_tables.hpp"
#include "cleave/io/joint_csv.hpp"
#include "column_reader.hpp"
#include "csv_table.hpp"
#include "text.hpp"

namespace cleave::io {
namespace {

/// A column that is not understood, with the one that may be meant.
std::string not_used(std::string_view cell, std::span<const ColumnNames> known) {
  std::vector<std::string_view> names;
  for (const ColumnNames& k : known) names.push_back(k.names[0]);
  const auto meant = cell.size() > 2 ? nearest(cell, names) : std::nullopt;
  return fmt::format("column {} is not used{}", shown(cell),
                     meant ? fmt::format("; where it is meant as {0}, name it {0}", *meant) : std::string{});
}

/// The rows of a table: `Reader` checks the header and reads a row.
template <class Row, class Reader>
std::expected<MappedTable<Row>, std::vector<ReadError>> read(std::string_view bytes, std::string_view name,
                                                             std::span<const ColumnNames> known,
                                                             std::string_view example) {
  CLEAVE_TRY(const CsvTable csv, table_of_text(bytes, name));
  ColumnReader columns{csv, name, known};
  const bool found = columns.find_columns(
      example, [&](std::size_t c) { return std::optional{not_used(csv.header[c], known)}; },
      [](std::size_t) { return std::optional<std::string>{}; });
  MappedTable<Row> table;
  Reader reader{columns};
  if (found) reader.check_header();
  if (columns.problems() > 0) return std::unexpected(columns.take_problems());
  for (const CsvTable::Row& row : csv.rows) {
    const std::size_t before = columns.problems();
    if (before >= ColumnReader::most_problems) break;
    if (!columns.has_all_cells(row)) continue;
    Row read = reader.row(row);
    read.line = row.line;
    if (columns.problems() == before) table.rows.push_back(std::move(read));
  }
  if (columns.problems() > 0) return std::unexpected(columns.take_problems());
  table.notes = std::move(columns.notes());
  reader.add_notes(table.notes);
  return table;
}

// ---- traces ---------------------------------------------------------------------------------------------------------

/// Columns of a plane as it was measured.
struct PlaneColumns {
  std::uint8_t dip, dip_direction, strike;
};
constexpr ColumnNames dip_names{"degrees", {"dip", "dip_angle", "dipangle"}};
constexpr ColumnNames dip_direction_names{"degrees",
                                          {"dip_direction", "dipdirection", "dipdir", "dip_dir", "dip_azimuth", "dd"}};
constexpr ColumnNames strike_names{"degrees", {"strike"}};

class PlaneReader final {
 public:
  PlaneReader(ColumnReader& columns, const PlaneColumns& at) : columns_{columns}, at_{at} {}

  void check_header() {
    const bool direction = columns_.has(at_.dip_direction) || columns_.has(at_.strike);
    if (columns_.has(at_.dip) != direction) {
      columns_.bad_header(direction ? "there is no column dip" : "there is no column dip_direction or strike",
                          "give both, or none: the planes are then not measured");
    }
    if (columns_.has(at_.dip_direction) && columns_.has(at_.strike)) {
      columns_.bad_header("there are both dip_direction and strike", "give one of them");
    }
  }

  /// None where the cells are empty.
  std::optional<geometry::Attitude> plane(const CsvTable::Row& row) {
    const std::uint8_t bearing = columns_.has(at_.strike) ? at_.strike : at_.dip_direction;
    if (columns_.cell(row, at_.dip).empty() && columns_.cell(row, bearing).empty()) return std::nullopt;
    const double steep = columns_.required(row, at_.dip);
    double direction = columns_.required(row, bearing);
    angles_.look_at(steep, direction);
    if (!(steep >= 0 && steep <= 90)) {
      columns_.problem(row, at_.dip, ReadFault::out_of_range, fmt::format("dip is {}, outside 0..90", steep),
                       "correct it");
    }
    if (!(direction >= 0 && direction <= 360)) {
      columns_.problem(row, bearing, ReadFault::out_of_range,
                       fmt::format("{} is {}, outside 0..360", columns_.name_of(bearing), direction), "correct it");
    }
    if (bearing == at_.strike) direction += 90;
    return geometry::Attitude{Dip::degrees(steep), DipDirection::degrees(geometry::wrap_degrees(direction))};
  }

  void add_notes(std::vector<std::string>& notes) const {
    if (!columns_.has(at_.dip) || columns_.unit(at_.dip) != nullptr) return;
    if (auto note = angles_.note(columns_.name_of(at_.dip))) notes.push_back(*std::move(note));
  }

 private:
  ColumnReader& columns_;
  PlaneColumns at_;
  AngleWatch angles_;
};

enum TraceColumn : std::uint8_t {
  x1,
  y1,
  z1,
  x2,
  y2,
  z2,
  face,
  trace_set,
  trace_joint,
  end1,
  end2,
  t_dip,
  t_dd,
  t_strike
};
constexpr std::array<ColumnNames, 14> trace_columns{{
    {"m", {"x1", "x_1", "easting1", "easting_1"}},
    {"m", {"y1", "y_1", "northing1", "northing_1"}},
    {"m", {"z1", "z_1", "elevation1", "elevation_1"}},
    {"m", {"x2", "x_2", "easting2", "easting_2"}},
    {"m", {"y2", "y_2", "northing2", "northing_2"}},
    {"m", {"z2", "z_2", "elevation2", "elevation_2"}},
    {"", {"face"}},
    {"", {"set", "joint_set", "set_id"}},
    {"", {"joint", "joint_id", "id"}},
    {"", {"end1", "end_1"}},
    {"", {"end2", "end_2"}},
    dip_names,
    dip_direction_names,
    strike_names,
}};

class TraceReader final {
 public:
  explicit TraceReader(ColumnReader& columns) : columns_{columns}, planes_{columns, {t_dip, t_dd, t_strike}} {}

  void check_header() {
    std::string missing;
    for (const TraceColumn c : {x1, y1, z1, x2, y2, z2}) {
      if (!columns_.has(c)) missing += (missing.empty() ? "" : ", ") + std::string{columns_.name_of(c)};
    }
    if (!missing.empty()) {
      columns_.bad_header(fmt::format("columns of the ends of traces are missing: {}", missing),
                          "add x1, y1, z1 and x2, y2, z2 (m): where the trace begins and ends");
    }
    planes_.check_header();
  }

  TraceRow row(const CsvTable::Row& row) {
    TraceRow out;
    out.face = columns_.text(row, face);
    out.set = columns_.text(row, trace_set);
    out.joint = columns_.text(row, trace_joint);
    out.ends[0] = {columns_.required(row, x1), columns_.required(row, y1), columns_.required(row, z1)};
    out.ends[1] = {columns_.required(row, x2), columns_.required(row, y2), columns_.required(row, z2)};
    out.goes_on = {goes_on(row, end1), goes_on(row, end2)};
    out.plane = planes_.plane(row);
    return out;
  }
  void add_notes(std::vector<std::string>& notes) const { planes_.add_notes(notes); }

 private:
  std::optional<bool> goes_on(const CsvTable::Row& row, TraceColumn column) {
    const std::string word = column_name(columns_.cell(row, column));
    if (word.empty()) return std::nullopt;
    if (word == "ends") return false;
    if (word == "goes_on") return true;
    columns_.problem(row, column, ReadFault::syntax,
                     fmt::format("{}: {} is not known", columns_.name_of(column), shown(columns_.cell(row, column))),
                     "write ends (the joint ends there) or goes_on (the face does), or leave it empty");
    return std::nullopt;
  }

  ColumnReader& columns_;
  PlaneReader planes_;
};

// ---- picks ----------------------------------------------------------------------------------------------------------

enum PickColumn : std::uint8_t { hole, depth, x, y, z, dip, dip_direction, strike, pick_set, pick_joint };
constexpr std::array<ColumnNames, 10> pick_columns{{
    {"", {"hole", "hole_id", "holeid", "borehole", "bhid"}},
    {"m", {"depth", "distance", "measured_depth"}},
    {"m", {"x", "easting", "east"}},
    {"m", {"y", "northing", "north"}},
    {"m", {"z", "elevation"}},
    dip_names,
    dip_direction_names,
    strike_names,
    {"", {"set", "joint_set", "set_id"}},
    {"", {"joint", "joint_id", "id"}},
}};

class PickReader final {
 public:
  explicit PickReader(ColumnReader& columns) : columns_{columns}, planes_{columns, {dip, dip_direction, strike}} {}

  void check_header() {
    const bool all = columns_.has(x) && columns_.has(y) && columns_.has(z);
    const bool any = columns_.has(x) || columns_.has(y) || columns_.has(z);
    if ((!columns_.has(depth) && !all) || (any && !all)) {
      columns_.bad_header("it is not said where the picks are", "add depth (m along the hole), or x, y and z (m)");
    }
    planes_.check_header();
  }

  PickRow row(const CsvTable::Row& row) {
    PickRow out;
    out.hole = columns_.text(row, hole);
    out.set = columns_.text(row, pick_set);
    out.joint = columns_.text(row, pick_joint);
    if (const auto along = columns_.number(row, depth)) out.depth = metres(*along);
    const bool placed =
        !columns_.cell(row, x).empty() || !columns_.cell(row, y).empty() || !columns_.cell(row, z).empty();
    if (placed) out.position = {columns_.required(row, x), columns_.required(row, y), columns_.required(row, z)};
    if (placed == !columns_.cell(row, depth).empty()) {
      columns_.problem(row, columns_.has(depth) ? depth : x, ReadFault::syntax,
                       placed ? "gives a depth and x, y, z" : "does not say where the pick is",
                       "give the depth along the hole, or x, y and z");
    }
    out.plane = planes_.plane(row);
    return out;
  }
  void add_notes(std::vector<std::string>& notes) const { planes_.add_notes(notes); }

 private:
  ColumnReader& columns_;
  PlaneReader planes_;
};

}  // namespace

std::expected<MappedTable<TraceRow>, std::vector<ReadError>> parse_trace_csv(std::string_view bytes,
                                                                             std::string_view name) {
  return read<TraceRow, TraceReader>(bytes, name, trace_columns, "face,set,joint,x1,y1,z1,x2,y2,z2");
}

std::expected<MappedTable<PickRow>, std::vector<ReadError>> parse_pick_csv(std::string_view bytes,
                                                                           std::string_view name) {
  return read<PickRow, PickReader>(bytes, name, pick_columns, "hole,set,joint,depth");
}

}  // namespace cleave::io
