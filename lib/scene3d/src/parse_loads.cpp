#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "cleave/core/nearest.hpp"
#include "cleave/scene3d/key_tables.hpp"
#include "context.hpp"

namespace cleave::scene {
namespace {

using stability::AnyFreeFace;
using stability::FreeSurface;
using std::string_view;

constexpr NumberRule pressure_rule = NumberRule{-1e15, false, 1e15, false, " Pa"}.usually(1e3, 1e9);
constexpr NumberRule joint_pressure_rule = rule::stress.usually(1e3, 1e8);
constexpr NumberRule force_rule = NumberRule{-1e15, false, 1e15, false, " N"}.usually(1e3, 1e11);
constexpr NumberRule line_force_rule = NumberRule{-1e15, false, 1e15, false, " N/m"}.usually(1e3, 1e11);
constexpr NumberRule seismic_rule =
    rule::ratio.usually(1e-3, 1, "it is a share of the weight: divide m/s2 by 9.81, per cent by 100");
constexpr NumberRule weight_rule = NumberRule{0, false, 1e5, false, " N/m3"}.usually(5000, 50000);
constexpr NumberRule combine_rule{0, false, 1e3, false, ""};

const KeyTable& water_keys() {
  static const KeyTable keys{
      .name = "water",
      .keys = {
          {"table", number_or_law<rule::coordinate>(), "",
           "level of the water table, m; a law: one level a realization (a single run has that of realization 0)"},
          {"flow", key::flag(), "false",
           "true: the pressures that [flow] finds in the joints, in place of a table; in runs without stages"},
          {"unit_weight", key::number(weight_rule), "9810", "N/m3"},
          {"free_faces", key::flag(), "false", "true: water also presses on free faces (a lake, a flooded opening)"},
          {"pressures", key::named(key::number(joint_pressure_rule)), "",
           "`{ SET = Pa }`: the mean pressure in all joints of a set, in place of the table; `default` is that of all "
           "sets that are not named"}}};
  return keys;
}

const KeyTable& surcharge_keys() {
  static const KeyTable keys{.name = "surcharge",
                             .keys = {{"on", key::text(), "\"all\"", "an excavation or a face of the domain"},
                                      {"within", key::table(&box_keys), "", "a box that cuts the loaded area out"},
                                      {"traction", key::vector(pressure_rule), "", "Pa, `[x, y, z]`"},
                                      {"pressure", key::number(pressure_rule), "", "Pa, against the rock"}}};
  return keys;
}

const KeyTable& point_keys() {
  static const KeyTable keys{
      .name = "point",
      .keys = {{"at", key::vector(rule::coordinate), required, "m; a free face must lie within 5 cm"},
               {"force", key::vector(force_rule), required, "N"}}};
  return keys;
}

const KeyTable& line_keys() {
  static const KeyTable keys{.name = "line",
                             .keys = {{"from", key::vector(rule::coordinate), required, "m"},
                                      {"to", key::vector(rule::coordinate), required, "m"},
                                      {"force_per_metre", key::vector(line_force_rule), required, "N/m"}}};
  return keys;
}

/// Pressures by set; `default` is that of all sets that are not named, as in [joints.default].
void parse_pressures(const Context& context, const TableReader& water, StatedLoads& loads) {
  const TomlTable* pressures = water.table("pressures");
  if (pressures == nullptr) return;
  std::vector<string_view> names;
  for (const NamedSet& set : context.sets) names.emplace_back(set.name);
  std::optional<double> of_the_rest;
  std::set<SetId> named;
  for (const TomlEntry& entry : pressures->entries) {
    const std::string path = water.path_of("pressures") + "." + entry.key;
    const auto value = water.number_of(entry.node, path, joint_pressure_rule);
    if (entry.key == "default") {
      of_the_rest = value;
      continue;
    }
    const auto at = std::ranges::find(names, string_view{entry.key});
    if (at == names.end()) {
      const auto guess = nearest(entry.key, names);
      water.problems().error(entry.line, path, "no joint belongs to this set",
                             guess ? fmt::format("did you mean \"{}\"?", *guess) : "remove it, or name a set so");
      continue;
    }
    const SetId set{static_cast<std::size_t>(at - names.begin())};
    named.insert(set);
    if (value) loads.pressures.push_back({set, *value});
  }
  if (!of_the_rest) return;
  for (const SetId set : context.sets.ids()) {
    if (!named.contains(set)) loads.pressures.push_back({set, *of_the_rest});
  }
}

std::optional<stability::WaterTable> parse_water(const Context& context, const TableReader& owner, StatedLoads& loads) {
  const auto found = owner.sub("water");
  if (!found) return std::nullopt;
  const TableReader& table = *found;
  const bool by_flow = table.flag("flow");
  if (!table.has("table") && !table.has("pressures") && !by_flow) {
    table.missing("table", "add table = 20.0 (its level, m), pressures = { SET = Pa }, or flow = true beside [flow]");
  }
  for (const string_view key : {"table", "pressures", "free_faces"}) {
    if (by_flow && table.has(key))
      table.error(key, "stands beside flow = true", "the pressures are those of [flow]: remove one");
  }
  parse_pressures(context, table, loads);
  const auto law = parse_number_law(table, "table", -1e12, 1e12);
  const auto level = law ? std::optional{law->quantile(0.5)} : std::nullopt;
  if (law && law->kind != FrictionLaw::Kind::constant) loads.water_level = *law;
  const UnitWeight unit_weight = newtons_per_cubic_metre(table.value("unit_weight"));
  const bool free_faces = table.flag("free_faces");
  if (by_flow) {
    loads.flow = unit_weight;
    return std::nullopt;
  }
  if (!level) {
    for (const string_view key : {"unit_weight", "free_faces"}) {
      if (!table.has("table") && table.has(key)) table.error(key, "has a meaning beside table only", "remove it");
    }
    return std::nullopt;
  }
  return stability::WaterTable{.level = *level, .unit_weight = unit_weight, .on_free_faces = free_faces};
}

std::optional<stability::Box> parse_within(const TableReader& owner) {
  const auto table = owner.sub("within");
  if (!table) return std::nullopt;
  const auto min = table->need_vec3("min"), max = table->need_vec3("max");
  if (!min || !max) return std::nullopt;
  if (!(min->x < max->x && min->y < max->y && min->z < max->z)) {
    table->error("max", "is not above min on each axis", "swap them");
    return std::nullopt;
  }
  return stability::Box{*min, *max};
}

void parse_surcharge(const TableReader& table, const std::optional<geometry::Solid>& domain,
                     const std::vector<Excavation>& excavations, StatedLoads& loads) {
  const auto surface = free_surface(table, "on", table.text("on").value_or("all"), domain, excavations);
  const auto traction = table.vec3("traction");
  const auto pressure = table.number("pressure");
  if (pressure && *pressure < 0) {
    table.note("pressure", "is below 0: it pulls at the rock", "what presses against the rock is positive");
  }
  if (!table.has("traction") && !table.has("pressure")) {
    table.missing("traction", "add traction = [x, y, z] (Pa) or pressure (Pa, against the rock)");
  }
  const auto box = parse_within(table);
  if (!surface) return;
  loads.surcharges.push_back({.on = *surface,
                              .within = box,
                              .traction = traction.value_or(geometry::Vec3{}),
                              .pressure = pascals(pressure.value_or(0))});
}

/// Of two pressures of a set the larger; where one of both has a table in its place, the larger of pressure and table
/// on each contact: nowhere less than either presses.
void add_pressures(StatedLoads& sum, const StatedLoads& part, double factor) {
  const auto find = [](StatedLoads& loads, SetId set) {
    return std::ranges::find(loads.pressures, set, &StatedLoads::SetPressure::set);
  };
  StatedLoads other = part;
  for (StatedLoads::SetPressure& entry : sum.pressures) {
    if (part.water && find(other, entry.set) == other.pressures.end()) entry.or_table = true;
  }
  for (StatedLoads::SetPressure entry : part.pressures) {
    entry.pa *= factor;
    const auto same = find(sum, entry.set);
    if (same == sum.pressures.end()) {
      entry.or_table = entry.or_table || sum.water.has_value();
      sum.pressures.push_back(entry);
    } else {
      same->pa = std::max(same->pa, entry.pa);
      same->or_table = same->or_table || entry.or_table;
    }
  }
}

void add(StatedLoads& sum, const StatedLoads& part, double factor) {
  add_pressures(sum, part, factor);
  sum.seismic += factor * part.seismic;
  if (part.flow) sum.flow = std::max(sum.flow.value_or(UnitWeight{}), factor * *part.flow);
  if (part.water) {
    stability::WaterTable water = *part.water;
    water.unit_weight *= factor;
    // Of two tables the level of the higher one and the larger unit weight: nowhere less than either presses, also
    // where a factor has made the higher one light.
    if (sum.water) {
      water.unit_weight = std::max(water.unit_weight, sum.water->unit_weight);
      water.on_free_faces = water.on_free_faces || sum.water->on_free_faces;
    }
    if (!sum.water || water.level > sum.water->level) {
      sum.water_level = part.water_level;
    } else {
      water.level = sum.water->level;
    }
    sum.water = water;
  }
  for (stability::Surcharge load : part.surcharges) {
    load.traction = factor * load.traction;
    load.pressure *= factor;
    sum.surcharges.push_back(load);
  }
  for (stability::PointForce load : part.points) {
    load.force = factor * load.force;
    sum.points.push_back(load);
  }
  for (stability::LineForce load : part.lines) {
    load.per_metre = factor * load.per_metre;
    sum.lines.push_back(load);
  }
}

const KeyTable& case_target_keys() {
  static const KeyTable keys{.name = "load_target",
                             .keys = {{"falling", key::number(rule::factor), "", "also of lifting"},
                                      {"sliding", key::number(rule::factor), "", "also of wedges"}}};
  return keys;
}

/// What it does not state is that of [stability].
std::optional<Targets> parse_case_target(const TableReader& load, const std::optional<Targets>& base) {
  const auto table = load.sub("target");
  if (!table) return std::nullopt;
  Targets out = base.value_or(Targets{});
  const auto take = [&](std::string_view key, double& factor) {
    const auto stated = table->number(key);
    if (!stated) return;
    factor = *stated;
    if (factor < 1) table->note(key, "asks for a factor of safety below 1", "what moves would meet it");
  };
  take("falling", out.falling);
  take("sliding", out.sliding);
  return out;
}

}  // namespace

std::optional<FreeSurface> free_surface(const TableReader& table, string_view key, const std::string& name,
                                        const std::optional<geometry::Solid>& domain,
                                        const std::vector<Excavation>& excavations) {
  if (name == "all") return AnyFreeFace{};
  std::vector<string_view> known{"all"};
  for (std::uint32_t i = 0; i < excavations.size(); ++i) {
    if (excavations[i].name == name) return stability::ExcavationWall{i};
    known.emplace_back(excavations[i].name);
  }
  if (domain) {
    for (std::uint32_t tag = 0; tag < domain->tags().size(); ++tag) {
      if (domain->tags()[tag] == name) return stability::DomainSide{tag};
      known.emplace_back(domain->tags()[tag]);
    }
  }
  if (table.problems().is_unread(name)) return std::nullopt;
  const auto guess = nearest(name, known);
  table.error(key, fmt::format("\"{}\" is neither an excavation nor a face of the domain", name.substr(0, 60)),
              guess ? fmt::format("did you mean \"{}\"?", *guess) : "write \"all\" for every free face");
  return std::nullopt;
}

std::vector<Key> load_set_keys() {
  return {
      {"seismic", key::vector(seismic_rule), "[0, 0, 0]", "pseudo-static force / weight, in the direction given"},
      {"water", key::table(&water_keys), "",
       "`{ table, unit_weight = 9810, free_faces = false, pressures = { SET = Pa, default = Pa }, flow = false }`, "
       "below"},
      {"surcharge", key::tables(&surcharge_keys), "",
       "`[{ on = \"all\", within = { min, max }, traction = [x, y, z], pressure }]`: Pa on free faces; `on` names an "
       "excavation or a face of the domain, `within` a box that cuts the loaded area out; `pressure` acts against "
       "the rock"},
      {"point", key::tables(&point_keys), "",
       "`[{ at = [x, y, z], force = [x, y, z] }]`, N; a free face must lie within 5 cm, else the run ends with 2"},
      {"line", key::tables(&line_keys), "",
       "`[{ from, to, force_per_metre }]`, N/m along a straight line on free faces"}};
}

const KeyTable& load_keys() {
  static const KeyTable keys = [] {
    KeyTable table{
        .name = "load",
        .keys = {{"name", key::text(), required, "of the case"},
                 {"combine", key::named(key::number(combine_rule)), "",
                  "`{ NAME = factor }` adds earlier cases times a factor; of two water tables the higher "
                  "level and the larger unit weight count, of two pressures of a set the larger; where one case has a "
                  "pressure and another a table, what presses more on each contact"}}};
    for (Key& key : load_set_keys()) table.keys.push_back(std::move(key));
    table.keys.push_back({"target", key::table(&case_target_keys), "",
                          "`{ falling = 1.2, sliding = 1.1 }`: required factors of safety under this load, say of an "
                          "earthquake; what is left out is that of `[stability]`"});
    return table;
  }();
  return keys;
}

StatedLoads parse_load_set(const Context& context, const TableReader& table,
                           const std::optional<geometry::Solid>& domain, const std::vector<Excavation>& excavations) {
  StatedLoads loads{.line = table.line()};
  if (const auto seismic = table.vec3("seismic")) loads.seismic = *seismic;
  loads.water = parse_water(context, table, loads);
  for (const TableReader& t : table.each("surcharge")) parse_surcharge(t, domain, excavations, loads);
  for (const TableReader& t : table.each("point")) {
    const auto at = t.need_vec3("at"), force = t.need_vec3("force");
    if (at && force) loads.points.push_back({*at, *force});
  }
  for (const TableReader& t : table.each("line")) {
    const auto from = t.need_vec3("from"), to = t.need_vec3("to");
    const auto force = t.need_vec3("force_per_metre");
    if (!from || !to || !force) continue;
    if (*from == *to) {
      t.error("to", "is the same point as from", "use point = { at, force }");
      continue;
    }
    loads.lines.push_back({*from, *to, *force});
  }
  return loads;
}

LoadSet checked(const Context& context, const StatedLoads& loads, geometry::Vec3 gravity) {
  LoadSet out{.water_level = loads.water_level, .flow = loads.flow, .line = loads.line};
  if (loads.flow && (loads.water || !loads.pressures.empty())) {
    context.problems.error(loads.line, "water", "is that of [flow] and a table or pressures as well",
                           "give one of them: both press in the same joints");
  }
  if (loads.flow && (gravity.x != 0 || gravity.y != 0 || gravity.z > 0)) {
    context.problems.error(loads.line, "water.flow", "needs gravity straight down: heads of [flow] are counted along z",
                           "give a table, or leave gravity at its default");
  }
  if (const auto body = stability::Loads::make(gravity, loads.seismic)) {
    out.body = *body;
  } else {
    context.problems.error(loads.line, "seismic", describe(body.error()), "");
  }
  stability::ActionSpec spec{.water = loads.water,
                             .joint_pressure = {},
                             .or_table = {},
                             .flow = {},
                             .surcharges = loads.surcharges,
                             .points = loads.points,
                             .lines = loads.lines};
  if (!loads.pressures.empty()) {
    spec.joint_pressure.resize(context.sets.size());
    spec.or_table.resize(context.sets.size());
  }
  for (const StatedLoads::SetPressure& entry : loads.pressures) {
    spec.joint_pressure[entry.set.index()] = entry.pa;
    spec.or_table[entry.set.index()] = entry.or_table ? 1 : 0;
  }
  if (auto actions = stability::Actions::make(std::move(spec))) {
    out.actions = *std::move(actions);
  } else {
    context.problems.error(loads.line, actions.error().which, actions.error().what, "");
  }
  return out;
}

std::vector<LoadCase> parse_load_cases(const Context& context, const TableReader& root,
                                       const std::optional<geometry::Solid>& domain,
                                       const std::vector<Excavation>& excavations, const StatedLoads& base,
                                       const std::optional<Targets>& target, geometry::Vec3 gravity) {
  std::vector<LoadCase> cases;
  std::vector<StatedLoads> own;
  for (const TableReader& table : root.each("load")) {
    const auto name = table.need_text("name");
    StatedLoads loads = parse_load_set(context, table, domain, excavations);
    if (table.has("seismic") && loads.seismic == geometry::Vec3{} && base.seismic != geometry::Vec3{}) {
      table.note("seismic", "adds nothing to the earthquake of [stability], which acts in this case as well",
                 "for a case without it, move it from [stability] to a [[load]] of its own");
    }
    if (const TomlTable* combine = table.table("combine")) {
      for (const TomlEntry& entry : combine->entries) {
        const std::string path = table.path_of("combine") + "." + entry.key;
        const auto factor = table.number_of(entry.node, path, combine_rule);
        const auto other = std::ranges::find(cases, entry.key, &LoadCase::name);
        if (other == cases.end()) {
          root.problems().error(entry.line, path, "is no load that stands before this one",
                                "name an earlier [[load]], with a factor: combine = { rain = 1.0 }");
        } else if (factor) {
          add(loads, own[static_cast<std::size_t>(other - cases.begin())], *factor);
        }
      }
    }
    if (!name) continue;
    if (*name == "base" || std::ranges::find(cases, *name, &LoadCase::name) != cases.end()) {
      table.error("name", fmt::format("\"{}\" is taken", name->substr(0, 60)),
                  *name == "base" ? "base is the case of [stability] alone" : "give each load its own name");
      continue;
    }
    own.push_back(loads);
    StatedLoads total = base;
    // Water of the case takes the place of that of [stability]; forces add up.
    if (loads.water || loads.flow) {
      if (loads.water && table.has("combine") && base.water && loads.water->unit_weight < base.water->unit_weight) {
        table.note("combine", "makes water lighter than that of [stability], whose place it takes",
                   "where that lies deep it presses less: give this load a water of its own");
      }
      total.water.reset();
      total.flow.reset();
      total.water_level.reset();
      total.pressures.clear();
    }
    // Pressures alone leave the table and other sets as they are.
    for (const StatedLoads::SetPressure& entry : loads.pressures) {
      std::erase_if(total.pressures, [&](const auto& other) { return other.set == entry.set; });
    }
    std::vector<StatedLoads::SetPressure> pressures = std::move(total.pressures);
    pressures.insert(pressures.end(), loads.pressures.begin(), loads.pressures.end());
    add(total, loads, 1);
    total.pressures = std::move(pressures);
    total.line = table.line();
    cases.push_back({*name, checked(context, total, gravity), parse_case_target(table, target)});
  }
  return cases;
}

}  // namespace cleave::scene
