#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "body_keys.hpp"
#include "cleave/core/nearest.hpp"
#include "cleave/scene2d/contact.hpp"
#include "contact_outline.hpp"
#include "contact_parts.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;
using std::string_view;

constexpr NumberRule dilation_rule{0, false, 60, false, " degrees"};
constexpr NumberRule water_rule = rule::stress.usually(1e3, 1e8);
constexpr NumberRule joint_stiffness_rule = NumberRule{0, true, 1e18, false, " Pa/m"}.usually(1e7, 1e13);
// Sizes of rock that moves by its weight: an elastic body by itself may be of any.
constexpr NumberRule rock_density_rule = body_density_rule.usually(rule::density.usual->low, rule::density.usual->high);
constexpr NumberRule side_pressure_rule = pressure_rule.usually(1e3, 1e9);
constexpr std::array<string_view, 1> fixed_word{"fixed"};

const KeyTable& contact_strength_keys() {
  static const KeyTable keys{
      .name = "joints of bodies",
      .keys = {{"friction", key::number(rule::friction), "30", "degrees"},
               {"residual_friction", key::number(rule::friction), "`friction`",
                "degrees, where a contact has slipped or opened, and of new contacts"},
               {"cohesion", key::number(rule::strength), "0", "Pa, until a contact breaks"},
               {"residual_cohesion", key::number(rule::strength), "0",
                "Pa, where a contact of the start has slipped, until it opens"},
               {"tension", key::number(rule::strength), "0", "Pa, until a contact breaks"},
               {"dilation", key::number(dilation_rule), "0",
                "degrees, part of `friction`: faces closed at the start ride up by this when they slip"},
               {"dilation_slip", key::number(rule::length), "", "m, slip at which they rise no further"},
               {"water_pressure", key::number(water_rule), "0",
                "Pa, of water between faces closed at the start: pushes both apart on that length all the time"},
               {"water_table", key::number(rule::coordinate), "",
                "m, height of still water: adds 9810 Pa to that for each metre below it"},
               {"normal_stiffness", key::number(joint_stiffness_rule), "rigid", "Pa/m, of the joint"},
               {"shear_stiffness", key::number(joint_stiffness_rule), "`normal_stiffness`",
                "Pa/m, until friction is reached"}}};
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
        {"fixed", key::flag(), "false", "never moves, but by `motion`"},
        {"motion", key::table(&support_motion_keys), "at rest",
         "of a fixed body, beside that of the ground: `{ velocity, time }`, `{ acceleration, time }` or `{ record }`; "
         "not with `static`"},
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

void parse_loads(const TableReader& body, const ContactOutline& outline, bool of_rock, ContactBody& spec) {
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
    for (const string_view key : {"pressure", "traction"}) {
      if (of_rock) table.note_unusual(key, side_pressure_rule);
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
    return about + rotated(x - about, k * turn * std::numbers::pi / 180) + k * shift;
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

/// One body, and gravity = 0: what it is of and what acts on it may have any size.
bool alone_without_weight(const TableReader& root, const std::vector<TableReader>& bodies) {
  const TomlTable* contact = root.table("contact");
  if (contact == nullptr || bodies.size() != 1 || bodies.front().has("repeat")) return false;
  const auto gravity = std::ranges::find(contact->entries, "gravity", &TomlEntry::key);
  if (gravity == contact->entries.end()) return false;
  const auto* whole = std::get_if<std::int64_t>(&gravity->node.value);
  const auto* number = std::get_if<double>(&gravity->node.value);
  return (whole != nullptr && *whole == 0) || (number != nullptr && *number == 0);
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
  if (defaults.of_rock) body.note_unusual("density", rock_density_rule);
  const ContactOutline outline = parse_contact_outline(body);
  spec.corners = outline.corners;
  parse_side_joints(body, outline, joints, spec);
  parse_supports(body, outline, spec);
  parse_support_motion(body, spec);
  parse_loads(body, outline, defaults.of_rock, spec);
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

void parse_dilation(const TableReader& table, const ContactJoint& otherwise, ContactJoint& joint) {
  joint.dilation = table.number("dilation").value_or(otherwise.dilation);
  const auto slip = table.number("dilation_slip");
  joint.dilation_slip = slip ? Length::from_si(*slip) : otherwise.dilation_slip;
  const string_view key = table.has("dilation") ? "dilation" : table.has("friction") ? "friction" : "residual_friction";
  const double least = joint.residual_friction.value_or(joint.friction);
  if (joint.dilation > least) {
    table.error(key, fmt::format("dilation of {:g} degrees is more than the friction of {:g}", joint.dilation, least),
                "rising costs a part of friction, residual or not: make dilation less");
  }
  if (joint.dilation > 0 && !(joint.dilation_slip > Length{})) {
    table.missing("dilation_slip", "write the slip in m at which the joint rises no further");
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
    const auto stiffness = [&](string_view key, std::optional<JointStiffness> otherwise) {
      const auto stated = named.table.number(key);
      return stated ? JointStiffness::from_si(*stated) : otherwise;
    };
    joint.normal_stiffness = stiffness("normal_stiffness", out[0].normal_stiffness);
    const bool own = named.table.has("normal_stiffness");
    joint.shear_stiffness = stiffness("shear_stiffness", own ? joint.normal_stiffness : out[0].shear_stiffness);
    const bool own_cohesion = named.table.has("cohesion");
    joint.residual_cohesion = Stress::from_si(
        named.table.number("residual_cohesion").value_or(own_cohesion ? 0.0 : out[0].residual_cohesion.si()));
    if (joint.residual_cohesion.si() > joint.cohesion) {
      named.table.error("residual_cohesion", "is more than cohesion", "what has slipped holds no better: make it less");
    }
    joint.residual_friction = named.table.number("residual_friction");
    if (!joint.residual_friction && !named.table.has("friction")) joint.residual_friction = out[0].residual_friction;
    if (joint.residual_friction && *joint.residual_friction > joint.friction) {
      named.table.error("residual_friction", "is more than friction", "what has slipped holds no better: make it less");
    }
    parse_dilation(named.table, out[0], joint);
    joint.water_pressure = Stress::from_si(named.table.number("water_pressure").value_or(out[0].water_pressure.si()));
    joint.water_table = out[0].water_table;
    if (const auto table = named.table.number("water_table")) joint.water_table = Length::from_si(*table);
  }
  const auto states = [](const Named& named) { return named.table.has("friction"); };
  if (std::ranges::any_of(tables, [&](const Named& named) { return named.at == 0 && states(named); })) return out;
  for (const Named& named : tables) {
    if (states(named)) continue;
    root.problems().note(named.table.line(), named.table.path(), "states no friction: 30 degrees is taken",
                         "write friction = DEGREES there, or in [joints.default]");
  }
  return out;
}

/// What bodies rub by, stated or not. A table of strengths that no side has is most likely a name that was misspelt.
void check_joints_used(const TableReader& root, const ContactScene& scene) {
  const TomlTable* found = root.table("joints");
  if (root.problems().errors() != 0) return;
  if (found == nullptr || found->entries.empty()) {
    if (scene.bodies.size() < 2) return;
    root.note("joints", "no strength is stated: friction 30 degrees, no cohesion, no tension",
              "write [joints.default] with friction = DEGREES");
    return;
  }
  std::vector<std::uint8_t> used(scene.joints.size(), 0);
  used.front() = 1;
  for (const ContactBody& body : scene.bodies) {
    for (const std::size_t joint : body.joint) used[joint] = 1;
  }
  std::vector<string_view> names;
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (used[k] != 0) names.emplace_back(scene.joints[k].name);
  }
  for (const TomlEntry& entry : found->entries) {
    if (std::ranges::find(names, entry.key) != names.end()) continue;
    report_unused_joints(root.problems(), entry.line, entry.key, names, "no side of a body has this joint",
                         "remove it, or name it in joint of a body");
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
    table.keys.push_back({"bolt", key::tables(&contact_bolt_keys), "[]", "bolts that hold bodies together"});
    table.steps = {{Step::contact, {"contact", "body", "rock", "joints", "bolt"}},
                   {Step::write, {"output"}},
                   {Step::report, {"project", "output"}}};
    return table;
  }();
  return keys;
}

std::optional<Kind2d> kind2d_of(string_view text) {
  const auto tree = read_toml(text);
  if (!tree) return std::nullopt;
  const auto has = [&](string_view key) {
    return std::ranges::find(tree->entries, key, &TomlEntry::key) != tree->entries.end();
  };
  if (has("domain") || has("joint") || has("joint_set")) return std::nullopt;
  if (has("contact")) return Kind2d::contact;
  return has("body") ? std::optional{Kind2d::elastic} : std::nullopt;
}

std::expected<ContactScene, std::vector<Problem>> parse_contact(string_view text, const std::string& shown) {
  Problems problems{shown};
  auto tree = read_toml(text);
  if (!tree) {
    problems.error(tree.error().line, "TOML", tree.error().what, tree.error().remedy);
    return std::unexpected(std::move(problems).take_errors());
  }
  const TableReader root{*tree, 1, "", problems, contact_scene_keys()};
  ContactScene scene;
  parse_plane_head(root, text, shown, scene);
  for (const TomlEntry& entry : tree->entries) scene.given.push_back(entry.key);
  const std::vector<TableReader> bodies = root.each("body");
  const bool of_rock = !alone_without_weight(root, bodies);
  RockDefaults defaults = parse_rock_defaults(root, of_rock ? rock_density_rule : body_density_rule);
  defaults.of_rock = of_rock;
  scene.joints = parse_strengths(root);
  const JointNames joints{scene.joints};
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
    parse_bolts(root, scene);
    check_elastic(scene, contact, problems);
  }
  check_joints_used(root, scene);
  if (problems.errors() == 0) {
    check_elements(scene, contact, problems);
    check_forces(scene, problems);
    check_rest(scene, problems);
    check_overlaps(scene, problems);
    note_water(root, scene);
  }
  if (!scene.bodies.empty() && std::ranges::all_of(scene.bodies, &ContactBody::fixed)) {
    problems.note(1, "body", "every body is fixed: nothing will move", "remove fixed = true where a body may move");
  }
  if (problems.errors() != 0) return std::unexpected(std::move(problems).take_errors());
  scene.notes = std::move(problems).take_notes();
  return scene;
}

}  // namespace cleave::scene
