#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "cleave/scene/contact.hpp"
#include "contact_outline.hpp"
#include "context.hpp"
#include "nearest.hpp"
#include "plane_input.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;
using std::string_view;

/// Empty for what is no solver. No default: the compiler asks for the name of a new one.
constexpr string_view solver_name(ContactSolver solver) noexcept {
  switch (solver) {
    case ContactSolver::cascade: return "cascade";
    case ContactSolver::open_close: return "open_close";
    case ContactSolver::newton: return "newton";
    case ContactSolver::continuation: return "continuation";
    case ContactSolver::lemke: return "lemke";
  }
  return "";
}
/// What a scene may say, in the order of the enumeration.
constexpr auto solver_names = [] {
  std::array<string_view, static_cast<std::size_t>(ContactSolver::lemke) + 1> names;
  for (std::size_t k = 0; k < names.size(); ++k) names[k] = solver_name(static_cast<ContactSolver>(k));
  return names;
}();
static_assert(solver_name(static_cast<ContactSolver>(solver_names.size())).empty(),
              "a solver that no scene can ask for");

/// A list of sides, counted from 1 in the order in which the corners are written.
std::vector<std::size_t> sides_of(const TableReader& table, const ContactOutline& outline) {
  std::vector<std::size_t> out;
  const std::size_t count = outline.corners.size();
  const auto push = [&](std::int64_t side, string_view key) {
    if (side < 1 || static_cast<std::size_t>(side) > count) {
      if (count > 0) {
        table.error(key, fmt::format("there is no side {}", side),
                    fmt::format("sides count from 1 to {}, in the order of the corners", count));
      }
      return;
    }
    out.push_back(outline.side_of[static_cast<std::size_t>(side) - 1]);
  };
  if (const auto side = table.integer("side", 1, 1000000)) push(*side, "side");
  if (const TomlEntry* sides = table.find("sides")) {
    const auto* array = std::get_if<TomlArray>(&sides->node.value);
    const auto* word = std::get_if<std::string>(&sides->node.value);
    if (word != nullptr && *word == "all") {
      for (std::size_t k = 0; k < count; ++k) out.push_back(k);
    } else if (array != nullptr) {
      if (array->items.empty()) table.error("sides", "names no side", "write sides = [1, 2], or remove what holds it");
      for (const TomlNode& node : array->items) {
        if (const auto* n = std::get_if<std::int64_t>(&node.value)) {
          push(*n, "sides");
        } else {
          table.error("sides", "must be a list of numbers", "write sides = [1, 2]");
        }
      }
    } else {
      table.error("sides", "must be a list of numbers, or \"all\"", "write sides = [1, 2]");
    }
  }
  if (!table.has("side") && !table.has("sides")) {
    table.missing("side", "name a side, counted from 1 in the order of the corners");
  }
  return out;
}

void parse_loads(const TableReader& body, const ContactOutline& outline, ContactBody& spec) {
  constexpr std::array<string_view, 7> keys{"side", "sides", "at", "pressure", "traction", "force", "time"};
  constexpr std::array<string_view, 3> kinds{"pressure", "traction", "force"};
  const auto found = body.tables("load");
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto table = reader(*found[i], fmt::format("{}[{}]", body.path_of("load"), i + 1), body.problems(), keys);
    const TomlEntry* kind = table.one_of(kinds);
    if (kind == nullptr) continue;
    const bool point = kind->key == "force";
    for (const string_view key : {"side", "sides", "at"}) {
      if (table.has(key) && point != (key == "at")) {
        table.error(key, fmt::format("stands beside {}", kind->key),
                    point ? "a force acts at a point: remove this key" : "it acts on whole sides: remove this key");
      }
    }
    ContactLoad load;
    load.line = table.line();
    load.time = parse_time_function(table, load.follows);
    load.timed = table.has("time");
    if (point) {
      if (!table.has("at")) table.missing("at", "write where the force acts: at = [x, y]");
      load.at = pair(table, "at", rule::coordinate).value_or(Vec2{});
      load.force = pair(table, "force", value_rule).value_or(Vec2{});
      spec.loads.push_back(load);
      continue;
    }
    if (kind->key == "pressure") {
      load.pressure = table.number("pressure", value_rule).value_or(0);
    } else {
      load.traction = pair(table, "traction", value_rule).value_or(Vec2{});
    }
    for (const std::size_t side : sides_of(table, outline)) {
      load.side = side;
      spec.loads.push_back(load);
    }
  }
}

