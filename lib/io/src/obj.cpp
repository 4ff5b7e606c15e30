#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/io/mesh.hpp"
#include "text.hpp"

namespace cleave::io {
namespace {

constexpr std::size_t most_corners = 4096;
constexpr std::size_t most_items = 0xFFFFFFFE;

/// Records of the format that say nothing about polygons.
constexpr auto skipped = std::to_array<std::string_view>(
    {"bevel", "bmat",   "bsp",   "bzp",       "c_interp", "cdc",    "cdp",    "con",        "cstype",
     "ctech", "curv",   "curv2", "d_interp",  "deg",      "end",    "hole",   "l",          "lod",
     "mg",    "mtllib", "p",     "parm",      "res",      "s",      "scrv",   "shadow_obj", "sp",
     "stech", "step",   "surf",  "trace_obj", "trim",     "usemap", "usemtl", "vn",         "vp",
     "vt",    "maplib", "call",  "csh",       "xyzrgb",   "color",  "cvn",    "shadow",     "usemtllib"});

class ObjReader final {
 public:
  ObjReader(std::string_view bytes, std::string_view file) : lines_{bytes, file} {}

  std::expected<MeshData, ReadError> run() {
    std::string_view line;
    while (lines_.next(line)) {
      std::string_view record = line;
      if (const std::string_view kept = trimmed(line); kept.ends_with('\\') && !trimmed(line).starts_with('#')) {
        join(kept);
        record = joined_;
      }
      CLEAVE_CHECK(read_record(record));
    }
    for (const auto& [line_number, corner] : ahead_) {  // corners that named a vertex not yet read
      if (corner >= mesh_.vertices.size()) {
        ReadError error = lines_.error(ReadFault::out_of_range, missing_vertex(corner + 1), renumber);
        error.line = line_number;
        return std::unexpected(std::move(error));
      }
    }
    if (mesh_.faces() == 0) {
      ReadError error =
          lines_.error(ReadFault::empty, "holds no f record, so no polygon", "give a file with v and f records");
      error.line.reset();
      return std::unexpected(std::move(error));
    }
    keep_used_groups();
    return std::move(mesh_);
  }

 private:
  /// Groups without faces go, the others are numbered by their first face.
  void keep_used_groups() {
    std::vector<std::optional<std::uint32_t>> number(mesh_.groups.size());
    std::vector<std::string> used;
    for (std::uint32_t& g : mesh_.group) {
      if (!number[g]) {
        number[g] = static_cast<std::uint32_t>(used.size());
        used.push_back(std::move(mesh_.groups[g]));
      }
      g = *number[g];
    }
    mesh_.groups = std::move(used);
  }

  static constexpr const char* renumber = "vertices count from 1, or from -1 backwards";

  [[nodiscard]] std::string missing_vertex(std::size_t number) const {
    return fmt::format("vertex {} does not exist, there are {}", number, mesh_.vertices.size());
  }

  void join(std::string_view first) {
    joined_.assign(first.substr(0, first.size() - 1));
    std::string_view line;
    while (lines_.next(line)) {
      const std::string_view kept = trimmed(line);
      joined_ += ' ';
      if (!kept.ends_with('\\')) {
        joined_ += kept;
        return;
      }
      joined_ += kept.substr(0, kept.size() - 1);
    }
  }

  std::expected<void, ReadError> read_record(std::string_view line) {
    if (const std::size_t comment = line.find('#'); comment != std::string_view::npos) line = line.substr(0, comment);
    const std::string_view keyword = take_word(line);
    if (keyword.empty()) return {};
    if (keyword == "v") return read_vertex(line);
    if (keyword == "f" || keyword == "fo") return read_face(line);
    if (keyword == "o" || keyword == "g") {
      enter_group(trimmed(line));
      return {};
    }
    if (std::ranges::find(skipped, keyword) != skipped.end()) return {};
    return std::unexpected(lines_.error(ReadFault::syntax,
                                        fmt::format("{} is not a record of an OBJ file", shown(keyword)),
                                        "check that this is an OBJ file"));
  }

