#include "contact_families.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "cleave/core/rng.hpp"

namespace cleave::testing {
namespace {

using dbem::Body;
using dbem::Vec2;
using Ring = std::vector<Vec2>;

class Draws {
 public:
  explicit Draws(std::uint64_t seed) : rng_{seed} {}
  double within(double low, double high) { return low + (high - low) * rng_.uniform(); }
  std::size_t count(std::size_t low, std::size_t high) {
    return static_cast<std::size_t>(rng_.between(static_cast<std::int64_t>(low), static_cast<std::int64_t>(high)));
  }
  bool one_in(std::size_t n) { return count(1, n) == 1; }
  double of(const std::vector<double>& choices) { return choices[count(0, choices.size() - 1)]; }

 private:
  Rng rng_;
};

Ring rectangle(double x, double y, double width, double height) {
  return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}

Ring turned(Ring ring, double angle) {
  for (Vec2& c : ring) c = rotated(c, angle);
  return ring;
}

void add(ContactScene& scene, Ring ring, bool held, std::vector<Ring> parts = {}, Vec2 velocity = {}) {
  if (parts.empty()) parts = {ring};
  Body body{.name = fmt::format("b{}", scene.bodies.size()), .outline = std::move(ring), .density = 2600};
  if (held) body.held = {true, true, true};
  body.velocity = velocity;
  scene.bodies.push_back(std::move(body));
  scene.parts.push_back(std::move(parts));
}

/// Corners on a circle at random angles: convex, at least four wide gaps.
Ring convex_polygon(Draws& draw, double radius) {
  const std::size_t n = draw.count(3, 7);
  std::vector<double> angles;
  const double start = draw.within(0, 2 * std::numbers::pi);
  for (std::size_t k = 0; k < n; ++k) {
    angles.push_back(start +
                     (static_cast<double>(k) + draw.within(0, 0.6)) * 2 * std::numbers::pi / static_cast<double>(n));
  }
  Ring ring;
  for (const double a : angles) ring.push_back({radius * std::cos(a), radius * std::sin(a)});
  return ring;
}

Ring shifted(Ring ring, Vec2 by) {
  for (Vec2& c : ring) c += by;
  return ring;
}

void fill_dropped(Draws& draw, ContactScene& s) {
  const double w = draw.of({1, 1, 0.3, 2.5}), h = draw.of({1, 0.5, 2}), under = draw.of({1, 0.5, 5});
  const double gap = draw.of({1e-3, 1e-2, 1e-5, 0.1});
  const bool fixed_below = draw.one_in(2);
  add(s, rectangle(-10, -1, 20, 1), true);
  add(s, rectangle(0, 0, w, under), fixed_below);
  add(s, rectangle(draw.of({0, 0, 0, 1e-9, -1e-6, 1e-3}), under + gap, w, h), false);
  s.until = 1;
}

void fill_column(Draws& draw, ContactScene& s) {
  const std::size_t n = draw.count(2, 10);
  const double gap = draw.of({1e-5, 1e-4, 1e-3, 1e-2, 0.05}), w = draw.of({1, 1, 0.5, 2});
  add(s, rectangle(-10, -1, 20, 1), true);
  for (std::size_t k = 0; k < n; ++k) add(s, rectangle(0, static_cast<double>(k) * (1 + gap) + gap, w, 1), false);
  s.options.quasi_static = draw.one_in(4);
  if (s.options.quasi_static) s.options.step = 0.01;
  s.until = 0.6;
}

void fill_row(Draws& draw, ContactScene& s) {
  const std::size_t n = draw.count(2, 8);
  const double gap = draw.of({1e-5, 1e-3, 0.02, 0.3}), h = draw.of({0.2, 1, 0.5});
  const bool last_fixed = draw.one_in(2);
  add(s, rectangle(-10, -1, 40, 1), true);
  for (std::size_t k = 0; k < n; ++k) {
    add(s, rectangle(static_cast<double>(k) * (1 + gap), 0, 1, h), last_fixed && k + 1 == n, {},
        k == 0 ? Vec2{draw.of({0.5, 2, 5}), 0} : Vec2{});
  }
  s.until = 1;
}

void fill_head_on(Draws& draw, ContactScene& s) {
  const double length = draw.of({1, 3, 5}), h = draw.of({0.1, 0.5, 1}), gap = draw.of({1e-4, 1e-2, 0.1, 0.5});
  const double speed = draw.of({0.5, 2, 10}), angle = draw.of({0, 0, 0.3, 1, 2});
  const double off = draw.of({0, 0, 0, 1e-9, 1e-4, 0.5 * h});
  const std::size_t n = draw.count(2, 4);
  for (std::size_t k = 0; k < n; ++k) {
    const double v = k == 0 ? speed : k + 1 == n ? -speed : 0;
    add(s, turned(rectangle(static_cast<double>(k) * (length + gap), k + 1 == n ? off : 0, length, h), angle), false,
        {}, rotated({v, 0}, angle));
  }
  s.options.gravity = {};
  s.laws.otherwise.restitution = draw.of({0, 0, 0.5, 1});
  s.until = std::min(1.0, 6 * (gap + 0.05) / speed);
}

void fill_toe(Draws& draw, ContactScene& s) {
  const double toe = draw.within(15, 89) * std::numbers::pi / 180, height = draw.of({0.5, 1});
  const double gap = draw.of({1e-3, 0.05, 0.2}), size = draw.of({0.5, 1, 2}), tilt = draw.of({0, 0, 0.2, -0.4, 1});
  const bool weight = !draw.one_in(4), held = draw.one_in(2);
  const Vec2 v = rotated({draw.of({0.5, 2}), 0}, tilt);
  add(s, turned(rectangle(-12, -1, 24, 1), tilt), true);
  const double run = height / std::tan(toe);
  add(s, turned({{-run - 1, 0}, {0, 0}, {-run, height}, {-run - 1, height}}, tilt), false, {}, v);
  const double lean = draw.of({0, 0, 0.2, 0.1});
  add(s, turned({{gap, 0}, {gap + size, 0}, {gap + size + lean, size}, {gap + lean, size}}, tilt), held);
  s.options.gravity = weight ? rotated({0, -9.81}, tilt) : Vec2{};
  s.until = 0.8;
}

void fill_slope(Draws& draw, ContactScene& s) {
  const double angle = -draw.within(15, 60) * std::numbers::pi / 180, t = draw.of({0.3, 0.5, 1});
  const std::size_t n = draw.count(1, 4), layers = draw.count(1, 3);
  const double gap = draw.of({0, 1e-5, 1e-3, 0.05}), cut = draw.of({0, 0, 0.3, -0.3});
  add(s, turned(rectangle(-20, -1, 40, 1), angle), true);
  add(s, turned({{5, 0}, {6, 0}, {6, 1}, {5 + cut, 1}}, angle), true);
  for (std::size_t l = 0; l < layers; ++l) {
    const double y = static_cast<double>(l) * t;
    double x = 5 + cut * std::min(1.0, y) - (cut < 0 ? 0.4 : 0.0) - gap;
    for (std::size_t k = 0; k < n; ++k) {
      // The toes of the slabs are acute on one side where the joints lean.
      const double c = cut * t;
      add(s, turned({{x - 1.5, y}, {x, y}, {x + (k == 0 ? std::min(c, 0.0) : c), y + t}, {x - 1.5 + c, y + t}}, angle),
          false);
      x -= 1.5 + gap;
    }
  }
  s.until = 0.8;
}

void fill_rubble(Draws& draw, ContactScene& s) {
  const std::size_t across = draw.count(2, 3), up = draw.count(2, 4);
  const double width = 1.3 * static_cast<double>(across);
  add(s, rectangle(-2, -1, width + 4, 1), true);
  add(s, rectangle(-1, 0, 1, 12), true);
  add(s, rectangle(width, 0, 1, 12), true);
  for (std::size_t k = 0; k < across * up; ++k) {
    const Vec2 at{0.65 + 1.3 * static_cast<double>(k % across), 0.65 + 1.3 * static_cast<double>(k / across)};
    add(s, shifted(convex_polygon(draw, draw.within(0.3, 0.64)), at), false);
    s.bodies.back().spin = draw.within(-1, 1);
  }
  s.until = 1;
}

/// The part of a convex ring on the left of the line.
Ring half(const Ring& ring, Vec2 at, Vec2 along, double sign) {
  Ring out;
  const auto side = [&](Vec2 p) { return sign * cross(along, p - at); };
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 p = ring[k], q = ring[k + 1 == ring.size() ? 0 : k + 1];
    const double a = side(p), b = side(q);
    if (a >= 0) out.push_back(p);
    if ((a > 0 && b < 0) || (a < 0 && b > 0)) {
      const bool up = a < b;  // the same point from either half
      const Vec2 from = up ? p : q, to = up ? q : p;
      const double fa = up ? a : b, fb = up ? b : a;
      out.push_back(from + (fa / (fa - fb)) * (to - from));
    }
  }
  return out;
}

double area_of(const Ring& ring) { return ring.size() < 3 ? 0 : dbem::polygon_moments(ring).area; }

/// Smallest extent across any of its edges.
double width_of(const Ring& ring) {
  double least = 1e300;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 d = ring[k + 1 == ring.size() ? 0 : k + 1] - ring[k];
    if (norm(d) < 1e-14) continue;
    double most = 0;
    for (const Vec2 p : ring) most = std::max(most, cross(d, p - ring[k]) / norm(d));
    least = std::min(least, most);
  }
  return least < 1e300 ? least : 0;
}