void parse_supports(const TableReader& body, const ContactOutline& outline, ContactBody& spec) {
  constexpr std::array<string_view, 3> keys{"side", "sides", "kind"};
  constexpr std::array<string_view, 1> kinds{"fixed"};
  const auto found = body.tables("support");
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto table = reader(*found[i], fmt::format("{}[{}]", body.path_of("support"), i + 1), body.problems(), keys);
    if (!table.has("kind")) table.missing("kind", "write kind = \"fixed\": a side that is clamped");
    if (!table.choice("kind", kinds) && table.has("kind")) continue;
    for (const std::size_t side : sides_of(table, outline)) {
      spec.held.resize(spec.corners.size(), false);
      spec.held[side] = true;
    }
  }
  if (spec.fixed) spec.held.clear();
  if (!found.empty() && spec.fixed) {
    body.error("support", "the whole body is fixed", "remove support, or fixed = true");
  }
}

struct JointNames {
  std::vector<ContactJoint>& joints;
  std::size_t of(const TableReader& table, string_view key, const std::string& name) const {
    const auto at = std::ranges::find(joints, name, &ContactJoint::name);
    if (at != joints.end()) return static_cast<std::size_t>(at - joints.begin());
    std::vector<string_view> known;
    for (const ContactJoint& joint : joints) known.emplace_back(joint.name);
    const auto guess = nearest(name, known);
    table.error(key, fmt::format("there is no [joints.{}]", name),
                guess ? fmt::format("did you mean \"{}\"?", *guess) : "add that table, or name one there is");
    return 0;
  }
};

void parse_side_joints(const TableReader& body, const ContactOutline& outline, const JointNames& names,
                       ContactBody& spec) {
  spec.joint.assign(spec.corners.size(), 0);
  const TomlEntry* entry = body.find("joint");
  if (entry == nullptr) return;
  if (const auto* one = std::get_if<std::string>(&entry->node.value)) {
    spec.joint.assign(spec.corners.size(), names.of(body, "joint", *one));
    return;
  }
  const auto* list = std::get_if<TomlArray>(&entry->node.value);
  if (list == nullptr || (list->items.size() != spec.corners.size() && !spec.corners.empty())) {
    body.error("joint", fmt::format("must be the name of a joint, or a list of {}, one a side", spec.corners.size()),
               "write joint = \"NAME\" with a table [joints.NAME]");
    return;
  }
  for (std::size_t k = 0; k < list->items.size() && k < spec.corners.size(); ++k) {
    if (const auto* name = std::get_if<std::string>(&list->items[k].value)) {
      spec.joint[outline.side_of[k]] = names.of(body, "joint", *name);
    } else {
      body.error("joint", "must hold names only", "write joint = [\"A\", \"B\", ...], one a side");
    }
  }
}

/// `repeat`: copies of a body, each shifted and turned once more.
struct Repeat {
  std::size_t count = 1;
  Vec2 shift, about;
  double turn = 0;  ///< degrees

  [[nodiscard]] Vec2 place(Vec2 x, std::size_t copy) const {
    const auto k = static_cast<double>(copy);
    return about + bem::rotated(x - about, k * turn * std::numbers::pi / 180) + k * shift;
  }
};

Repeat parse_repeat(const TableReader& body) {
  Repeat out;
  const TomlTable* found = body.table("repeat");
  if (found == nullptr) return out;
  constexpr std::array<string_view, 4> keys{"count", "shift", "turn", "about"};
  const TableReader table{*found, body.line_of("repeat"), body.path_of("repeat"), body.problems(), keys};
  if (!table.has("count")) table.missing("count", "write how many bodies: count = 12");
  out.count = static_cast<std::size_t>(table.integer("count", 1, 100000).value_or(1));
  out.shift = pair(table, "shift", rule::coordinate).value_or(Vec2{});
  out.turn = table.number("turn", rule::turn).value_or(0);
  out.about = pair(table, "about", rule::coordinate).value_or(Vec2{});
  if (!table.has("shift") && !table.has("turn")) {
    table.missing("shift", "write shift = [x, y] or turn = DEGREES with about = [x, y]");
  }
  if (table.has("turn") && !table.has("about")) table.missing("about", "write about which point: about = [x, y]");
  return out;
}

