#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/dbem/world.hpp"
#include "study.hpp"

#ifdef CLEAVE_HAS_BOX2D
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
#endif
#include <box2d/box2d.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
#endif

// Error against time of rigid blocks in contact: cleave, and Box2D (Catto; Debian's libbox2d) as the bound on speed.
// Box2D iterates on impulses a fixed number of times in single precision and lets bodies sink by half a centimetre; it
// is made for games and says so. Both see the same polygons, densities, friction, gravity and steps.
//
// slider: 1 x 0.5 m on 30 degrees, friction 20; error of the way after 0.8 s, closed form.
// stack:  20 blocks of 1 m; largest displacement after 2 s over the side: it should not move.
// arch:   12 stones, radius 10 m, 1.12 m thick; largest displacement after 2 s over the thickness: it should not move.
// falling: 1,000 boxes of 1 m, turned at random, fall side by side in five layers and settle for 2 s; the deepest
//         overlap at the end over the side: nothing should be inside anything.

namespace cleave::study {
namespace {

using bem::Vec2;

struct Piece {
  std::vector<Vec2> corners;  ///< convex, counter-clockwise, at most 8
  bool fixed = false;
};
struct Case {
  std::string name;
  std::vector<Piece> pieces;
  double friction = 0;  ///< tangent
  double end = 0;       ///< s
};

std::vector<Vec2> box(Vec2 corner, double width, double height, double angle = 0) {
  std::vector<Vec2> out;
  for (const Vec2 p : {Vec2{0, 0}, Vec2{width, 0}, Vec2{width, height}, Vec2{0, height}}) {
    out.push_back(corner + rotated(p, angle));
  }
  return out;
}

constexpr double degree = std::numbers::pi / 180;

Case slider() {
  const double slope = 30 * degree;
  return {"slider",
          {{{{0, 0}, {10 * std::cos(slope), 0}, {0, 5}}, true},
           {box({std::cos(slope), 5 - std::sin(slope)}, 1, 0.5, -slope), false}},
          std::tan(20 * degree),
          0.8};
}
Case stack(int count) {
  Case out{"stack", {{box({-5, -1}, 11, 1), true}}, std::tan(30 * degree), 2};
  for (int k = 0; k < count; ++k) out.pieces.push_back({box({0, static_cast<double>(k)}, 1, 1), false});
  return out;
}
Case arch(int stones) {
  Case out{"arch", {{box({8, -2}, 4, 2), true}, {box({-12, -2}, 4, 2), true}}, std::tan(60 * degree), 2};
  const double radius = 10, thick = 1.12;
  for (int k = 0; k < stones; ++k) {
    const auto at = [&](double r, int joint) {
      const double angle = std::numbers::pi * joint / stones;
      return Vec2{r * std::cos(angle), joint == stones ? 0 : r * std::sin(angle)};
    };
    out.pieces.push_back({{at(radius + thick / 2, k), at(radius + thick / 2, k + 1), at(radius - thick / 2, k + 1),
                           at(radius - thick / 2, k)},
                          false});
  }
  return out;
}

Case falling(int count) {
  const double pitch = 1.6;
  const int across = count / 5;
  const double width = pitch * across;
  Case out{"falling",
           {{box({-2, -1}, width + 4, 1), true}, {box({-2, 0}, 1, 20), true}, {box({width + 1, 0}, 1, 20), true}},
           0.5,
           2};
  Rng rng{1};
  for (int k = 0; k < count; ++k) {
    const Vec2 middle{pitch * (k % across) + 0.8 + 0.1 * (rng.uniform() - 0.5), 1 + 1.5 * (k / across)};
    const double angle = std::numbers::pi * rng.uniform();
    out.pieces.push_back({box(middle - rotated(Vec2{0.5, 0.5}, angle), 1, 1, angle), false});
  }
  return out;
}

struct Answer {
  std::vector<Vec2> moved;                    ///< displacements of the centroids of what moves
  std::vector<std::vector<Vec2>> outlines{};  ///< of all pieces at the end
};

/// How far the second polygon reaches behind the side of the first that it is least behind; both are convex.
double depth_behind_sides(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  double least = 1e300;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const Vec2 along = a[(k + 1) % a.size()] - a[k];
    double deepest = -1e300;
    for (const Vec2 p : b) deepest = std::max(deepest, -dot(turned_right(along), p - a[k]) / norm(along));
    least = std::min(least, deepest);
  }
  return least;
}

double deepest_overlap(const std::vector<std::vector<Vec2>>& outlines) {
  double worst = 0;
  for (std::size_t a = 0; a < outlines.size(); ++a) {
    for (std::size_t b = a + 1; b < outlines.size(); ++b) {
      const double depth =
          std::min(depth_behind_sides(outlines[a], outlines[b]), depth_behind_sides(outlines[b], outlines[a]));
      worst = std::max(worst, depth);
    }
  }
  return worst;
}

double error_of(const Case& problem, const Answer& answer) {
  const std::vector<Vec2>& moved = answer.moved;
  if (problem.name == "falling") return deepest_overlap(answer.outlines);
  if (problem.name == "slider") {
    const double exact =
        9.81 / 2 * (std::sin(30 * degree) - std::cos(30 * degree) * problem.friction) * problem.end * problem.end;
    return std::abs(norm(moved[0]) - exact) / exact;
  }
  double most = 0;
  for (const Vec2 u : moved) most = std::max(most, norm(u));
  return most / (problem.name == "arch" ? 1.12 : 1);
}

/// Empty when the run stopped.
std::optional<Answer> by_cleave(const Case& problem, double step) {
  std::vector<dbem::Body> bodies;
  for (const Piece& piece : problem.pieces) {
    dbem::Body body;
    body.outline = piece.corners;
    body.density = 2000;
    if (piece.fixed) body.held = {true, true, true};
    bodies.push_back(std::move(body));
  }
  dbem::Laws laws;
  laws.otherwise.friction = problem.friction;
  dbem::WorldOptions options;
  options.step = step;
  auto world = dbem::World::make(std::move(bodies), laws, options);
  if (!world) return std::nullopt;
  while (world->time() < problem.end * (1 - 1e-12)) {
    if (!world->step(problem.end - world->time())) return std::nullopt;
  }
  Answer out;
  for (std::size_t b = 0; b < problem.pieces.size(); ++b) {
    if (!problem.pieces[b].fixed) out.moved.push_back(world->displacement(b));
    out.outlines.push_back(world->outline(b));
  }
  return out;
}

#ifdef CLEAVE_HAS_BOX2D
Answer by_box2d(const Case& problem, double step, int velocity_iterations, int position_iterations) {
  b2World world{b2Vec2{0, -9.81F}};
  std::vector<b2Body*> moving, all;  // owned by the world
  std::vector<b2Vec2> start;
  for (const Piece& piece : problem.pieces) {
    b2BodyDef definition;
    definition.type = piece.fixed ? b2_staticBody : b2_dynamicBody;
    b2Body* body = world.CreateBody(&definition);
    std::vector<b2Vec2> corners;
    for (const Vec2 p : piece.corners) corners.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y));
    b2PolygonShape shape;
    shape.Set(corners.data(), static_cast<int32>(corners.size()));
    b2FixtureDef fixture;
    fixture.shape = &shape;
    fixture.density = 2000;
    fixture.friction = static_cast<float>(problem.friction);
    body->CreateFixture(&fixture);
    all.push_back(body);
    if (piece.fixed) continue;
    moving.push_back(body);
    start.push_back(body->GetWorldCenter());
  }
  const auto steps = static_cast<int>(std::lround(problem.end / step));
  for (int k = 0; k < steps; ++k) world.Step(static_cast<float>(step), velocity_iterations, position_iterations);
  Answer out;
  for (std::size_t b = 0; b < moving.size(); ++b) {
    const b2Vec2 u = moving[b]->GetWorldCenter() - start[b];
    out.moved.push_back({static_cast<double>(u.x), static_cast<double>(u.y)});
  }
  for (std::size_t b = 0; b < all.size(); ++b) {
    std::vector<Vec2>& outline = out.outlines.emplace_back();
    for (const Vec2 p : problem.pieces[b].corners) {
      const b2Vec2 now = all[b]->GetWorldPoint(b2Vec2{static_cast<float>(p.x), static_cast<float>(p.y)});
      outline.push_back({static_cast<double>(now.x), static_cast<double>(now.y)});
    }
  }
  return out;
}
#endif

