#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "cleave/scene/bodies.hpp"
#include "context.hpp"
#include "parse_elastic.hpp"
#include "plane_input.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;
using std::string_view;

constexpr double radians = std::numbers::pi / 180;

std::optional<bem::Sym2> stress_of(const TableReader& table, string_view key) {
  const auto v = table.vec3(key, value_rule);
  if (!v) return std::nullopt;
  return bem::Sym2{v->x, v->z, v->y};  // written xx, yy, xy
}

std::optional<bem::Loop> circle_of(const TableReader& table, bool clockwise) {
  const auto centre = pair(table, "centre", rule::coordinate);
  if (!table.has("centre")) table.missing("centre", "write centre = [x, y]");
  const auto radius = table.need_number("radius", rule::length);
  if (!centre || !radius) return std::nullopt;
  return bem::circle(*centre, *radius, clockwise);
}

/// Loops as the user wrote them; sides are numbered through all of them.
struct Outline {
  std::vector<bem::Loop> loops;
  std::vector<std::size_t> first;  ///< number of each loop's first side
  std::size_t sides = 0;

  void add(bem::Loop loop) {
    first.push_back(sides);
    for (bem::Side& side : loop) side.condition = sides++;
    loops.push_back(std::move(loop));
  }
};

void parse_outline(const TableReader& body, Outline& outline, bool infinite) {
  constexpr std::array<string_view, 2> circle_keys{"centre", "radius"};
  constexpr std::array<string_view, 3> arc_keys{"side", "through", "hole"};
  if (infinite) {
    if (body.has("outline") || body.has("circle")) {
      body.error(body.has("outline") ? "outline" : "circle", "an infinite body has no outline",
                 "describe its openings by holes and round_holes");
    }
  } else if (const TomlEntry* entry = body.find("outline")) {
    if (auto corners = corners_of(body, entry->node, body.path_of("outline"))) outline.add(bem::polygon(*corners));
  } else if (const TomlTable* table = body.table("circle")) {
    const TableReader circle{*table, body.line_of("circle"), body.path_of("circle"), body.problems(), circle_keys};
    if (auto loop = circle_of(circle, false)) outline.add(std::move(*loop));
  } else if (!body.has("circle")) {
    body.missing("outline", "write outline = [[x, y], [x, y], [x, y], ...], anticlockwise, or circle = {...}");
  }
  if (const TomlEntry* holes = body.find("holes")) {
    if (const auto* array = std::get_if<TomlArray>(&holes->node.value)) {
      for (std::size_t i = 0; i < array->items.size(); ++i) {
        const std::string path = fmt::format("{}[{}]", body.path_of("holes"), i + 1);
        if (auto corners = corners_of(body, array->items[i], path)) outline.add(bem::polygon(*corners));
      }
    } else {
      body.error("holes", "must be a list of outlines", "write holes = [[[x, y], [x, y], [x, y]], ...]");
    }
  }
  const auto rounds = body.tables("round_holes");
  for (std::size_t i = 0; i < rounds.size(); ++i) {
    const auto round =
        reader(*rounds[i], fmt::format("{}[{}]", body.path_of("round_holes"), i + 1), body.problems(), circle_keys);
    if (auto loop = circle_of(round, true)) outline.add(std::move(*loop));
  }
  const auto arcs = body.tables("arcs");
  for (std::size_t i = 0; i < arcs.size(); ++i) {
    const auto arc = reader(*arcs[i], fmt::format("{}[{}]", body.path_of("arcs"), i + 1), body.problems(), arc_keys);
    const auto hole = arc.integer("hole", 1, 1000).value_or(0);
    const std::size_t loop = static_cast<std::size_t>(hole) - (infinite && hole > 0 ? 1U : 0U);
    const auto side = arc.integer("side", 1, 100000);
    const auto through = pair(arc, "through", rule::coordinate);
    if (!arc.has("side")) arc.missing("side", "name the side, counted from 1");
    if (!arc.has("through")) arc.missing("through", "write a point of the arc: through = [x, y]");
    if (!side || !through) continue;
    if (loop >= outline.loops.size() || static_cast<std::size_t>(*side) > outline.loops[loop].size()) {
      arc.error("side", "there is no such side", "sides count from 1, in the order of the corners");
      continue;
    }
    outline.loops[loop][static_cast<std::size_t>(*side) - 1].through = through;
  }
}

