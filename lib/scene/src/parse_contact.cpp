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

constexpr NumberRule downwards_rule{0, false, 1e3, false, " m/s2, downwards (a direction: [x, y])"};
constexpr std::array<string_view, 1> fixed_word{"fixed"};
constexpr std::array<string_view, 1> auto_word{"auto"};

const KeyTable& contact_strength_keys() {
  static const KeyTable keys{.name = "joints of bodies",
                             .keys = {{"friction", key::number(rule::friction), "30", "degrees"},
                                      {"cohesion", key::number(rule::stress), "0", "Pa, until a contact breaks"},
                                      {"tension", key::number(rule::stress), "0", "Pa, until a contact breaks"}}};
  return keys;
}

const KeyTable& contact_load_keys() {
  static const KeyTable keys{
      .name = "contact body.load", .keys = body_load_keys(), .one_of = {{"pressure", "traction", "force"}}};
  return keys;
}

const KeyTable& contact_support_keys() {
  static const KeyTable keys = [] {
    KeyTable table{.name = "contact body.support", .keys = side_keys()};
    table.keys.push_back({"kind", key::word(fixed_word), required, "clamped sides"});
    return table;
  }();
  return keys;
}

const KeyTable& repeat_keys() {
  static const KeyTable keys{
      .name = "body.repeat",
      .keys = {{"count", key::whole(1, 100'000), required, "bodies"},
               {"shift", key::pair(rule::coordinate), "[0, 0]", "`[x, y]` in m, of each once more"},
               {"rotation", key::number(rule::turn), "0", "degrees about `centre`, of each once more", "turn"},
               {"centre", key::pair(rule::coordinate), "", "`[x, y]` in m, of the rotation", "about"}}};
  return keys;
}

const KeyTable& rock_strength_keys() {
  static const KeyTable keys{.name = "contact.strength",
                             .keys = {{"cohesion", key::number({0, false, 1e12, false, " Pa"}), required, "Pa"},
                                      {"friction", key::number({0, false, 89, false, " degrees"}), required, "degrees"},
                                      {"tension", key::number({0, false, 1e12, false, " Pa"}), required, "Pa"}}};
  return keys;
}

const KeyTable& history_point_keys() {
  static const KeyTable keys{.name = "contact.points", .keys = history_keys()};
  return keys;
}

const KeyTable& contact_keys() {
  static const KeyTable keys{
      .name = "contact",
      .keys = {
          {"duration", key::number(time_rule), "", "s; with `static` the longest relaxation"},
          {"step", key::number(time_rule), "from size, speed and how fast loads change",
           "s, the first step; it is cut where contacts do not converge or bodies move too far"},
          {"max_step", key::number(time_rule), "`step`", "s; when larger, steps grow while little moves"},
          {"static", key::flag(), "false",
           "true: relax to rest (implicit steps, each from rest, so without `velocity` and loads in time); no rest "
           "found: exit code 4"},
          {"gravity", key::either({key::number(downwards_rule), key::pair(rule::acceleration)}), "9.81",
           "m/s2 downwards (not negative), or `[x, y]`"},
          {"rigid", key::either({key::flag(), key::word(auto_word)}), "\"auto\"",
           "`true`: three freedoms a body; `false`: elastic; `\"auto\"`: elastic where a body is clamped or strains "
           "may "
           "reach 1e-4; `cleave plan` says which and why"},
          {"solver", key::word(solver_names), "\"cascade\"",
           "`open_close` (that of Fu 2014), `newton`, `continuation`, `lemke`, or all of them, cheapest first"},
          {"restitution", key::number({0, false, 1, false, ""}), "0",
           "of the normal velocity at impacts of rigid bodies"},
          {"max_displacement", key::number({0, true, 1, false, ""}), "0.05",
           "of the scene's extent: no corner moves further in one step", "largest_move"},
          {"points", key::tables(&history_point_keys), "[]",
           "`[{ name, at = [x, y], body }]`: histories in points.csv, summary.json and the report"},
          {"frames", key::whole(1, 5000), "120", "pictures kept for the animation and the VTU series"},
          {"plane", key::word(plane_words), "\"strain\"", "of elastic bodies: plane strain or plane stress"},
          {"element", key::number(rule::length), "a quarter of the body", "m, longest element of elastic bodies"},
          {"modes", key::whole(0, 10'000), "0", "of an elastic body; 0: all, which keeps static compliance exact"},
          {"estimate", key::flag(), "false",
           "true: an estimate of the error of the steps, by two more runs with twice and four times the step"},
          {"strength", key::table(&rock_strength_keys), "",
           "`{ cohesion, friction, tension }` of the rock of elastic bodies (Pa, degrees, Pa): `safety` of their "
           "stress"},
          {"damping", key::number({0, false, 10, false, ""}), "0", "share of critical damping of elastic vibrations"}}};
  return keys;
}

const KeyTable& contact_body_keys() {
  static const KeyTable keys = [] {
    KeyTable table{.name = "contact body",
                   .keys = outline_keys(),
                   .one_of = {{"outline", "rectangle", "polygon", "circle", "voussoir"}}};
    const std::vector<Key> more{
        {"name", key::text(), "`body N`", "in the results"},
        {"repeat", key::table(&repeat_keys), "",
         "`{ count, shift, rotation, centre }`: so many bodies: stacks, rows, arches. `velocity` and the directions of "
         "loads stay as written. Names become \"NAME 1\", \"NAME 2\", ..."},
        {"fixed", key::flag(), "false", "never moves"},
        {"joint", key::either({key::text(), key::texts()}), "\"default\"",
         "`[joints.NAME]` of all sides, or a list with one name a side. A side of joint `default` takes the other's; "
         "of "
         "two names the weaker of each strength counts"},
        {"velocity", key::pair(speed_rule), "[0, 0]", "m/s at the start"},
        {"angular_velocity", key::number(angular_velocity_rule), "0", "rad/s at the start", "spin"},
        {"support", key::tables(&contact_support_keys), "[]",
         "clamped sides of an elastic body, which then moves only by deforming (in a rigid run it is fixed)"},
        {"load", key::tables(&contact_load_keys), "[]",
         "as for other bodies: `pressure`, `traction`, or `force` with `at` (on the body, of an elastic one on its "
         "outline); `time` not with `static`"}};
    table.keys.insert(table.keys.end(), more.begin(), more.end());
    for (Key& key : material_keys()) table.keys.push_back(std::move(key));
    return table;
  }();
  return keys;
}

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
  if (const auto side = table.integer("side")) push(*side, "side");
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
  const std::vector<TableReader> found = body.each("load");
  for (const TableReader& table : found) {
    const TomlEntry* kind = table.one_of();
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
      load.at = pair(table, "at").value_or(Vec2{});
      load.force = pair(table, "force").value_or(Vec2{});
      spec.loads.push_back(load);
      continue;
    }
    if (kind->key == "pressure") {
      load.pressure = table.number("pressure").value_or(0);
    } else {
      load.traction = pair(table, "traction").value_or(Vec2{});
    }
    for (const std::size_t side : sides_of(table, outline)) {
      load.side = side;
      spec.loads.push_back(load);
    }
  }
}

void parse_supports(const TableReader& body, const ContactOutline& outline, ContactBody& spec) {
  const std::vector<TableReader> found = body.each("support");
  for (const TableReader& table : found) {
    if (!table.has("kind")) table.missing("kind", "write kind = \"fixed\": a side that is clamped");
    if (!table.choice("kind") && table.has("kind")) continue;
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
  const auto found = body.sub("repeat");
  if (!found) return out;
  const TableReader& table = *found;
  if (!table.has("count")) table.missing("count", "write how many bodies: count = 12");
  out.count = static_cast<std::size_t>(table.integer("count").value_or(1));
  out.shift = pair(table, "shift").value_or(Vec2{});
  out.turn = table.number("rotation").value_or(0);
  out.about = pair(table, "centre").value_or(Vec2{});
  if (!table.has("shift") && !table.has("rotation")) {
    table.missing("shift", "write shift = [x, y] or rotation = DEGREES with centre = [x, y]");
  }
  if (table.has("rotation") && !table.has("centre"))
    table.missing("centre", "write about which point: centre = [x, y]");
  return out;
}

void parse_body(const TableReader& body, const RockDefaults& defaults, const JointNames& joints,
                std::vector<ContactBody>& bodies, std::map<std::string, std::uint32_t>& names) {
  ContactBody spec;
  spec.line = body.line();
  spec.name = body.text("name").value_or(fmt::format("body {}", bodies.size() + 1));
  spec.fixed = body.flag("fixed");
  const auto own_young = body.number("young");
  const auto own_poisson = body.number("poisson");
  const auto own_density = body.number("density");
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
  spec.velocity = pair(body, "velocity").value_or(Vec2{});
  spec.spin = body.number("angular_velocity").value_or(0);
  for (const string_view key : {"velocity", "angular_velocity", "load"}) {
    if (spec.fixed && body.has(key)) body.error(key, "the body is fixed", "remove this key, or fixed = true");
  }
  for (const string_view key : {"velocity", "angular_velocity"}) {
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
    tables.push_back({TableReader{*table, entry.line, path, root.problems(), contact_strength_keys()},
                      entry.key == "default" ? 0 : out.size() - 1});
  }
  std::ranges::stable_sort(tables, {}, &Named::at);  // the default first: others take from it what they do not state
  for (const Named& named : tables) {
    ContactJoint& joint = out[named.at];
    joint.friction = named.table.number("friction").value_or(out[0].friction);
    joint.cohesion = named.table.number("cohesion").value_or(out[0].cohesion);
    joint.tension = named.table.number("tension").value_or(out[0].tension);
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
      s.gravity = pair(table, "gravity").value_or(Vec2{});
    } else {
      s.gravity = {0, -table.number("gravity").value_or(0)};
    }
  }
  s.to_rest = table.flag("static");
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
  s.step = table.number("step").value_or(step);
  s.max_step = table.number("max_step").value_or(s.step);
  if (!s.to_rest && std::max(s.step, s.max_step) > load_time / 5) {
    table.note(
        table.has("max_step") ? "max_step" : "step",
        fmt::format("is long for a load that changes within {:.3g} s: only its mean over each step acts", load_time),
        fmt::format("use steps of {:.2g} s", load_time / 20));
  }
  if (s.max_step < s.step) table.error("max_step", "is shorter than step", "make it as long, or longer");
  if (s.to_rest) {
    const double natural = g > 0 ? std::sqrt(size_of(scene, true) / g) : 1;
    s.duration = table.number("duration").value_or(1000 * natural);
  } else {
    if (!table.has("duration"))
      table.missing("duration", "write how long to follow the bodies, in s, or static = true");
    s.duration = table.number("duration").value_or(1);
  }
  if (s.duration / s.step > 5e7) {
    table.error(table.has("step") ? "step" : "duration", "makes more than fifty million steps",
                "use a longer step or a shorter time");
  }
  if (table.has("step") && s.step > s.duration) {
    table.error("step", "is longer than the whole time", "use a shorter step");
  }
  s.solver = table.word<ContactSolver>("solver");
  s.restitution = table.value("restitution");
  if (const TomlEntry* rigid = table.find("rigid")) {
    const auto* word = std::get_if<std::string>(&rigid->node.value);
    const auto* flag = std::get_if<bool>(&rigid->node.value);
    if (flag != nullptr) {
      s.rigidity = *flag ? Rigidity::rigid : Rigidity::elastic;
    } else if (word == nullptr || *word != "auto") {
      table.error("rigid", "must be true, false or \"auto\"", "write rigid = \"auto\"");
    }
  }
  s.plane = table.word<bem::PlaneState>("plane");
  s.element = table.number("element").value_or(0);
  s.modes = static_cast<std::size_t>(table.count("modes"));
  s.damping = table.value("damping");
  s.largest_move = table.value("max_displacement");
  s.frames = static_cast<std::size_t>(table.count("frames"));
  s.estimate = table.flag("estimate");
  if (const auto strength = table.sub("strength")) {
    s.strength = RockStrength{.cohesion = strength->need_number("cohesion").value_or(0),
                              .friction = strength->need_number("friction").value_or(0),
                              .tension = strength->need_number("tension").value_or(0)};
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
  std::size_t number = 0;
  for (const TableReader& point : table.each("points")) {
    ++number;
    if (!point.has("at")) point.missing("at", "write at = [x, y]");
    const auto at = pair(point, "at");
    if (!at) continue;
    PointSpec spec{.name = point.text("name").value_or(fmt::format("point {}", number)), .at = *at, .body = 0};
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

const KeyTable& contact_scene_keys() {
  static const KeyTable keys = [] {
    KeyTable table{.name = "contact scene", .keys = head_keys()};
    table.keys.push_back({"joints", key::named(key::table(&contact_strength_keys)), "",
                          "strength by name; `[joints.default]` for what the others do not state"});
    table.keys.push_back({"contact", key::table(&contact_keys), required, "the problem"});
    table.keys.push_back(
        {"body", key::tables(&contact_body_keys), required, "bodies that touch, slide, fall and come to rest"});
    table.steps = {{Stage::contact, {"contact", "body", "rock", "joints"}},
                   {Stage::write, {"output"}},
                   {Stage::report, {"output"}}};
    return table;
  }();
  return keys;
}

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
  const TableReader root{*tree, 1, "", problems, contact_scene_keys()};
  ContactScene scene;
  parse_plane_head(root, text, shown, scene);
  for (const TomlEntry& entry : tree->entries) scene.given.push_back(entry.key);
  const RockDefaults defaults = parse_rock_defaults(root);
  scene.joints = parse_strengths(root);
  const JointNames joints{scene.joints};
  const std::vector<TableReader> bodies = root.each("body");
  std::map<std::string, std::uint32_t> names;
  for (const TableReader& body : bodies) parse_body(body, defaults, joints, scene.bodies, names);
  if (bodies.empty()) problems.error(1, "body", "there is no body", "write at least one [[body]]");
  const TomlTable* section = root.table("contact");
  const TomlTable empty;
  const TableReader contact{section != nullptr ? *section : empty, root.line_of("contact"), "contact", problems,
                            contact_keys()};
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