std::string words(double step) {
  char text[32];
  std::snprintf(text, sizeof text, "dt=%.4g", step);
  return text;
}

/// Error of the way of the slider under a push along the slope that swings with time, closed form; empty when stopped.
std::optional<double> swung(double step) {
  const Case problem = slider();
  const double up = 30 * degree, omega = 8, mass = 2000 * 0.5, push = 0.2 * mass * 9.81;
  const Vec2 down{std::cos(up), -std::sin(up)};
  dbem::Body slope{.name = "slope", .outline = problem.pieces[0].corners};
  slope.held = {true, true, true};
  dbem::Body block{.name = "block", .outline = problem.pieces[1].corners, .density = 2000};
  // At the height of the base: the pressure stays on both corners.
  block.forces.push_back({block.outline[1], push * down, [=](double t) { return std::cos(omega * t); }, false});
  dbem::Laws laws;
  laws.otherwise.friction = problem.friction;
  auto world = dbem::World::make({slope, block}, laws, {.step = step, .displacement = 1});
  if (!world) return std::nullopt;
  while (world->time() < problem.end * (1 - 1e-12)) {
    if (!world->step(problem.end - world->time())) return std::nullopt;
  }
  const double exact = 9.81 / 2 * (std::sin(up) - std::cos(up) * problem.friction) * problem.end * problem.end +
                       push / mass / (omega * omega) * (1 - std::cos(omega * problem.end));
  return std::abs(norm(world->displacement(1)) - exact) / exact;
}