/// The sides an entry of support or load means.
std::vector<std::size_t> sides_of(const TableReader& table, const Outline& outline, bool infinite) {
  std::vector<std::size_t> out;
  const auto hole = table.integer("hole", 1, 1000);
  const std::size_t loop = hole ? static_cast<std::size_t>(*hole) - (infinite ? 1U : 0U) : 0;
  if (loop >= outline.loops.size()) {
    if (!outline.loops.empty())
      table.error("hole", "there is no such hole", "holes count from 1, round ones after the others");
    return out;
  }
  const std::size_t count = outline.loops[loop].size();
  const auto push = [&](std::int64_t side, string_view key) {
    if (side < 1 || static_cast<std::size_t>(side) > count) {
      table.error(key, fmt::format("there is no side {}", side),
                  fmt::format("sides count from 1 to {}, in the order of the corners", count));
      return;
    }
    out.push_back(outline.first[loop] + static_cast<std::size_t>(side) - 1);
  };
  if (const auto side = table.integer("side", 1, 100000)) push(*side, "side");
  if (const TomlEntry* sides = table.find("sides")) {
    const auto* array = std::get_if<TomlArray>(&sides->node.value);
    const auto* word = std::get_if<std::string>(&sides->node.value);
    if (array != nullptr) {
      for (const TomlNode& node : array->items) {
        if (const auto* n = std::get_if<std::int64_t>(&node.value)) {
          push(*n, "sides");
        } else {
          table.error("sides", "must be a list of numbers", "write sides = [1, 2]");
        }
      }
    } else if (word != nullptr && *word == "all") {
      for (std::size_t k = 0; k < count; ++k) out.push_back(outline.first[loop] + k);
    } else {
      table.error("sides", "must be a list of numbers, or \"all\"", "write sides = [1, 2]");
    }
  } else if (hole && !table.has("side")) {
    for (std::size_t k = 0; k < count; ++k) out.push_back(outline.first[loop] + k);
  }
  return out;
}

void parse_supports(const TableReader& body, const Outline& outline, BodySpec& spec, bool moving) {
  constexpr std::array<string_view, 9> keys{"side", "sides", "hole", "at", "kind", "normal", "along", "value", "angle"};
  constexpr std::array<string_view, 7> kinds{"fixed", "roller", "symmetry", "spring", "displacement", "bonded", "pin"};
  constexpr NumberRule stiffness{0, false, 1e18, false, " Pa/m"};
  const auto found = body.tables("support");
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto table = reader(*found[i], fmt::format("{}[{}]", body.path_of("support"), i + 1), body.problems(), keys);
    const auto kind = table.choice("kind", kinds);
    if (!table.has("kind")) table.missing("kind", "write one of: fixed roller symmetry spring displacement bonded pin");
    if (!kind) continue;
    if (*kind == 6) {
      const auto at = pair(table, "at", rule::coordinate);
      if (!table.has("at")) table.missing("at", "write where: at = [x, y]");
      if (at) spec.pins.push_back(*at);
      if (!moving)
        table.error("kind", "a pin holds a moving body; without [elastic.time] nothing moves",
                    "use fixed, or add [elastic.time]");
      continue;
    }
    const auto sides = sides_of(table, outline, spec.extent != bem::Extent::bounded);
    if (sides.empty() && !table.has("side") && !table.has("sides") && !table.has("hole")) {
      table.missing("side", "name a side, counted from 1 in the order of the corners");
    }
    bem::Condition condition;
    switch (*kind) {
      case 0: condition = bem::clamped(); break;
      case 1:
      case 2: condition = bem::roller(); break;
      case 3:
        condition =
            bem::springs(table.number("normal", stiffness).value_or(0), table.number("along", stiffness).value_or(0));
        break;
      case 4: {
        const Vec2 v = pair(table, "value", value_rule).value_or(Vec2{});
        if (moving && !(v == Vec2{}))
          table.error("value", "moving supports are not part of moving scenes", "write kind = \"fixed\"");
        condition = bem::displacement([v](Vec2) { return v; });
        break;
      }
      default:
        condition = bem::bonded();
        spec.bonded = true;
        if (moving)
          table.error("kind", "bonded bodies are solved in static scenes only",
                      "remove [elastic.time], or make one body of them");
        break;
    }
    if (const auto angle = table.number("angle", rule::turn)) {
      if (*kind == 1) {
        // The direction in which the side cannot move.
        condition.axes = bem::Axes::fixed;
        condition.turn = *angle * radians;
      } else {
        table.error("angle", "has a meaning for rollers only", "remove it");
      }
    }
    for (const std::size_t side : sides) spec.region.conditions[side] = condition;
    spec.held = spec.held || !sides.empty();
  }
}

