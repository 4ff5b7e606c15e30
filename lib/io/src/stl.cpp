#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "bytes.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/io/mesh.hpp"
#include "text.hpp"

namespace cleave::io {
namespace {

constexpr std::size_t header_size = 84;
constexpr std::size_t triangle_size = 50;
constexpr std::size_t most_triangles = 0xFFFFFFFE / 3;

void add_triangle(MeshData& mesh, const std::array<geometry::Vec3, 3>& corners, std::uint32_t line) {
  for (const geometry::Vec3& p : corners) {
    mesh.corners.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
    mesh.vertices.push_back(p);
  }
  mesh.ends.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  mesh.group.push_back(static_cast<std::uint32_t>(mesh.groups.size() - 1));
  mesh.lines.push_back(line);
}

std::expected<MeshData, ReadError> parse_binary(std::string_view bytes, std::string_view file) {
  const auto fail = [&](ReadFault fault, std::string what, std::string remedy) {
    return std::unexpected(whole_file(fault, file, std::move(what), std::move(remedy)));
  };
  const std::uint64_t count = unsigned_at<4>(bytes.substr(80), std::endian::little);
  const std::uint64_t expected = header_size + triangle_size * count;
  if (bytes.size() < expected) {
    return fail(ReadFault::truncated,
                fmt::format("says it has {} triangles, but the bytes end after {}", count,
                            (bytes.size() - header_size) / triangle_size),
                "get the whole file again");
  }
  const std::uint64_t extra = bytes.size() - expected;
  if (extra >= triangle_size) {
    return fail(ReadFault::syntax, fmt::format("says it has {} triangles, but {} bytes follow them", count, extra),
                "check that this is an STL file");
  }
  if (count == 0) return fail(ReadFault::empty, "holds no triangle", "give a file with triangles");
  if (count > most_triangles) return fail(ReadFault::too_large, "has more than 2^32 - 2 corners", "split the file");
  MeshData mesh;
  if (extra > 0) mesh.notes.push_back(fmt::format("{} bytes after the last triangle ignored", extra));
  mesh.groups.emplace_back();
  mesh.vertices.reserve(3 * count);
  mesh.corners.reserve(3 * count);
  for (std::uint64_t t = 0; t < count; ++t) {
    const std::string_view record = bytes.substr(header_size + t * triangle_size + 12);  // the normal is left out
    std::array<geometry::Vec3, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto at = [&](std::size_t axis) {
        return static_cast<double>(float_at(record.substr(12 * c + 4 * axis), std::endian::little));
      };
      corners[c] = {at(0), at(1), at(2)};
      if (!geometry::is_finite(corners[c])) {
        return fail(ReadFault::bad_number,
                    fmt::format("triangle {} has a coordinate that is not a finite number", t + 1),
                    "correct or remove the triangle");
      }
    }
    add_triangle(mesh, corners, 0);
  }
  return mesh;
}

class TextReader final {
 public:
  TextReader(std::string_view bytes, std::string_view file) : lines_{bytes, file} {}

  std::expected<MeshData, ReadError> run() {
    bool any = false;
    while (next_word()) {
      if (!same_word(word_, "solid")) return std::unexpected(unexpected_word("solid"));
      any = true;
      mesh_.groups.emplace_back(trimmed(line_));
      line_ = {};
      CLEAVE_CHECK(read_solid());
    }
    if (!any || mesh_.faces() == 0) {
      return std::unexpected(
          whole_file(ReadFault::empty, lines_.file(), "holds no triangle", "give a file with triangles"));
    }
    return std::move(mesh_);
  }

 private:
  /// The next word of the file, over line ends; false at the end.
  bool next_word() {
    while ((word_ = take_word(line_)).empty()) {
      if (!lines_.next(line_)) return false;
    }
    return true;
  }

  [[nodiscard]] ReadError unexpected_word(std::string_view wanted) const {
    const bool last = lines_.rest().empty() && trimmed(line_).empty();
    if (last && wanted != "solid") return truncated();  // most likely the rest of the word is missing
    return lines_.error(ReadFault::syntax, fmt::format("{} stands where \"{}\" should", shown(word_), wanted),
                        "check that this is an STL file");
  }