void parse_body(const TableReader& body, const RockDefaults& defaults, const JointNames& joints,
                std::vector<ContactBody>& bodies, std::map<std::string, std::uint32_t>& names) {
  ContactBody spec;
  spec.line = body.line();
  spec.name = body.text("name").value_or(fmt::format("body {}", bodies.size() + 1));
  spec.fixed = body.boolean("fixed").value_or(false);
  const auto own_young = body.number("young", young_rule);
  const auto own_poisson = body.number("poisson", poisson_rule);
  const auto own_density = body.number("density", body_density_rule);
  spec.young = own_young ? own_young : defaults.young;
  spec.poisson = own_poisson ? own_poisson : defaults.poisson;
  spec.density = own_density.value_or(defaults.density);
  if (!spec.fixed && !(spec.density > 0)) {
    body.error("density", "a body that moves needs a mass: its density is 0", "give kg/m3, say 2700, or fixed = true");
  }
  const ContactOutline outline = parse_contact_outline(body);
  spec.corners = outline.corners;
  parse_side_joints(body, outline, joints, spec);
  parse_supports(body, outline, spec);
  parse_loads(body, outline, spec);
  spec.velocity = pair(body, "velocity", value_rule).value_or(Vec2{});
  spec.spin = body.number("spin", value_rule).value_or(0);
  for (const string_view key : {"velocity", "spin", "load"}) {
    if (spec.fixed && body.has(key)) body.error(key, "the body is fixed", "remove this key, or fixed = true");
  }
  for (const string_view key : {"velocity", "spin"}) {
    if (spec.clamped() && body.has(key)) {
      body.error(key, "a clamped body starts at rest", "remove this key, or support");
    }
  }
  if (spec.name.empty()) body.error("name", "is empty", "give a name, or remove the key");
  const Repeat repeat = parse_repeat(body);
  const bool many = body.has("repeat");
  for (std::size_t k = 0; k < repeat.count; ++k) {
    ContactBody copy = spec;
    if (many) copy.name = fmt::format("{} {}", spec.name, k + 1);
    for (Vec2& corner : copy.corners) corner = repeat.place(corner, k);
    for (ContactLoad& load : copy.loads) load.at = repeat.place(load.at, k);
    if (const auto [at, fresh] = names.emplace(copy.name, copy.line); !fresh) {
      body.error("name", fmt::format("\"{}\" is the name of the body of line {}, too", copy.name, at->second),
                 "give each body a name of its own");
    }
    bodies.push_back(std::move(copy));
  }
}

std::vector<ContactJoint> parse_strengths(const TableReader& root) {
  std::vector<ContactJoint> out{{.name = "default"}};
  const TomlTable* found = root.table("joints");
  if (found == nullptr) return out;
  constexpr std::array<string_view, 3> keys{"friction", "cohesion", "tension"};
  constexpr NumberRule strength{0, false, 1e15, false, " Pa"};
  struct Named {
    TableReader table;
    std::size_t at;
  };
  std::vector<Named> tables;
  for (const TomlEntry& entry : found->entries) {
    const std::string path = "joints." + entry.key;
    const auto* table = std::get_if<TomlTable>(&entry.node.value);
    if (table == nullptr) {
      root.problems().error(entry.line, path, "must be a table", "write [joints." + entry.key + "]");
      continue;
    }
    if (entry.key != "default") out.push_back({.name = entry.key});
    tables.push_back(
        {TableReader{*table, entry.line, path, root.problems(), keys}, entry.key == "default" ? 0 : out.size() - 1});
  }
  std::ranges::stable_sort(tables, {}, &Named::at);  // the default first: others take from it what they do not state
  for (const Named& named : tables) {
    ContactJoint& joint = out[named.at];
    joint.friction = named.table.number("friction", rule::friction).value_or(out[0].friction);
    joint.cohesion = named.table.number("cohesion", strength).value_or(out[0].cohesion);
    joint.tension = named.table.number("tension", strength).value_or(out[0].tension);
  }
  if (std::ranges::none_of(tables, [](const Named& n) { return n.at == 0 && n.table.has("friction"); }) &&
      std::ranges::any_of(out, [&](const ContactJoint& j) { return j.name == "default"; }) && tables.empty()) {
    root.note("joints", "no strength is stated: friction 30 degrees, no cohesion, no tension",
              "write [joints.default] with friction = DEGREES");
  }
  return out;
}