void parse_loads(const TableReader& body, const Outline& outline, BodySpec& spec, bool moving) {
  constexpr std::array<string_view, 8> keys{"side", "sides", "hole", "at", "pressure", "traction", "force", "time"};
  constexpr std::array<string_view, 3> kinds{"pressure", "traction", "force"};
  const auto found = body.tables("load");
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto table = reader(*found[i], fmt::format("{}[{}]", body.path_of("load"), i + 1), body.problems(), keys);
    const TomlEntry* kind = table.one_of(kinds);
    if (kind == nullptr) continue;
    BodyLoadSpec load;
    load.timed = table.has("time");
    if (load.timed && !moving)
      table.error("time", "loads change with time in moving scenes only", "add [elastic.time], or remove it");
    load.time = parse_time_function(table, load.follows);
    if (kind->key == "force") {
      const auto at = pair(table, "at", rule::coordinate);
      if (!table.has("at")) table.missing("at", "write where the force acts: at = [x, y]");
      load.at = at.value_or(Vec2{});
      load.force = pair(table, "force", value_rule).value_or(Vec2{});
    } else {
      load.sides = sides_of(table, outline, spec.extent != bem::Extent::bounded);
      if (load.sides.empty() && !table.has("side") && !table.has("sides") && !table.has("hole")) {
        table.missing("side", "name a side, counted from 1 in the order of the corners");
      }
      if (kind->key == "pressure") {
        load.pressure = table.number("pressure", value_rule).value_or(0);
      } else {
        load.traction = pair(table, "traction", value_rule).value_or(Vec2{});
      }
    }
    spec.loads.push_back(std::move(load));
  }
}

/// Static loads become part of the sides' conditions, in whatever directions these leave to tractions.
void put_loads(BodySpec& spec) {
  for (const BodyLoadSpec& load : spec.loads) {
    for (const std::size_t side : load.sides) {
      bem::Condition& c = spec.region.conditions[side];
      const auto axes = [axes = c.axes, turn = c.turn](Vec2 n) {
        return axes == bem::Axes::normal ? std::array{bem::rotated(n, turn), bem::rotated(bem::turned_left(n), turn)}
                                         : std::array{bem::rotated({1, 0}, turn), bem::rotated({0, 1}, turn)};
      };
      for (std::size_t k = 0; k < 2; ++k) {
        if (c.component[k].given == bem::Given::displacement) continue;
        c.component[k].value = [before = c.component[k].value, axes, k, p = load.pressure, t = load.traction](Vec2 x,
                                                                                                              Vec2 n) {
          return (before ? before(x, n) : 0.0) + dot(t - p * n, axes(n)[k]);
        };
      }
    }
  }
}

