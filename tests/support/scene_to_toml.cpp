#include "scene_to_toml.hpp"

#include <sstream>

namespace cleave::testing {

std::string scene_to_toml(const IntegerScene& scene, std::string_view note) {
  std::ostringstream out;
  const auto point = [&](IntegerPoint p) { out << '[' << p.x << ", " << p.y << ", " << p.z << ']'; };
  const auto points = [&](const char* key, const std::vector<IntegerPoint>& all) {
    out << key << " = [";
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i > 0) out << ", ";
      point(all[i]);
    }
    out << "]\n";
  };
  std::istringstream lines{std::string{note}};
  for (std::string line; std::getline(lines, line);) out << "# " << line << '\n';
  out << "schema = 1\n\n[domain]\nbox = { min = ";
  point(scene.min);
  out << ", max = ";
  point(scene.max);
  out << " }\n";
  for (const IntegerPolygon& joint : scene.joints) {
    out << "\n[[joint]]\n";
    points("polygon", joint);
  }
  for (const IntegerSolid& solid : scene.excavations) {
    out << "\n[[excavation]]\nkind = \"polyhedron\"\n";
    points("vertices", solid.vertices);
    out << "faces = [";
    for (std::size_t f = 0; f < solid.faces.size(); ++f) {
      out << (f > 0 ? ", [" : "[");
      for (std::size_t i = 0; i < solid.faces[f].size(); ++i) out << (i > 0 ? ", " : "") << solid.faces[f][i] + 1;
      out << ']';
    }
    out << "]\n";
  }
  return out.str();
}

}  // namespace cleave::testing
