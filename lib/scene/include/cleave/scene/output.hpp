#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/core/fields.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/scene/problem.hpp"

namespace cleave::scene {

/// [project]: what heads summary.json and the report; nothing is computed from it.
struct Project {
  std::string name = {}, author = {}, client = {}, date = {};
  [[nodiscard]] bool empty() const { return name.empty() && author.empty() && client.empty() && date.empty(); }
};
template <class V>
void fields(V& v, const Project& x) {
  v("name", when(!x.name.empty(), x.name));
  v("author", when(!x.author.empty(), x.author));
  v("client", when(!x.client.empty(), x.client));
  v("date", when(!x.date.empty(), x.date));
}

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

/// What every kind of scene says of itself, and where it was read.
struct SceneHead {
  std::string title = {};
  Project project = {};
  std::uint64_t seed = 1;
  OutputSettings output = {};
  std::string shown = {};               ///< how messages name the scene file
  std::string file_name = {};           ///< the same without its folder
  std::string sha256 = {};              ///< of the scene file's bytes
  std::vector<std::string> given = {};  ///< keys of the scene file, those of included ones too
  std::vector<Problem> notes = {};      ///< worth knowing, not wrong: a joint outside the domain
};

}  // namespace cleave::scene
