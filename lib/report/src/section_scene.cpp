#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "cleave/core/expected.hpp"
#include "cleave/core/text.hpp"
#include "cleave/exchange/text.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/report/write.hpp"
#include "cleave/topology/section.hpp"

namespace cleave::report {
namespace {

using geometry::Vec3;

topology::SectionPlane plane_of(const scene::SectionSpec& spec) {
  if (spec.horizontal) return {spec.through, {1, 0, 0}, {0, 1, 0}};
  const double azimuth = spec.azimuth * std::numbers::pi / 180;
  // Heights stay those of the scene.
  return {{spec.through.x, spec.through.y, 0}, {std::sin(azimuth), std::cos(azimuth), 0}, {0, 0, 1}};
}

std::string toml_string(std::string_view text) {
  std::string out;
  append_json_string(out, text);  // a basic string of TOML has the same escapes
  return out;
}

/// Joints by what the scene of contact can tell apart: set and strength.
class Joints final {
 public:
  explicit Joints(const scene::RunResult& result) : result_{result} {}

  std::string name_of(topology::JointId id) {
    const scene::JointInfo& joint = result_.joints[id];
    const auto key = std::tuple{joint.set.value(), joint.strength.friction().degrees(), joint.strength.cohesion().si(),
                                joint.strength.tension().si()};
    if (const auto known = names_.find(key); known != names_.end()) return known->second;
    std::string name = result_.sets[joint.set].name;
    const std::size_t before = count_[name]++;
    // "default" would mean: as the other side.
    if (before > 0 || name == "default") name += " " + std::to_string(before + 1);
    text_ += "[joints." + toml_string(name) + "]\nfriction = " + number(joint.strength.friction().degrees()) +
             "\ncohesion = " + number(joint.strength.cohesion().si()) +
             "\ntension = " + number(joint.strength.tension().si()) + "\n\n";
    return names_.emplace(key, name).first->second;
  }
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  const scene::RunResult& result_;
  std::map<std::tuple<std::uint32_t, double, double, double>, std::string> names_;
  std::map<std::string, std::size_t> count_;
  std::string text_;
};

std::string scene_of(const scene::RunResult& result, const scene::SectionSpec& spec, const topology::Section& section) {
  const topology::SectionPlane plane = plane_of(spec);
  Joints joints{result};
  std::string bodies;
  std::map<std::uint32_t, std::size_t> parts;
  bool cut = false;
  for (const topology::SectionPolygon& polygon : section.polygons) {
    const std::size_t part = parts[polygon.block.value()]++;
    bodies += "[[body]]\nname = \"block " + std::to_string(polygon.block.value()) +
              (part > 0 ? " part " + std::to_string(part + 1) : "") + "\"\n";
    // Held where the rock goes on in the plane; what lies behind and before the plane does not count.
    if (std::ranges::any_of(polygon.sides, [](const topology::SectionSide& side) {
          return side.role == topology::Role::fixed || side.role == topology::Role::window;
        })) {
      bodies += "fixed = true\n";
    }
    std::string outline, names;
    for (std::size_t k = 0; k < polygon.corners.size(); ++k) {
      const char* gap = k > 0 ? ", " : "";
      outline += gap + ("[" + number(polygon.corners[k].x) + ", " + number(polygon.corners[k].y) + "]");
      const topology::SectionSide& side = polygon.sides[k];
      cut = cut || side.cut;
      names += gap + toml_string(side.cut ? "intact" : side.joint ? joints.name_of(*side.joint) : "default");
    }
    bodies += "outline = [" + outline + "]\njoint = [" + names + "]\n\n";
  }
  Vec3 gravity = result.stability ? result.stability->loads.body.gravity() : Vec3{0, 0, -9.81};
  const bool shaken = result.stability && norm(result.stability->loads.body.seismic()) > 0;
  if (shaken) gravity += norm(gravity) * result.stability->loads.body.seismic();
  std::string out =
      "# Section of " + on_one_line(result.scene_file) + ", written by cleave: run it with `cleave run`.\n";
  out += spec.horizontal ? "# Level z = " + number(spec.through.z) + " m; x = east, y = north.\n"
                         : "# Vertical, through (" + number(spec.through.x) + ", " + number(spec.through.y) +
                               "); x towards azimuth " + number(geometry::wrap_degrees(spec.azimuth - result.north)) +
                               " degrees, y up.\n";
  out += "title = " + toml_string(result.title + ": section") +
         "\n\n[rock]\ndensity = " + number(result.rock.mass.density().si()) + "\n\n" + joints.text();
  if (cut) {
    out +=
        "# Cuts through rock: blocks that are rings in the section.\n[joints.intact]\nfriction = 60\ncohesion = "
        "1e9\ntension = 1e9\n\n";
  }
  if (shaken) out += "# With the seismic push of [stability], held for the whole time.\n";
  out += "[contact]\nduration = 2\ngravity = [" + number(dot(plane.right, gravity)) + ", " +
         number(dot(plane.up, gravity)) + "]\n\n" + bodies;
  out.pop_back();
  return out;
}

}  // namespace

std::expected<std::vector<std::string>, WriteError> write_sections(const scene::RunResult& result,
                                                                   const std::filesystem::path& folder) {
  std::vector<std::string> notes;
  if (!result.complex) return notes;
  const topology::BlockComplex& complex = result.complex->complex();
  for (const scene::SectionSpec& spec : result.output.sections) {
    const std::string file = spec.name.empty() ? "section.toml" : "section_" + spec.name + ".toml";
    const topology::Section section = topology::section(complex, plane_of(spec));
    if (section.polygons.empty()) {
      notes.push_back(file + ": not written, the plane meets no block");
      continue;
    }
    CLEAVE_CHECK(write_file(folder / file, scene_of(result, spec, section)));
    notes.push_back(file + ": " + std::to_string(section.polygons.size()) +
                    (section.polygons.size() == 1 ? " body, " : " bodies, ") + number(section.area) + " m2");
    if (section.parted > 0) {
      notes.push_back(file + ": " +
                      (section.parted == 1 ? "1 block is a ring there and was"
                                           : std::to_string(section.parted) + " blocks are rings there and were") +
                      " cut into parts; the cuts have the joint \"intact\"");
    }
    if (section.left_out > 0) {
      notes.push_back(file + ": " +
                      (section.left_out == 1 ? "1 sliver was" : std::to_string(section.left_out) + " slivers were") +
                      " left out, " + number(section.left_out_area) + " m2");
    }
  }
  return notes;
}

}  // namespace cleave::report
