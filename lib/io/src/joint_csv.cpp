#include "cleave/io/joint_csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/core/nearest.hpp"
#include "cleave/core/text.hpp"
#include "cleave/core/units.hpp"
#include "cleave/io/field_tables.hpp"
#include "cleave/io/file.hpp"
#include "column_reader.hpp"
#include "csv_table.hpp"
#include "joint_slips.hpp"
#include "text.hpp"

namespace cleave::io {
namespace {

enum class Column : std::uint8_t {
  dip,
  dip_direction,
  strike,
  trend,
  plunge,
  x,
  y,
  z,
  radius,
  diameter,
  side_a,
  side_b,
  rotation,
  friction,
  cohesion,
  tension,
  set,
  id
};
constexpr std::size_t column_count = 18;

/// In the order of `Column`.
constexpr std::array<ColumnNames, column_count> known{{
    {"degrees", {"dip", "dip_angle", "dipangle"}},
    {"degrees", {"dip_direction", "dipdirection", "dipdir", "dip_dir", "dip_azimuth", "dd", "azimuth"}},
    {"degrees", {"strike"}},
    {"degrees", {"trend", "pole_trend"}},
    {"degrees", {"plunge", "pole_plunge"}},
    {"m", {"x", "easting", "east"}},
    {"m", {"y", "northing", "north"}},
    {"m", {"z", "elevation"}},
    {"m", {"radius"}},
    {"m", {"diameter", "diam"}},
    {"m", {"side_a"}},
    {"m", {"side_b"}},
    {"degrees", {"rotation"}},
    {"degrees", {"friction", "friction_angle", "frictionangle", "phi"}},
    {"Pa", {"cohesion"}},
    {"Pa", {"tension", "tensile_strength"}},
    {"", {"set"}},
    {"", {"id"}},
}};

/// What stands for a column in other tables and may be something else here.
constexpr std::array<std::pair<std::string_view, Column>, 3> may_be{{
    {"c", Column::cohesion},
    {"fric", Column::friction},
    {"coh", Column::cohesion},
}};

constexpr std::size_t index(Column column) { return static_cast<std::size_t>(column); }
std::string_view name_of(Column column) { return known[index(column)].names[0]; }

class TableReader final {
 public:
  TableReader(const CsvTable& csv, std::string_view file, const JointCsvOptions& options)
      : csv_{csv}, columns_{csv, file, known}, options_{options} {}

  std::expected<JointTable, std::vector<ReadError>> run() {
    read_header();
    if (columns_.problems() > 0) return std::unexpected(columns_.take_problems());
    for (const CsvTable::Row& row : csv_.rows) {
      read_row(row);
      if (columns_.problems() >= ColumnReader::most_problems) break;
    }
    if (columns_.problems() == 0 && table_.rows.empty()) {
      columns_.report(ReadFault::empty, {}, {}, "has a header but no joints", "add a line for each joint");
    }
    if (columns_.problems() > 0) return std::unexpected(columns_.take_problems());
    table_.notes = std::move(columns_.notes());
    note_radians();
    const bool sized = has(Column::radius) || has(Column::diameter) || has(Column::side_a);
    for (auto& note : {sized ? note_on_endless(table_.rows) : std::nullopt, note_on_repeated(table_.rows)}) {
      if (note) table_.notes.push_back(*note);
    }
    return std::move(table_);
  }

 private:
  // ---- header
  // -----------------------------------------------------------------------------------------------------------

  [[nodiscard]] bool has(Column column) const { return columns_.has(index(column)); }

  /// Of a name that is not understood: the column of which it may be a slip or a short form.
  static std::optional<Column> may_mean(std::string_view cell) {
    for (const auto& [name, column] : may_be) {
      if (cell == name || cell.starts_with(std::string{name} + '_')) return column;
    }
    if (cell.size() <= 3) return std::nullopt;
    std::vector<std::string_view> names;
    for (const ColumnNames& k : known) names.push_back(k.names[0]);
    const auto guess = nearest(cell, names);
    if (!guess) return std::nullopt;
    return static_cast<Column>(std::ranges::find(names, *guess) - names.begin());
  }
  static bool is_size(Column column) {
    return column == Column::radius || column == Column::diameter || column == Column::side_a ||
           column == Column::side_b;
  }
  static std::string not_used(std::string_view cell) {
    std::string remedy;
    if (const auto meant = may_mean(cell)) {
      remedy = fmt::format("; where it is meant as {0}, name it {0}", name_of(*meant));
    } else if (cell == "jrc" || cell == "jcs") {
      remedy = "; the law of Barton and Bandis is given by set: jrc and jcs of [joints.NAME]";
    }
    return fmt::format("column {} is not used{}", shown(cell), remedy);
  }