  std::expected<void, ReadError> read_vertex(std::string_view line) {
    if (mesh_.vertices.size() >= most_items) return std::unexpected(too_many());
    std::array<double, 3> p{};
    for (double& x : p) {
      const std::string_view word = take_word(line);
      if (word.empty()) {
        return std::unexpected(
            lines_.error(ReadFault::syntax, "a v record has fewer than three numbers", "give x, y and z"));
      }
      const auto value = number_of(word);
      if (!value) return std::unexpected(lines_.error(ReadFault::bad_number, value.error(), "correct the coordinate"));
      x = *value;
    }
    mesh_.vertices.push_back({p[0], p[1], p[2]});  // a weight or a colour may follow
    return {};
  }

  std::expected<void, ReadError> read_face(std::string_view line) {
    const std::size_t first = mesh_.corners.size();
    for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
      CLEAVE_TRY(const std::uint32_t corner, read_corner(word));
      mesh_.corners.push_back(corner);
      if (corner >= mesh_.vertices.size()) ahead_.emplace_back(lines_.number(), corner);
    }
    const std::size_t count = mesh_.corners.size() - first;
    if (count == 0)
      return std::unexpected(lines_.error(ReadFault::syntax, "an f record names no vertex", "name its corners"));
    if (count > most_corners) {
      return std::unexpected(lines_.error(ReadFault::too_large,
                                          fmt::format("a face has {} corners, allowed are {}", count, most_corners),
                                          "split it into smaller polygons"));
    }
    if (mesh_.corners.size() >= most_items) return std::unexpected(too_many());
    if (mesh_.groups.empty()) enter_group("");  // before any o or g
    mesh_.ends.push_back(static_cast<std::uint32_t>(mesh_.corners.size()));
    mesh_.group.push_back(group_);
    mesh_.lines.push_back(lines_.number());
    return {};
  }

  /// The vertex number of i, i/t, i//n or i/t/n; from 0.
  [[nodiscard]] std::expected<std::uint32_t, ReadError> read_corner(std::string_view word) const {
    const std::string_view digits = word.substr(0, word.find('/'));
    std::int64_t value = 0;
    const char* const end = std::to_address(digits.end());
    const auto [stop, failure] = std::from_chars(std::to_address(digits.begin()), end, value);
    if (failure != std::errc{} || stop != end) {
      return std::unexpected(lines_.error(ReadFault::syntax, fmt::format("{} is not a corner of a face", shown(word)),
                                          "write corners as i, i/t, i//n or i/t/n"));
    }
    const auto count = static_cast<std::int64_t>(mesh_.vertices.size());
    if (value == 0 || value < -count || value > static_cast<std::int64_t>(most_items)) {
      return std::unexpected(lines_.error(ReadFault::out_of_range,
                                          fmt::format("vertex {} does not exist, there are {} so far", value, count),
                                          renumber));
    }
    return static_cast<std::uint32_t>(value > 0 ? value - 1 : count + value);
  }

  void enter_group(std::string_view name) {
    while (name.ends_with('\\'))
      name = trimmed(name.substr(0, name.size() - 1));  // would continue the line when written again
    const auto [at, is_new] =
        group_numbers_.try_emplace(std::string{name}, static_cast<std::uint32_t>(mesh_.groups.size()));
    if (is_new) mesh_.groups.emplace_back(name);
    group_ = at->second;
  }

  [[nodiscard]] ReadError too_many() const {
    return lines_.error(ReadFault::too_large, "there are more than 2^32 - 2 vertices or corners", "split the file");
  }

  LineReader lines_;
  MeshData mesh_;
  std::string joined_;
  std::map<std::string, std::uint32_t, std::less<>> group_numbers_;
  std::uint32_t group_ = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ahead_;
};

}  // namespace

std::expected<MeshData, ReadError> parse_obj(std::string_view bytes, std::string_view name) {
  return ObjReader{without_bom(bytes), name}.run();
}

}  // namespace cleave::io