void parse_body(const TableReader& body, const RockDefaults& defaults, bem::PlaneState plane, bool moving,
                std::vector<BodySpec>& bodies) {
  constexpr std::array<string_view, 3> extents{"bounded", "plane", "half_plane"};
  const std::string fallback = fmt::format("body {}", bodies.size() + 1);
  const std::string name = body.text("name").value_or(fallback);
  const auto own_young = body.number("young", young_rule);
  const auto own_poisson = body.number("poisson", poisson_rule);
  const auto own_density = body.number("density", body_density_rule);
  const auto young = own_young ? own_young : defaults.young;
  const auto poisson = own_poisson ? own_poisson : defaults.poisson;
  const double density = own_density.value_or(defaults.density);
  if (!young && !body.has("young") && !defaults.young_given)
    body.missing("young", "give Young's modulus in Pa here or in [rock], say 60e9");
  if (!poisson && !body.has("poisson") && !defaults.poisson_given)
    body.missing("poisson", "give Poisson's ratio here or in [rock], say 0.25");
  if (moving && !(density > 0)) body.error("density", "a moving body needs a density above 0", "give kg/m3, say 2700");
  auto material = bem::Material::make(pascals(young.value_or(1)), poisson.value_or(0.25),
                                      kilograms_per_cubic_metre(density), plane);
  if (!material) return;  // ruled out above
  BodySpec spec{.name = name, .line = body.line(), .region = {.name = name, .material = *material}};
  spec.extent = static_cast<bem::Extent>(body.choice("extent", extents).value_or(0));
  const bool infinite = spec.extent != bem::Extent::bounded;
  if (infinite && moving)
    body.error("extent", "an infinite body is solved in static scenes only", "remove [elastic.time]");
  if (spec.extent == bem::Extent::half_plane) {
    spec.surface = body.need_number("surface", rule::coordinate).value_or(0);
  } else if (body.has("surface")) {
    body.error("surface", "has a meaning for extent = \"half_plane\" only", "remove it");
  }
  Outline outline;
  parse_outline(body, outline, infinite);
  const std::size_t before = body.problems().errors();
  if (outline.loops.empty() && before == 0) {
    body.missing(infinite ? "holes" : "outline", infinite ? "an infinite body needs at least one opening" : "");
  }
  spec.region.conditions.assign(outline.sides, bem::free_surface());
  if (!outline.loops.empty()) {
    auto checked = bem::check_loops(outline.loops, infinite);
    if (!checked) {
      body.problems().error(body.line_of(infinite ? "holes" : "outline"), body.path_of(infinite ? "holes" : "outline"),
                            describe(checked.error()), "mend the corners");
    } else if (!infinite && std::ranges::find(checked->turned, std::size_t{0}) != checked->turned.end()) {
      body.note(body.has("outline") ? "outline" : "circle", "runs clockwise and was turned; sides keep their numbers",
                "write the corners anticlockwise");
    }
    if (checked) {
      for (std::size_t l = 0; l < outline.loops.size(); ++l) {
        // Turned loops hold the same sides with the same condition numbers.
        outline.loops[l] = checked->loops[l];
      }
    }
  }
  spec.region.loops = outline.loops;
  // Sides keep the numbers of the corners as written: conditions index them.
  parse_supports(body, outline, spec, moving);
  parse_loads(body, outline, spec, moving);
  if (const TomlTable* found = body.table("in_situ")) {
    constexpr std::array<string_view, 3> keys{"stress", "level", "gradient"};
    const TableReader table{*found, body.line_of("in_situ"), body.path_of("in_situ"), body.problems(), keys};
    if (!table.has("stress")) table.missing("stress", "write stress = [sxx, syy, sxy] in Pa, compression negative");
    spec.in_situ.stress = stress_of(table, "stress").value_or(bem::Sym2{});
    spec.in_situ.level = table.number("level", rule::coordinate).value_or(0);
    spec.in_situ.gradient = stress_of(table, "gradient").value_or(bem::Sym2{});
    spec.stressed = true;
    if (moving) table.error("stress", "stress before loading is part of static scenes only", "remove [elastic.time]");
  }
  spec.velocity = pair(body, "velocity", value_rule).value_or(Vec2{});
  spec.spin = body.number("spin", value_rule).value_or(0);
  if (!moving && (body.has("velocity") || body.has("spin"))) {
    body.error(body.has("velocity") ? "velocity" : "spin", "nothing moves without [elastic.time]",
               "add it, or remove this key");
  }
  if (moving && spec.held && !spec.pins.empty()) {
    body.error("support", "pins hold bodies that turn; a body with held sides does not", "use one or the other");
  }
  if (const auto elements = body.integer("elements", 1, 10000)) {
    for (bem::Loop& loop : spec.region.loops) {
      for (bem::Side& side : loop) side.elements = static_cast<std::size_t>(*elements);
    }
  }
  const double grading = body.number("grading", {1, false, 6, false, ""}).value_or(moving ? 1 : 2);
  for (bem::Loop& loop : spec.region.loops) {
    // Stress is singular at corners: elements get shorter towards them.
    for (bem::Side& side : loop) {
      if (!side.through) side.grade_start = side.grade_end = grading;
    }
  }
  if (!moving) put_loads(spec);
  bodies.push_back(std::move(spec));
}

