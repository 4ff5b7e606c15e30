#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "body_keys.hpp"
#include "cleave/scene2d/bodies.hpp"
#include "parse_elastic.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;
using std::string_view;

constexpr double radians = std::numbers::pi / 180;
constexpr NumberRule stiffness_rule{0, false, 1e18, false, " Pa/m"};
constexpr std::array<string_view, 7> support_words{"fixed",        "roller", "symmetry", "spring",
                                                   "displacement", "bonded", "pin"};

const KeyTable& circle_keys() {
  static const KeyTable keys{.name = "circle",
                             .keys = {{"centre", key::pair(rule::coordinate), required, "`[x, y]` in m"},
                                      {"radius", key::number(rule::length), required, "m"}}};
  return keys;
}

const KeyTable& arc_keys() {
  static const KeyTable keys{
      .name = "body.arcs",
      .keys = {{"side", key::whole(1, 100'000), required, "a side, counted from 1"},
               {"through", key::pair(rule::coordinate), required, "`[x, y]` in m, a point of the arc"},
               {"hole", key::whole(1, 1000), "", "of a hole; none: of the outline"}}};
  return keys;
}

Key hole_key() { return {"hole", key::whole(1, 1000), "", "of a hole, counted from 1, round ones after the others"}; }

const KeyTable& body_support_keys() {
  static const KeyTable keys = [] {
    KeyTable table{.name = "elastic body.support", .keys = side_keys()};
    const std::vector<Key> more{
        hole_key(),
        {"kind", key::word(support_words), required,
         "`fixed`; `roller`; `symmetry`; `spring`; `displacement`; `bonded` to another body's side; `pin`: moving "
         "bodies that turn"},
        {"at", key::pair(rule::coordinate), "", "`[x, y]` in m, of a pin"},
        {"normal", key::number(stiffness_rule), "0", "Pa/m, of a spring"},
        {"along", key::number(stiffness_rule), "0", "Pa/m, of a spring"},
        {"value", key::pair(rule::coordinate), "", "`[x, y]` in m, of a displacement"},
        {"angle", key::number(rule::turn), "the normal", "degrees, of a roller: the direction held"}};
    table.keys.insert(table.keys.end(), more.begin(), more.end());
    return table;
  }();
  return keys;
}

const KeyTable& load_keys_of_body() {
  static const KeyTable keys = [] {
    KeyTable table{
        .name = "elastic body.load", .keys = body_load_keys(), .one_of = {{"pressure", "traction", "force"}}};
    table.keys.push_back(hole_key());
    return table;
  }();
  return keys;
}

const KeyTable& elastic_body_keys() {
  static const KeyTable keys = [] {
    KeyTable table{
        .name = "elastic body",
        .keys = {{"name", key::text(), "`body N`", "in the results"},
                 {"outline", key::pairs(), "",
                  "corners in m, counter-clockwise; side k runs from corner k to the next (clockwise is turned, with a "
                  "note)"},
                 {"circle", key::table(&circle_keys), "", "`{ centre, radius }` instead of `outline`; two sides"},
                 {"arcs", key::tables(&arc_keys), "[]",
                  "`[{ side, through, hole }]`: makes a side the arc of a circle through a point"},
                 {"holes", key::array(key::pairs()), "[]",
                  "outlines; `hole = N` names one in supports, loads, arcs (round ones count on)"},
                 {"round_holes", key::tables(&circle_keys), "[]", "circles"},
                 {"support", key::tables(&body_support_keys), "[]", "sides that are held, below"},
                 {"load", key::tables(&load_keys_of_body), "[]", "what acts on it, below"},
                 {"velocity", key::pair(speed_rule), "[0, 0]", "m/s at the start, less what pins do not allow"},
                 {"angular_velocity", key::number(angular_velocity_rule), "0", "rad/s at the start", "spin"},
                 {"extent", key::word<bem::Extent>(), "\"bounded\"",
                  "`\"plane\"`: infinite around its holes; `\"half_plane\"` below `surface`"},
                 {"surface", key::number(rule::coordinate), "", "m, y of the surface of a half plane"},
                 {"in_situ", key::table(&in_situ_keys), "", "`{ stress, level, gradient }`: stress before loading"},
                 {"grading", key::number({1, false, 6, false, ""}), "2 static, 1 moving",
                  "element ends at (k/n)^grading from corners"},
                 {"elements", key::whole(1, 10'000), "from `element`", "number on every side"}}};
    for (Key& key : material_keys()) table.keys.push_back(std::move(key));
    return table;
  }();
  return keys;
}

std::optional<bem::Loop> circle_of(const TableReader& table, bool clockwise) {
  const auto centre = pair(table, "centre");
  if (!table.has("centre")) table.missing("centre", "write centre = [x, y]");
  const auto radius = table.need_number("radius");
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
  if (infinite) {
    if (body.has("outline") || body.has("circle")) {
      body.error(body.has("outline") ? "outline" : "circle", "an infinite body has no outline",
                 "describe its openings by holes and round_holes");
    }
  } else if (const TomlEntry* entry = body.find("outline")) {
    if (auto corners = corners_of(body, entry->node, body.path_of("outline"))) outline.add(bem::polygon(*corners));
  } else if (const auto circle = body.sub("circle")) {
    if (auto loop = circle_of(*circle, false)) outline.add(std::move(*loop));
  } else if (!body.has("circle")) {
    body.missing("outline", "write outline = [[x, y], [x, y], [x, y], ...], counter-clockwise, or circle = {...}");
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
  for (const TableReader& round : body.each("round_holes")) {
    if (auto loop = circle_of(round, true)) outline.add(std::move(*loop));
  }
  for (const TableReader& arc : body.each("arcs")) {
    const auto hole = arc.integer("hole").value_or(0);
    const std::size_t loop = static_cast<std::size_t>(hole) - (infinite && hole > 0 ? 1U : 0U);
    const auto side = arc.integer("side");
    const auto through = pair(arc, "through");
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
  const auto hole = table.integer("hole");
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
  if (const auto side = table.integer("side")) push(*side, "side");
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
  for (const TableReader& table : body.each("support")) {
    const auto kind = table.choice("kind");
    if (!table.has("kind")) table.missing("kind", "write one of: fixed roller symmetry spring displacement bonded pin");
    if (!kind) continue;
    if (*kind == 6) {
      const auto at = pair(table, "at");
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
      case 3: condition = bem::springs(table.number("normal").value_or(0), table.number("along").value_or(0)); break;
      case 4: {
        const Vec2 v = pair(table, "value").value_or(Vec2{});
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
    if (const auto angle = table.number("angle")) {
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
  for (const TableReader& table : body.each("load")) {
    const TomlEntry* kind = table.one_of();
    if (kind == nullptr) continue;
    BodyLoadSpec load;
    load.timed = table.has("time");
    if (load.timed && !moving)
      table.error("time", "loads change with time in moving scenes only", "add [elastic.time], or remove it");
    load.time = parse_time_function(table, load.follows);
    if (kind->key == "force") {
      const auto at = pair(table, "at");
      if (!table.has("at")) table.missing("at", "write where the force acts: at = [x, y]");
      load.at = at.value_or(Vec2{});
      load.force = pair(table, "force").value_or(Vec2{});
    } else {
      load.sides = sides_of(table, outline, spec.extent != bem::Extent::bounded);
      if (load.sides.empty() && !table.has("side") && !table.has("sides") && !table.has("hole")) {
        table.missing("side", "name a side, counted from 1 in the order of the corners");
      }
      if (kind->key == "pressure") {
        load.pressure = table.number("pressure").value_or(0);
      } else {
        load.traction = pair(table, "traction").value_or(Vec2{});
      }
    }
    spec.loads.push_back(std::move(load));
  }
}

/// Static loads become part of the sides' conditions, in whatever directions these leave to tractions.
void apply_static_loads(BodySpec& spec) {
  for (const BodyLoadSpec& load : spec.loads) {
    for (const std::size_t side : load.sides) {
      bem::Condition& c = spec.region.conditions[side];
      const auto axes = [axes = c.axes, turn = c.turn](Vec2 n) {
        return axes == bem::Axes::normal ? std::array{rotated(n, turn), rotated(turned_left(n), turn)}
                                         : std::array{rotated({1, 0}, turn), rotated({0, 1}, turn)};
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
  const std::string fallback = fmt::format("body {}", bodies.size() + 1);
  const std::string name = body.text("name").value_or(fallback);
  const auto own_young = body.number("young");
  const auto own_poisson = body.number("poisson");
  const auto own_density = body.number("density");
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
  spec.extent = body.word<bem::Extent>("extent");
  const bool infinite = spec.extent != bem::Extent::bounded;
  if (infinite && moving)
    body.error("extent", "an infinite body is solved in static scenes only", "remove [elastic.time]");
  if (spec.extent == bem::Extent::half_plane) {
    spec.surface = body.need_number("surface").value_or(0);
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
                            describe(checked.error()), "correct the corners");
    } else if (!infinite && std::ranges::find(checked->turned, std::size_t{0}) != checked->turned.end()) {
      body.note(body.has("outline") ? "outline" : "circle", "runs clockwise and was turned; sides keep their numbers",
                "write the corners counter-clockwise");
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
  if (const auto in_situ = body.sub("in_situ")) {
    spec.in_situ = parse_in_situ(*in_situ);
    spec.stressed = true;
    if (moving)
      in_situ->error("stress", "stress before loading is part of static scenes only", "remove [elastic.time]");
  }
  spec.velocity = pair(body, "velocity").value_or(Vec2{});
  spec.spin = body.value("angular_velocity");
  if (!moving && (body.has("velocity") || body.has("angular_velocity"))) {
    body.error(body.has("velocity") ? "velocity" : "angular_velocity", "nothing moves without [elastic.time]",
               "add it, or remove this key");
  }
  if (moving && spec.held && !spec.pins.empty()) {
    body.error("support", "pins hold bodies that turn; a body with held sides does not", "use one or the other");
  }
  if (const auto elements = body.integer("elements")) {
    for (bem::Loop& loop : spec.region.loops) {
      for (bem::Side& side : loop) side.elements = static_cast<std::size_t>(*elements);
    }
  }
  const double grading = body.number("grading").value_or(moving ? 1 : 2);
  for (bem::Loop& loop : spec.region.loops) {
    // Stress is singular at corners: elements get shorter towards them.
    for (bem::Side& side : loop) {
      if (!side.through) side.grade_start = side.grade_end = grading;
    }
  }
  if (!moving) apply_static_loads(spec);
  bodies.push_back(std::move(spec));
}

}  // namespace

const KeyTable& elastic_scene_keys() {
  static const KeyTable keys = [] {
    KeyTable table{.name = "elastic scene", .keys = head_keys()};
    table.keys.push_back({"elastic", key::table(&elastic_keys), "", "the problem"});
    table.keys.push_back({"body", key::tables(&elastic_body_keys), required, "elastic bodies"});
    table.steps = {
        {Step::elastic, {"elastic", "body", "rock"}}, {Step::write, {"output"}}, {Step::report, {"project", "output"}}};
    return table;
  }();
  return keys;
}

std::expected<BodiesScene, std::vector<Problem>> parse_bodies(string_view text, const std::string& shown) {
  Problems problems{shown};
  auto tree = read_toml(text);
  if (!tree) {
    problems.error(tree.error().line, "TOML", tree.error().what, tree.error().remedy);
    return std::unexpected(std::move(problems).take_errors());
  }
  const TableReader root{*tree, 1, "", problems, elastic_scene_keys()};
  BodiesScene scene;
  parse_plane_head(root, text, shown, scene);
  for (const TomlEntry& entry : tree->entries) scene.given.push_back(entry.key);
  const RockDefaults defaults = parse_rock_defaults(root);
  bem::PlaneState plane = bem::PlaneState::strain;
  const TomlTable empty;
  const TomlTable* section = root.table("elastic");
  const TableReader elastic{section != nullptr ? *section : empty, root.line_of("elastic"), "elastic", problems,
                            elastic_keys()};
  {
    plane = elastic.word<bem::PlaneState>("plane");
    scene.options.mesh.order = elastic.word<bem::Order>("order");
    scene.options.mesh.element = elastic.number("element");
    scene.options.integration = elastic.value("integration");
    scene.tolerance = elastic.number("tolerance");
    scene.stress = elastic.flag("stress");
    scene.frequencies = static_cast<std::size_t>(elastic.count("frequencies"));
    if (const TomlEntry* g = elastic.find("gravity")) {
      if (std::holds_alternative<TomlArray>(g->node.value)) {
        scene.gravity = pair(elastic, "gravity").value_or(Vec2{});
      } else {
        scene.gravity = {0, -elastic.number("gravity").value_or(0)};
      }
    }
    parse_elastic_time(elastic, scene);
  }
  const std::vector<TableReader> bodies = root.each("body");
  for (const TableReader& body : bodies) parse_body(body, defaults, plane, scene.time.has_value(), scene.bodies);
  if (bodies.empty()) problems.error(1, "body", "there is no body", "write at least one [[body]]");
  if (problems.errors() == 0) check_overlaps(scene.bodies, problems);
  if (problems.errors() == 0 && !scene.time) check_supports(scene.bodies, problems);
  parse_elastic_points(elastic, scene);
  if (problems.errors() != 0) return std::unexpected(std::move(problems).take_errors());
  scene.notes = std::move(problems).take_notes();
  return scene;
}

}  // namespace cleave::scene
