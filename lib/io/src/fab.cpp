#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/geometry/polygon.hpp"
#include "cleave/io/mesh.hpp"
#include "mesh_build.hpp"
#include "text.hpp"

namespace cleave::io {
namespace {

using geometry::Vec3;

constexpr std::size_t most_corners = 4096;

/// Corners moved into the plane through their mean that their area vector is normal to.
void flatten(std::vector<Vec3>& corners) {
  Vec3 mean;
  for (const Vec3& p : corners) mean += p / static_cast<double>(corners.size());
  Vec3 area;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    area += cross(corners[i] - mean, corners[(i + 1) % corners.size()] - mean);
  }
  const Vec3 normal = geometry::normalized(area);
  for (Vec3& p : corners) p -= normal * dot(p - mean, normal);
}

double size_of(const std::vector<Vec3>& corners) {
  double size = 0;
  for (const Vec3& p : corners) size = std::max(size, norm(p - corners.front()));
  return size;
}

class FabReader final {
 public:
  FabReader(std::string_view bytes, std::string_view file) : lines_{bytes, file} {}

  std::expected<Surfaces, ReadError> run() {
    bool any = false;
    std::string_view line;
    while (lines_.next(line)) {
      std::string_view rest = line;
      const std::string_view keyword = take_word(rest);
      if (keyword.empty()) continue;
      if (keyword != "BEGIN") {
        return std::unexpected(lines_.error(any ? ReadFault::syntax : ReadFault::unknown_format,
                                            fmt::format("{} stands where BEGIN should", shown(keyword)),
                                            "check that this is a FracMan file saved as text"));
      }
      any = true;
      CLEAVE_CHECK(read_section(trimmed(rest)));
    }
    result_.polygons = std::move(polygons_).finish();
    result_.surfaces = std::move(surfaces_).finish();
    if (result_.faces() == 0) {
      return std::unexpected(whole_file(ReadFault::empty, lines_.file(), "holds no fracture",
                                        "give a file with a section BEGIN FRACTURE"));
    }
    CLEAVE_CHECK(compare(fractures_, polygons_read_, "No_Fractures"));
    CLEAVE_CHECK(compare(tessellated_, surfaces_read_, "No_TessFractures"));
    if (metres_ != 1) result_.notes.emplace_back("converted from feet to metres");
    if (flattened_ > 0) {
      result_.notes.push_back(fmt::format(
          "{} fractures were not planar: corners moved by at most {:.3g} m into a plane", flattened_, largest_move_));
    }
    return std::move(result_);
  }

 private:
  [[nodiscard]] ReadError wrong(ReadFault fault, std::string what, std::string remedy) const {
    return lines_.error(fault, std::move(what), std::move(remedy));
  }

  /// The next line with a word in it; an error at the end of the bytes.
  std::expected<std::string_view, ReadError> need_line() {
    std::string_view line;
    while (lines_.next(line)) {
      if (!trimmed(line).empty()) return trimmed(line);
    }
    return std::unexpected(wrong(ReadFault::truncated, "ends in the middle of a section", "get the whole file again"));
  }

  std::expected<void, ReadError> read_section(std::string_view name) {
    if (name == "FRACTURE" || name == "TESSFRACTURE") {
      if (!has_format_) {
        return std::unexpected(wrong(ReadFault::syntax, fmt::format("{} comes before a section FORMAT", name),
                                     "begin the file with BEGIN FORMAT"));
      }
      return name == "FRACTURE" ? read_fractures() : read_tessellated();
    }
    if (name == "FORMAT") has_format_ = true;
    std::uint64_t entries = 0;
    while (true) {
      CLEAVE_TRY(const std::string_view line, need_line());
      if (ends(line, name)) break;
      ++entries;
      const std::size_t equals = line.find('=');
      const std::string_view key = trimmed(line.substr(0, equals));
      const std::string_view value = equals == std::string_view::npos ? "" : trimmed(line.substr(equals + 1));
      if (name == "FORMAT") CLEAVE_CHECK(read_format(key, value));
      if (name == "SETS") CLEAVE_CHECK(read_set(key, value));
    }
    const bool known = name == "FORMAT" || name == "SETS" || name == "PROPERTIES";
    if (!known && entries > 0) {
      result_.notes.push_back(fmt::format("not read: {} lines of the section {}", entries, shown(name)));
    }
    return {};
  }

  static bool ends(std::string_view line, std::string_view section) {
    return take_word(line) == "END" && trimmed(line) == section;
  }

