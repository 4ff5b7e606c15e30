#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "bytes.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/io/mesh.hpp"
#include "text.hpp"
#include "vtu_check.hpp"
#include "xml_tags.hpp"

namespace cleave::io {
namespace {

using std::string_view;

constexpr std::int64_t polyhedron = 42;  // VTK_POLYHEDRON

/// The bytes of RFC 4648 text; blanks are passed over, padding may stand between two runs. Empty when it is none.
std::optional<std::string> from_base64(string_view text) {
  constexpr auto digits = [] {
    std::array<std::int8_t, 256> table{};
    table.fill(-1);
    constexpr string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < letters.size(); ++i) {
      table[static_cast<unsigned char>(letters[i])] = static_cast<std::int8_t>(i);
    }
    return table;
  }();
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int have = 0;
  for (const char c : text) {
    if (is_blank(c) || c == '\n') continue;
    if (c == '=') {  // what is left of a group of four is padding
      bits = 0;
      have = 0;
      continue;
    }
    const std::int8_t digit = digits[static_cast<unsigned char>(c)];
    if (digit < 0) return std::nullopt;
    bits = (bits << 6U | static_cast<std::uint32_t>(digit)) & 0xFFFFFFU;
    if (++have == 1) continue;
    const auto shift = static_cast<unsigned>(8 - 2 * have);  // 4, 2, 0 bits belong to the next byte
    bytes += static_cast<char>(bits >> shift & 0xFFU);
    if (have == 4) have = 0;
  }
  return bytes;
}

/// How the numbers of an array lie in memory.
struct Type {
  std::size_t size;
  enum class Kind : std::uint8_t { whole, natural, real } kind;
};
std::optional<Type> type_named(string_view name) {
  using enum Type::Kind;
  constexpr std::array<std::pair<string_view, Type>, 10> types{{{"Int8", {1, whole}},
                                                                {"UInt8", {1, natural}},
                                                                {"Int16", {2, whole}},
                                                                {"UInt16", {2, natural}},
                                                                {"Int32", {4, whole}},
                                                                {"UInt32", {4, natural}},
                                                                {"Int64", {8, whole}},
                                                                {"UInt64", {8, natural}},
                                                                {"Float32", {4, real}},
                                                                {"Float64", {8, real}}}};
  const auto found = std::ranges::find(types, name, &std::pair<string_view, Type>::first);
  return found == types.end() ? std::nullopt : std::optional{found->second};
}

/// An array of the file, its numbers as whole numbers or as reals; wholes beyond 2^63 do not occur in indices.
struct Array {
  bool real = false;
  std::vector<std::int64_t> wholes;
  std::vector<double> reals;
};

class VtuReader final {
 public:
  VtuReader(string_view bytes, string_view file) : all_{bytes}, rest_{bytes}, file_{file} {}

  std::expected<Polyhedra, ReadError> run() {
    CLEAVE_CHECK(read_arrays());
    CLEAVE_CHECK(read_points());
    CLEAVE_CHECK(read_cells());
    CLEAVE_CHECK(read_blocks());
    CLEAVE_CHECK(check_counts());
    CLEAVE_CHECK(check_cells());
    return std::move(result_);
  }

 private:
  [[nodiscard]] ReadError wrong(ReadFault fault, std::string what, std::string remedy) const {
    const string_view read = all_.substr(0, all_.size() - rest_.size());
    const auto line = static_cast<std::uint32_t>(1 + std::ranges::count(read, '\n'));
    return {fault, std::string{file_}, line, {}, std::move(what), std::move(remedy)};
  }
  [[nodiscard]] ReadError whole(ReadFault fault, std::string what, std::string remedy) const {
    return whole_file(fault, file_, std::move(what), std::move(remedy));
  }
  static constexpr const char* resave = "save it with inline arrays, as ascii or uncompressed binary";

