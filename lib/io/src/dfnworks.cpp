#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "cleave/core/expected.hpp"
#include "cleave/io/mesh.hpp"
#include "mesh_build.hpp"
#include "text.hpp"

namespace cleave::io {
namespace {

using geometry::Vec3;

constexpr std::size_t most_corners = 4096;

/// `nPolygons: N`, then N polygons; braces and commas only part the numbers, and line ends are blanks.
class PolygonReader final {
 public:
  PolygonReader(std::string_view bytes, std::string_view file) : lines_{bytes, file} {}

  std::expected<Surfaces, ReadError> run() {
    CLEAVE_TRY(const std::string_view head, next_word());
    std::string_view count_word = head;
    constexpr std::string_view key = "npolygons:";
    const std::string lowered = lower(head);
    if (!lowered.starts_with(key)) {
      return std::unexpected(lines_.error(ReadFault::unknown_format, fmt::format("begins with {}", shown(head)),
                                          "a polygon file of dfnWorks begins with nPolygons: and their number"));
    }
    count_word.remove_prefix(key.size());
    if (count_word.empty()) {
      CLEAVE_TRY(count_word, next_word());
    }
    CLEAVE_TRY(const double polygons, number(count_word));
    if (!(polygons >= 1 && polygons <= 1e9) || polygons != std::floor(polygons)) {
      return std::unexpected(lines_.error(ReadFault::out_of_range, fmt::format("nPolygons is {}", polygons),
                                          "give how many polygons follow"));
    }
    const std::uint32_t group = builder_.group_named("");
    for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(polygons); ++i) CLEAVE_CHECK(read_polygon(group));
    if (const auto more = word()) {
      return std::unexpected(lines_.error(
          ReadFault::syntax, fmt::format("{} stands behind the last polygon", shown(*more)), "correct nPolygons"));
    }
    Surfaces result;
    result.polygons = std::move(builder_).finish();
    return result;
  }

 private:
  /// The next word; braces and commas are blanks.
  std::optional<std::string_view> word() {
    constexpr std::string_view between = " \t\r{},";
    while (true) {
      const std::size_t begin = line_.find_first_not_of(between);
      if (begin != std::string_view::npos) {
        const std::size_t end = std::min(line_.find_first_of(between, begin), line_.size());
        const std::string_view found = line_.substr(begin, end - begin);
        line_.remove_prefix(end);
        return found;
      }
      if (!lines_.next(line_)) return std::nullopt;
    }
  }
  std::expected<std::string_view, ReadError> next_word() {
    if (const auto found = word()) return *found;
    return std::unexpected(lines_.number() == 0
                               ? lines_.error(ReadFault::empty, "is empty", "give a file with polygons")
                               : lines_.error(ReadFault::truncated, "ends in the middle of a polygon",
                                              "get the whole file again, or correct nPolygons"));
  }
  std::expected<double, ReadError> number(std::string_view text) const {
    const auto value = number_of(text);
    if (!value) return std::unexpected(lines_.error(ReadFault::bad_number, value.error(), "correct the number"));
    return *value;
  }
  std::expected<double, ReadError> next_number() {
    CLEAVE_TRY(const std::string_view text, next_word());
    return number(text);
  }

  std::expected<void, ReadError> read_polygon(std::uint32_t group) {
    CLEAVE_TRY(const double count, next_number());
    const std::uint32_t line = lines_.number();
    if (!(count >= 3 && count <= static_cast<double>(most_corners)) || count != std::floor(count)) {
      return std::unexpected(lines_.error(ReadFault::out_of_range, fmt::format("a polygon has {} corners", count),
                                          fmt::format("it must be a whole number from 3 to {}", most_corners)));
    }
    std::vector<Vec3> corners;
    for (std::size_t c = 0; c < static_cast<std::size_t>(count); ++c) {
      std::array<double, 3> at{};
      for (double& x : at) {
        CLEAVE_TRY(x, next_number());
        if (std::abs(x) > 1e12) {
          return std::unexpected(
              lines_.error(ReadFault::out_of_range, "a corner lies further than 1e12 m away", "correct it"));
        }
      }
      corners.push_back({at[0], at[1], at[2]});
    }
    if (builder_.full(corners.size())) {
      return std::unexpected(
          lines_.error(ReadFault::too_large, "there are more than 2^32 - 2 corners", "split the file"));
    }
    builder_.add_face(corners, group, line);
    return {};
  }

  LineReader lines_;
  std::string_view line_;
  MeshBuilder builder_;
};

}  // namespace

std::expected<Surfaces, ReadError> parse_dfnworks_polygons(std::string_view bytes, std::string_view name) {
  return PolygonReader{without_bom(bytes), name}.run();
}

}  // namespace cleave::io
