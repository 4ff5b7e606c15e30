#include <fmt/format.h>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <system_error>
#include <utility>

#include "bytes.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/io/mesh.hpp"
#include "text.hpp"

namespace cleave::io {
namespace {

constexpr std::uint64_t most_items = 0xFFFFFFFE;

enum class Type : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };

std::optional<Type> type_named(std::string_view name) {
  constexpr auto names = std::to_array<std::pair<std::string_view, Type>>({{"char", Type::i8},
                                                                           {"int8", Type::i8},
                                                                           {"uchar", Type::u8},
                                                                           {"uint8", Type::u8},
                                                                           {"short", Type::i16},
                                                                           {"int16", Type::i16},
                                                                           {"ushort", Type::u16},
                                                                           {"uint16", Type::u16},
                                                                           {"int", Type::i32},
                                                                           {"int32", Type::i32},
                                                                           {"uint", Type::u32},
                                                                           {"uint32", Type::u32},
                                                                           {"float", Type::f32},
                                                                           {"float32", Type::f32},
                                                                           {"double", Type::f64},
                                                                           {"float64", Type::f64}});
  for (const auto& [text, type] : names) {
    if (text == name) return type;
  }
  return std::nullopt;
}

std::size_t size_of(Type type) {
  switch (type) {
    case Type::i8:
    case Type::u8: return 1;
    case Type::i16:
    case Type::u16: return 2;
    case Type::i32:
    case Type::u32:
    case Type::f32: return 4;
    case Type::f64: return 8;
  }
  std::unreachable();
}

/// Every value of the format fits a double exactly.
double value_at(std::string_view bytes, Type type, std::endian order) {
  switch (type) {
    case Type::i8: return static_cast<std::int8_t>(unsigned_at<1>(bytes, order));
    case Type::u8: return static_cast<std::uint8_t>(unsigned_at<1>(bytes, order));
    case Type::i16: return static_cast<std::int16_t>(unsigned_at<2>(bytes, order));
    case Type::u16: return static_cast<std::uint16_t>(unsigned_at<2>(bytes, order));
    case Type::i32: return static_cast<std::int32_t>(unsigned_at<4>(bytes, order));
    case Type::u32: return static_cast<std::uint32_t>(unsigned_at<4>(bytes, order));
    case Type::f32: return static_cast<double>(float_at(bytes, order));
    case Type::f64: return double_at(bytes, order);
  }
  std::unreachable();
}

struct Property {
  std::string name;
  Type type;
  std::optional<Type> count;  ///< of a list
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};
enum class Encoding : std::uint8_t { text, little, big };

class PlyReader final {
 public:
  PlyReader(std::string_view bytes, std::string_view file) : lines_{bytes, file} {}

  std::expected<MeshData, ReadError> run() {
    CLEAVE_CHECK(read_header());
    rest_ = lines_.rest();
    mesh_.groups.emplace_back();
    bool has_vertices = false;
    bool has_faces = false;
    for (const Element& element : elements_) {
      if (element.name == "vertex") {
        has_vertices = true;
        CLEAVE_CHECK(read_vertices(element));
      } else if (element.name == "face") {
        has_faces = true;
        CLEAVE_CHECK(read_faces(element));
      } else {
        CLEAVE_CHECK(for_each_row(
            element, [](std::size_t, std::span<const double>) {},
            [](std::uint64_t) { return std::expected<void, ReadError>{}; }));
      }
    }
    if (!has_vertices || !has_faces || mesh_.faces() == 0) {
      return std::unexpected(whole(ReadFault::empty, "holds no faces", "give a file with elements vertex and face"));
    }
    for (std::size_t f = 0; f < mesh_.faces(); ++f) {
      for (const std::uint32_t corner : mesh_.face(f)) {
        if (corner < mesh_.vertices.size()) continue;
        ReadError error = whole(ReadFault::out_of_range,
                                fmt::format("face {} names vertex {}, there are {}", f, corner, mesh_.vertices.size()),
                                "vertices count from 0");
        if (encoding_ == Encoding::text) error.line = mesh_.lines[f];
        return std::unexpected(std::move(error));
      }
    }
    const std::string_view left = encoding_ == Encoding::text ? trimmed_all() : rest_;
    if (!left.empty()) mesh_.notes.push_back(fmt::format("{} bytes after the last element ignored", left.size()));
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] ReadError whole(ReadFault fault, std::string what, std::string remedy) const {
    return whole_file(fault, lines_.file(), std::move(what), std::move(remedy));
  }
  [[nodiscard]] ReadError truncated() const {
    return whole(ReadFault::truncated, "ends before all elements that its header promises", "get the whole file again");
  }

