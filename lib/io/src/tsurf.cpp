#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/io/mesh.hpp"
#include "mesh_build.hpp"
#include "text.hpp"

namespace cleave::io {
namespace {

using geometry::Vec3;

constexpr std::size_t most_items = 0xFFFFFFFE;

std::string_view without_quotes(std::string_view word) {
  if (word.size() >= 2 && word.front() == '"' && word.back() == '"') return word.substr(1, word.size() - 2);
  return word;
}

class TsurfReader final {
 public:
  TsurfReader(std::string_view bytes, std::string_view file) : lines_{bytes, file} {}

  std::expected<Surfaces, ReadError> run() {
    bool any = false;
    std::string_view line;
    while (lines_.next(line)) {
      std::string_view rest = line;
      const std::string_view keyword = take_word(rest);
      if (keyword.empty() || keyword.starts_with('#')) continue;
      if (keyword != "GOCAD") {
        return std::unexpected(lines_.error(any ? ReadFault::syntax : ReadFault::unknown_format,
                                            fmt::format("{} stands where GOCAD should", shown(keyword)),
                                            "check that this is a GoCAD file saved as text"));
      }
      any = true;
      const std::string_view kind = take_word(rest);
      if (same_word(kind, "tsurf")) {
        CLEAVE_CHECK(read_object());
      } else {
        CLEAVE_CHECK(skip_object(kind));
      }
    }
    if (builder_.faces() == 0) {
      return std::unexpected(whole_file(ReadFault::empty, lines_.file(), "holds no triangle of a TSurf",
                                        "give a file with a triangulated surface"));
    }
    for (const auto& [kind, count] : skipped_) {
      result_.notes.push_back(fmt::format("not read: {} objects of kind {}", count, shown(kind)));
    }
    result_.surfaces = std::move(builder_).finish();
    return std::move(result_);
  }

 private:
  /// What belongs to one object only.
  struct Object {
    std::string name;
    double unit = 1;
    bool depth = false;
    bool has_group = false;
    std::uint32_t group = 0;
    std::map<std::int64_t, Vec3> vertices;  ///< as in the file
  };

  [[nodiscard]] ReadError wrong(ReadFault fault, std::string what, std::string remedy) const {
    return lines_.error(fault, std::move(what), std::move(remedy));
  }

  /// The next line of an object; an error at the end of the bytes.
  std::expected<std::string_view, ReadError> need_line() {
    std::string_view line;
    if (lines_.next(line)) return line;
    return std::unexpected(wrong(ReadFault::truncated, "ends in the middle of an object", "get the whole file again"));
  }

  std::expected<void, ReadError> skip_object(std::string_view kind) {
    while (true) {
      CLEAVE_TRY(std::string_view line, need_line());
      if (take_word(line) == "END" && trimmed(line).empty()) break;
    }
    if (skipped_.size() < 100) ++skipped_[std::string{kind.substr(0, 30)}];
    return {};
  }

  std::expected<void, ReadError> read_object() {
    Object object;
    while (true) {
      CLEAVE_TRY(const std::string_view line, need_line());
      std::string_view rest = line;
      const std::string_view keyword = take_word(rest);
      if (keyword == "END") return {};
      if (keyword == "HEADER" || keyword.starts_with("HEADER{")) {
        CLEAVE_CHECK(read_header(object, trimmed(line).substr(6)));
      } else if (keyword == "AXIS_NAME") {
        CLEAVE_CHECK(read_axis_names(rest));
      } else if (keyword == "AXIS_UNIT") {
        CLEAVE_CHECK(read_units(object, rest));
      } else if (keyword == "ZPOSITIVE") {
        CLEAVE_CHECK(read_z_positive(object, take_word(rest)));
      } else if (keyword == "VRTX" || keyword == "PVRTX") {
        CLEAVE_CHECK(read_vertex(object, rest));
      } else if (keyword == "ATOM" || keyword == "PATOM") {
        CLEAVE_CHECK(read_atom(object, rest));
      } else if (keyword == "TRGL") {
        CLEAVE_CHECK(read_triangle(object, rest));
      } else if (keyword == "GOCAD") {
        return std::unexpected(
            wrong(ReadFault::truncated, "an object begins before the last one ends", "get the whole file again"));
      }  // all else says nothing about the surface
    }
  }

  /// HEADER { name:x } over one line or several.
  std::expected<void, ReadError> read_header(Object& object, std::string_view rest) {
    while (true) {
      const std::string_view text = trimmed(rest);
      std::string_view entry = text.starts_with('{') ? trimmed(text.substr(1)) : text;
      const bool last = entry.ends_with('}');
      if (last) entry.remove_suffix(1);
      if (entry.starts_with('*')) entry.remove_prefix(1);
      if (entry.starts_with("name:")) object.name = trimmed(entry.substr(5));
      if (last) return {};
      CLEAVE_TRY(rest, need_line());
    }
  }