/// Extent of what moves (of everything when nothing does).
double size_of(const ContactScene& scene, bool height) {
  double low = 1e300, high = -1e300;
  for (const bool all : {false, true}) {
    for (const ContactBody& body : scene.bodies) {
      if (body.fixed && !all) continue;
      for (const Vec2 p : body.corners) {
        low = std::min(low, height ? p.y : p.x);
        high = std::max(high, height ? p.y : p.x);
      }
    }
    if (high > low) return high - low;
  }
  return 1;
}

void parse_settings(const TableReader& table, ContactScene& scene) {
  ContactSettings& s = scene.settings;
  if (const TomlEntry* g = table.find("gravity")) {
    if (std::holds_alternative<TomlArray>(g->node.value)) {
      s.gravity = pair(table, "gravity", rule::acceleration).value_or(Vec2{});
    } else {
      constexpr NumberRule downwards{0, false, 1e3, false, " m/s2, downwards (a direction: [x, y])"};
      s.gravity = {0, -table.number("gravity", downwards).value_or(0)};
    }
  }
  s.to_rest = table.boolean("static").value_or(false);
  double smallest = 1e300, fastest = 0, load_time = 1e300;
  for (const ContactBody& body : scene.bodies) {
    if (body.fixed || body.corners.size() < 3) continue;
    bem::Vec2 low{1e300, 1e300}, high{-1e300, -1e300};
    for (const Vec2 p : body.corners) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    for (const ContactLoad& load : body.loads) load_time = std::min(load_time, load.time.fastest());
    smallest = std::min(smallest, norm(high - low));
    fastest = std::max(fastest, norm(body.velocity) + std::abs(body.spin) * norm(high - low) / 2);
  }
  if (smallest == 1e300) smallest = 1;
  const double g = norm(s.gravity);
  // A body falls a few thousandths of its own size from rest, or flies a hundredth of it, in the first step.
  double step = 1e-2;
  if (g > 0) step = 0.05 * std::sqrt(smallest / g);
  if (fastest > 0) step = std::min(step, 0.01 * smallest / fastest);
  step = std::min(step, load_time / 20);
  s.step = table.number("step", time_rule).value_or(step);
  s.max_step = table.number("max_step", time_rule).value_or(s.step);
  if (!s.to_rest && std::max(s.step, s.max_step) > load_time / 5) {
    table.note(
        table.has("max_step") ? "max_step" : "step",
        fmt::format("is long for a load that changes within {:.3g} s: only its mean over each step acts", load_time),
        fmt::format("use steps of {:.2g} s", load_time / 20));
  }
  if (s.max_step < s.step) table.error("max_step", "is shorter than step", "make it as long, or longer");
  if (s.to_rest) {
    const double natural = g > 0 ? std::sqrt(size_of(scene, true) / g) : 1;
    s.duration = table.number("duration", time_rule).value_or(1000 * natural);
  } else {
    if (!table.has("duration"))
      table.missing("duration", "write how long to follow the bodies, in s, or static = true");
    s.duration = table.number("duration", time_rule).value_or(1);
  }
  if (s.duration / s.step > 5e7) {
    table.error(table.has("step") ? "step" : "duration", "makes more than fifty million steps",
                "use a longer step or a shorter time");
  }
  if (table.has("step") && s.step > s.duration) {
    table.error("step", "is longer than the whole time", "use a shorter step");
  }
  s.solver = static_cast<ContactSolver>(table.choice("solver", solver_names).value_or(0));
  s.restitution = table.number("restitution", {0, false, 1, false, ""}).value_or(0);
  if (const TomlEntry* rigid = table.find("rigid")) {
    const auto* word = std::get_if<std::string>(&rigid->node.value);
    const auto* flag = std::get_if<bool>(&rigid->node.value);
    if (flag != nullptr) {
      s.rigidity = *flag ? Rigidity::rigid : Rigidity::elastic;
    } else if (word == nullptr || *word != "auto") {
      table.error("rigid", "must be true, false or \"auto\"", "write rigid = \"auto\"");
    }
  }
  constexpr std::array<string_view, 2> planes{"strain", "stress"};
  if (table.choice("plane", planes) == std::size_t{1}) s.plane = bem::PlaneState::stress;
  s.element = table.number("element", rule::length).value_or(0);
  s.modes = static_cast<std::size_t>(table.integer("modes", 0, 10000).value_or(0));
  s.damping = table.number("damping", {0, false, 10, false, ""}).value_or(0);
  s.largest_move = table.number("largest_move", {0, true, 1, false, ""}).value_or(s.largest_move);
  s.frames = static_cast<std::size_t>(table.integer("frames", 1, 5000).value_or(120));
  s.estimate = table.boolean("estimate").value_or(false);
  if (const TomlTable* found = table.table("strength")) {
    constexpr std::array<string_view, 3> strength_keys{"cohesion", "friction", "tension"};
    const TableReader strength{*found, table.line_of("strength"), table.path_of("strength"), table.problems(),
                               strength_keys};
    s.strength =
        RockStrength{.cohesion = strength.need_number("cohesion", {0, false, 1e12, false, " Pa"}).value_or(0),
                     .friction = strength.need_number("friction", {0, false, 89, false, " degrees"}).value_or(0),
                     .tension = strength.need_number("tension", {0, false, 1e12, false, " Pa"}).value_or(0)};
  }
}