void fill_cut_wall(Draws& draw, ContactScene& s) {
  std::vector<Ring> parts{rectangle(0, 0, draw.of({2, 4}), draw.of({1, 2, 3}))};
  const std::size_t lines = draw.count(2, 6);
  for (std::size_t k = 0; k < lines; ++k) {
    const Vec2 at{draw.within(0, 3), draw.within(0, 2)};
    const double angle = draw.within(0, std::numbers::pi);
    std::vector<Ring> next;
    for (const Ring& ring : parts) {
      const Ring a = half(ring, at, {std::cos(angle), std::sin(angle)}, 1);
      const Ring b = half(ring, at, {std::cos(angle), std::sin(angle)}, -1);
      const bool cut = area_of(a) > 0.02 && area_of(b) > 0.02 && width_of(a) > 0.1 && width_of(b) > 0.1;
      if (cut) next.insert(next.end(), {a, b});
      if (!cut) next.push_back(ring);
    }
    parts = std::move(next);
  }
  add(s, rectangle(-10, -1, 24, 1), true);
  for (const Ring& ring : parts) add(s, ring, false);
  s.options.gravity = {9.81 * draw.of({0, 0.2, 0.5, -0.7}), -9.81};
  s.until = 0.6;
}

void fill_gas(Draws& draw, ContactScene& s) {
  const std::size_t across = draw.count(2, 4);
  const double width = 1.4 * static_cast<double>(across);
  add(s, rectangle(-1, -1, width + 2, 1), true);
  add(s, rectangle(-1, width, width + 2, 1), true);
  add(s, rectangle(-1, 0, 1, width), true);
  add(s, rectangle(width, 0, 1, width), true);
  for (std::size_t k = 0; k < across * across; ++k) {
    const Vec2 at{0.7 + 1.4 * static_cast<double>(k % across), 0.7 + 1.4 * static_cast<double>(k / across)};
    add(s, shifted(convex_polygon(draw, draw.within(0.25, 0.6)), at), false, {},
        {draw.within(-2, 2), draw.within(-2, 2)});
  }
  s.options.gravity = {};
  s.laws.otherwise = {.friction = 0, .restitution = 1};
  s.closed = true;
  s.until = 2;
}

