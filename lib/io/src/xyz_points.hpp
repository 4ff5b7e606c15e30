#pragma once

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/geometry/vec3.hpp"
#include "cleave/io/file.hpp"
#include "cleave/io/height_grid.hpp"

namespace cleave::io {

/// Points of a table, in metres.
struct XyzPoints {
  struct Sample {
    geometry::Vec3 at;
    std::uint32_t line;
  };
  std::vector<Sample> samples;  ///< those that have a height
  std::vector<std::string> notes;
};

/// Lines of x, y, z, in this order or as a line of names says. What parts the numbers is found line by line:
/// semicolons (numbers may have decimal commas then), else commas, else blanks and tabs; # begins a comment.
[[nodiscard]] std::expected<XyzPoints, ReadError> read_xyz_points(std::string_view bytes, std::string_view name,
                                                                  const HeightGridOptions& options);

}  // namespace cleave::io