  std::expected<void, ReadError> read_header() {
    std::string_view line;
    if (!lines_.next(line) || trimmed(line) != "ply") {
      return std::unexpected(
          whole(ReadFault::unknown_format, "does not begin with \"ply\"", "check that this is a PLY file"));
    }
    std::optional<Encoding> encoding;
    while (lines_.next(line)) {
      const std::string_view keyword = take_word(line);
      if (keyword.empty() || keyword == "comment" || keyword == "obj_info") continue;
      if (keyword == "end_header") {
        if (!encoding)
          return std::unexpected(lines_.error(ReadFault::syntax, "the header names no format", "add a format line"));
        encoding_ = *encoding;
        return {};
      }
      if (keyword == "format") {
        const std::string_view name = take_word(line);
        if (name == "ascii")
          encoding = Encoding::text;
        else if (name == "binary_little_endian")
          encoding = Encoding::little;
        else if (name == "binary_big_endian")
          encoding = Encoding::big;
        else {
          return std::unexpected(lines_.error(ReadFault::unknown_format,
                                              fmt::format("format {} is not known", shown(name)),
                                              "use ascii, binary_little_endian or binary_big_endian"));
        }
      } else if (keyword == "element") {
        CLEAVE_CHECK(read_element(line));
      } else if (keyword == "property") {
        CLEAVE_CHECK(read_property(line));
      } else {
        return std::unexpected(lines_.error(ReadFault::syntax,
                                            fmt::format("{} is not a line of a PLY header", shown(keyword)),
                                            "check that this is a PLY file"));
      }
    }
    return std::unexpected(whole(ReadFault::truncated, "its header has no end_header", "get the whole file again"));
  }

  std::expected<void, ReadError> read_element(std::string_view line) {
    Element element{std::string{take_word(line)}, 0, {}};
    const std::string_view digits = take_word(line);
    const char* const end = std::to_address(digits.end());
    const auto [stop, failure] = std::from_chars(std::to_address(digits.begin()), end, element.count);
    if (digits.empty() || failure != std::errc{} || stop != end) {
      return std::unexpected(lines_.error(
          ReadFault::bad_number, fmt::format("{} is not a count of elements", shown(digits)), "give a whole number"));
    }
    for (const Element& other : elements_) {
      if (other.name == element.name) {
        return std::unexpected(
            lines_.error(ReadFault::syntax, fmt::format("element {} comes twice", shown(element.name)), "remove one"));
      }
    }
    if (element.count > most_items) {
      return std::unexpected(lines_.error(ReadFault::too_large, "has more than 2^32 - 2 elements", "split the file"));
    }
    elements_.push_back(std::move(element));
    return {};
  }

  std::expected<void, ReadError> read_property(std::string_view line) {
    const auto bad_type = [&](std::string_view name) {
      return lines_.error(ReadFault::syntax, fmt::format("{} is not a type of PLY", shown(name)),
                          "use char uchar short ushort int uint float double");
    };
    if (elements_.empty()) {
      return std::unexpected(
          lines_.error(ReadFault::syntax, "a property comes before any element", "name its element first"));
    }
    std::string_view word = take_word(line);
    std::optional<Type> count;
    if (word == "list") {
      word = take_word(line);
      count = type_named(word);
      if (!count || *count == Type::f32 || *count == Type::f64) return std::unexpected(bad_type(word));
      word = take_word(line);
    }
    const std::optional<Type> type = type_named(word);
    if (!type) return std::unexpected(bad_type(word));
    elements_.back().properties.push_back({std::string{take_word(line)}, *type, count});
    return {};
  }

  /// The next number of the data. Text: the next word, over line ends.
  std::expected<double, ReadError> next_value(Type type) {
    if (encoding_ == Encoding::text) {
      std::string_view word;
      while ((word = take_word(line_)).empty()) {
        if (!lines_.next(line_)) return std::unexpected(truncated());
      }
      auto value = number_of(word);
      if (!value)
        return std::unexpected(lines_.error(ReadFault::bad_number, std::move(value).error(), "correct the number"));
      return *value;
    }
    const std::size_t size = size_of(type);
    if (rest_.size() < size) return std::unexpected(truncated());
    const double value = value_at(rest_, type, encoding_ == Encoding::little ? std::endian::little : std::endian::big);
    rest_.remove_prefix(size);
    return value;
  }