void fill_lattice(Draws& draw, ContactScene& s) {
  // Shapes made of unit cells; the parts are rectangles.
  struct Piece {
    Ring ring;
    std::vector<Ring> parts;
    double width;
  };
  const std::vector<Piece> pieces{
      {rectangle(0, 0, 1, 1), {}, 1},
      {rectangle(0, 0, 2, 1), {}, 2},
      {{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, {rectangle(0, 0, 2, 1), rectangle(0, 1, 1, 1)}, 2},
      {{{0, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},
       {rectangle(0, 0, 3, 1), rectangle(0, 1, 1, 1), rectangle(2, 1, 1, 1)},
       3},
      {{{1, 0}, {2, 0}, {2, 1}, {3, 1}, {3, 2}, {0, 2}, {0, 1}, {1, 1}},
       {rectangle(1, 0, 1, 1), rectangle(0, 1, 3, 1)},
       3},
      {{{0, 0}, {2, 0}, {1, 1}}, {}, 2},
      {{{0, 0}, {1, 0}, {2, 1}, {1, 1}}, {}, 2},
  };
  const std::size_t rows = draw.count(2, 4);
  const double gap = draw.of({0, 1e-5, 1e-2}), lift = draw.of({0, 1e-3, 0.1});
  add(s, rectangle(-10, -1, 28, 1), true);
  double y = lift;
  for (std::size_t r = 0; r < rows; ++r) {
    double x = static_cast<double>(draw.count(0, 1));
    for (std::size_t k = draw.count(1, 3); k > 0; --k) {
      const Piece& piece = pieces[draw.count(0, pieces.size() - 1)];
      std::vector<Ring> parts;
      for (const Ring& part : piece.parts) parts.push_back(shifted(part, {x, y}));
      add(s, shifted(piece.ring, {x, y}), false, std::move(parts), {draw.of({0, 0, 1, -1}), 0});
      x += piece.width + gap;
    }
    y += 2 + lift;
  }
  s.until = 0.8;
}

void fill_stacks(Draws& draw, ContactScene& s) {
  const std::size_t across = draw.count(2, 6), up = draw.count(2, 25);
  const double gap = draw.of({0, 0, 1e-9, 1e-6, 1e-3}), h = draw.of({1, 0.5, 0.25}), lift = draw.of({0, 0, 1e-5});
  const bool uneven = draw.one_in(2);
  add(s, rectangle(-10, -1, 30, 1), true);
  for (std::size_t k = 0; k < across; ++k) {
    const std::size_t high = uneven ? draw.count(1, up) : up;
    for (std::size_t r = 0; r < high; ++r) {
      add(s, rectangle(static_cast<double>(k) * (1 + gap), static_cast<double>(r) * (h + lift) + lift, 1, h), false);
    }
  }
  s.options.gravity = {9.81 * draw.of({0, 0, 0.05, 0.2}), -9.81};
  s.until = 0.5;
}

void fill_ratio(Draws& draw, ContactScene& s) {
  const std::size_t n = draw.count(2, 8);
  const double heavy = std::pow(10, draw.within(0, 9)), gap = draw.of({0, 0, 1e-3});
  const bool lintel = draw.one_in(2);
  add(s, rectangle(-10, -1, 20, 1), true);
  double y = gap;
  for (std::size_t k = 0; k < n; ++k) {
    if (lintel) {
      add(s, rectangle(0, y, 0.5, 0.5), false);
      add(s, rectangle(1.5, y, 0.5, 0.5), false);
      y += 0.5 + gap;
    }
    add(s, rectangle(0, y, 2, 1), false);
    s.bodies.back().density = draw.one_in(2) ? 2600 * heavy : 2600;
    y += 1 + gap;
  }
  // The last digits of the heavy ones' forces move the light ones, by at most a thousandth of a step's fall.
  s.gain = 1e-5;
  s.until = 0.4;
}

/// A block whose lowest corner is at `tip`.
Ring on_its_tip(Draws& draw, Vec2 tip, double size) {
  const double wide = size * draw.of({1, 1, 0.2, 0.6});
  switch (draw.count(0, 2)) {
    case 0: return {tip, tip + Vec2{wide, size}, tip + Vec2{-wide, size}};
    case 1: return {tip, tip + Vec2{wide, size}, tip + Vec2{0, 2 * size}, tip + Vec2{-wide, size}};
    default: return {tip, tip + Vec2{wide, size}, tip + Vec2{0, 1.5 * size}, tip + Vec2{-wide, size}};
  }
}

void fill_towers_of_tips(Draws& draw, ContactScene& s) {
  const double roof = draw.of({0.5, 0.25, 0.1, 1}), gap = draw.of({0, 0, 0, 1e-9, 1e-6, 1e-3});
  add(s, {{-0.5, 0}, {0.5, 0}, {0.5, 1}, {0, 1 + roof}, {-0.5, 1}}, draw.one_in(2));
  double y = 1 + roof + gap;
  for (std::size_t k = draw.count(1, 3); k > 0; --k) {
    Ring ring = on_its_tip(draw, {draw.of({0, 0, 0, 1e-10, -1e-9, 1e-7}), y}, draw.of({0.5, 0.5, 1, 0.2}));
    const bool last = ring.size() == 3;
    y = ring[last ? 1 : 2].y + gap;
    add(s, std::move(ring), false);
    if (last) break;
  }
}

void fill_diagonals(Draws& draw, ContactScene& s) {
  const std::size_t across = draw.count(2, 5), up = draw.count(2, 4);
  const double pitch = 1 + draw.of({0, 0, 1e-9, 1e-6}), angle = draw.of({0, 0, 0.3, 1});
  const bool all = draw.one_in(3), held = draw.one_in(2);
  const Vec2 corner{5 * std::sin(angle), 0};
  for (std::size_t i = 0; i < across; ++i) {
    for (std::size_t r = 0; r < up; ++r) {
      if ((i + r) % 2 != 0 && !all) continue;
      const Ring ring = rectangle(static_cast<double>(i) * pitch, static_cast<double>(r) * pitch, 1, 1);
      add(s, shifted(turned(ring, angle), corner), held && i == 0 && r == 0);
    }
  }
}

void fill_diamonds(Draws& draw, ContactScene& s) {
  const std::size_t across = draw.count(2, 4), rows = draw.count(1, 4);
  const double gap = draw.of({0, 0, 1e-9, 1e-5});
  for (std::size_t k = 0; k <= across; ++k) {
    const double x = 2 * static_cast<double>(k);
    add(s, {{x - 1, 0}, {x + 1, 0}, {x, 1}}, draw.one_in(2));
  }
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t k = 0; k < across + r % 2; ++k) {
      const double x = 2 * static_cast<double>(k) + (r % 2 == 0 ? 1 : 0), y = static_cast<double>(r) * (1 + gap) + gap;
      add(s, {{x, y}, {x + 1, y + 1}, {x, y + 2}, {x - 1, y + 1}}, false);
    }
  }
}

