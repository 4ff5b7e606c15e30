#include "suite.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>

#include "cleave/core/rng.hpp"
#include "elastic_body.hpp"

namespace cleave::contact_suite {
namespace {

using dbem::Body;
using dbem::Laws;
using dbem::Vec2;
using dbem::World;
using dbem::WorldOptions;
using std::numbers::pi;
using Corners = std::vector<Vec2>;

constexpr double g = 9.81;

/// A scene and how its problem is taken from it.
struct Scene {
  std::vector<Body> bodies;
  Laws laws;
  double step = 1e-2;
  Vec2 gravity = {0, -g};
  int warm_up = 0;  // steps made before the problem is taken
  double gap = 0;   // a gap opened under everything, m
};

double between(Rng& rng, double low, double high) { return low + (high - low) * rng.uniform(); }

Corners rectangle(double x, double y, double width, double height) {
  return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}
Corners turned(Corners corners, double angle) {
  for (Vec2& c : corners) c = rotated(c, angle);
  return corners;
}

Body fixed(Corners corners) {
  Body body{.name = "", .outline = std::move(corners)};
  body.held = {true, true, true};
  return body;
}

/// Makes a body of corners; the seed's random numbers decide what the family varies.
using Maker = std::function<Body(const Corners&)>;

Body rigid(const Corners& corners) { return Body{.name = "", .outline = corners, .density = 2600}; }

Maker elastic(double young, std::size_t per_side = 2, std::size_t modes = 12) {
  return [=](const Corners& corners) { return support::elastic_body(corners, {.young = young}, per_side, modes); };
}

Laws friction(double mu, double restitution = 0) {
  Laws laws;
  laws.otherwise.friction = mu;
  laws.otherwise.restitution = restitution;
  return laws;
}

void scale_mass(Body& body, double factor) {
  body.density *= factor;
  if (body.modes) {  // the same shapes, slower and smaller
    for (double& w : body.modes->omega) w /= std::sqrt(factor);
    for (double& s : body.modes->shapes) s /= std::sqrt(factor);
  }
}

/// Masses spread over `ratio` at random, the last body the heaviest.
void spread_masses(Rng& rng, std::vector<Body>& bodies, double ratio) {
  for (std::size_t k = 1; k < bodies.size(); ++k) {
    scale_mass(bodies[k], k + 1 == bodies.size() ? ratio : std::pow(ratio, rng.uniform()));
  }
}

/// Random velocities and a random push to the side.
void shake(Rng& rng, Scene& scene, double speed, double side = 0.3) {
  for (Body& body : scene.bodies) {
    if (body.held.all()) continue;
    body.velocity = {speed * rng.normal(), speed * rng.normal()};
    body.spin = speed * rng.normal();
  }
  scene.gravity = {side * g * between(rng, -1, 1), -g};
}

Scene stack(Rng& rng, std::size_t count, const Maker& make = rigid) {
  Scene scene{.bodies = {fixed(rectangle(-5, -1, 10, 1))}, .laws = friction(0.6)};
  double y = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double width = between(rng, 0.8, 1.2), height = between(rng, 0.6, 1.2);
    Body body = make(rectangle(-width / 2, 0, width, height));
    body.origin += {between(rng, -0.05, 0.05), y};
    y += height;
    scene.bodies.push_back(std::move(body));
  }
  return scene;
}

Scene wall(Rng& rng, std::size_t rows, std::size_t columns, const Maker& make = rigid) {
  const double width = between(rng, 0.8, 1.5), height = between(rng, 0.4, 0.9);
  const double n = static_cast<double>(columns);
  Scene scene{.bodies = {fixed(rectangle(-5, -1, n * width + 10, 1))}, .laws = friction(0.6)};
  const Body brick = make(rectangle(0, 0, width, height));
  const double joint = 0.002 * width;
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t k = 0; k + r % 2 < columns; ++k) {
      Body body = brick;
      const double shift = r % 2 == 1 ? 0.5 * width : 0.0;
      body.origin += {static_cast<double>(k) * (width + joint) + shift, static_cast<double>(r) * height};
      scene.bodies.push_back(std::move(body));
    }
  }
  return scene;
}