  void read_header() {
    const auto wrong = [&](std::string what, std::string remedy) {
      columns_.bad_header(std::move(what), std::move(remedy));
    };
    const auto unknown = [&](std::size_t c) -> std::optional<std::string> {
      unknown_.push_back(c);
      return not_used(csv_.header[c]);
    };
    const auto may_be_strike = [&](std::size_t c) -> std::optional<std::string> {
      const std::string& cell = csv_.header[c];
      if (!cell.starts_with("azimuth")) return std::nullopt;  // some call the strike so
      return fmt::format("{} is read as the dip direction; where it is the strike, name it strike", shown(cell));
    };
    if (!columns_.find_columns("dip,dip_direction,x,y,z (both orders of dip and direction are in use)", unknown,
                               may_be_strike)) {
      return;
    }
    const auto states_unit = [&](Column column) { return columns_.unit(index(column)) != nullptr; };
    table_.friction_unit = states_unit(Column::friction);
    table_.cohesion_unit = states_unit(Column::cohesion);
    table_.tension_unit = states_unit(Column::tension);
    const bool plane = has(Column::dip) || has(Column::dip_direction) || has(Column::strike);
    const bool pole = !plane && (has(Column::trend) || has(Column::plunge));
    if (plane && (has(Column::trend) || has(Column::plunge))) {
      columns_.notes().emplace_back("trend and plunge are not used beside dip");
      columns_.forget(index(Column::trend));
      columns_.forget(index(Column::plunge));
    }
    if (pole && has(Column::trend) != has(Column::plunge)) {
      wrong("of trend and plunge of the pole one is missing", "give both");
    }
    if (!pole && !has(Column::dip)) wrong("there is no column dip", "add it (degrees from horizontal)");
    if (!pole && has(Column::dip_direction) == has(Column::strike)) {
      wrong(has(Column::strike) ? "there are both dip_direction and strike"
                                : "there is no column dip_direction or strike",
            "give one of them");
    }
    const int axes = int{has(Column::x)} + int{has(Column::y)} + int{has(Column::z)};
    if (axes != 3 && (options_.need_position || axes != 0))
      wrong("the columns x, y and z are not all there", "add the missing ones");
    if (has(Column::side_a) != has(Column::side_b)) wrong("of side_a and side_b one is missing", "give both");
    if (has(Column::rotation) && !has(Column::side_a))
      wrong("rotation goes with side_a and side_b", "add them, or remove rotation");
  }

  // ---- rows
  // -------------------------------------------------------------------------------------------------------------

  [[nodiscard]] std::string_view cell(const CsvTable::Row& row, Column column) const {
    return columns_.cell(row, index(column));
  }
  std::optional<double> number(const CsvTable::Row& row, Column column) { return columns_.number(row, index(column)); }
  double required(const CsvTable::Row& row, Column column) { return columns_.required(row, index(column)); }
  void problem(const CsvTable::Row& row, Column column, ReadFault fault, std::string what, std::string remedy) {
    columns_.problem(row, index(column), fault, std::move(what), std::move(remedy));
  }

  /// A number in a column that is not understood may be the size that this joint lacks.
  void look_for_size(const CsvTable::Row& row) {
    constexpr std::array<std::string_view, 8> never{"no", "nr", "number", "jrc", "jcs", "aperture", "spacing", "rqd"};
    for (const std::size_t c : unknown_) {
      std::string plain = row.cells[c];
      if (csv_.separator == ';') std::ranges::replace(plain, ',', '.');
      const auto value = number_of(plain);
      if (!value || !(*value > 0) || std::ranges::find(never, csv_.header[c]) != never.end()) continue;
      if (const auto meant = may_mean(csv_.header[c]); meant && !is_size(*meant)) continue;
      columns_.report(
          ReadFault::bad_columns, csv_.header_line, static_cast<std::uint32_t>(c) + 1,
          fmt::format("column {} is not understood, and the joint of line {} has no size without it",
                      shown(csv_.header[c]), row.line),
          "name it radius, diameter, or side_a and side_b; where it is no size and joints are meant to go through "
          "the whole domain, remove it");
      told_of_size_ = true;
      return;
    }
  }