  /// Reads the rows of an element; each property's values go to `take(property, values)`, each whole row to
  /// `finish(row)`.
  template <class Take, class Finish>
  std::expected<void, ReadError> for_each_row(const Element& element, Take&& take, Finish&& finish) {
    if (element.properties.empty()) return {};
    std::vector<double> values;
    for (std::uint64_t row = 0; row < element.count; ++row) {
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const Property& property = element.properties[p];
        double count = 1;
        if (property.count) {
          CLEAVE_TRY(count, next_value(*property.count));
          if (!(count >= 0 && count <= 4294967295.0 && count == std::floor(count))) {
            return std::unexpected(place(ReadFault::out_of_range,
                                         fmt::format("a list of {} has {} entries", property.name, count),
                                         "give a whole number that is not negative"));
          }
        }
        values.clear();
        for (double i = 0; i < count; ++i) {  // grows with the bytes that are there, whatever the count says
          CLEAVE_TRY(const double value, next_value(property.type));
          values.push_back(value);
        }
        take(p, std::span<const double>{values});
      }
      CLEAVE_CHECK(finish(row));
    }
    return {};
  }

  /// An error at the line being read, in text.
  [[nodiscard]] ReadError place(ReadFault fault, std::string what, std::string remedy) const {
    ReadError error = whole(fault, std::move(what), std::move(remedy));
    if (encoding_ == Encoding::text) error.line = lines_.number();
    return error;
  }

  std::expected<void, ReadError> read_vertices(const Element& element) {
    std::array<std::optional<std::size_t>, 3> axis_property;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const Property& property = element.properties[p];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (property.name == std::array{"x", "y", "z"}[axis] && !property.count) axis_property[axis] = p;
      }
    }
    if (!axis_property[0] || !axis_property[1] || !axis_property[2]) {
      return std::unexpected(whole(ReadFault::syntax, "its vertices have no x, y and z", "add the properties"));
    }
    std::array<double, 3> p{};
    return for_each_row(
        element,
        [&](std::size_t property, std::span<const double> values) {
          for (std::size_t axis = 0; axis < 3; ++axis) {
            if (axis_property[axis] == property) p[axis] = values[0];
          }
        },
        [&](std::uint64_t row) -> std::expected<void, ReadError> {
          mesh_.vertices.push_back({p[0], p[1], p[2]});
          if (geometry::is_finite(mesh_.vertices.back())) return {};
          return std::unexpected(
              place(ReadFault::bad_number, fmt::format("vertex {} is not finite", row), "correct or remove it"));
        });
  }

  std::expected<void, ReadError> read_faces(const Element& element) {
    std::optional<std::size_t> list;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const Property& property = element.properties[p];
      if ((property.name == "vertex_indices" || property.name == "vertex_index") && property.count) list = p;
    }
    if (!list) {
      return std::unexpected(
          whole(ReadFault::syntax, "its faces have no list vertex_indices or vertex_index", "add the property"));
    }
    std::optional<ReadError> wrong;
    CLEAVE_CHECK(for_each_row(
        element,
        [&](std::size_t property, std::span<const double> values) {
          if (property != *list || wrong) return;
          if (values.size() > 4096) {
            wrong = place(ReadFault::too_large, fmt::format("a face has {} corners, allowed are 4096", values.size()),
                          "split it into smaller polygons");
            return;
          }
          for (const double value : values) {
            if (!(value >= 0 && value <= static_cast<double>(most_items) && value == std::floor(value))) {
              wrong = place(ReadFault::out_of_range, fmt::format("{} is not a vertex number", value),
                            "vertices count from 0");
              return;
            }
            mesh_.corners.push_back(static_cast<std::uint32_t>(value));
          }
        },
        [&](std::uint64_t) -> std::expected<void, ReadError> {
          if (wrong) return std::unexpected(*wrong);
          if (mesh_.corners.size() >= most_items) {
            return std::unexpected(place(ReadFault::too_large, "has more than 2^32 - 2 corners", "split the file"));
          }
          mesh_.ends.push_back(static_cast<std::uint32_t>(mesh_.corners.size()));
          mesh_.group.push_back(0);
          mesh_.lines.push_back(encoding_ == Encoding::text ? lines_.number() : 0);
          return {};
        }));
    return {};
  }

  /// What is left of a text file but blanks.
  [[nodiscard]] std::string_view trimmed_all() const {
    std::string_view left = trimmed(line_);
    if (!left.empty()) return left;
    left = lines_.rest();
    while (!left.empty() && (is_blank(left.front()) || left.front() == '\n')) left.remove_prefix(1);
    return left;
  }

  LineReader lines_;
  std::string_view line_;  ///< what is left of the line being read, in text
  std::string_view rest_;  ///< what is left of binary data
  Encoding encoding_ = Encoding::text;
  std::vector<Element> elements_;
  MeshData mesh_;
};

}  // namespace

std::expected<MeshData, ReadError> parse_ply(std::string_view bytes, std::string_view name) {
  return PlyReader{without_bom(bytes), name}.run();
}

}  // namespace cleave::io
