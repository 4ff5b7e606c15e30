#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "cleave/bem/problem.hpp"
#include "contact_parts.hpp"

namespace cleave::scene {

using bem::Vec2;

namespace {

/// Of one body: with all its modes it then takes 13 GB and some ten minutes.
constexpr double most_elements = 500;

}  // namespace

bool holds(const ContactBody& body, Vec2 at) { return bem::inside({bem::polygon(body.corners)}, at); }

bool lies_on(const ContactBody& body, Vec2 at) {
  for (std::size_t k = 0; k < body.corners.size(); ++k) {
    const Vec2 a = body.corners[k], d = body.corners[(k + 1) % body.corners.size()] - a;
    if (norm(at - a - std::clamp(dot(at - a, d) / dot(d, d), 0.0, 1.0) * d) <= 1e-6 * norm(d)) return true;
  }
  return false;
}

double element_of(const ContactSettings& settings, const ContactBody& body) {
  if (settings.element) return *settings.element;
  Box2 box;
  for (const Vec2 p : body.corners) box.add(p);
  return std::max(box.high.x - box.low.x, box.high.y - box.low.y) / 4;
}

double elements_of(const ContactSettings& settings, const ContactBody& body) {
  const double element = element_of(settings, body);
  double sum = 0;
  for (std::size_t k = 0; k < body.corners.size(); ++k) {
    const double side = norm(body.corners[(k + 1) % body.corners.size()] - body.corners[k]);
    sum += std::max(1.0, std::ceil(side / element - 1e-9));
  }
  return sum;
}

/// The matrices of an elastic body grow with the square of its elements, and the time for them with the third power.
void check_elements(const ContactScene& scene, const TableReader& contact, Problems& problems) {
  if (!rigidity_of(scene).elastic) return;
  for (const ContactBody& body : scene.bodies) {
    const double count = body.fixed ? 0 : elements_of(scene.settings, body);
    if (count <= most_elements) continue;
    const bool given = scene.settings.element.has_value();
    problems.error(given ? contact.line_of("element") : body.line, given ? "contact.element" : "body.outline",
                   fmt::format("makes {:.6g} elements of \"{}\", more than the {:g} that a body may have", count,
                               body.name, most_elements),
                   given ? "write a longer one, or rigid = true" : "give it fewer corners, or write rigid = true");
    return;
  }
}

/// A point force acts where a body is; elastic bodies are known on their outlines only.
void check_forces(const ContactScene& scene, Problems& problems) {
  const bool elastic = rigidity_of(scene).elastic;
  for (const ContactBody& body : scene.bodies) {
    if (body.corners.empty()) continue;
    for (const ContactLoad& load : body.loads) {
      if (load.side || lies_on(body, load.at)) continue;
      const std::string place = fmt::format("({:.6g}, {:.6g})", load.at.x, load.at.y);
      if (!holds(body, load.at)) {
        problems.error(load.line, "body.load.at", fmt::format("{} lies outside \"{}\"", place, body.name),
                       "a force acts on its body: move the point onto it");
      } else if (elastic) {
        problems.error(load.line, "body.load.at", fmt::format("{} lies inside \"{}\", which deforms", place, body.name),
                       "point forces act on the outline of elastic bodies: move the point there, or rigid = true");
      }
    }
  }
}

/// Relaxation starts at rest and knows no time.
void check_rest(const ContactScene& scene, Problems& problems) {
  if (!scene.settings.to_rest) return;
  for (const ContactBody& body : scene.bodies) {
    if (body.motion) {
      problems.error(body.line, "body.motion", "moves, but static = true knows no time",
                     "remove motion, or static = true");
    }
    if (!(body.velocity == Vec2{}) || body.spin != 0) {
      problems.error(body.line, "body.velocity",
                     fmt::format("\"{}\" has a speed at the start, but static = true starts from rest", body.name),
                     "remove velocity and angular_velocity, or static = true");
    }
    for (const ContactLoad& load : body.loads) {
      if (!load.timed) continue;
      problems.error(load.line, "body.load.time", "loads change with time in moving scenes only",
                     "remove it, or static = true");
    }
  }
}

/// Bodies may touch but not lie in each other. What rounding of written coordinates makes is let pass.
void check_overlaps(const ContactScene& scene, Problems& problems) {
  double smallest = 1e300;
  std::vector<std::vector<Vec2>> polygons;
  for (const ContactBody& body : scene.bodies) {
    polygons.push_back(body.corners);
    double longest = 0;
    for (const Vec2 p : body.corners) longest = std::max(longest, norm(p - body.corners.front()));
    smallest = std::min(smallest, longest);
  }
  for (const Overlap& overlap : overlaps_of(polygons, 1e-5 * smallest)) {
    // Two fixed bodies may share room: nothing moves between them.
    if (scene.bodies[overlap.first].fixed && scene.bodies[overlap.second].fixed) continue;
    problems.error(
        scene.bodies[overlap.second].line, fmt::format("body[{}]", overlap.second + 1),
        fmt::format("\"{}\" overlaps \"{}\" by {:.3g} m at ({:.6g}, {:.6g})", scene.bodies[overlap.second].name,
                    scene.bodies[overlap.first].name, overlap.depth, overlap.at.x, overlap.at.y),
        "move one of them: bodies may touch, not lie in each other");
  }
}

void note_water(const TableReader& root, const ContactScene& scene) {
  double lowest = 1e300, highest = -1e300;
  for (const ContactBody& body : scene.bodies) {
    for (const Vec2 corner : body.corners) {
      lowest = std::min(lowest, corner.y);
      highest = std::max(highest, corner.y);
    }
  }
  for (const ContactJoint& joint : scene.joints) {
    const bool own = &joint == &scene.joints.front() || joint.water_table != scene.joints.front().water_table;
    if (!own || !joint.water_table) continue;
    const double level = joint.water_table->si();
    if (level > lowest && level <= highest) continue;
    root.problems().note(
        root.line_of("joints"), fmt::format("joints.{}.water_table", joint.name),
        level > highest
            ? fmt::format("is {:g}, above all bodies (up to {:g}): they stand under water", level, highest)
            : fmt::format("is {:g}, below all bodies (from {:g} on), so that nothing is wet", level, lowest),
        "it is a level in the coordinates of the scene, not a depth or a level above the sea");
  }
}

void check_elastic(const ContactScene& scene, const TableReader& contact, Problems& problems) {
  if (scene.settings.in_situ && !rigidity_of(scene).elastic) {
    contact.error("in_situ", "is locked in bodies that deform, but these are rigid",
                  "give young and poisson in [rock] and rigid = false, or remove in_situ");
  }
  if (scene.settings.in_situ && scene.settings.to_rest && scene.settings.gravity == Vec2{}) {
    contact.error("in_situ", "comes to rest by no weight, which static = true measures forces by",
                  "give gravity, or a duration with mass_damping in place of static = true");
  }
  if (scene.settings.rigidity == Rigidity::rigid) return;
  const bool must = scene.settings.rigidity == Rigidity::elastic;
  const bool clamped = std::ranges::any_of(scene.bodies, &ContactBody::clamped);
  if (!must && !clamped) return;
  for (const ContactBody& body : scene.bodies) {
    if (body.fixed || (body.young && body.poisson)) continue;
    problems.error(must ? contact.line_of("rigid") : body.line, must ? "contact.rigid" : "body.young",
                   fmt::format("bodies deform, but \"{}\" has no Young's modulus or Poisson's ratio", body.name),
                   "give young and poisson in [rock] or in the body, or rigid = true");
    return;
  }
}

}  // namespace cleave::scene