void fill_tips(Draws& draw, ContactScene& s) {
  add(s, rectangle(-20, -1, 40, 1), true);
  switch (draw.count(0, 2)) {
    case 0: fill_towers_of_tips(draw, s); break;
    case 1: fill_diagonals(draw, s); break;
    default: fill_diamonds(draw, s); break;
  }
  s.options.gravity = {9.81 * draw.of({0, 0, 0, 0.2}), -9.81};
  s.options.step = draw.of({1e-4, 1e-3, 5e-3, 1e-2});
  s.until = s.options.step < 1e-3 ? 0.2 : 0.6;
}

}  // namespace

ContactScene make_contact_scene(ContactFamily family, std::uint64_t seed) {
  Draws draw{seed * 16 + static_cast<std::uint64_t>(family)};
  ContactScene scene;
  scene.laws.otherwise.friction = draw.of({0, 0.2, 0.5, 1});
  scene.options.step = draw.of({1e-3, 5e-3, 1e-2});
  switch (family) {
    case ContactFamily::dropped: fill_dropped(draw, scene); break;
    case ContactFamily::column: fill_column(draw, scene); break;
    case ContactFamily::row: fill_row(draw, scene); break;
    case ContactFamily::head_on: fill_head_on(draw, scene); break;
    case ContactFamily::toe: fill_toe(draw, scene); break;
    case ContactFamily::slope: fill_slope(draw, scene); break;
    case ContactFamily::rubble: fill_rubble(draw, scene); break;
    case ContactFamily::cut_wall: fill_cut_wall(draw, scene); break;
    case ContactFamily::gas: fill_gas(draw, scene); break;
    case ContactFamily::lattice: fill_lattice(draw, scene); break;
    case ContactFamily::stacks: fill_stacks(draw, scene); break;
    case ContactFamily::ratio: fill_ratio(draw, scene); break;
    case ContactFamily::tips: fill_tips(draw, scene); break;
  }
  return scene;
}

