#include "engine_cases.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "shapes.hpp"

namespace cleave::study::engines {
namespace {

using motion::turn_by;
using motion::shapes::block;
using motion::shapes::degree;

constexpr double g = 9.81;

double tangent(double degrees) { return std::tan(degrees * degree); }

/// z on the normal of a plane, y down its dip.
Turn slope(double dip, double dip_direction) {
  return turn_by({0, 0, -dip_direction * degree}) * turn_by({-dip * degree, 0, 0});
}
Body box_body(Vec3 sides, Vec3 at, double friction, Turn turn = {}) {
  return {.shape = block(sides.x, sides.y, sides.z), .sides = sides, .at = at, .turn = turn, .friction = friction};
}
/// With the centroid taken off.
Body hull_body(motion::Polyhedron shape, double friction) {
  const Vec3 middle = motion::mass_properties(shape).value().centroid;
  return {.shape = motion::shapes::moved(std::move(shape), -middle), .at = middle, .friction = friction};
}
Vec3 went(const Scene& scene, const Outcome& out, std::size_t body = 0) {
  return out.frames.back().at(body).at - scene.bodies.at(body).at;
}
double turned(const Scene& scene, const Outcome& out, std::size_t body = 0) {
  const Turn t = out.frames.back().at(body).turn, s = scene.bodies.at(body).turn;
  return motion::angle_of(motion::normalized(t * Turn{.w = s.w, .x = -s.x, .y = -s.y, .z = -s.z}));
}
/// Largest way of a body off where it should have gone.
double farthest(const Scene& scene, const Outcome& out, const std::function<Vec3(std::size_t)>& exact) {
  double most = 0;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const double off = norm(went(scene, out, b) - exact(b));
    if (!(off <= most)) most = off;  // what is no number stays
  }
  return most;
}
double wrong_reaction(const Scene& scene, const Outcome& out) {
  double weight = 0;
  for (const Body& b : scene.bodies) weight += mass_of(b).mass * norm(scene.gravity);
  return out.reaction ? std::abs(*out.reaction / weight - 1) : std::nan("");
}

/// Down planes of any direction, turned by 25 degrees in the plane; `stick`: the one that stays.
Case slides(bool stick) {
  Case out{.name = stick ? "stick" : "slide", .parts = {}, .steps = {0.02, 0.01, 0.005, 0.0025}, .within = {1e-9}};
  for (const auto& [dip, direction, friction] :
       {std::tuple{30.0, 0.0, 10.0}, {30, 137, 10}, {35, 222.5, 20}, {50, 313, 30}, {35, 222.5, 36}}) {
    if ((friction > dip) != stick) continue;
    const Turn plane = slope(dip, direction);
    Scene scene{.bodies = {box_body({1, 2, 0.5}, plane * Vec3{0, 0, 0.25}, tangent(friction),
                                    plane * turn_by({0, 0, 25 * degree}))},
                .floors = {{plane, tangent(friction)}}};
    const double way = stick ? 0 : g / 2 * (std::sin(dip * degree) - std::cos(dip * degree) * tangent(friction));
    const Vec3 exact = way * (plane * Vec3{0, 1, 0});
    const double scale = stick ? 1 : way;
    out.parts.push_back({scene, {1}, {[=](const Outcome& o) { return norm(went(scene, o) - exact) / scale; }}});
  }
  return out;
}

/// Thrown across a slope as steep as its friction: the path turns downhill.
Case across() {
  Case out{.name = "across", .parts = {}, .steps = {0.02, 0.01, 0.005, 0.0025, 0.00125}, .within = {2e-3}};
  const Turn plane = slope(30, 90);
  const Vec3 over = plane * Vec3{1, 0, 0}, down = plane * Vec3{0, 1, 0};
  for (const double yaw : {0.0, 45.0}) {
    Scene scene{
        .bodies = {box_body({1, 1, 0.1}, plane * Vec3{0, 0, 0.05}, tangent(30), plane * turn_by({0, 0, yaw * degree}))},
        .floors = {{plane, tangent(30)}}};
    scene.bodies[0].velocity = 2 * over;
    const Vec3 exact = 0.84711001 * down + 0.53868197 * over;
    out.parts.push_back({scene, {1}, {[=](const Outcome& o) { return norm(went(scene, o) - exact); }}});
  }
  return out;
}

Case stops() {
  Scene scene{.bodies = {box_body({1, 2, 0.5}, {0, 0, 0.25}, 0.3)}, .floors = {{{}, 0.3}}};
  scene.bodies[0].velocity = {1, 1, 0};
  const double way = 2 / (2 * 0.3 * g);
  const Vec3 exact{way * std::numbers::sqrt2 / 2, way * std::numbers::sqrt2 / 2, 0};
  return {.name = "stop",
          .parts = {{scene, {0.6}, {[=](const Outcome& o) { return norm(went(scene, o) - exact) / way; }}}},
          .steps = {0.02, 0.01, 0.005, 0.0025},
          .within = {1e-4}};
}

/// Tetrahedron on two planes, down their line or at rest.
Case wedge() {
  Case out{.name = "wedge", .parts = {}, .steps = {0.02, 0.01, 0.005, 0.0025}, .within = {1e-8}};
  const Turn first = slope(45, 105), second = slope(70, 235);
  const Vec3 n1 = first * Vec3{0, 0, 1}, n2 = second * Vec3{0, 0, 1};
  Vec3 line = geometry::normalized(cross(n1, n2));
  if (line.z > 0) line = -line;
  const Vec3 top = 2 / line.z * line;
  Vec3 a = geometry::normalized(cross(n1, {0, 0, 1})), b = geometry::normalized(cross(n2, {0, 0, 1}));
  if (dot(n2, a) < 0) a = -a;
  if (dot(n1, b) < 0) b = -b;
  // What presses on either plane, over the mass.
  const double c = dot(n1, n2), w1 = g * n1.z, w2 = g * n2.z;
  const double p1 = (w1 - c * w2) / (1 - c * c), p2 = (w2 - c * w1) / (1 - c * c);
  for (const auto& [f1, f2] : {std::pair{20, 10}, {20, 20}, {20, 30}}) {
    Scene scene{.bodies = {hull_body(motion::shapes::hull({{0, 0, 0}, top, top + 2.5 * a, top + 2.5 * b}), 10)},
                .floors = {{first, tangent(f1)}, {second, tangent(f2)}}};
    const double drive = std::max(0.0, -g * line.z - tangent(f1) * p1 - tangent(f2) * p2);
    const Vec3 exact = drive * 0.5 * 0.5 / 2 * line;
    out.parts.push_back({scene, {0.5}, {[=](const Outcome& o) { return norm(went(scene, o) - exact) / 0.173; }}});
  }
  return out;
}

/// Hexagonal prism that spins on its base: pressed at its corners, however it is shared out, it stops by one law.
Case spins() {
  Scene scene{.bodies = {hull_body(motion::shapes::prism(motion::shapes::regular(6, 1), 0, 0.4), 0.3)},
              .floors = {{{}, 0.3}}};
  scene.bodies[0].spin = {0, 0, 5};
  const double angle = 25 / (2 * 0.3 * g * 12 / 5);
  return {.name = "spin",
          .parts = {{scene, {0.76}, {[=](const Outcome& o) {
                       return std::abs(turned(scene, o) - angle) / angle + norm(went(scene, o));
                     }}}},
          .steps = {0.02, 0.01, 0.005, 0.0025},
          .within = {1e-4}};
}

/// Tumbles without forces from near its middle axis; after a period its spin is as it was.
Case tumbles() {
  Scene scene{.bodies = {box_body({1, 2, 3}, {}, 0)}, .floors = {}, .gravity = {}};
  const Vec3 start{0.01, 1, 0};
  scene.bodies[0].spin = start;
  const double period = 46.837819;
  const auto spin = [](const Outcome& o) {
    const Pose& p = o.frames.back().at(0);
    return p.turn.back(p.spin);
  };
  const auto energy = [](Vec3 w) { return 6.5 * w.x * w.x + 5 * w.y * w.y + 2.5 * w.z * w.z; };
  return {.name = "tumble",
          .parts = {{scene,
                     {period},
                     {[=](const Outcome& o) { return norm(spin(o) - start); },
                      [=](const Outcome& o) { return std::abs(energy(spin(o)) / energy(start) - 1); }}}},
          .steps = {period / 1171, period / 2342, period / 4684, period / 9368},
          .within = {1e-3, 1e-11},
          .measures = {"", " energy"}};
}

/// Dropped flat by 1 m: what is left of the height.
Case drops() {
  Case out{.name = "drop", .parts = {}, .steps = {0.02, 0.01, 0.005, 0.0025}, .within = {2e-2}};
  for (const double e : {0.0, 0.5, 1.0}) {
    const Scene scene{.bodies = {box_body({1, 1, 1}, {0, 0, 1.5}, 0.5)}, .floors = {{{}, 0.5}}, .restitution = e};
    out.parts.push_back({scene, {0.6}, {[=](const Outcome& o) {
                           const Pose& p = o.frames.back().at(0);
                           return std::abs(p.at.z - 0.5 + dot(p.velocity, p.velocity) / (2 * g) - e * e);
                         }}});
  }
  return out;
}

/// Angle after `time` of a prism 1 x 1 x 3 about a pivot `out` beyond and 1.5 below its middle, under level and upright
/// gravity.
double toppled(double out, double level, double upright, double time) {
  const double inertia = 10.0 / 12 + out * out + 2.25;
  const auto pull = [&](double a) {
    const double x = -out * std::cos(a) + 1.5 * std::sin(a), z = 1.5 * std::cos(a) + out * std::sin(a);
    return (z * level + x * upright) / inertia;
  };
  double a = 0, w = 0;
  constexpr int count = 4000;
  const double h = time / count;
  for (int k = 0; k < count; ++k) {
    const double k1 = pull(a), k2 = pull(a + h / 2 * w), k3 = pull(a + h / 2 * w + h * h / 4 * k1),
                 k4 = pull(a + h * w + h * h / 2 * k2);
    a += h * w + h * h / 6 * (k1 + k2 + k3);
    w += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return a;
}

/// Prism 1 x 1 x 3 a little below and above the tilts at which it turns over side, corner and edge.
Case tilts() {
  Case out{.name = "tilt", .parts = {}, .steps = {0.02, 0.01, 0.005, 0.0025}, .within = {2e-2}};
  // The edge: 22.5 degrees off the side, about that side alone.
  const double off = 22.5 * degree;
  double largest = 0;
  for (const bool over : {true, false}) {
    for (const auto& [low, high, way] : {std::tuple{18.3, 18.6, 0.0}, {25.2, 25.3, 45.0}, {19.0, 20.0, 22.5}}) {
      const double dip = (over ? high : low) * degree;
      Scene scene{.bodies = {box_body({1, 1, 3}, {0, 0, 1.5}, 5)}, .floors = {{{}, 5}}};
      scene.gravity = {g * std::sin(dip) * std::cos(way * degree), g * std::sin(dip) * std::sin(way * degree),
                       -g * std::cos(dip)};
      const double level = g * std::sin(dip) * (way == 22.5 ? std::cos(off) : 1);
      const double exact = over ? toppled(way == 45 ? std::numbers::sqrt2 / 2 : 0.5, level, g * std::cos(dip), 1) : 0;
      largest = std::max(largest, exact);
      const double scale = over ? exact : largest;
      out.parts.push_back({scene, {1}, {[=](const Outcome& o) { return std::abs(turned(scene, o) - exact) / scale; }}});
    }
  }
  return out;
}

/// Five bricks, each out over the one below by a share of the most that stands.
Scene leaning(double share) {
  Scene scene{.bodies = {}, .floors = {{{}, 0.6}}};
  double x = 0;
  for (int k = 0; k < 5; ++k) {
    scene.bodies.push_back(box_body({1, 1, 0.2}, {x + 0.5, 0.5, 0.2 * k + 0.1}, 0.6));
    x += share * 0.5 / (4 - k + (k == 4 ? 1 : 0));
  }
  return scene;
}
/// Stands at 0.999 of the most, by how far it moves; topples at 1.001, or is all wrong.
Case overhang() {
  const auto most = [](const Scene& scene, const Outcome& o) {
    double angle = 0;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      const double a = turned(scene, o, b);
      if (!(a <= angle)) angle = a;
    }
    return angle;
  };
  const Scene under = leaning(0.999), over = leaning(1.001);
  const auto still = [](std::size_t) { return Vec3{}; };
  return {
      .name = "overhang",
      .parts = {{under, {1}, {[=](const Outcome& o) { return std::max(most(under, o), farthest(under, o, still)); }}},
                {over, {1}, {[=](const Outcome& o) { return most(over, o) > 1e-3 ? 0.0 : 1.0; }}}},
      .steps = {0.02, 0.01, 0.005, 0.0025},
      .within = {1e-7}};
}

/// What should not move, and what it weighs on the floor as long as it stands.
Case stands(const std::string& name, const Scene& scene, double time, const std::vector<double>& steps, bool large) {
  const auto still = [](std::size_t) { return Vec3{}; };
  return {
      .name = name,
      .parts = {{scene,
                 {time},
                 {[=](const Outcome& o) { return farthest(scene, o, still); },
                  [=](const Outcome& o) { return farthest(scene, o, still) < 0.1 ? wrong_reaction(scene, o) : 1; }}}},
      .steps = steps,
      .within = {1e-6, 1e-6},
      .measures = {"", " reaction"},
      .large = large};
}

Scene stacks(int count, int height, double friction, double gap = 0, double drop = 0) {
  Scene scene{.bodies = {}, .floors = {{{}, friction}}};
  const int side = static_cast<int>(std::ceil(std::sqrt(count)));
  for (int k = 0; k < count; ++k) {
    const double x = 2.0 * (k % side - side / 2), y = 2.0 * (k / side - side / 2);
    for (int z = 0; z < height; ++z) {
      scene.bodies.push_back(box_body({1, 1, 1}, {x, y, drop + z * (1 + gap) + 0.5}, friction));
    }
  }
  return scene;
}

/// Smooth columns that drop by 2 m with gaps of 1 cm: where they lie at the end, and that nothing moves any more.
Case columns(const std::string& name, int count, int height, bool large) {
  const Scene scene = stacks(count, height, 0, 0.01, 2);
  const auto exact = [=](std::size_t b) {
    return Vec3{0, 0, -2 - 0.01 * static_cast<double>(b % static_cast<std::size_t>(height))};
  };
  return {.name = name,
          .parts = {{scene, {1}, {[=](const Outcome& o) { return farthest(scene, o, exact); }}}},
          .steps = {0.02, 0.01, 0.005, 0.0025},
          .within = {1e-6},
          .large = large};
}

/// In bond, ends with half stones.
Scene wall(int rows, int columns) {
  Scene scene{.bodies = {}, .floors = {{{}, 0.6}}};
  for (int row = 0; row < rows; ++row) {
    for (double x = row % 2 == 0 ? 0 : -0.5; x < columns; x += 1) {
      const double a = std::max(x, 0.0), b = std::min(x + 1, 1.0 * columns);
      scene.bodies.push_back(box_body({b - a, 0.5, 0.5}, {(a + b) / 2 - 0.5 * columns, 0, 0.5 * row + 0.25}, 0.6));
    }
  }
  return scene;
}

/// Stacks of four that slide down a plane as one: only the lowest joint slips.
Case sliding_stacks(int count) {
  const Turn plane = slope(15, 137);
  Scene scene = stacks(count, 4, 2);
  scene.floors = {{plane, tangent(10)}};
  for (Body& b : scene.bodies) {
    b.at = plane * b.at;
    b.turn = plane;
  }
  const double way = g / 2 * (std::sin(15 * degree) - std::cos(15 * degree) * tangent(10));
  const Vec3 exact = way * (plane * Vec3{0, 1, 0});
  return {.name = "slide 1000",
          .parts = {{scene, {1}, {[=](const Outcome& o) {
                       return farthest(scene, o, [=](std::size_t) { return exact; }) / way;
                     }}}},
          .steps = {0.05, 0.02, 0.01, 0.005, 0.0025},
          .within = {1e-6},
          .large = true};
}

}  // namespace

std::vector<Case> small_cases() {
  std::vector<Case> out{slides(false), slides(true), across(), stops(), wedge(),
                        spins(),       tumbles(),    drops(),  tilts(), overhang()};
  for (const auto& [name, top] : {std::pair{"stack", 1.0}, {"stack top 1e3", 1e3}, {"stack top 1e6", 1e6}}) {
    Scene scene = stacks(1, 20, 0.5);
    scene.bodies.back().density *= top;
    out.push_back(stands(name, scene, 5, {0.02, 0.01, 0.005, 0.0025}, false));
  }
  out.push_back(columns("columns", 4, 10, false));
  return out;
}

std::vector<Case> large_cases(int count) {
  const std::vector<double> steps{0.1, 0.05, 0.02, 0.01, 0.005, 0.0025};
  return {stands("stacks 1000", stacks(count / 10, 10, 0.5), 1, steps, true),
          stands("wall 1000", wall(20, count / 20), 1, steps, true), sliding_stacks(count / 4),
          columns("columns 1000", count / 10, 10, true)};
}

}  // namespace cleave::study::engines