/// Error against step, with its order.
void order(Study& study) {
  Plot plot{"Sliding block under a swinging push: error against step", "step (s)", "error of the way, relative", {}};
  Series series{"cleave", {}, true, true};
  for (const double step : {0.04, 0.02, 0.01, 0.005, 0.0025}) {
    std::optional<double> error;
    const Cost cost = study.measure([&] { error = swung(step); });
    study.add({"slider_swung", "cleave", words(step), error, cost, std::nullopt,
               error ? Status::converged : Status::stopped});
    if (error) series.points.emplace_back(step, *error);
  }
  plot.series.push_back(std::move(series));
  study.plot("order", plot);
}

void body(Study& study) {
  order(study);
  const std::vector<Case> cases{slider(), stack(study.quick() ? 5 : 20), arch(12), falling(study.quick() ? 100 : 1000)};
  std::vector<double> steps{0.02, 0.01, 0.005, 0.0025};
  if (!study.quick()) steps.push_back(0.00125);
  Plot plot{"Rigid blocks in contact: error against time", "processor time (s)", "error, relative", {}};
  for (const Case& problem : cases) {
    Series own{problem.name + " cleave", {}, true, false};
    Series peer{problem.name + " Box2D", {}, true, false};
    for (const double step : steps) {
      if (problem.name == "falling" && step != 0.01) continue;  // tens of seconds otherwise
      std::optional<Answer> answer;
      const Cost cost = study.measure([&] { answer = by_cleave(problem, step); });
      Row row{problem.name, "cleave", words(step), std::nullopt, cost, std::nullopt, Status::stopped};
      if (answer) {
        row.error = error_of(problem, *answer);
        row.status = Status::converged;
        own.points.emplace_back(cost.cpu_s, std::max(*row.error, 1e-16));
      }
      study.add(row);
#ifdef CLEAVE_HAS_BOX2D
      for (const int iterations : {8, 100}) {
        Answer moved;
        const Cost spent =
            study.measure([&] { moved = by_box2d(problem, step, iterations, iterations == 8 ? 3 : 50); });
        const double error = error_of(problem, moved);
        study.add({problem.name, "box2d", words(step) + " it=" + std::to_string(iterations), error, spent, std::nullopt,
                   Status::converged});
        if (iterations == 8) peer.points.emplace_back(spent.cpu_s, std::max(error, 1e-16));
      }
#else
      study.add({problem.name, "box2d", words(step), std::nullopt, {}, std::nullopt, Status::refused});
#endif
    }
    plot.series.push_back(std::move(own));
#ifdef CLEAVE_HAS_BOX2D
    plot.series.push_back(std::move(peer));
#endif
  }
  study.plot("error", plot);
}

}  // namespace
}  // namespace cleave::study

int main(int argc, char** argv) { return cleave::study::run("contact_peers", argc, argv, cleave::study::body); }