ContactScene turned_by_a_quarter(ContactScene scene) {
  const auto turn = [](Vec2& p) { p = {-p.y, p.x}; };
  for (Body& body : scene.bodies) {
    std::ranges::for_each(body.outline, turn);
    turn(body.velocity);
  }
  for (auto& parts : scene.parts) {
    for (Ring& part : parts) std::ranges::for_each(part, turn);
  }
  turn(scene.options.gravity);
  return scene;
}

ContactScene mirrored(ContactScene scene) {
  const auto mirror = [](Ring& ring) {
    for (Vec2& p : ring) p.x = -p.x;
    std::ranges::reverse(ring);
  };
  for (Body& body : scene.bodies) {
    mirror(body.outline);
    body.velocity.x = -body.velocity.x;
    body.spin = -body.spin;
  }
  for (auto& parts : scene.parts) std::ranges::for_each(parts, mirror);
  scene.options.gravity.x = -scene.options.gravity.x;
  return scene;
}

ContactScene reversed_order(ContactScene scene) {
  std::ranges::reverse(scene.bodies);
  std::ranges::reverse(scene.parts);
  return scene;
}

double widest_common_part(const std::vector<Ring>& a, const std::vector<Ring>& b) {
  double worst = 0;
  for (const Ring& p : a) {
    for (const Ring& q : b) {
      Ring common = p;
      for (std::size_t k = 0; k < q.size() && common.size() > 2; ++k) {
        common = half(common, q[k], q[k + 1 == q.size() ? 0 : k + 1] - q[k], 1);
      }
      if (common.size() > 2) worst = std::max(worst, width_of(common));
    }
  }
  return worst;
}

