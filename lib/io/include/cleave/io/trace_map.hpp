#pragma once

#include <array>
#include <cstddef>
#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/io/file.hpp"

namespace cleave::io {

/// Lines and polygons of a map, coordinates as in the file.
struct TraceMap {
  std::vector<std::vector<std::array<double, 2>>> lines;
  std::vector<std::vector<std::array<double, 2>>> polygons;  ///< outer rings, without the repeated last corner
  bool unit_known = true;                                    ///< false for digitised pixels: the user must give a scale
  std::vector<std::string> notes;                            ///< what was left out
};

/// By the ending of `name`: .geojson/.json (LineString, MultiLineString, Polygon, MultiPolygon; coordinates in degrees
/// are refused, null geometries skipped), .csv with a header (x1,y1,x2,y2, or trace,x,y), .txt as FracPaQ writes it
/// (one trace a line, x1 y1 x2 y2 ... with tabs, pixels).
[[nodiscard]] std::expected<TraceMap, ReadError> parse_trace_map(std::string_view bytes, std::string_view name);

}  // namespace cleave::io