  std::expected<void, ReadError> read_format(std::string_view key, std::string_view value) {
    if (same_word(key, "format") && !same_word(value, "ascii")) {
      return std::unexpected(
          wrong(ReadFault::unknown_format, fmt::format("its format is {}", shown(value)), "export it as Ascii"));
    }
    if (same_word(key, "xaxis") && !same_word(value, "east")) {
      return std::unexpected(wrong(ReadFault::out_of_range, fmt::format("its x axis is {}", shown(value)),
                                   "export it with XAxis = East (x = east, y = north, z = up)"));
    }
    if (same_word(key, "length_unit")) {
      const bool feet = same_word(value, "feet") || same_word(value, "foot") || same_word(value, "ft");
      const bool metres = same_word(value, "meter") || same_word(value, "metre") || same_word(value, "m") ||
                          same_word(value, "meters") || same_word(value, "metres");
      if (!feet && !metres) {
        return std::unexpected(wrong(ReadFault::out_of_range, fmt::format("the unit {} is not known", shown(value)),
                                     "export it in Meter"));
      }
      metres_ = feet ? 0.3048 : 1;
    }
    if (same_word(key, "no_fractures")) fractures_ = Stated{std::string{value}, lines_.number()};
    if (same_word(key, "no_tessfractures")) tessellated_ = Stated{std::string{value}, lines_.number()};
    if (same_word(key, "no_properties")) {
      const auto number = number_of(value);
      if (!number || !(*number >= 0 && *number <= 1e6) || *number != std::floor(*number)) {
        return std::unexpected(wrong(ReadFault::out_of_range, fmt::format("No_Properties is {}", shown(value)),
                                     "give how many properties each fracture has"));
      }
      properties_ = static_cast<std::uint32_t>(*number);
    }
    return {};
  }

  /// How many there are, by the header.
  struct Stated {
    std::string number;
    std::uint32_t line;
  };
  [[nodiscard]] std::expected<void, ReadError> compare(const std::optional<Stated>& stated, std::uint64_t found,
                                                       std::string_view key) const {
    const auto number = number_of(stated ? std::string_view{stated->number} : "");
    if (!stated || (number && *number == static_cast<double>(found))) return {};
    ReadError error =
        wrong(ReadFault::truncated, fmt::format("{} is {}, the file has {}", key, shown(stated->number), found),
              fmt::format("get the whole file again, or correct {}", key));
    error.line = stated->line;
    return std::unexpected(std::move(error));
  }

  /// Set1 = "name"
  std::expected<void, ReadError> read_set(std::string_view key, std::string_view value) {
    if (key.size() < 4 || !same_word(key.substr(0, 3), "set")) return {};
    const auto number = number_of(key.substr(3));
    if (!number) return {};
    if (value.size() >= 2 && value.front() == '"' && value.back() == '"') value = value.substr(1, value.size() - 2);
    sets_.insert_or_assign(*number, std::string{value});
    return {};
  }

  [[nodiscard]] std::string set_name(double number) const {
    const auto found = sets_.find(number);
    return found == sets_.end() ? std::string{} : found->second;
  }

  std::expected<std::vector<double>, ReadError> numbers(std::string_view line) const {
    std::vector<double> values;
    for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
      const auto number = number_of(word);
      if (!number) return std::unexpected(wrong(ReadFault::bad_number, number.error(), "correct the number"));
      values.push_back(*number);
    }
    return values;
  }

  std::expected<std::size_t, ReadError> count(double value, double low, double high, std::string_view what) const {
    if (value >= low && value <= high && value == std::floor(value)) return static_cast<std::size_t>(value);
    return std::unexpected(wrong(ReadFault::out_of_range, fmt::format("a fracture has {} {}", value, what),
                                 fmt::format("it must be a whole number from {} to {}", low, high)));
  }