  [[nodiscard]] ReadError truncated() const {
    return lines_.error(ReadFault::truncated, "ends in the middle of a solid", "get the whole file again");
  }

  std::expected<void, ReadError> need_word() {
    if (next_word()) return {};
    return std::unexpected(truncated());
  }

  std::expected<void, ReadError> expect(std::string_view wanted) {
    CLEAVE_CHECK(need_word());
    if (!same_word(word_, wanted)) return std::unexpected(unexpected_word(wanted));
    return {};
  }

  std::expected<double, ReadError> number() {
    CLEAVE_CHECK(need_word());
    auto value = number_of(word_);
    if (!value)
      return std::unexpected(lines_.error(ReadFault::bad_number, std::move(value).error(), "correct the coordinate"));
    return *value;
  }

  std::expected<void, ReadError> read_solid() {
    while (true) {
      CLEAVE_CHECK(need_word());
      if (same_word(word_, "endsolid")) {
        line_ = {};  // the name again
        return {};
      }
      if (!same_word(word_, "facet")) return std::unexpected(unexpected_word("facet"));
      CLEAVE_CHECK(read_facet());
    }
  }

  std::expected<void, ReadError> read_facet() {
    const std::uint32_t line = lines_.number();
    if (mesh_.faces() >= most_triangles) {
      return std::unexpected(
          lines_.error(ReadFault::too_large, "there are more than 2^32 - 2 corners", "split the file"));
    }
    CLEAVE_CHECK(expect("normal"));
    for (int i = 0; i < 3; ++i) CLEAVE_CHECK(need_word());  // often zero, wrong or "nan": never looked at
    CLEAVE_CHECK(expect("outer"));
    CLEAVE_CHECK(expect("loop"));
    std::array<geometry::Vec3, 3> corners;
    for (geometry::Vec3& p : corners) {
      CLEAVE_CHECK(expect("vertex"));
      CLEAVE_TRY(const double x, number());
      CLEAVE_TRY(const double y, number());
      CLEAVE_TRY(const double z, number());
      p = {x, y, z};
    }
    CLEAVE_CHECK(expect("endloop"));
    CLEAVE_CHECK(expect("endfacet"));
    add_triangle(mesh_, corners, line);
    return {};
  }

  LineReader lines_;
  std::string_view line_;
  std::string_view word_;
  MeshData mesh_;
};

/// Text begins with "solid", has no zero byte near its start, and goes on with a facet or the end of the solid.
bool reads_as_text(std::string_view bytes) {
  if (bytes.substr(0, 1000).find('\0') != std::string_view::npos) return false;
  LineReader lines{bytes, ""};
  std::string_view line;
  std::string_view word;
  while (word.empty() && lines.next(line)) word = take_word(line);
  if (!same_word(word, "solid")) return false;
  word = {};
  while (word.empty() && lines.next(line)) word = take_word(line);
  return word.empty() || same_word(word, "facet") || same_word(word, "endsolid");
}

}  // namespace

std::expected<MeshData, ReadError> parse_stl(std::string_view bytes, std::string_view name) {
  const auto fail = [&](ReadFault fault, std::string what, std::string remedy) {
    return std::unexpected(whole_file(fault, name, std::move(what), std::move(remedy)));
  };
  if (bytes.empty()) return fail(ReadFault::empty, "is empty", "give a file with triangles");
  const bool has_header = bytes.size() >= header_size;
  const bool exact =
      has_header && bytes.size() == header_size + triangle_size * unsigned_at<4>(bytes.substr(80), std::endian::little);
  const std::string_view text = without_bom(bytes);
  if (!exact && reads_as_text(text)) return TextReader{text, name}.run();
  if (!has_header)
    return fail(ReadFault::unknown_format, "is neither a text nor a binary STL file", "check what it is");
  return parse_binary(bytes, name);
}

}  // namespace cleave::io
