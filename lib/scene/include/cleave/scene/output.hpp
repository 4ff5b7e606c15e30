#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/geometry/vec3.hpp"

namespace cleave::scene {

/// A section of the block system as a scene of contact.
struct SectionSpec {
  std::string name;  ///< empty: section.toml, else section_NAME.toml
  bool horizontal = false;
  geometry::Vec3 through;
  double azimuth = 90;  ///< degrees clockwise from +y: where a vertical section's x axis points
};

struct OutputSettings {
  bool vtu = true;                        ///< blocks.vtu
  bool csv = true;                        ///< key_blocks.csv
  bool report = true;                     ///< report.html
  std::vector<std::string> exports = {};  ///< among known_exports, each once: blocks.obj and so on
  /// blocks = "key": only key blocks are asked for, so only the rock near free faces is cut.
  bool only_key_blocks = false;
  std::vector<SectionSpec> sections = {};
};

/// What [output] exports may name; docs/formats.md has the files.
inline constexpr std::array<std::string_view, 8> known_exports{"obj",   "ply",    "stl",   "3dec",
                                                               "3dec5", "lsdyna", "nmm3d", "dda"};

}  // namespace cleave::scene
