#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "cleave/core/overloaded.hpp"
#include "cleave/geometry/orientation.hpp"
#include "context.hpp"
#include "nearest.hpp"

namespace cleave::scene {
namespace {

using geometry::Vec3;
using std::string_view;

constexpr NumberRule capacity_rule{0, false, 1e12, false, ""};

/// Keys length, tendon, plate, bond, anchorage.
std::optional<stability::BoltType> parse_type(const TableReader& table) {
  const auto tendon = table.need_number("tendon", capacity_rule);
  const auto bond = table.need_number("bond", capacity_rule);
  const auto anchorage = table.need_number("anchorage", rule::length_or_zero);
  const auto plate = table.number("plate", capacity_rule);
  if (!tendon || !bond || !anchorage) return std::nullopt;
  return stability::BoltType{.tendon = *tendon, .plate = plate.value_or(0), .bond = *bond, .anchorage = *anchorage};
}

std::optional<std::array<double, 2>> pair_of(const TableReader& table, string_view key, const NumberRule& rule) {
  const TomlEntry* entry = table.find(key);
  if (entry == nullptr) return std::nullopt;
  const auto* array = std::get_if<TomlArray>(&entry->node.value);
  if (array == nullptr || array->items.size() != 2) {
    table.error(key, "must be two numbers", "write [2.5, 2.0]");
    return std::nullopt;
  }
  const auto a = table.number_of(array->items[0], table.path_of(key) + "[1]", rule);
  const auto b = table.number_of(array->items[1], table.path_of(key) + "[2]", rule);
  if (!a || !b) return std::nullopt;
  return std::array{*a, *b};
}

void parse_rings(const TableReader& table, const std::vector<Excavation>& excavations, stability::RingPattern ring,
                 SupportSettings& support) {
  const auto name = table.text("tunnel");
  const auto spacing = pair_of(table, "spacing", rule::length);
  if (!table.has("spacing")) table.missing("spacing", "add spacing = [along the axis, around the section], m");
  const auto offset = pair_of(table, "offset", rule::length_or_zero);
  constexpr NumberRule angle{-180, false, 180, false, " degrees"};
  constexpr NumberRule tilt{-80, false, 80, false, " degrees"};
  const auto arc = pair_of(table, "arc", angle);
  if (arc && !((*arc)[0] < (*arc)[1])) table.error("arc", "its first angle is not below its second", "swap them");
  const auto stagger = table.boolean("stagger");
  const auto inclination = table.number("inclination", tilt);
  if (!name || !spacing) return;
  std::vector<string_view> known;
  for (const Excavation& excavation : excavations) {
    if (excavation.tunnel) known.emplace_back(excavation.name);
    if (!excavation.tunnel || excavation.name != *name) continue;
    ring.axis = excavation.tunnel->axis;
    ring.up = excavation.tunnel->up;
    ring.outline = excavation.tunnel->outline;
    ring.along = (*spacing)[0];
    ring.around = (*spacing)[1];
    ring.offset_along = offset ? (*offset)[0] : 0;
    ring.offset_around = offset ? (*offset)[1] : 0;
    if (arc) ring.arc = *arc;
    ring.stagger = stagger.value_or(false);
    ring.inclination = inclination.value_or(0);
    const auto bolts = bolts_of(ring);
    if (bolts.size() > 200'000) {
      table.error("spacing", fmt::format("makes {} bolts", bolts.size()), "space them wider");
      return;
    }
    support.plan.bolts.insert(support.plan.bolts.end(), bolts.begin(), bolts.end());
    support.patterns.emplace_back(std::move(ring));
    return;
  }
  const auto guess = nearest(*name, known);
  table.error("tunnel", fmt::format("\"{}\" is no excavation of kind \"tunnel\"", name->substr(0, 60)),
              guess ? fmt::format("did you mean \"{}\"?", *guess) : "name an [[excavation]] of that kind");
}

void parse_grid(const TableReader& owner, stability::GridPattern grid, SupportSettings& support) {
  const TomlTable* found = owner.table("grid");
  const auto spacing = pair_of(owner, "spacing", rule::length);
  if (!owner.has("spacing")) owner.missing("spacing", "add spacing = [across, down the dip], m");
  const auto offset = pair_of(owner, "offset", rule::length_or_zero);
  const auto stagger = owner.boolean("stagger");
  constexpr NumberRule tilt{-89, false, 89, false, " degrees"};
  const auto plunge = owner.number("plunge", tilt);
  if (found == nullptr) return;
  constexpr std::array<string_view, 5> keys{"corner", "dip", "dip_direction", "width", "height"};
  const TableReader table{*found, owner.line_of("grid"), owner.path_of("grid"), owner.problems(), keys};
  const auto corner = table.need_vec3("corner", rule::coordinate);
  const auto dip = table.need_number("dip", rule::dip);
  const auto direction = table.need_number("dip_direction", rule::dip_direction);
  const auto width = table.need_number("width", rule::length), height = table.need_number("height", rule::length);
  if (!corner || !dip || !direction || !width || !height || !spacing) return;
  const Vec3 normal =
      geometry::upward_normal({Dip::degrees(*dip), DipDirection::degrees(*direction == 360 ? 0 : *direction)});
  const double a = *direction * (3.14159265358979323846 / 180), d = *dip * (3.14159265358979323846 / 180);
  grid.corner = *corner;
  grid.down = {std::cos(d) * std::sin(a), std::cos(d) * std::cos(a), -std::sin(d)};
  grid.across = geometry::cross(normal, grid.down);
  grid.width = *width;
  grid.height = *height;
  grid.spacing_across = (*spacing)[0];
  grid.spacing_down = (*spacing)[1];
  grid.offset_across = offset ? (*offset)[0] : 0;
  grid.offset_down = offset ? (*offset)[1] : 0;
  grid.stagger = stagger.value_or(false);
  if (plunge) {
    const double p = *plunge * (3.14159265358979323846 / 180);
    grid.direction = {-std::cos(p) * std::sin(a), -std::cos(p) * std::cos(a), -std::sin(p)};
  } else {
    grid.direction = -normal;
  }
  const auto bolts = bolts_of(grid);
  if (bolts.size() > 200'000) {
    owner.error("spacing", fmt::format("makes {} bolts", bolts.size()), "space them wider");
    return;
  }
  support.plan.bolts.insert(support.plan.bolts.end(), bolts.begin(), bolts.end());
  support.patterns.emplace_back(grid);
}

void parse_bolts(const TableReader& root, const std::vector<Excavation>& excavations, SupportSettings& support) {
  constexpr std::array<string_view, 16> keys{"name",   "tunnel", "grid",        "at",       "direction", "spacing",
                                             "offset", "arc",    "inclination", "plunge",   "stagger",   "length",
                                             "tendon", "plate",  "bond",        "anchorage"};
  constexpr std::array<string_view, 3> kinds{"tunnel", "grid", "at"};
  const auto nodes = root.tables("bolts");
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const TableReader table{*std::get_if<TomlTable>(&nodes[i]->value), nodes[i]->line,
                            fmt::format("support.bolts[{}]", i + 1), root.problems(), keys};
    support.groups.push_back(table.text("name").value_or(fmt::format("bolts {}", i + 1)));
    const auto group = static_cast<std::uint32_t>(i);
    const auto length = table.need_number("length", rule::length);
    const auto type = parse_type(table);
    const TomlEntry* kind = table.one_of(kinds);
    if (kind == nullptr) continue;
    const auto misused = [&](std::initializer_list<string_view> others) {
      for (const string_view key : others) {
        if (table.has(key)) table.error(key, fmt::format("has no meaning for bolts of `{}`", kind->key), "remove it");
      }
    };
    const double l = length.value_or(1);
    const stability::BoltType t = type.value_or(stability::BoltType{});
    if (kind->key == "tunnel") {
      misused({"direction", "plunge"});
      stability::RingPattern ring;
      ring.length = l;
      ring.type = t;
      ring.group = group;
      parse_rings(table, excavations, std::move(ring), support);
    } else if (kind->key == "grid") {
      misused({"direction", "arc", "inclination"});
      stability::GridPattern grid;
      grid.length = l;
      grid.type = t;
      grid.group = group;
      parse_grid(table, grid, support);
    } else {
      misused({"spacing", "offset", "arc", "inclination", "stagger", "plunge"});
      const auto at = table.points("at");
      const auto direction = table.need_vec3("direction", rule::any);
      if (!at || !direction) continue;
      if (!(geometry::norm(*direction) > 0)) {
        table.error("direction", "is the zero vector", "give the way into the rock");
        continue;
      }
      for (const Vec3 collar : *at) {
        const stability::Bolt bolt{
            .collar = collar, .direction = geometry::normalized(*direction), .length = l, .type = t, .group = group};
        support.single.push_back(bolt);
        support.plan.bolts.push_back(bolt);
      }
    }
  }
}

void parse_spot(const TableReader& owner, SupportSettings& support) {
  const TomlTable* found = owner.table("spot");
  if (found == nullptr) return;
  constexpr std::array<string_view, 6> keys{"length", "tendon", "plate", "bond", "anchorage", "most"};
  const TableReader table{*found, owner.line_of("spot"), owner.path_of("spot"), owner.problems(), keys};
  const auto length = table.need_number("length", rule::length);
  const auto type = parse_type(table);
  const auto most = table.integer("most", 1, 1000);
  if (!length || !type) return;
  support.plan.spot =
      stability::SpotBolts{.type = *type, .length = *length, .most = static_cast<std::uint32_t>(most.value_or(20))};
}

void parse_shotcrete(const TableReader& owner, SupportSettings& support) {
  const TomlTable* found = owner.table("shotcrete");
  if (found == nullptr) return;
  constexpr std::array<string_view, 4> keys{"thickness", "strength", "adhesion", "bond_width"};
  const TableReader table{*found, owner.line_of("shotcrete"), owner.path_of("shotcrete"), owner.problems(), keys};
  const auto thickness = table.need_number("thickness", rule::length);
  constexpr NumberRule strength_rule{0, true, 1e12, false, " Pa"};
  const auto strength = table.need_number("strength", strength_rule);
  const auto adhesion = table.number("adhesion", rule::stress);
  const auto width = table.number("bond_width", rule::length);
  if (!thickness || !strength) return;
  support.plan.shotcrete = stability::Shotcrete{.thickness = *thickness,
                                                .shear_strength = *strength,
                                                .adhesion = adhesion.value_or(0),
                                                .bond_width = width.value_or(0.03)};
}

void parse_design(const TableReader& owner, SupportSettings& support) {
  const TomlTable* found = owner.table("design");
  if (found == nullptr) return;
  constexpr std::array<string_view, 6> keys{"lengths", "scale", "phases", "cost_per_bolt", "cost_per_metre", "offsets"};
  const TableReader table{*found, owner.line_of("design"), owner.path_of("design"), owner.problems(), keys};
  DesignSettings design;
  const TomlEntry* lengths = table.find("lengths");
  if (lengths == nullptr) {
    table.missing("lengths", "add lengths = [3, 4, 5], m");
    return;
  }
  if (const auto* array = std::get_if<TomlArray>(&lengths->node.value); array != nullptr && !array->items.empty()) {
    for (std::size_t i = 0; i < array->items.size(); ++i) {
      const auto length =
          table.number_of(array->items[i], fmt::format("{}[{}]", table.path_of("lengths"), i + 1), rule::length);
      if (length) design.lengths.push_back(*length);
    }
  } else {
    table.error("lengths", "must be a list of numbers", "write lengths = [3, 4, 5], m");
  }
  constexpr NumberRule scale_rule{0, true, 100, false, ""};
  if (const auto scale = pair_of(table, "scale", scale_rule)) {
    design.tightest = (*scale)[0];
    design.widest = (*scale)[1];
    if (!(design.tightest < design.widest))
      table.error("scale", "its first number is not below its second", "swap them");
  }
  design.phases = static_cast<std::uint32_t>(table.integer("phases", 1, 64).value_or(4));
  design.cost_per_bolt = table.number("cost_per_bolt", capacity_rule).value_or(0);
  design.cost_per_metre = table.number("cost_per_metre", capacity_rule).value_or(1);
  design.offsets = static_cast<std::uint32_t>(table.integer("offsets", 1, 10000).value_or(40));
  if (support.patterns.empty()) {
    owner.error("design", "there is no pattern to space", "add [[support.bolts]] with tunnel or grid");
    return;
  }
  support.design = std::move(design);
}

}  // namespace

std::optional<SupportSettings> parse_support(const TableReader& root, const std::vector<Excavation>& excavations,
                                             const std::optional<StabilitySettings>& stability) {
  const TomlTable* found = root.table("support");
  if (found == nullptr) return std::nullopt;
  constexpr std::array<string_view, 7> keys{"bolts", "spot", "shotcrete", "design", "action", "spot_area", "key_only"};
  constexpr std::array<string_view, 2> actions{"passive", "active"};
  const TableReader table{*found, root.line_of("support"), "support", root.problems(), keys};
  SupportSettings support;
  support.line = root.line_of("support");
  parse_bolts(table, excavations, support);
  parse_spot(table, support);
  parse_shotcrete(table, support);
  parse_design(table, support);
  support.plan.active = table.choice("action", actions).value_or(0) == 1;
  support.plan.spot_area = table.number("spot_area", rule::length_or_zero).value_or(0.5);
  support.plan.key_only = table.boolean("key_only").value_or(false);
  if (stability && stability->target) {
    support.plan.target_falling = stability->target->falling;
    support.plan.target_sliding = stability->target->sliding;
  }
  return support;
}

}  // namespace cleave::scene