Scene arch(Rng& rng, std::size_t count, const Maker& make = rigid) {
  Scene scene{.bodies = {fixed(rectangle(-3, -1, 6, 1))}, .laws = friction(between(rng, 0.5, 1.2))};
  const double t = between(rng, 0.112, 0.2);
  const double a = 1 - t / 2, b = 1 + t / 2;
  const auto at = [](double r, double angle) { return Vec2{r * std::cos(angle), r * std::sin(angle)}; };
  for (std::size_t k = 0; k < count; ++k) {
    const double t0 = pi * static_cast<double>(k) / static_cast<double>(count);
    const double t1 = pi * static_cast<double>(k + 1) / static_cast<double>(count);
    scene.bodies.push_back(make({at(a, t0), at(b, t0), at(b, t1), at(a, t1)}));
  }
  return scene;
}

/// A wedge pressed between two planes, with a block on top: more friction forces than equations.
Scene wedge(Rng& rng, const Maker& make = rigid) {
  const double t = std::tan(between(rng, 0.1, 0.5));
  const double depth = between(rng, 1, 2);
  Scene scene{.bodies = {fixed({{-4, 0}, {-0.5, 0}, {-0.5 - 4 * t, 4}, {-4, 4}}),
                         fixed({{0.5, 0}, {4, 0}, {4, 4}, {0.5 + 4 * t, 4}})},
              .laws = friction(between(rng, 0.1, 0.9))};
  scene.bodies.push_back(
      make({{-0.5 - t, 1}, {0.5 + t, 1}, {0.5 + (1 + depth) * t, 1 + depth}, {-0.5 - (1 + depth) * t, 1 + depth}}));
  const double width = 0.5 + (1 + depth) * t;
  scene.bodies.push_back(make(rectangle(-0.5 * width, 1 + depth, width, between(rng, 0.3, 1))));
  return scene;
}

/// A box cut by random lines into convex blocks that fit each other exactly, in a trough.
Scene rubble(Rng& rng, std::size_t lines) {
  std::vector<Corners> pieces{rectangle(0, 0, 4, 3)};
  for (std::size_t l = 0; l < lines; ++l) {
    const double angle = between(rng, 0, pi);
    const Vec2 normal{std::cos(angle), std::sin(angle)};
    const Vec2 through{between(rng, 0.8, 3.2), between(rng, 0.6, 2.4)};
    std::vector<Corners> next;
    for (const Corners& piece : pieces) {
      Corners side[2];
      for (std::size_t k = 0; k < piece.size(); ++k) {
        const Vec2 p = piece[k], q = piece[(k + 1) % piece.size()];
        const double a = dot(normal, p - through), b = dot(normal, q - through);
        (a >= 0 ? side[0] : side[1]).push_back(p);
        if ((a >= 0) != (b >= 0)) {
          const Vec2 cut = p + a / (a - b) * (q - p);
          side[0].push_back(cut);
          side[1].push_back(cut);
        }
      }
      for (Corners& part : side) {
        if (part.size() >= 3) next.push_back(std::move(part));
      }
    }
    bool slivers = false;
    for (const Corners& piece : next) slivers = slivers || dbem::polygon_moments(piece).area < 0.02;
    if (!slivers) pieces = std::move(next);
  }
  Scene scene{.bodies = {fixed({{-2, -1}, {6, -1}, {6, 3}, {4, 3}, {4, 0}, {0, 0}, {0, 3}, {-2, 3}})},
              .laws = friction(between(rng, 0.2, 0.8))};
  for (const Corners& piece : pieces) {
    const dbem::PolygonMoments m = dbem::polygon_moments(piece);
    Corners local;
    bool short_edge = false;
    for (std::size_t k = 0; k < piece.size(); ++k) {
      local.push_back(piece[k] - m.centroid);
      short_edge = short_edge || norm(piece[(k + 1) % piece.size()] - piece[k]) < 1e-6;
    }
    if (short_edge) continue;
    Body body = rigid(local);
    body.origin = m.centroid;
    scene.bodies.push_back(std::move(body));
  }
  return scene;
}