/// Bodies must not lie in each other; bonded ones touch along sides.
void check_overlaps(const std::vector<BodySpec>& bodies, Problems& problems) {
  const auto bounded = [](const BodySpec& b) { return b.extent == bem::Extent::bounded; };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      if (!bounded(bodies[i]) || !bounded(bodies[j])) continue;
      const auto pokes = [](const BodySpec& a, const BodySpec& b) -> std::optional<Vec2> {
        // Points of a's boundary, moved a little inwards, that lie inside b.
        for (const bem::Loop& loop : a.region.loops) {
          for (std::size_t s = 0; s < loop.size(); ++s) {
            for (int k = 0; k < 16; ++k) {
              const bem::SidePoint p = bem::point_on(loop, s, (k + 0.5) / 16);
              const Vec2 inward = bem::turned_left(p.derivative) * 1e-6;
              if (bem::inside(b.region.loops, p.x + inward)) return p.x;
            }
          }
        }
        return std::nullopt;
      };
      auto at = pokes(bodies[i], bodies[j]);
      if (!at) at = pokes(bodies[j], bodies[i]);
      if (at) {
        problems.error(bodies[j].line, fmt::format("body[{}].outline", j + 1),
                       fmt::format("overlaps \"{}\" at ({:.6g}, {:.6g})", bodies[i].name, at->x, at->y),
                       "move one of them; bodies may touch along bonded sides");
      }
    }
  }
}

}  // namespace

double TimeFunction::operator()(double t) const {
  switch (kind) {
    case Kind::step: return 1;
    case Kind::ramp: return std::min(1.0, t / duration);
    case Kind::pulse: return t < duration / 2 ? 2 * t / duration : std::max(0.0, 2 - 2 * t / duration);
    case Kind::harmonic: return std::sin(2 * std::numbers::pi * frequency * t);
  }
  return 0;
}

double TimeFunction::mean(double from, double to) const {
  // Integral of a line of this slope and value at 0 over the part of the interval that lies in [low, high].
  const auto line = [&](double low, double high, double value, double slope) {
    const double a = std::max(from, low), b = std::min(to, high);
    return b > a ? (b - a) * (value + slope * (a + b) / 2) : 0.0;
  };
  constexpr double never = std::numeric_limits<double>::infinity();
  switch (kind) {
    case Kind::step: return 1;
    case Kind::ramp: return (line(0, duration, 0, 1 / duration) + line(duration, never, 1, 0)) / (to - from);
    case Kind::pulse:
      return (line(0, duration / 2, 0, 2 / duration) + line(duration / 2, duration, 2, -2 / duration)) / (to - from);
    case Kind::harmonic: {
      const double half = std::numbers::pi * frequency * (to - from);
      return (*this)(0.5 * (from + to)) * std::sin(half) / half;
    }
  }
  return 0;
}