bool holds(const ContactBody& body, Vec2 at) { return bem::inside({bem::polygon(body.corners)}, at); }

/// On the outline, up to what rounding of written coordinates makes.
bool lies_on(const ContactBody& body, Vec2 at) {
  for (std::size_t k = 0; k < body.corners.size(); ++k) {
    const Vec2 a = body.corners[k], d = body.corners[(k + 1) % body.corners.size()] - a;
    if (norm(at - a - std::clamp(dot(at - a, d) / dot(d, d), 0.0, 1.0) * d) <= 1e-6 * norm(d)) return true;
  }
  return false;
}

/// The body that holds the point, or on whose outline it lies; one that moves goes before fixed ones.
std::optional<std::size_t> body_at(const std::vector<ContactBody>& bodies, Vec2 at) {
  std::optional<std::size_t> best;
  const auto take = [&](std::size_t b) {
    if (!best || (bodies[*best].fixed && !bodies[b].fixed)) best = b;
  };
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (holds(bodies[b], at) || lies_on(bodies[b], at)) take(b);
  }
  return best;
}

void parse_points(const TableReader& table, ContactScene& scene) {
  constexpr std::array<string_view, 3> keys{"name", "at", "body"};
  const auto found = table.tables("points");
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto point = reader(*found[i], fmt::format("contact.points[{}]", i + 1), table.problems(), keys);
    if (!point.has("at")) point.missing("at", "write at = [x, y]");
    const auto at = pair(point, "at", rule::coordinate);
    if (!at) continue;
    PointSpec spec{.name = point.text("name").value_or(fmt::format("point {}", i + 1)), .at = *at, .body = 0};
    if (spec.name.empty()) point.error("name", "is empty", "give a name, or remove the key");
    if (std::ranges::find(scene.points, spec.name, &PointSpec::name) != scene.points.end()) {
      point.error("name", fmt::format("\"{}\" is the name of another point, too", spec.name),
                  "give each point a name of its own");
      continue;
    }
    if (const auto wanted = point.text("body")) {
      const auto body = std::ranges::find(scene.bodies, *wanted, &ContactBody::name);
      if (body == scene.bodies.end()) {
        std::vector<string_view> known;
        for (const ContactBody& b : scene.bodies) known.emplace_back(b.name);
        const auto guess = nearest(*wanted, known);
        point.error("body", fmt::format("there is no body \"{}\"", wanted->substr(0, 60)),
                    guess ? fmt::format("did you mean \"{}\"?", *guess) : "name one there is");
        continue;
      }
      spec.body = static_cast<std::size_t>(body - scene.bodies.begin());
      if (!holds(*body, *at) && !lies_on(*body, *at)) {
        point.note("at", fmt::format("lies outside \"{}\": it moves as if it were a part of it", body->name),
                   "write the place at the start of the run");
      }
    } else if (const auto body = body_at(scene.bodies, *at)) {
      spec.body = *body;
    } else {
      point.error("at", "lies in no body", "move the point, or name its body");
      continue;
    }
    scene.points.push_back(std::move(spec));
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
    if (!(body.velocity == Vec2{}) || body.spin != 0) {
      problems.error(body.line, "body.velocity",
                     fmt::format("\"{}\" has a speed at the start, but static = true starts from rest", body.name),
                     "remove velocity and spin, or static = true");
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

void check_elastic(const ContactScene& scene, const TableReader& contact, Problems& problems) {
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

}  // namespace

string_view name_of(ContactSolver solver) noexcept { return solver_name(solver); }

bool is_contact_scene(string_view text) {
  const auto tree = read_toml(text);
  if (!tree) return false;
  const auto has = [&](string_view key) {
    return std::ranges::find(tree->entries, key, &TomlEntry::key) != tree->entries.end();
  };
  return has("contact") && !has("domain") && !has("joint") && !has("joint_set");
}

std::expected<ContactScene, std::vector<Problem>> parse_contact(string_view text, const std::string& shown) {
  Problems problems{shown};
  auto tree = read_toml(text);
  if (!tree) {
    problems.error(tree.error().line, "TOML", tree.error().what, "mend the syntax: see https://toml.io");
    return std::unexpected(std::move(problems).take_errors());
  }
  constexpr std::array<string_view, 8> root_keys{"schema", "title",   "seed", "rock",
                                                 "joints", "contact", "body", "output"};
  const TableReader root{*tree, 1, "", problems, root_keys};
  ContactScene scene;
  parse_plane_head(root, text, shown, scene);
  const RockDefaults defaults = parse_rock_defaults(root);
  scene.joints = parse_strengths(root);
  const JointNames joints{scene.joints};
  constexpr std::array<string_view, 16> body_keys{"name",  "outline", "rectangle", "polygon", "circle", "voussoir",
                                                  "fixed", "density", "young",     "poisson", "joint",  "support",
                                                  "load",  "spin",    "velocity",  "repeat"};
  const auto found = root.tables("body");
  std::map<std::string, std::uint32_t> names;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto body = reader(*found[i], fmt::format("body[{}]", i + 1), problems, body_keys);
    parse_body(body, defaults, joints, scene.bodies, names);
  }
  if (found.empty()) problems.error(1, "body", "there is no body", "write at least one [[body]]");
  constexpr std::array<string_view, 17> contact_keys{
      "strength", "estimate", "gravity", "duration", "step",    "max_step", "static", "solver",      "restitution",
      "rigid",    "plane",    "element", "modes",    "damping", "frames",   "points", "largest_move"};
  const TomlTable* section = root.table("contact");
  const TomlTable empty;
  const TableReader contact{section != nullptr ? *section : empty, root.line_of("contact"), "contact", problems,
                            contact_keys};
  if (section != nullptr) {
    parse_settings(contact, scene);
    parse_points(contact, scene);
    check_elastic(scene, contact, problems);
  }
  if (problems.errors() == 0) {
    check_forces(scene, problems);
    check_rest(scene, problems);
    check_overlaps(scene, problems);
  }
  if (!scene.bodies.empty() && std::ranges::all_of(scene.bodies, &ContactBody::fixed)) {
    problems.note(1, "body", "every body is fixed: nothing will move", "remove fixed = true where a body may move");
  }
  if (problems.errors() != 0) return std::unexpected(std::move(problems).take_errors());
  scene.notes = std::move(problems).take_notes();
  return scene;
}

}  // namespace cleave::scene