/// L-shaped blocks hooked into each other.
Scene hooks(Rng& rng, std::size_t count) {
  Scene scene{.bodies = {fixed(rectangle(-5, -1, 20, 1))}, .laws = friction(between(rng, 0.2, 0.8))};
  const double w = between(rng, 0.3, 0.6);
  for (std::size_t k = 0; k < count; ++k) {
    const double x = static_cast<double>(k % 4) * (1 + w), y = static_cast<double>(k / 4);
    Body body = rigid({{0, 0}, {1 + w, 0}, {1 + w, 1}, {1, 1}, {1, 1 - w / 2}, {0, 1 - w / 2}});
    if (k % 4 == 3) body = rigid(rectangle(0, 0, 1, 1 - w / 2));
    body.origin = {x, y};
    scene.bodies.push_back(std::move(body));
    Body filler = rigid(rectangle(0, 1 - w / 2, 1, w / 2));
    filler.origin = {x, y};
    scene.bodies.push_back(std::move(filler));
  }
  return scene;
}

/// Two squares that meet at their corners, and a third that pushes.
Scene corner_on_corner(Rng& rng) {
  Scene scene{.bodies = {fixed(rectangle(-5, -1, 10, 1))}, .laws = friction(between(rng, 0, 1), 0)};
  scene.bodies.push_back(rigid(rectangle(0, 0, 1, 1)));
  Body upper = rigid(turned(rectangle(-0.5, 0, 0.5, 0.5), between(rng, -0.3, 0.3)));
  upper.outline = turned(rectangle(0, 0, 0.6, 0.6), pi / 4 + between(rng, -0.2, 0.2));
  upper.origin = {rng.uniform() < 0.5 ? 0.0 : 1.0, 1};
  upper.velocity = {between(rng, -0.5, 0.5), -1};
  scene.bodies.push_back(std::move(upper));
  Body side = rigid(rectangle(0, 0, 0.8, 0.5));
  side.origin = {1, 0};
  side.velocity = {-1, 0};
  scene.bodies.push_back(std::move(side));
  return scene;
}

Scene rod(Rng& rng) {
  Scene scene{
      .bodies = {fixed(rectangle(-20, -1, 40, 1)), rigid(turned(rectangle(0, 0, 2, 0.05), between(rng, 0.7, 1.3)))},
      .laws = friction(between(rng, 1.4, 4)),
      .step = 1e-3};
  scene.bodies[1].velocity = {-between(rng, 1, 5), 0};
  scene.bodies[1].spin = between(rng, -1, 1);
  return scene;
}

Scene spinning(Rng& rng) {
  Scene scene{.bodies = {}, .laws = friction(0.5, 0.3), .gravity = {0, 0}};
  for (int k = 0; k < 9; ++k) {
    Body body = rigid(rectangle(0, 0, 1, 1));
    body.origin = {static_cast<double>(k % 3), static_cast<double>(k / 3)};
    body.spin = between(rng, -10, 10);
    body.velocity = {rng.normal(), rng.normal()};
    scene.bodies.push_back(std::move(body));
  }
  scene.step = 1e-3;
  return scene;
}

struct Family {
  std::string name;
  std::size_t seeds;
  bool elastic;
  bool small;  // also in the quick list
  std::function<Scene(Rng&)> make;
};

