#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "context.hpp"
#include "nearest.hpp"

namespace cleave::scene {
namespace {

using stability::AnyFreeFace;
using stability::FreeSurface;
using std::string_view;

constexpr NumberRule pressure_rule{-1e15, false, 1e15, false, " Pa"};
constexpr NumberRule force_rule{-1e15, false, 1e15, false, " N"};

std::optional<FreeSurface> parse_surface(const TableReader& table, const std::optional<geometry::Solid>& domain,
                                         const std::vector<Excavation>& excavations) {
  const auto name = table.text("on");
  if (!name || *name == "all") return AnyFreeFace{};
  std::vector<string_view> known{"all"};
  for (std::uint32_t i = 0; i < excavations.size(); ++i) {
    if (excavations[i].name == *name) return stability::ExcavationWall{i};
    known.emplace_back(excavations[i].name);
  }
  if (domain) {
    for (std::uint32_t tag = 0; tag < domain->tags().size(); ++tag) {
      if (domain->tags()[tag] == *name) return stability::DomainSide{tag};
      known.emplace_back(domain->tags()[tag]);
    }
  }
  const auto guess = nearest(*name, known);
  table.error("on", fmt::format("\"{}\" is neither an excavation nor a face of the domain", name->substr(0, 60)),
              guess ? fmt::format("did you mean \"{}\"?", *guess) : "write \"all\" for every free face");
  return std::nullopt;
}

std::optional<stability::WaterTable> parse_water(const Context& context, const TableReader& owner, LoadSet& loads) {
  const TomlTable* found = owner.table("water");
  if (found == nullptr) return std::nullopt;
  constexpr std::array<string_view, 4> keys{"table", "unit_weight", "free_faces", "pressures"};
  constexpr NumberRule weight{0, false, 1e5, false, " N/m3"};
  const TableReader table{*found, owner.line_of("water"), owner.path_of("water"), owner.problems(), keys};
  if (!table.has("table") && !table.has("pressures")) {
    table.missing("table", "add table = 20.0 (its level, m) or pressures = { SET = Pa }");
  }
  if (const TomlTable* pressures = table.table("pressures")) {
    for (const TomlEntry& entry : pressures->entries) {
      const auto value = table.number_of(entry.node, table.path_of("pressures") + "." + entry.key, rule::stress);
      std::optional<SetId> set;
      std::vector<string_view> names;
      for (const SetId id : context.sets.ids()) {
        if (context.sets[id].name == entry.key) set = id;
        names.emplace_back(context.sets[id].name);
      }
      if (!set) {
        const auto guess = nearest(entry.key, names);
        owner.problems().error(entry.line, table.path_of("pressures") + "." + entry.key, "no joint belongs to this set",
                               guess ? fmt::format("did you mean \"{}\"?", *guess) : "remove it, or name a set so");
      } else if (value) {
        loads.pressures.emplace_back(*set, *value);
      }
    }
  }
  const auto law = parse_number_law(table, "table", rule::coordinate, -1e12, 1e12);
  const auto level = law ? std::optional{law->quantile(0.5)} : std::nullopt;
  if (law && law->kind != FrictionLaw::Kind::constant) loads.water_level = *law;
  const auto unit_weight = table.number("unit_weight", weight);
  const auto free_faces = table.boolean("free_faces");
  if (!level) {
    for (const string_view key : {"unit_weight", "free_faces"}) {
      if (!table.has("table") && table.has(key)) table.error(key, "has a meaning beside table only", "remove it");
    }
    return std::nullopt;
  }
  return stability::WaterTable{
      .level = *level, .unit_weight = unit_weight.value_or(9810), .on_free_faces = free_faces.value_or(false)};
}

std::optional<stability::Box> parse_within(const TableReader& owner) {
  const TomlTable* found = owner.table("within");
  if (found == nullptr) return std::nullopt;
  constexpr std::array<string_view, 2> keys{"min", "max"};
  const TableReader table{*found, owner.line_of("within"), owner.path_of("within"), owner.problems(), keys};
  const auto min = table.need_vec3("min", rule::coordinate), max = table.need_vec3("max", rule::coordinate);
  if (!min || !max) return std::nullopt;
  if (!(min->x < max->x && min->y < max->y && min->z < max->z)) {
    table.error("max", "is not above min on each axis", "swap them");
    return std::nullopt;
  }
  return stability::Box{*min, *max};
}

void parse_surcharge(const TableReader& table, const std::optional<geometry::Solid>& domain,
                     const std::vector<Excavation>& excavations, LoadSet& loads) {
  const auto surface = parse_surface(table, domain, excavations);
  const auto traction = table.vec3("traction", pressure_rule);
  const auto pressure = table.number("pressure", pressure_rule);
  if (!table.has("traction") && !table.has("pressure")) {
    table.missing("traction", "add traction = [x, y, z] (Pa) or pressure (Pa, against the rock)");
  }
  const auto box = parse_within(table);
  if (!surface) return;
  loads.surcharges.push_back({.on = *surface,
                              .within = box,
                              .traction = traction.value_or(geometry::Vec3{}),
                              .pressure = pressure.value_or(0)});
}

void add(LoadSet& sum, const LoadSet& part, double factor) {
  sum.seismic += factor * part.seismic;
  if (part.water) {
    stability::WaterTable water = *part.water;
    water.unit_weight *= factor;
    // Two tables: the one that presses more anywhere they differ is the higher one.
    if (!sum.water || water.level > sum.water->level) {
      sum.water = water;
      sum.water_level = part.water_level;
    }
  }
  for (const auto& [set, pressure] : part.pressures) {
    const auto same = std::ranges::find(sum.pressures, set, &std::pair<SetId, double>::first);
    if (same == sum.pressures.end()) {
      sum.pressures.emplace_back(set, factor * pressure);
    } else {
      same->second = std::max(same->second, factor * pressure);
    }
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

}  // namespace

LoadSet parse_load_set(const Context& context, const TableReader& table, const std::optional<geometry::Solid>& domain,
                       const std::vector<Excavation>& excavations) {
  LoadSet loads{.line = table.line()};
  if (const auto seismic = table.vec3("seismic", rule::ratio)) loads.seismic = *seismic;
  loads.water = parse_water(context, table, loads);
  const auto each = [&](string_view key, std::span<const string_view> keys, auto&& parse) {
    const auto nodes = table.tables(key);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      parse(TableReader{*std::get_if<TomlTable>(&nodes[i]->value), nodes[i]->line,
                        fmt::format("{}[{}]", table.path_of(key), i + 1), table.problems(), keys});
    }
  };
  constexpr std::array<string_view, 4> surcharge_keys{"on", "within", "traction", "pressure"};
  constexpr std::array<string_view, 2> point_keys{"at", "force"};
  constexpr std::array<string_view, 3> line_keys{"from", "to", "force_per_metre"};
  each("surcharge", surcharge_keys, [&](const TableReader& t) { parse_surcharge(t, domain, excavations, loads); });
  each("point", point_keys, [&](const TableReader& t) {
    const auto at = t.need_vec3("at", rule::coordinate), force = t.need_vec3("force", force_rule);
    if (at && force) loads.points.push_back({*at, *force});
  });
  each("line", line_keys, [&](const TableReader& t) {
    const auto from = t.need_vec3("from", rule::coordinate), to = t.need_vec3("to", rule::coordinate);
    const auto force = t.need_vec3("force_per_metre", force_rule);
    if (!from || !to || !force) return;
    if (*from == *to) {
      t.error("to", "is the same point as from", "use point = { at, force }");
      return;
    }
    loads.lines.push_back({*from, *to, *force});
  });
  return loads;
}

std::vector<LoadCase> parse_load_cases(const Context& context, const TableReader& root,
                                       const std::optional<geometry::Solid>& domain,
                                       const std::vector<Excavation>& excavations, const LoadSet& base) {
  constexpr std::array<string_view, 7> keys{"name", "combine", "seismic", "water", "surcharge", "point", "line"};
  constexpr NumberRule factor_rule{0, false, 1e3, false, ""};
  std::vector<LoadCase> cases;
  std::vector<LoadSet> own;
  const auto found = root.tables("load");
  for (std::size_t i = 0; i < found.size(); ++i) {
    const TableReader table{*std::get_if<TomlTable>(&found[i]->value), found[i]->line, fmt::format("load[{}]", i + 1),
                            root.problems(), keys};
    const auto name = table.need_text("name");
    LoadSet loads = parse_load_set(context, table, domain, excavations);
    if (const TomlTable* combine = table.table("combine")) {
      for (const TomlEntry& entry : combine->entries) {
        const std::string path = table.path_of("combine") + "." + entry.key;
        const auto factor = table.number_of(entry.node, path, factor_rule);
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
    LoadSet total = base;
    // Water of the case takes the place of that of [stability]; forces add up.
    if (loads.water) {
      total.water.reset();
      total.water_level.reset();
    }
    for (const auto& [set, pressure] : loads.pressures) {
      static_cast<void>(pressure);
      std::erase_if(total.pressures, [&](const auto& entry) { return entry.first == set; });
    }
    add(total, loads, 1);
    total.line = found[i]->line;
    cases.push_back({*name, std::move(total)});
  }
  return cases;
}

}  // namespace cleave::scene
