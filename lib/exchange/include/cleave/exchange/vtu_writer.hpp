#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "cleave/exchange/text.hpp"
#include "cleave/geometry/vec3.hpp"

/// VTK's XML file of an unstructured grid; every .vtu of cleave is written with it.
namespace cleave::report {

enum class VtuFormat : std::uint8_t { binary, ascii };

template <class T>
constexpr std::string_view vtu_type() {
  if constexpr (std::is_same_v<T, double>) return "Float64";
  if constexpr (std::is_same_v<T, std::int64_t>) return "Int64";
  if constexpr (std::is_same_v<T, std::int32_t>) return "Int32";
  if constexpr (std::is_same_v<T, std::uint8_t>) return "UInt8";
}

/// Sections in the order of the calls: fields, piece, points, cells, then arrays of points or cells.
class VtuWriter final {
 public:
  /// `comment` stands at the top and may hold any text; empty: none.
  explicit VtuWriter(VtuFormat format, std::string_view comment = {}, std::size_t reserve = 0);

  void begin(std::string_view section) { out_.append("<").append(section).append(">\n"); }
  void end(std::string_view section) { out_.append("</").append(section).append(">\n"); }
  /// Text as VTK wants it: the codes of the characters, each string ended by 0.
  void strings(std::string_view name, const std::vector<std::string>& texts);
  void begin_piece(std::size_t points, std::size_t cells);
  void points(std::span<const geometry::Vec3> points);
  /// Section `Cells`: `ends` of the cells in `connectivity`; of polyhedra also VTK's stream of faces and their ends.
  void cells(const std::vector<std::int64_t>& connectivity, const std::vector<std::int64_t>& ends,
             const std::vector<std::uint8_t>& types);
  void polyhedra(const std::vector<std::int64_t>& connectivity, const std::vector<std::int64_t>& ends,
                 const std::vector<std::int64_t>& faces, const std::vector<std::int64_t>& face_ends);

  template <class T>
  void array(std::string_view name, const std::vector<T>& values, int components = 1) {
    begin_array(vtu_type<T>(), name, components);
    if (format_ == VtuFormat::binary) {
      bytes(std::as_bytes(std::span{values}));
    } else {
      out_ += '\n';
      for (std::size_t i = 0; i < values.size(); ++i) {
        if constexpr (std::is_same_v<T, double>) {
          append_number(out_, values[i]);
        } else {
          out_ += std::to_string(values[i]);
        }
        out_ += (i + 1) % static_cast<std::size_t>(components) == 0 ? '\n' : ' ';
      }
    }
    out_ += "</DataArray>\n";
  }
  void vectors(std::string_view name, std::span<const geometry::Vec3> values);

  [[nodiscard]] std::string finish() &&;

 private:
  void begin_cells(const std::vector<std::int64_t>& connectivity, const std::vector<std::int64_t>& ends,
                   const std::vector<std::uint8_t>& types);
  void begin_array(std::string_view type, std::string_view name, int components);
  void bytes(std::span<const std::byte> values);

  VtuFormat format_;
  std::string out_;
};

/// A .pvd of files at times.
[[nodiscard]] std::string pvd(std::span<const std::pair<double, std::string>> files);
/// "NAME_0007.vtu".
[[nodiscard]] std::string frame_file(std::string_view name, std::size_t frame);

}  // namespace cleave::report