std::vector<Family> families() {
  const auto with = [](auto scene_of, auto change) {
    return [=](Rng& rng) {
      Scene scene = scene_of(rng);
      change(rng, scene);
      return scene;
    };
  };
  const auto pushed = [](Rng& rng, Scene& s) { shake(rng, s, 0); };
  const auto hit = [](Rng& rng, Scene& s) { shake(rng, s, 0.5); };
  const auto masses = [](double ratio, double speed) {
    return [=](Rng& rng, Scene& s) {
      spread_masses(rng, s.bodies, ratio);
      shake(rng, s, speed);
    };
  };
  const auto stack8 = [](Rng& rng) { return stack(rng, 8); };
  const auto stack50 = [](Rng& rng) { return stack(rng, 50); };
  const auto wall3 = [](Rng& rng) { return wall(rng, 3, 4); };
  const auto wall6 = [](Rng& rng) { return wall(rng, 6, 6); };
  const auto arch8 = [](Rng& rng) { return arch(rng, 6 + static_cast<std::size_t>(rng.between(0, 8))); };
  const auto soft = elastic(1e8);
  const auto elastic_stack = [=](Rng& rng) { return stack(rng, 4, soft); };
  const auto elastic_wall = [=](Rng& rng) { return wall(rng, 3, 3, soft); };
  const std::size_t n = 10;
  return {
      {"stack", n, false, true, with(stack8, pushed)},
      {"stack-frictionless", n, false, true,
       with(stack8,
            [](Rng& r, Scene& s) {
              shake(r, s, 0);
              s.laws = friction(0);
            })},
      {"stack-89deg", n, false, true,
       with(stack8,
            [](Rng& r, Scene& s) {
              shake(r, s, 0);
              s.laws = friction(57.29);
            })},
      {"stack-impact", n, false, true, with(stack8, hit)},
      {"stack-m1e2", n, false, true, with(stack8, masses(1e2, 0))},
      {"stack-m1e3", n, false, true, with(stack8, masses(1e3, 0))},
      {"stack-m1e6", n, false, true, with(stack8, masses(1e6, 0))},
      {"stack50", n, false, false, with(stack50, pushed)},
      {"stack50-m1e3", n, false, false, with(stack50, masses(1e3, 0))},
      {"stack200", 8, false, false, with([](Rng& rng) { return stack(rng, 200); }, pushed)},
      {"wall", n, false, true, with(wall3, pushed)},
      {"wall-impact", n, false, true, with(wall3, hit)},
      {"wall-m1e3", n, false, true, with(wall3, masses(1e3, 0))},
      {"wall-impact-m1e3", n, false, true, with(wall3, masses(1e3, 0.5))},
      {"wall-impact-m1e6", n, false, true, with(wall3, masses(1e6, 0.5))},
      {"wall33-impact", n, false, false, with(wall6, hit)},
      {"wall1000", 8, false, false,
       with([](Rng& rng) { return wall(rng, 25, 40); }, [](Rng& rng, Scene& s) { shake(rng, s, 0, 0.05); })},
      {"arch", n, false, true, with(arch8, pushed)},
      {"arch-impact", n, false, true, with(arch8, hit)},
      {"arch-m1e3", n, false, true, with(arch8, masses(1e3, 0))},
      {"arch101", 8, false, false,
       with([](Rng& rng) { return arch(rng, 101); }, [](Rng& rng, Scene& s) { shake(rng, s, 0, 0.1); })},
      {"wedge", n, false, true, with([](Rng& rng) { return wedge(rng); }, pushed)},
      {"wedge-impact-m1e3", n, false, true,
       with([](Rng& rng) { return wedge(rng); },
            [](Rng& rng, Scene& s) {
              scale_mass(s.bodies[3], 1e3);
              shake(rng, s, 0.5);
            })},
      {"rubble", n, false, true, with([](Rng& rng) { return rubble(rng, 6); }, pushed)},
      {"rubble-impact", n, false, true, with([](Rng& rng) { return rubble(rng, 6); }, hit)},
      {"hooks", n, false, true, with([](Rng& rng) { return hooks(rng, 8); }, hit)},
      {"gaps-1e-9", n, false, true,
       with(stack8,
            [](Rng& rng, Scene& s) {
              shake(rng, s, 0);
              s.gap = 1e-9;
            })},
      {"nearly-parallel", n, false, true,
       with(stack8,
            [](Rng& rng, Scene& s) {
              shake(rng, s, 0);
              for (std::size_t k = 1; k < s.bodies.size(); ++k) {
                const double angle = std::pow(10.0, between(rng, -10, -6));
                s.bodies[k].outline = turned(s.bodies[k].outline, rng.uniform() < 0.5 ? angle : -angle);
              }
              s.gap = 1e-6;
            })},
      {"corner-on-corner", n, false, true, corner_on_corner},
      {"rod", n, false, true, rod},
      {"steps", n, false, true,
       [=](Rng& rng) {
         Scene s = wall3(rng);
         shake(rng, s, 0.1);
         s.step = std::pow(10.0, between(rng, -6, -1));
         return s;
       }},
      {"offset-1e6", n, false, true,
       with(arch8,
            [](Rng& rng, Scene& s) {
              shake(rng, s, 0.1);
              for (Body& b : s.bodies) b.origin += {1e6, -1e6};
            })},
      {"spinning", n, false, true, spinning},
      {"restitution", n, false, true,
       with(wall3,
            [](Rng& rng, Scene& s) {
              shake(rng, s, 1);
              s.laws = friction(0.4, between(rng, 0.2, 1));
            })},
      {"arch-falling", n, false, true,
       [](Rng& rng) {
         Scene s = arch(rng, 12);
         s.laws = friction(0.25);
         s.warm_up = static_cast<int>(rng.between(5, 30));
         return s;
       }},
      {"elastic-stack", n, true, true, with(elastic_stack, pushed)},
      {"elastic-stack-impact", n, true, false, with(elastic_stack, hit)},
      {"elastic-stack-m1e3", n, true, false, with(elastic_stack, masses(1e3, 0))},
      {"elastic-modulus-1e6", n, true, true,
       [](Rng& rng) {
         // Stiff and soft blocks in turns, either at the bottom.
         std::size_t made = rng.uniform() < 0.5 ? 0 : 1;
         Scene s = stack(rng, 4, [&](const Corners& c) { return elastic(made++ % 2 == 0 ? 1e13 : 1e7)(c); });
         shake(rng, s, 0.2);
         return s;
       }},
      {"elastic-wall", n, true, false, with(elastic_wall, pushed)},
      {"elastic-wall-impact", n, true, false, with(elastic_wall, hit)},
      {"elastic-arch", n, true, false, with([=](Rng& rng) { return arch(rng, 7, soft); }, hit)},
      {"elastic-wedge", n, true, true, with([=](Rng& rng) { return wedge(rng, soft); }, hit)},
  };
}