double deepest_overlap(const ContactScene& scene, const dbem::World& world) {
  std::vector<std::vector<Ring>> now;
  struct Bounds {
    Vec2 low{1e300, 1e300}, high{-1e300, -1e300};
  };
  std::vector<Bounds> bounds(world.size());
  for (std::size_t b = 0; b < world.size(); ++b) {
    now.push_back(scene.parts[b]);
    for (Ring& part : now.back()) {
      for (Vec2& p : part) {
        p = world.position(b, p);
        bounds[b].low = {std::min(bounds[b].low.x, p.x), std::min(bounds[b].low.y, p.y)};
        bounds[b].high = {std::max(bounds[b].high.x, p.x), std::max(bounds[b].high.y, p.y)};
      }
    }
  }
  double worst = 0;
  for (std::size_t a = 0; a < now.size(); ++a) {
    for (std::size_t b = a + 1; b < now.size(); ++b) {
      if (scene.bodies[a].held.all() && scene.bodies[b].held.all()) continue;
      if (bounds[a].high.x <= bounds[b].low.x || bounds[b].high.x <= bounds[a].low.x ||
          bounds[a].high.y <= bounds[b].low.y || bounds[b].high.y <= bounds[a].low.y) {
        continue;
      }
      const double size = std::sqrt(std::min(dbem::polygon_moments(scene.bodies[a].outline).area,
                                             dbem::polygon_moments(scene.bodies[b].outline).area));
      worst = std::max(worst, widest_common_part(now[a], now[b]) / size);
    }
  }
  return worst;
}

ContactOutcome run_contact_scene(const ContactScene& scene, std::size_t most) {
  ContactOutcome out;
  auto world = dbem::World::make(scene.bodies, scene.laws, scene.options);
  if (!world) {
    out.why = describe(world.error());
    return out;
  }
  out.made = true;
  const double start = world->energy().kinetic;
  double scale = std::abs(start), before = world->energy().total(), momentum_scale = 0;
  for (std::size_t b = 0; b < world->size(); ++b) {
    if (scene.bodies[b].held.all()) continue;
    scale += world->mass(b) * norm(scene.options.gravity);  // falling a metre
    momentum_scale += world->mass(b) * norm(scene.bodies[b].velocity);
  }
  const bool isolated = norm(scene.options.gravity) == 0 &&
                        std::ranges::none_of(scene.bodies, [](const Body& b) { return b.held.all(); });
  const Vec2 momentum = world->momentum();
  while (world->time() < scene.until * (1 - 1e-12) && out.steps < most) {
    const auto report = world->step(scene.until - world->time());
    if (!report) {
      out.stopped = true;
      out.why = describe(report.error());
      break;
    }
    ++out.steps;
    out.reported = std::max(out.reported, report->max_penetration);
    out.overlap = std::max(out.overlap, deepest_overlap(scene, *world));
    const double total = world->energy().total();
    if (!scene.options.quasi_static) out.energy_gain = std::max(out.energy_gain, (total - before) / scale);
    before = total;
    if (isolated) out.momentum = std::max(out.momentum, norm(world->momentum() - momentum) / momentum_scale);
  }
  out.time = world->time();
  out.energy_left = start > 0 ? world->energy().kinetic / start : 1;
  for (std::size_t b = 0; b < world->size(); ++b) out.places.push_back(world->centroid(b));
  return out;
}

}  // namespace cleave::testing