  std::expected<void, ReadError> read_arrays() {
    std::string section;
    bool is_vtu = false;
    bool complete = false;
    int pieces = 0;
    while (const auto tag = take_tag(rest_)) {
      if (tag->name == "VTKFile") {
        CLEAVE_CHECK(read_file_tag(*tag));
        is_vtu = true;
      } else if (!is_vtu) {
        break;
      } else if (tag->name == "Piece" && ++pieces == 2) {
        return std::unexpected(
            wrong(ReadFault::unknown_format, "has several pieces", "save it as one piece, not in parallel"));
      } else if (tag->name == "Piece") {
        stated_points_ = tag->find("NumberOfPoints");
        stated_cells_ = tag->find("NumberOfCells");
      } else if (tag->name == "Points" || tag->name == "Cells" || tag->name == "CellData") {
        section = tag->name;
      } else if (tag->name == "/Points" || tag->name == "/Cells" || tag->name == "/CellData") {
        section.clear();
      } else if (tag->name == "DataArray") {
        CLEAVE_CHECK(read_array(section, *tag));
      } else if (tag->name == "/VTKFile") {
        complete = true;
      }
    }
    if (!is_vtu) {
      return std::unexpected(whole(ReadFault::unknown_format, "has no tag VTKFile", "check that this is a VTU file"));
    }
    if (!complete) {
      return std::unexpected(
          wrong(ReadFault::truncated, "ends before </VTKFile>", "get the whole file again; appended data is not read"));
    }
    return {};
  }

  std::expected<void, ReadError> read_file_tag(const XmlTag& tag) {
    const string_view type = tag.find("type").value_or("");
    if (type != "UnstructuredGrid") {
      return std::unexpected(wrong(ReadFault::unknown_format, fmt::format("holds {}", shown(type)),
                                   "give a file of type UnstructuredGrid"));
    }
    if (tag.find("compressor")) return std::unexpected(wrong(ReadFault::unknown_format, "is compressed", resave));
    const string_view order = tag.find("byte_order").value_or("LittleEndian");
    order_ = order == "BigEndian" ? std::endian::big : std::endian::little;
    header_size_ = tag.find("header_type").value_or("UInt32") == "UInt64" ? 8 : 4;
    return {};
  }

  std::expected<void, ReadError> read_array(const std::string& section, const XmlTag& tag) {
    const string_view name = tag.find("Name").value_or("");
    const bool wanted =
        section == "Points" || section == "Cells" || (section == "CellData" && (name == "block" || name == "volume"));
    if (!wanted) return {};
    const auto type = type_named(tag.find("type").value_or(""));
    if (!type) {
      return std::unexpected(
          wrong(ReadFault::syntax,
                fmt::format("the array {} has the type {}", shown(name), shown(tag.find("type").value_or(""))),
                "it must be Int8 to UInt64, Float32 or Float64"));
    }
    const string_view format = tag.find("format").value_or("ascii");
    Array array{.real = type->kind == Type::Kind::real, .wholes = {}, .reals = {}};
    if (format == "ascii") {
      CLEAVE_CHECK(read_text(tag.text, name, array));
    } else if (format == "binary") {
      CLEAVE_CHECK(read_binary(tag.text, name, *type, array));
    } else {
      return std::unexpected(
          wrong(ReadFault::unknown_format, fmt::format("the array {} is {}", shown(name), shown(format)), resave));
    }
    const std::string key = section == "Points"     ? "points"
                            : section == "CellData" ? "cell " + std::string{name}
                                                    : std::string{name};
    arrays_.insert_or_assign(key, std::move(array));
    return {};
  }

  std::expected<void, ReadError> read_text(string_view text, string_view name, Array& array) {
    LineReader lines{text, file_};
    string_view line;
    while (lines.next(line)) {
      for (string_view word = take_word(line); !word.empty(); word = take_word(line)) {
        const auto value = number_of(word);
        constexpr double largest = 9007199254740992.0;
        if (!value || (!array.real && (*value != std::floor(*value) || std::abs(*value) > largest))) {
          return std::unexpected(wrong(ReadFault::bad_number,
                                       fmt::format("the array {} holds {}", shown(name), shown(word)),
                                       "correct the number"));
        }
        if (array.real) {
          array.reals.push_back(*value);
        } else {
          array.wholes.push_back(static_cast<std::int64_t>(*value));
        }
      }
    }
    return {};
  }