  std::optional<double> in_range(const CsvTable::Row& row, Column column, bool (*allowed)(double), const char* range) {
    const std::optional<double> value = number(row, column);
    if (!value || allowed(*value)) return value;
    problem(row, column, ReadFault::out_of_range, fmt::format("{} is {}", name_of(column), *value),
            fmt::format("it must be {}", range));
    return std::nullopt;
  }

  void note_radians() {
    const Column inclined = has(Column::trend) ? Column::plunge : Column::dip;
    if (columns_.unit(index(inclined)) != nullptr) return;
    if (auto note = angles_.note(name_of(inclined))) table_.notes.push_back(*std::move(note));
  }
  /// What to do about a direction beyond a whole turn.
  [[nodiscard]] static std::string remedy_of_direction(Column column, double degrees) {
    if (!(degrees > 360 && degrees <= 400)) return "correct it, or set wrap = true";
    return fmt::format("correct it; in gon name the column \"{} (gon)\"; or set wrap = true", name_of(column));
  }

  /// Of the pole: the normal that points down.
  geometry::Attitude of_pole(const CsvTable::Row& row) {
    const double trend = required(row, Column::trend), plunge = required(row, Column::plunge);
    angles_.look_at(plunge, trend);
    if (!options_.wrap && !(plunge >= 0 && plunge <= 90)) {
      problem(row, Column::plunge, ReadFault::out_of_range, fmt::format("plunge is {}, outside 0..90", plunge),
              "correct it, or set wrap = true");
    }
    if (!options_.wrap && !(trend >= 0 && trend <= 360)) {
      problem(row, Column::trend, ReadFault::out_of_range, fmt::format("trend is {}, outside 0..360", trend),
              remedy_of_direction(Column::trend, trend));
    }
    return within(90 - plunge, geometry::wrap_degrees(trend) + 180);
  }

  geometry::Attitude attitude(const CsvTable::Row& row) {
    if (has(Column::trend)) return of_pole(row);
    const Column bearing = has(Column::strike) ? Column::strike : Column::dip_direction;
    const double dip = required(row, Column::dip);
    double direction = required(row, bearing);
    angles_.look_at(dip, direction);
    if (!options_.wrap) {
      if (!(dip >= 0 && dip <= 90)) {
        // In the other order the row would be right.
        const bool swapped = dip > 90 && dip <= 360 && direction >= 0 && direction <= 90;
        problem(row, Column::dip, ReadFault::out_of_range, fmt::format("dip is {}, outside 0..90", dip),
                swapped
                    ? fmt::format("are dip and {} swapped? Then swap their names in the header; else correct it, or "
                                  "set wrap = true",
                                  name_of(bearing))
                    : "correct it, or set wrap = true");
      }
      if (!(direction >= 0 && direction <= 360)) {
        problem(row, bearing, ReadFault::out_of_range,
                fmt::format("{} is {}, outside 0..360", name_of(bearing), direction),
                remedy_of_direction(bearing, direction));
      }
    }
    if (bearing == Column::strike) direction = geometry::wrap_degrees(direction) + 90;
    return within(dip, direction);
  }

  /// The same plane with a dip in 0..90 and a direction in 0..360.
  static geometry::Attitude within(double dip, double direction) {
    dip = geometry::wrap_degrees(dip);
    if (dip > 180) {  // a dip upwards is a dip the other way
      dip = 360 - dip;
      direction = geometry::wrap_degrees(direction) + 180;
    }
    if (dip > 90) {
      dip = 180 - dip;
      direction = geometry::wrap_degrees(direction) + 180;
    }
    return {Dip::degrees(dip), DipDirection::degrees(geometry::wrap_degrees(direction))};
  }

