/// Small random stacks, falling clusters and free clouds of blocks in three dimensions, convex or not, some tied to one
/// another, some under loads or in water, as they are and turned by a quarter, mirrored or listed backwards: every
/// accepted step meets the law and shares no space, no run gains energy without restitution, momentum and energy close,
/// no tie bears more than its capacity or comes back, and the first steps do not depend on how it is written.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <utility>
#include <vector>

#include "byte_source.hpp"
#include "cleave/motion/world.hpp"
#include "fuzz_target.hpp"
#include "shapes.hpp"

namespace {

using namespace cleave::motion;

struct Setting {
  std::vector<BodySpec> bodies;
  std::vector<Tie> ties = {};
  std::vector<Load> loads = {};
  std::optional<StillWater> water = {};
  double friction = 0;
  Vec3 gravity;
};

void require(bool good, const char* what, double value) {
  if (good) return;
  std::fprintf(stderr, "%s: %g\n", what, value);
  std::abort();
}

double count_of(cleave::support::ByteSource& bytes, std::size_t last) { return static_cast<double>(bytes.up_to(last)); }

Polyhedron random_shape(cleave::support::ByteSource& bytes) {
  const double a = 0.4 + 0.1 * count_of(bytes, 8), b = 0.4 + 0.1 * count_of(bytes, 8),
               c = 0.3 + 0.1 * count_of(bytes, 5);
  switch (bytes.up_to(3)) {
    case 0: return shapes::icosahedron(0.5 * a);
    case 1: return shapes::prism(shapes::regular(3 + static_cast<unsigned>(bytes.up_to(4)), 0.7 * a), -c / 2, c / 2);
    case 2: {
      const double x = 0.5 * a, y = 0.5 * b;
      return shapes::moved(shapes::prism({{0, 0}, {2 * x, 0}, {2 * x, y}, {x, y}, {x, 2 * y}, {0, 2 * y}}, 0, c),
                           {-0.5 * a, -0.5 * b, -c / 2});
    }
    default: return shapes::block(a, b, c);
  }
}

double unit(cleave::support::ByteSource& bytes) { return (count_of(bytes, 254) - 127) / 127; }

Vec3 near_middle(cleave::support::ByteSource& bytes, const BodySpec& body) {
  Vec3 middle;
  const std::vector<Vec3>& all = body.shape.vertices;
  for (const Vec3 v : all) middle += v / static_cast<double>(all.size());
  return middle + 0.2 * Vec3{unit(bytes), unit(bytes), unit(bytes)};
}

/// Ties from points near the middle of bodies, some of them weak and some without ductility.
void add_ties(cleave::support::ByteSource& bytes, Setting& out) {
  const std::size_t count = bytes.up_to(6) < 4 || out.bodies.size() < 2 ? 0 : 1 + bytes.up_to(3);
  for (std::size_t k = 0; k < count; ++k) {
    const auto body = static_cast<std::uint32_t>(bytes.up_to(out.bodies.size() - 1));
    const auto other = static_cast<std::uint32_t>(bytes.up_to(out.bodies.size() - 1));
    if (body == other) continue;
    const auto end = [&](std::uint32_t b) { return near_middle(bytes, out.bodies[b]); };
    const Tie tie{.body = body,
                  .other = other,
                  .end = end(body),
                  .other_end = end(other),
                  .capacity = cleave::newtons(std::pow(10, 2 * unit(bytes))),
                  .ductility = cleave::metres(0.05 * count_of(bytes, 3))};
    if (norm(tie.end - tie.other_end) > 0.1) out.ties.push_back(tie);
  }
}

/// Forces on bodies and between two, some of which end, and water about all of them.
void add_loads(cleave::support::ByteSource& bytes, Setting& out) {
  const std::size_t count = bytes.up_to(6) < 4 ? 0 : 1 + bytes.up_to(3);
  for (std::size_t k = 0; k < count; ++k) {
    Load load{.body = static_cast<std::uint32_t>(bytes.up_to(out.bodies.size() - 1))};
    const auto other = static_cast<std::uint32_t>(bytes.up_to(out.bodies.size()));
    if (other == load.body) continue;
    if (other < out.bodies.size()) load.other = other;
    load.at = near_middle(bytes, out.bodies[load.body]);
    load.force = std::pow(10, unit(bytes)) * Vec3{unit(bytes), unit(bytes), unit(bytes)};
    if (bytes.up_to(1) == 1) load.opens = load.slides = cleave::metres(0.01 + 0.02 * count_of(bytes, 5));
    if (norm(load.force) > 0) out.loads.push_back(load);
  }
  if (bytes.up_to(6) < 5) return;
  out.water = {.level = cleave::metres(2 * unit(bytes)),
               .unit_weight = cleave::newtons_per_cubic_metre(9.81 * std::pow(10, unit(bytes)))};
}

Setting random_setting(cleave::support::ByteSource& bytes) {
  enum class Kind : std::uint8_t { stack, falling, cloud };
  const auto kind = static_cast<Kind>(bytes.up_to(2));
  Setting out{.bodies = {}, .friction = 0.1 * count_of(bytes, 12), .gravity = {0, 0, -9.81}};
  const std::size_t count = 1 + bytes.up_to(5);
  double top = 0;
  for (std::size_t k = 0; k < count; ++k) {
    if (kind == Kind::stack) {
      const double h = 0.2 + 0.1 * count_of(bytes, 6), x = 0.2 * unit(bytes), y = 0.2 * unit(bytes);
      out.bodies.push_back({.shape = shapes::box({x - 0.5, y - 0.4, top}, {x + 0.5, y + 0.4, top + h})});
      top += h;
      continue;
    }
    const Turn turn = turn_by({unit(bytes), unit(bytes), unit(bytes)});
    const Vec3 at = kind == Kind::cloud
                        ? Vec3{1.9 * static_cast<double>(k % 2), 1.9 * static_cast<double>(k / 2 % 2),
                               1.9 * static_cast<double>(k / 4)}
                        : Vec3{0.3 * unit(bytes), 0.3 * unit(bytes), 1.1 + 1.9 * static_cast<double>(k)};
    BodySpec body{.shape = shapes::moved(random_shape(bytes), at, turn)};
    body.density = cleave::kilograms_per_cubic_metre(std::pow(10, unit(bytes)));
    body.velocity = kind == Kind::cloud ? 3.0 * (Vec3{0.9, 0.9, 0.9} - at) : Vec3{0, 0, -4};
    body.spin = {unit(bytes), unit(bytes), unit(bytes)};
    out.bodies.push_back(std::move(body));
  }
  if (kind == Kind::cloud) {
    out.gravity = {};
  } else {
    out.bodies.push_back({.shape = shapes::box({-6, -6, -1}, {6, 6, 0}), .fixed = true});
  }
  add_ties(bytes, out);
  add_loads(bytes, out);
  return out;
}

/// Every direction by a map of the axes; spins turn the other way in a mirror.
template <class Map>
Setting mapped(Setting in, const Map& map, bool mirror) {
  for (BodySpec& body : in.bodies) {
    for (Vec3& v : body.shape.vertices) v = map(v);
    body.velocity = map(body.velocity);
    body.spin = mirror ? -map(body.spin) : map(body.spin);
    if (!mirror) continue;
    for (Facet& facet : body.shape.facets) {
      for (auto& loop : facet.loops) std::ranges::reverse(loop);
    }
  }
  in.gravity = map(in.gravity);
  for (Tie& tie : in.ties) {
    tie.end = map(tie.end);
    tie.other_end = map(tie.other_end);
  }
  for (Load& load : in.loads) {
    load.at = map(load.at);
    load.force = map(load.force);
  }
  if (in.water) in.water->up = map(in.water->up);
  return in;
}

void look_at_ties(const World& world, const std::vector<Tie>& ties, std::vector<TieState>& before) {
  for (std::size_t k = 0; k < ties.size(); ++k) {
    const TieState now = world.tie(k);
    const double length = norm(ties[k].end - ties[k].other_end);
    const double apart =
        norm(world.position(ties[k].body, ties[k].end) - world.position(ties[k].other, ties[k].other_end));
    require(now.force.si() <= ties[k].capacity.si() * (1 + 1e-6), "a tie bears too much", now.force.si());
    require(now.lengthened >= before[k].lengthened && now.broken >= before[k].broken, "a tie comes back", 0);
    require(now.broken || now.lengthened <= ties[k].ductility, "a tie is too long", now.lengthened.si());
    require(now.broken || apart - length - now.lengthened.si() < 1e-4 * length, "a tie is drawn",
            apart - length - now.lengthened.si());
    before[k] = now;
  }
}

struct Outcome {
  bool made = false, one_answer = true;
  double early = 0;  ///< kinetic energy after the first steps
  double scale = 0;
};

Outcome run(const Setting& setting, int steps, int early) {
  Outcome out;
  WorldOptions options{.gravity = setting.gravity, .step = 0.01};
  options.solver.accept = 1e-6;
  options.solver.patience = 1000;
  auto made = World::make({.bodies = setting.bodies,
                           .surfaces = {{setting.friction, 0}},
                           .ties = setting.ties,
                           .loads = setting.loads,
                           .water = setting.water},
                          options);
  if (!made) return out;
  out.made = true;
  double weight = 0;
  for (std::size_t b = 0; b < made->size(); ++b) weight += made->fixed(b) ? 0 : made->mass(b);
  out.scale = std::abs(made->energy().start) + weight * 9.81;
  for (const Load& load : setting.loads) out.scale += norm(load.force);
  std::vector<TieState> before(setting.ties.size());
  for (int k = 0; k < steps; ++k) {
    const auto report = made->step();
    if (!report) break;  // said, and the world is as it was
    require(report->residual <= options.solver.accept, "a step misses the law", report->residual);
    require(report->overlap <= options.overlap, "bodies share space", report->overlap);
    look_at_ties(*made, setting.ties, before);
    out.one_answer = out.one_answer && (k >= early || report->may_be_locked == 0);
    if (k + 1 == early) out.early = made->energy().kinetic;
  }
  require(made->energy().largest_gain <= 1e-5 * out.scale, "energy grows", made->energy().largest_gain / out.scale);
  require(made->energy().closing_error <= 1e-9, "energy does not close", made->energy().closing_error);
  require(made->momentum_error() <= 1e-9, "momentum does not close", made->momentum_error());
  return out;
}

}  // namespace