  /// A count of bytes, then the numbers.
  std::expected<void, ReadError> read_binary(string_view text, string_view name, Type type, Array& array) {
    const auto bytes = from_base64(text);
    const std::size_t have = bytes ? bytes->size() : 0;
    if (!bytes || have < header_size_) {
      return std::unexpected(wrong(ReadFault::syntax, fmt::format("the array {} is not base64", shown(name)), resave));
    }
    const string_view all = *bytes;
    const std::uint64_t stated = header_size_ == 8 ? unsigned_at<8>(all, order_) : unsigned_at<4>(all, order_);
    if (stated != have - header_size_ || stated % type.size != 0) {
      return std::unexpected(
          wrong(ReadFault::truncated,
                fmt::format("the array {} says it has {} bytes and has {}", shown(name), stated, have - header_size_),
                "get the whole file again"));
    }
    for (std::size_t at = header_size_; at < have; at += type.size) append(all.substr(at, type.size), type, array);
    return {};
  }

  void append(string_view bytes, Type type, Array& array) const {
    if (type.kind == Type::Kind::real) {
      array.reals.push_back(type.size == 8 ? double_at(bytes, order_) : static_cast<double>(float_at(bytes, order_)));
      return;
    }
    std::uint64_t value = type.size == 8   ? unsigned_at<8>(bytes, order_)
                          : type.size == 4 ? unsigned_at<4>(bytes, order_)
                          : type.size == 2 ? unsigned_at<2>(bytes, order_)
                                           : unsigned_at<1>(bytes, order_);
    if (type.kind == Type::Kind::whole && type.size < 8) {
      const std::uint64_t sign = std::uint64_t{1} << (8 * type.size - 1);
      value = (value ^ sign) - sign;
    }
    array.wholes.push_back(std::bit_cast<std::int64_t>(value));
  }

  std::expected<const Array*, ReadError> need(const std::string& name, bool real) const {
    const auto found = arrays_.find(name);
    if (found == arrays_.end()) {
      return std::unexpected(whole(ReadFault::syntax, fmt::format("has no array {}", shown(name)),
                                   "give a grid of polyhedra in the layout with faces and faceoffsets"));
    }
    if (found->second.real != real) {
      return std::unexpected(whole(
          ReadFault::syntax, fmt::format("the array {} is not of {}", shown(name), real ? "reals" : "whole numbers"),
          "save it anew"));
    }
    return &found->second;
  }

  std::expected<void, ReadError> read_points() {
    CLEAVE_TRY(const Array* array, need("points", true));
    const std::vector<double>& flat = array->reals;
    if (flat.size() % 3 != 0) {
      return std::unexpected(whole(ReadFault::truncated,
                                   fmt::format("has {} coordinates, not three a point", flat.size()), "save it anew"));
    }
    for (std::size_t i = 0; i < flat.size(); i += 3) {
      const geometry::Vec3 p{flat[i], flat[i + 1], flat[i + 2]};
      if (!geometry::is_finite(p)) {
        return std::unexpected(
            whole(ReadFault::bad_number, fmt::format("point {} is not finite", i / 3), "correct or remove it"));
      }
      result_.points.push_back(p);
    }
    return {};
  }

  std::expected<void, ReadError> read_cells() {
    CLEAVE_TRY(const Array* types, need("types", false));
    for (std::size_t c = 0; c < types->wholes.size(); ++c) {
      if (types->wholes[c] == polyhedron) continue;
      return std::unexpected(
          whole(ReadFault::unknown_format,
                fmt::format("cell {} is of the VTK type {}, not a polyhedron (42)", c, types->wholes[c]),
                "give a grid of polyhedra"));
    }
    if (types->wholes.empty())
      return std::unexpected(whole(ReadFault::empty, "holds no cell", "give a grid with cells"));
    CLEAVE_TRY(const Array* faces, need("faces", false));
    CLEAVE_TRY(const Array* ends, need("faceoffsets", false));
    if (ends->wholes.size() != types->wholes.size()) {
      return std::unexpected(whole(
          ReadFault::out_of_range,
          fmt::format("has {} cells but {} faceoffsets", types->wholes.size(), ends->wholes.size()), "save it anew"));
    }
    std::int64_t begin = 0;
    for (std::size_t c = 0; c < ends->wholes.size(); ++c) {
      const std::int64_t end = ends->wholes[c];
      if (end < begin || end > static_cast<std::int64_t>(faces->wholes.size()) ||
          !is_cell(std::span{faces->wholes}.subspan(static_cast<std::size_t>(begin),
                                                    static_cast<std::size_t>(end - begin)))) {
        return std::unexpected(
            whole(ReadFault::out_of_range, fmt::format("the faces of cell {} do not fit together", c), "save it anew"));
      }
      begin = end;
    }
    result_.face_stream = faces->wholes;
    result_.face_stream.resize(static_cast<std::size_t>(begin));
    result_.face_ends = ends->wholes;
    return {};
  }