  std::variant<Persistent, DiscSize, RectangleSize> size(const CsvTable::Row& row) {
    const auto positive = [](double v) { return v > 0; };
    const std::optional<double> radius = in_range(row, Column::radius, positive, "positive");
    const std::optional<double> diameter = in_range(row, Column::diameter, positive, "positive");
    const std::optional<double> a = in_range(row, Column::side_a, positive, "positive");
    const std::optional<double> b = in_range(row, Column::side_b, positive, "positive");
    const std::optional<double> rotation = number(row, Column::rotation);
    const bool filled_a = !cell(row, Column::side_a).empty();
    const bool filled_b = !cell(row, Column::side_b).empty();
    if (!cell(row, Column::radius).empty() && !cell(row, Column::diameter).empty()) {
      problem(row, Column::diameter, ReadFault::syntax, "a joint has a radius or a diameter, not both",
              "leave one of them empty");
    }
    const bool round = !cell(row, Column::radius).empty() || !cell(row, Column::diameter).empty();
    if (round && (filled_a || filled_b)) {
      problem(row, Column::radius, ReadFault::syntax, "a joint has a radius (or diameter) or sides, not both",
              "leave one of them empty");
    }
    if (filled_a != filled_b)
      problem(row, filled_a ? Column::side_b : Column::side_a, ReadFault::syntax, "of side_a and side_b one is empty",
              "give both");
    if (rotation && !filled_a)
      problem(row, Column::rotation, ReadFault::syntax, "a joint without sides has no rotation", "leave it empty");
    if (diameter) return DiscSize{metres(0.5 * *diameter)};
    if (radius) return DiscSize{metres(*radius)};
    if (a && b) return RectangleSize{metres(*a), metres(*b), geometry::InPlaneRotation::degrees(rotation.value_or(0))};
    if (!round && !filled_a && !filled_b && !told_of_size_) look_for_size(row);
    return Persistent{};
  }

  void read_row(const CsvTable::Row& row) {
    const std::size_t before = columns_.problems();
    if (!columns_.has_all_cells(row)) return;
    JointRow joint{.line = row.line,
                   .plane = attitude(row),
                   .position = {},
                   .size = size(row),
                   .friction = {},
                   .cohesion = {},
                   .tension = {},
                   .set = {},
                   .id = {}};
    if (has(Column::x)) {
      const double x = required(row, Column::x);
      const double y = required(row, Column::y);
      const double z = required(row, Column::z);
      joint.position = geometry::Vec3{x, y, z};
    }
    const auto friction =
        in_range(row, Column::friction, [](double v) { return v >= 0 && v < 90; }, "in 0..90 (degrees), 90 excluded");
    const auto strength = [&](Column column) {
      return in_range(row, column, [](double v) { return v >= 0; }, "0 or more (Pa)");
    };
    const auto cohesion = strength(Column::cohesion), tension = strength(Column::tension);
    if (friction) joint.friction = FrictionAngle::degrees(*friction);
    if (cohesion) joint.cohesion = pascals(*cohesion);
    if (tension) joint.tension = pascals(*tension);
    joint.set = columns_.text(row, index(Column::set));
    joint.id = cell(row, Column::id);
    if (columns_.problems() == before) table_.rows.push_back(std::move(joint));
  }

  const CsvTable& csv_;
  ColumnReader columns_;
  JointCsvOptions options_;
  std::vector<std::size_t> unknown_;  ///< columns that are not understood
  bool told_of_size_ = false;
  AngleWatch angles_;
  JointTable table_;
};

}  // namespace

std::expected<JointTable, std::vector<ReadError>> parse_joint_csv(std::string_view bytes, std::string_view name,
                                                                  const JointCsvOptions& options) {
  CLEAVE_TRY(const CsvTable csv, table_of_text(bytes, name));
  return TableReader{csv, name, options}.run();
}

std::expected<JointTable, std::vector<ReadError>> read_joint_csv(const std::filesystem::path& path,
                                                                 const JointCsvOptions& options) {
  const auto bytes = read_file(path);
  if (!bytes) return std::unexpected(std::vector{bytes.error()});
  return parse_joint_csv(*bytes, path.string(), options);
}

}  // namespace cleave::io