CLEAVE_FUZZ_TARGET(input) {
  cleave::support::ByteSource bytes{input};
  const auto how = bytes.up_to(3);
  const Setting setting = random_setting(bytes);
  constexpr int early = 4;
  const Outcome plain = run(setting, 60, early);
  Setting other = setting;
  if (how == 1) other = mapped(setting, [](Vec3 v) { return Vec3{-v.y, v.x, v.z}; }, false);
  if (how == 2) other = mapped(setting, [](Vec3 v) { return Vec3{-v.x, v.y, v.z}; }, true);
  if (how == 3) {
    std::ranges::reverse(other.bodies);
    std::ranges::reverse(other.ties);
    const auto last = static_cast<std::uint32_t>(other.bodies.size() - 1);
    for (Tie& tie : other.ties) {
      tie.body = last - tie.body;
      tie.other = last - tie.other;
    }
    std::ranges::reverse(other.loads);
    for (Load& load : other.loads) {
      load.body = last - load.body;
      if (load.other) load.other = last - *load.other;
    }
  }
  if (how == 0) return;
  const Outcome again = run(other, early, early);
  require(plain.made == again.made, "one way of writing it is refused", 0);
  if (!plain.made || !plain.one_answer || !again.one_answer) return;
  require(std::abs(plain.early - again.early) <= 1e-4 * plain.scale, "it depends on how it is written",
          (plain.early - again.early) / plain.scale);
}