  /// number x y z
  std::expected<Vec3, ReadError> read_corner() {
    CLEAVE_TRY(const std::string_view line, need_line());
    CLEAVE_TRY(const std::vector<double> values, numbers(line));
    if (values.size() != 4) {
      return std::unexpected(wrong(ReadFault::syntax, fmt::format("a corner has {} numbers", values.size()),
                                   "give its number, x, y and z"));
    }
    const Vec3 at = Vec3{values[1], values[2], values[3]} * metres_;
    if (std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) <= 1e12) return at;
    return std::unexpected(wrong(ReadFault::out_of_range, "a corner lies further than 1e12 m away", "correct it"));
  }

  /// id, corners, [set,] properties; corners; 0 and the normal.
  std::expected<void, ReadError> read_fractures() {
    while (true) {
      CLEAVE_TRY(const std::string_view line, need_line());
      if (ends(line, "FRACTURE")) return {};
      const std::uint32_t first_line = lines_.number();
      CLEAVE_TRY(const std::vector<double> head, numbers(line));
      const bool has_set = head.size() == 3 + std::size_t{properties_};
      if (!has_set && head.size() != 2 + std::size_t{properties_}) {
        return std::unexpected(
            wrong(ReadFault::syntax,
                  fmt::format("a fracture begins with {} numbers, No_Properties is {}", head.size(), properties_),
                  "give id, number of corners, set and properties"));
      }
      CLEAVE_TRY(const std::size_t corner_count, count(head[1], 3, most_corners, "corners"));
      std::vector<Vec3> corners;
      for (std::size_t c = 0; c < corner_count; ++c) {
        CLEAVE_TRY(const Vec3 corner, read_corner());
        corners.push_back(corner);
      }
      CLEAVE_TRY(const std::string_view normal, need_line());
      CLEAVE_TRY(const std::vector<double> normal_numbers, numbers(normal));
      if (normal_numbers.size() != 4 || normal_numbers[0] != 0) {
        return std::unexpected(wrong(ReadFault::syntax,
                                     fmt::format("{} corners are not followed by 0 and the normal", corner_count),
                                     "correct the number of corners"));
      }
      if (polygons_.full(corner_count)) return std::unexpected(too_many());
      make_planar(corners);
      ++polygons_read_;
      polygons_.add_face(corners, polygons_.group_named(has_set ? set_name(head[2]) : ""), first_line);
    }
  }

  [[nodiscard]] ReadError too_many() const {
    return wrong(ReadFault::too_large, "there are more than 2^32 - 2 corners", "split the file");
  }

  /// Corners of little precision are moved into one plane; what is bent by more than 1 % of its size stays bent.
  void make_planar(std::vector<Vec3>& corners) {
    const auto polygon = geometry::Polygon::make(corners);
    if (polygon || !std::holds_alternative<geometry::NotPlanar>(polygon.error())) return;
    std::vector<Vec3> flat = corners;
    flatten(flat);
    double largest = 0;
    for (std::size_t i = 0; i < flat.size(); ++i) largest = std::max(largest, norm(flat[i] - corners[i]));
    if (!(largest <= 0.01 * size_of(corners)) || !geometry::Polygon::make(flat)) return;
    corners = std::move(flat);
    ++flattened_;
    largest_move_ = std::max(largest_move_, largest);
  }

  /// id, nodes, faces, set; nodes; faces as "number i j k" or "number 3 i j k", properties behind.
  std::expected<void, ReadError> read_tessellated() {
    while (true) {
      CLEAVE_TRY(const std::string_view line, need_line());
      if (ends(line, "TESSFRACTURE")) return {};
      CLEAVE_TRY(const std::vector<double> head, numbers(line));
      if (head.size() < 3) {
        return std::unexpected(wrong(ReadFault::syntax,
                                     fmt::format("a tessellated fracture begins with {} numbers", head.size()),
                                     "give id, number of nodes, number of faces and set"));
      }
      CLEAVE_TRY(const std::size_t node_count, count(head[1], 3, 1e9, "nodes"));
      CLEAVE_TRY(const std::size_t face_count, count(head[2], 1, 1e9, "faces"));
      std::vector<Vec3> nodes;
      for (std::size_t n = 0; n < node_count; ++n) {
        CLEAVE_TRY(const Vec3 node, read_corner());
        nodes.push_back(node);
      }
      const std::uint32_t group = surfaces_.new_group(head.size() > 3 ? set_name(head[3]) : "");
      for (std::size_t f = 0; f < face_count; ++f) CLEAVE_CHECK(read_triangle(nodes, group));
      ++surfaces_read_;
    }
  }

  std::expected<void, ReadError> read_triangle(const std::vector<Vec3>& nodes, std::uint32_t group) {
    CLEAVE_TRY(const std::string_view line, need_line());
    CLEAVE_TRY(const std::vector<double> values, numbers(line));
    const std::size_t without_count = 4 + std::size_t{properties_};
    const bool counted = values.size() == without_count + 1 && values[1] == 3;
    if (values.size() != without_count && values.size() != 4 && !counted && !(values.size() == 5 && values[1] == 3)) {
      return std::unexpected(wrong(ReadFault::syntax, fmt::format("a face has {} numbers", values.size()),
                                   "give its number and three nodes"));
    }
    const std::size_t first = counted || (values.size() == 5 && values[1] == 3) ? 2 : 1;
    std::array<Vec3, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) {
      const double number = values[first + c];
      if (!(number >= 1 && number <= static_cast<double>(nodes.size()) && number == std::floor(number))) {
        return std::unexpected(wrong(ReadFault::out_of_range,
                                     fmt::format("a face names node {} of {}", number, nodes.size()),
                                     "nodes count from 1"));
      }
      corners[c] = nodes[static_cast<std::size_t>(number) - 1];
    }
    if (surfaces_.full(3)) return std::unexpected(too_many());
    surfaces_.add_face(corners, group, lines_.number());
    return {};
  }

  LineReader lines_;
  bool has_format_ = false;
  double metres_ = 1;
  std::uint32_t properties_ = 0;
  std::map<double, std::string> sets_;
  MeshBuilder polygons_;
  MeshBuilder surfaces_;
  std::optional<Stated> fractures_, tessellated_;
  std::uint64_t polygons_read_ = 0, surfaces_read_ = 0;
  std::uint64_t flattened_ = 0;
  double largest_move_ = 0;
  Surfaces result_;
};

}  // namespace

std::expected<Surfaces, ReadError> parse_fab(std::string_view bytes, std::string_view name) {
  if (bytes.empty()) {
    return std::unexpected(whole_file(ReadFault::empty, name, "is empty", "give a file with fractures"));
  }
  return FabReader{without_bom(bytes), name}.run();
}

}  // namespace cleave::io