  std::expected<void, ReadError> read_axis_names(std::string_view rest) const {
    const std::string first = lower(without_quotes(take_word(rest)));
    if (first.starts_with('y') || first.starts_with("north") || first.starts_with('z')) {
      return std::unexpected(wrong(ReadFault::out_of_range, fmt::format("its first axis is {}", shown(first)),
                                   "save it with the axes X (east), Y (north), Z"));
    }
    return {};
  }

  std::expected<void, ReadError> read_units(Object& object, std::string_view rest) {
    std::array<std::string, 3> units;
    for (std::string& unit : units) unit = lower(without_quotes(take_word(rest)));
    if (units[0] != units[1] || units[0] != units[2]) {
      return std::unexpected(wrong(ReadFault::out_of_range, "its axes have different units", "save it in metres"));
    }
    const std::string& unit = units[0];
    if (unit == "m" || unit == "meter" || unit == "metre" || unit == "meters" || unit == "metres" || unit.empty() ||
        unit == "unitless" || unit == "none") {
      return {};
    }
    if (unit != "ft" && unit != "feet") {
      return std::unexpected(
          wrong(ReadFault::out_of_range, fmt::format("the unit {} is not known", shown(unit)), "save it in metres"));
    }
    object.unit = 0.3048;
    result_.notes.push_back(fmt::format("{}: converted from feet to metres", shown(object.name)));
    return {};
  }

  std::expected<void, ReadError> read_z_positive(Object& object, std::string_view word) const {
    object.depth = same_word(word, "depth");
    if (object.depth || same_word(word, "elevation")) return {};
    return std::unexpected(
        wrong(ReadFault::syntax, fmt::format("ZPOSITIVE is {}", shown(word)), "it is Elevation or Depth"));
  }

  std::expected<std::int64_t, ReadError> take_id(std::string_view& rest) const {
    const std::string_view word = take_word(rest);
    std::int64_t value = 0;
    const char* const end = std::to_address(word.end());
    const auto [stop, failure] = std::from_chars(std::to_address(word.begin()), end, value);
    if (failure != std::errc{} || stop != end) {
      return std::unexpected(wrong(ReadFault::syntax, fmt::format("{} is not the number of a vertex", shown(word)),
                                   "give a whole number"));
    }
    return value;
  }

  std::expected<void, ReadError> define(Object& object, std::int64_t id, Vec3 place) {
    if (object.vertices.size() >= most_items) {
      return std::unexpected(wrong(ReadFault::too_large, "there are more than 2^32 - 2 vertices", "split the file"));
    }
    if (object.vertices.emplace(id, place).second) return {};
    return std::unexpected(
        wrong(ReadFault::out_of_range, fmt::format("vertex {} is given twice", id), "number the vertices anew"));
  }

  std::expected<void, ReadError> read_vertex(Object& object, std::string_view rest) {
    CLEAVE_TRY(const std::int64_t id, take_id(rest));
    std::array<double, 3> p{};
    for (double& coordinate : p) {
      const auto number = number_of(take_word(rest));
      if (!number) return std::unexpected(wrong(ReadFault::bad_number, number.error(), "give x, y and z"));
      coordinate = *number;
    }
    return define(object, id, {p[0], p[1], p[2]});  // properties may follow
  }

  std::expected<void, ReadError> read_atom(Object& object, std::string_view rest) {
    CLEAVE_TRY(const std::int64_t id, take_id(rest));
    CLEAVE_TRY(const Vec3 place, vertex(object, rest));
    return define(object, id, place);
  }

  std::expected<Vec3, ReadError> vertex(const Object& object, std::string_view& rest) const {
    CLEAVE_TRY(const std::int64_t id, take_id(rest));
    const auto found = object.vertices.find(id);
    if (found != object.vertices.end()) return found->second;
    return std::unexpected(wrong(ReadFault::out_of_range, fmt::format("vertex {} does not exist", id),
                                 "give each vertex before the triangles that use it"));
  }

  std::expected<void, ReadError> read_triangle(Object& object, std::string_view rest) {
    std::array<Vec3, 3> corners;
    for (Vec3& p : corners) {
      CLEAVE_TRY(p, vertex(object, rest));
      p = p * object.unit;
      if (object.depth) p.z = -p.z;
    }
    if (object.depth) std::swap(corners[1], corners[2]);
    if (builder_.full(3)) {
      return std::unexpected(wrong(ReadFault::too_large, "there are more than 2^32 - 2 corners", "split the file"));
    }
    if (!std::exchange(object.has_group, true)) object.group = builder_.new_group(object.name);
    builder_.add_face(corners, object.group, lines_.number());
    return {};
  }

  LineReader lines_;
  MeshBuilder builder_;
  Surfaces result_;
  std::map<std::string, std::uint64_t> skipped_;
};

}  // namespace

std::expected<Surfaces, ReadError> parse_tsurf(std::string_view bytes, std::string_view name) {
  if (bytes.empty()) {
    return std::unexpected(whole_file(ReadFault::empty, name, "is empty", "give a file with a triangulated surface"));
  }
  return TsurfReader{without_bom(bytes), name}.run();
}

}  // namespace cleave::io