  [[nodiscard]] bool is_cell(std::span<const std::int64_t> stream) const {
    if (stream.empty() || stream[0] < 4) return false;
    std::size_t at = 1;
    for (std::int64_t f = 0; f < stream[0]; ++f) {
      if (at >= stream.size() || stream[at] < 3) return false;
      if (static_cast<std::uint64_t>(stream[at]) > stream.size() - at - 1) return false;
      const auto count = static_cast<std::size_t>(stream[at]);
      for (const std::int64_t point : stream.subspan(at + 1, count)) {
        if (point < 0 || point >= static_cast<std::int64_t>(result_.points.size())) return false;
      }
      at += count + 1;
    }
    return at == stream.size();
  }

  std::expected<void, ReadError> read_blocks() {
    const std::size_t cells = result_.size();
    if (!arrays_.contains("cell block")) {
      for (std::size_t c = 0; c < cells; ++c) result_.block.push_back(static_cast<std::uint32_t>(c));
      return {};
    }
    CLEAVE_TRY(const Array* blocks, need("cell block", false));
    const bool fit = blocks->wholes.size() == cells && std::ranges::all_of(blocks->wholes, [](std::int64_t b) {
                       return b >= 0 && b < std::int64_t{0xFFFFFFFE};
                     });
    if (!fit) {
      return std::unexpected(
          whole(ReadFault::out_of_range, "the cell array \"block\" does not number the cells", "save it anew"));
    }
    for (const std::int64_t block : blocks->wholes) result_.block.push_back(static_cast<std::uint32_t>(block));
    return {};
  }

  std::expected<void, ReadError> check_counts() const {
    const auto differ = [](std::optional<string_view> stated, std::size_t count) {
      const auto number = number_of(stated.value_or(""));
      return stated && !(number && *number == static_cast<double>(count));
    };
    if (!differ(stated_points_, result_.points.size()) && !differ(stated_cells_, result_.size())) return {};
    return std::unexpected(
        whole(ReadFault::truncated,
              fmt::format("has {} points and {} cells, but says NumberOfPoints {} and NumberOfCells {}",
                          result_.points.size(), result_.size(), shown(stated_points_.value_or("")),
                          shown(stated_cells_.value_or(""))),
              "get the whole file again, or correct the tag Piece"));
  }

  std::expected<void, ReadError> check_cells() const {
    std::vector<double> volumes;
    if (const auto found = arrays_.find("cell volume"); found != arrays_.end()) {
      volumes = found->second.reals;
      for (const std::int64_t whole_number : found->second.wholes) volumes.push_back(static_cast<double>(whole_number));
      if (volumes.size() != result_.size()) {
        return std::unexpected(whole(
            ReadFault::out_of_range,
            fmt::format("has {} cells but {} numbers in the cell array \"volume\"", result_.size(), volumes.size()),
            "save it anew"));
      }
    }
    auto fault = fault_of_cells(result_, volumes);
    if (!fault) return {};
    return std::unexpected(whole(ReadFault::out_of_range, std::move(fault->what), std::move(fault->remedy)));
  }

  string_view all_;
  string_view rest_;
  string_view file_;
  std::endian order_ = std::endian::little;
  std::size_t header_size_ = 4;
  std::optional<string_view> stated_points_, stated_cells_;
  std::map<std::string, Array, std::less<>> arrays_;  ///< cell arrays as "cell NAME"
  Polyhedra result_;
};

}  // namespace

std::expected<Polyhedra, ReadError> parse_vtu(string_view bytes, string_view name) {
  return VtuReader{without_bom(bytes), name}.run();
}

}  // namespace cleave::io