double TimeFunction::fastest() const {
  switch (kind) {
    case Kind::step: break;
    case Kind::ramp:
    case Kind::pulse: return duration;
    case Kind::harmonic: return 1 / frequency;
  }
  return std::numeric_limits<double>::infinity();
}

bool is_bodies_scene(string_view text) {
  const auto tree = read_toml(text);
  if (!tree) return false;
  const auto has = [&](string_view key) {
    return std::ranges::find(tree->entries, key, &TomlEntry::key) != tree->entries.end();
  };
  return has("body") && !has("contact") && !has("domain") && !has("joint") && !has("joint_set");
}

std::expected<BodiesScene, std::vector<Problem>> parse_bodies(string_view text, const std::string& shown) {
  Problems problems{shown};
  auto tree = read_toml(text);
  if (!tree) {
    problems.error(tree.error().line, "TOML", tree.error().what, "mend the syntax: see https://toml.io");
    return std::unexpected(std::move(problems).take_errors());
  }
  constexpr std::array<string_view, 7> root_keys{"schema", "title", "seed", "rock", "elastic", "body", "output"};
  const TableReader root{*tree, 1, "", problems, root_keys};
  BodiesScene scene;
  parse_plane_head(root, text, shown, scene);
  const RockDefaults defaults = parse_rock_defaults(root);
  bem::PlaneState plane = bem::PlaneState::strain;
  constexpr std::array<string_view, 10> elastic_keys{"plane",       "gravity", "order", "element", "tolerance",
                                                     "integration", "points",  "time",  "stress",  "frequencies"};
  const TomlTable empty;
  const TomlTable* section = root.table("elastic");
  const TableReader elastic{section != nullptr ? *section : empty, root.line_of("elastic"), "elastic", problems,
                            elastic_keys};
  {
    constexpr std::array<string_view, 2> planes{"strain", "stress"};
    constexpr std::array<string_view, 3> orders{"constant", "linear", "quadratic"};
    if (elastic.choice("plane", planes) == std::size_t{1}) plane = bem::PlaneState::stress;
    scene.options.mesh.order = static_cast<bem::Order>(elastic.choice("order", orders).value_or(2));
    scene.options.mesh.element = elastic.number("element", rule::length).value_or(0);
    scene.options.integration = elastic.number("integration", {1e-15, false, 1e-2, false, ""}).value_or(1e-10);
    scene.tolerance = elastic.number("tolerance", {1e-12, false, 1, false, ""});
    scene.stress = elastic.boolean("stress").value_or(true);
    scene.frequencies = static_cast<std::size_t>(elastic.integer("frequencies", 0, 100).value_or(0));
    if (const TomlEntry* g = elastic.find("gravity")) {
      if (std::holds_alternative<TomlArray>(g->node.value)) {
        scene.gravity = pair(elastic, "gravity", rule::acceleration).value_or(Vec2{});
      } else {
        scene.gravity = {0, -elastic.number("gravity", rule::acceleration).value_or(0)};
      }
    }
    parse_elastic_time(elastic, scene);
  }
  constexpr std::array<string_view, 18> body_keys{"name",  "outline", "circle",  "arcs",    "holes",   "round_holes",
                                                  "young", "poisson", "density", "support", "load",    "velocity",
                                                  "spin",  "extent",  "surface", "in_situ", "grading", "elements"};
  const auto found = root.tables("body");
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto body = reader(*found[i], fmt::format("body[{}]", i + 1), problems, body_keys);
    parse_body(body, defaults, plane, scene.time.has_value(), scene.bodies);
  }
  if (found.empty()) problems.error(1, "body", "there is no body", "write at least one [[body]]");
  if (problems.errors() == 0) check_overlaps(scene.bodies, problems);
  parse_elastic_points(elastic, scene);
  if (problems.errors() != 0) return std::unexpected(std::move(problems).take_errors());
  scene.notes = std::move(problems).take_notes();
  return scene;
}

}  // namespace cleave::scene