std::optional<std::vector<dbem::ContactProblem>> problem_of(Scene scene) {
  if (scene.gap > 0) {
    double lift = 0;
    for (Body& body : scene.bodies) {
      if (body.held.all()) continue;
      lift += scene.gap;
      body.origin.y += lift;
    }
  }
  auto world = World::make(std::move(scene.bodies), std::move(scene.laws),
                           {.gravity = scene.gravity, .step = scene.step, .overlap = 1e-4, .sleep = false});
  if (!world) {
    fmt::print(stderr, "suite: {}\n", dbem::describe(world.error()));
    return std::nullopt;
  }
  for (int k = 0; k < scene.warm_up; ++k) {
    if (!world->step()) return std::nullopt;
  }
  return world->problems(scene.step);
}

}  // namespace

std::size_t SuiteProblem::contacts() const {
  std::size_t sum = 0;
  for (const auto& group : groups) sum += group.contacts();
  return sum;
}

std::vector<SuiteProblem> suite(bool quick) {
  std::vector<SuiteProblem> problems;
  std::uint64_t family_number = 0;
  for (const Family& family : families()) {
    ++family_number;
    if (quick && !family.small) continue;
    for (std::uint64_t seed = 1; seed <= (quick ? 2 : family.seeds); ++seed) {
      Rng rng{1000 * family_number + seed};
      auto groups = problem_of(family.make(rng));
      if (!groups) std::abort();
      problems.push_back({family.name, seed, family.elastic, *std::move(groups)});
    }
  }
  return problems;
}

}  // namespace cleave::contact_suite
