#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "cleave/core/nearest.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/scene3d/key_tables.hpp"
#include "context.hpp"

namespace cleave::scene {
namespace {

using geometry::Vec3;
using std::string_view;

constexpr NumberRule capacity_rule = NumberRule{0, false, 1e12, false, " N"}.usually(1e3, 1e8);
constexpr NumberRule bond_rule = NumberRule{0, false, 1e12, false, " N/m"}.usually(1e3, 1e9);
constexpr NumberRule bolt_length_rule = rule::length.usually(0.2, 200);
constexpr NumberRule spacing_rule = rule::length.usually(0.1, 50);
constexpr NumberRule area_rule{0, false, 1e9, false, " m2"};
constexpr NumberRule arc_rule{-180, false, 180, false, " degrees"};
constexpr NumberRule inclination_rule{-80, false, 80, false, " degrees"};
constexpr NumberRule plunge_rule{-89, false, 89, false, " degrees"};
constexpr NumberRule ductility_rule{0, false, 1e3, false, " m"};
constexpr NumberRule cost_rule{0, false, 1e12, false, ""};
constexpr std::array<string_view, 2> actions{"passive", "active"};

/// length and the capacities of one bolt, of patterns and of spot bolts.
std::vector<Key> bolt_keys() {
  return {
      {"length", key::number(bolt_length_rule), required, "m"},
      {"tendon_capacity", key::number(capacity_rule), required, "N", "tendon"},
      {"plate_capacity", key::number(capacity_rule), "0", "N, 0 = none", "plate"},
      {"kind", key::word(stability::bolt_kind_names), "\"grouted\"",
       "`\"grouted\"` over its length; `\"friction\"` (split set, Swellex); `\"cable\"`; `\"mechanical\"`: held at its "
       "end over `anchorage`, free up to the plate"},
      {"bond_strength", key::number(bond_rule), "",
       "N/m of gripped length, pi times the diameter of the hole times the strength of the bond; needed but for "
       "mechanical; the diameter itself is not asked",
       "bond"},
      {"anchor_capacity", key::number(capacity_rule), "", "N, of mechanical"},
      {"free_length", key::number(rule::length_or_zero), "0", "m from the collar that grips nothing, of cables"},
      {"anchorage", key::number(rule::length_or_zero), required,
       "m that must be gripped; of mechanical: of the anchor, at its end"},
      {"shear_capacity", key::number(capacity_rule), "0", "N across the bolt, of grouted and friction; 0: not counted"},
      {"angle", key::word<stability::AngleLaw>(), "\"full\"",
       "share of tension and shear at the angle t to the movement: `\"full\"` the pair that does the most work, "
       "`\"cosine\"` cos t, `\"linear\"` 1 - t/90"},
      {"ductility", key::number(ductility_rule), "0",
       "m that it lengthens at its capacity before it breaks, for `[motion]`; 0: it breaks there"}};
}

const KeyTable& grid_keys() {
  static const KeyTable keys{
      .name = "support.bolts.grid",
      .keys = {{"corner", key::vector(rule::coordinate), required, "m"},
               {"dip", key::number(rule::dip), required, "degrees, of the plane"},
               {"dip_direction", key::number(rule::dip_direction), required, "degrees, of the plane"},
               {"width", key::number(rule::length), required, "m, along strike, to the right seen from the air"},
               {"height", key::number(rule::length), required, "m, down the dip"}}};
  return keys;
}

const KeyTable& group_keys() {
  static const KeyTable keys = [] {
    KeyTable table{
        .name = "support.bolts",
        .keys =
            {{"name", key::text(), "`bolts N`", "of the group"},
             {"tunnel", key::text(), "", "rings on the excavation of kind tunnel of this name"},
             {"grid", key::table(&grid_keys), "",
              "a grid in a plane, from `corner` along strike (to the right seen from the air) and down the dip"},
             {"at", key::points(), "", "single bolts with one `direction`"},
             {"direction", key::vector(rule::any), "", "of single bolts, into the rock"},
             {"spacing", key::pair(spacing_rule), "",
              "m: along the axis and around the section; of a grid across and down the dip"},
             {"offset", key::pair(rule::length_or_zero), "[0, 0]", "m, of the first bolt"},
             {"arc", key::pair(arc_rule), "[-120, 120]",
              "of rings: degrees from up to the right in which the wall's normal must lie; the default is all but the "
              "floor, [-180, 180] all round"},
             {"inclination", key::number(inclination_rule), "0",
              "of rings: degrees from the normal towards the axis's end"},
             {"plunge", key::number(plunge_rule), "",
              "of grids: degrees below horizontal, against the dip direction; none: at right angles to the plane"},
             {"stagger", key::flag(), "false", "every other row is shifted by half a spacing"},
             {"after_stage", key::whole(0, 10'000), "stage of its tunnel, else 0",
              "of excavation in stages: installed after it; `[sequence]` is checked stage by stage without and with "
              "the bolts of the stage"}},
        .one_of = {{"tunnel", "grid", "at"}}};
    for (Key& key : bolt_keys()) table.keys.push_back(std::move(key));
    return table;
  }();
  return keys;
}

const KeyTable& spot_keys() {
  static const KeyTable keys = [] {
    KeyTable table{.name = "support.spot", .keys = bolt_keys()};
    table.keys.push_back({"max_per_block", key::whole(1, 1000), "20", "bolts of one block", "most"});
    return table;
  }();
  return keys;
}

const KeyTable& design_keys() {
  static const KeyTable keys{
      .name = "support.design",
      .keys = {
          {"lengths", key::array(key::number(rule::length), 1), required, "m, of bolts"},
          {"scale", key::pair(rule::factor), "[0.25, 4]", "tightest and widest multiple of the patterns' spacings"},
          {"phases", key::whole(1, 64), "4", "offsets of the pattern that must all pass"},
          {"offsets", key::whole(1, 10000), "40", "drawn at random, at which the pattern found is tried"},
          {"spot", key::flag(), "false", "true: the spot bolts of `[support]` count too; without, the pattern alone"},
          {"cost_per_bolt", key::number(cost_rule), "0", "in any currency"},
          {"cost_per_metre", key::number(cost_rule), "1", "of bolt"}}};
  return keys;
}

/// Of one pattern.
constexpr std::uint64_t most_bolts = 200'000;

/// What holds a bolt of that kind; an error for keys of other kinds.
std::optional<stability::BoltKind> parse_kind(const TableReader& table, double anchorage) {
  const std::size_t kind = table.choice("kind").value_or(0);
  const string_view name = stability::bolt_kind_names.at(kind);
  const auto misused = [&](std::initializer_list<string_view> others) {
    for (const string_view key : others) {
      if (table.has(key)) table.error(key, fmt::format("has no meaning for bolts of kind \"{}\"", name), "remove it");
    }
  };
  if (name == "mechanical") {
    misused({"bond_strength", "free_length", "shear_capacity"});
    const auto anchor = table.number("anchor_capacity");
    if (!table.has("anchor_capacity")) table.missing("anchor_capacity", "add anchor_capacity = 100e3, N");
    if (!(anchorage > 0)) table.error("anchorage", "is 0", "a mechanical anchor has a length, such as 0.3");
    if (!(table.value("plate_capacity") > 0)) {
      table.error("plate_capacity", "is 0", "a bolt that is free up to its head holds by its plate alone");
    }
    return anchor.transform([](double a) { return stability::BoltKind{stability::MechanicalAnchor{newtons(a)}}; });
  }
  misused({"anchor_capacity"});
  const auto bond = table.number("bond_strength");
  if (!table.has("bond_strength")) {
    table.missing("bond_strength", "add bond_strength = 200e3, N per metre");
  }
  if (!bond) return std::nullopt;
  const ForcePerLength strength = newtons_per_metre(*bond);
  const Force shear = newtons(table.value("shear_capacity"));
  if (name == "cable") {
    misused({"shear_capacity"});
    return stability::Cable{.bond = strength, .free_length = metres(table.value("free_length"))};
  }
  misused({"free_length"});
  static_assert(stability::bolt_kind_names.size() == 4, "each kind has its case; grouted is the last");
  if (name == "friction") return stability::FrictionTube{.bond = strength, .shear = shear};
  return stability::GroutedBar{.bond = strength, .shear = shear};
}

/// Keys of `bolt_keys` but the length.
std::optional<stability::BoltType> parse_type(const TableReader& table) {
  const auto tendon = table.need_number("tendon_capacity");
  const auto anchorage = table.need_number("anchorage");
  const double plate = table.value("plate_capacity");
  const auto kind = parse_kind(table, anchorage.value_or(1));
  if (!tendon || !anchorage || !kind) return std::nullopt;
  if (const auto length = table.number("length"); length && *anchorage >= *length) {
    table.note("anchorage",
               fmt::format("is {:g} m, and the bolt is {:g} m long: no bolt is gripped so, and none holds anything",
                           *anchorage, *length),
               "give the length that must be gripped beyond the block");
  }
  if (const auto* cable = std::get_if<stability::Cable>(&*kind)) {
    const double free = cable->free_length.si();
    if (const auto length = table.number("length"); length && free > 0 && free + *anchorage > *length) {
      table.note("free_length",
                 fmt::format("is {:g} m, and the cable is {:g} m long: less than its anchorage of {:g} m is left to "
                             "grip, and none holds anything",
                             free, *length, *anchorage),
                 "make the cables longer, or this less");
    }
  }
  return stability::BoltType{.tendon = newtons(*tendon),
                             .plate = newtons(plate),
                             .anchorage = metres(*anchorage),
                             .kind = *kind,
                             .angle = table.word<stability::AngleLaw>("angle"),
                             .ductility = metres(table.value("ductility"))};
}

void parse_rings(const TableReader& table, const std::vector<Excavation>& excavations, stability::RingPattern ring,
                 SupportSettings& support) {
  const auto name = table.text("tunnel");
  const auto spacing = table.pair("spacing");
  if (!table.has("spacing")) table.missing("spacing", "add spacing = [along the axis, around the section], m");
  const auto offset = table.pair("offset");
  const auto arc = table.pair("arc");
  if (arc && !((*arc)[0] < (*arc)[1])) {
    table.error("arc", "its first angle is not below its second", "swap them");
    return;
  }
  if (!name || !spacing) return;
  std::vector<string_view> known;
  for (const Excavation& excavation : excavations) {
    if (excavation.tunnel) known.emplace_back(excavation.name);
    if (!excavation.tunnel || excavation.name != *name) continue;
    ring.axis = excavation.tunnel->axis;
    ring.up = excavation.tunnel->up;
    ring.outline = excavation.tunnel->outline;
    ring.along = metres((*spacing)[0]);
    ring.around = metres((*spacing)[1]);
    ring.offset_along = metres(offset ? (*offset)[0] : 0);
    ring.offset_around = metres(offset ? (*offset)[1] : 0);
    if (arc) ring.arc = *arc;
    if (!table.has("after_stage")) {
      ring.after_stage = excavation.stage;
    } else if (ring.after_stage < excavation.stage) {
      table.error("after_stage",
                  fmt::format("is {}, and its tunnel is excavated in stage {}", ring.after_stage, excavation.stage),
                  "without it bolts are installed after the stage of their tunnel");
    }
    ring.stagger = table.flag("stagger");
    ring.inclination = table.value("inclination");
    const std::uint64_t number = number_of_bolts(ring);
    if (number == 0) {
      table.error(arc ? "arc" : "offset",
                  "leaves no bolts: no wall of the section has its normal there, or rings begin "
                  "beyond the tunnel's end",
                  "widen the arc, or lessen the offset");
      return;
    }
    if (number > most_bolts) {
      table.error("spacing", fmt::format("makes {} bolts", number), "space them wider");
      return;
    }
    const auto bolts = bolts_of(ring);
    support.plan.bolts.insert(support.plan.bolts.end(), bolts.begin(), bolts.end());
    support.patterns.emplace_back(std::move(ring));
    return;
  }
  if (table.problems().is_unread(*name)) return;
  const auto guess = nearest(*name, known);
  table.error("tunnel", fmt::format("\"{}\" is no excavation of kind \"tunnel\"", name->substr(0, 60)),
              guess ? fmt::format("did you mean \"{}\"?", *guess) : "name an [[excavation]] of that kind");
}

void parse_grid(const Context& context, const TableReader& owner, stability::GridPattern grid,
                SupportSettings& support) {
  const auto found = owner.sub("grid");
  const auto spacing = owner.pair("spacing");
  if (!owner.has("spacing")) owner.missing("spacing", "add spacing = [across, down the dip], m");
  const auto offset = owner.pair("offset");
  const auto plunge = owner.number("plunge");
  if (!found) return;
  const TableReader& table = *found;
  const auto corner = table.need_vec3("corner");
  const auto dip = table.need_number("dip"), direction = table.need_number("dip_direction");
  const auto width = table.need_number("width"), height = table.need_number("height");
  if (!corner || !dip || !direction || !width || !height || !spacing) return;
  const geometry::Attitude plane{Dip::degrees(*dip), context.turned(*direction)};
  const Vec3 normal = geometry::upward_normal(plane);
  grid.corner = *corner;
  grid.down = geometry::dip_vector(plane);
  grid.across = geometry::cross(normal, grid.down);
  grid.width = metres(*width);
  grid.height = metres(*height);
  grid.spacing_across = metres((*spacing)[0]);
  grid.spacing_down = metres((*spacing)[1]);
  grid.offset_across = metres(offset ? (*offset)[0] : 0);
  grid.offset_down = metres(offset ? (*offset)[1] : 0);
  grid.stagger = owner.flag("stagger");
  if (plunge) {
    const double trend = geometry::wrap_degrees(plane.direction.degrees() + 180);
    grid.direction = geometry::line_vector({geometry::Trend::degrees(trend), geometry::Plunge::degrees(*plunge)});
  } else {
    grid.direction = -normal;
  }
  if (const std::uint64_t number = number_of_bolts(grid); number > most_bolts) {
    owner.error("spacing", fmt::format("makes {} bolts", number), "space them wider");
    return;
  }
  const auto bolts = bolts_of(grid);
  support.plan.bolts.insert(support.plan.bolts.end(), bolts.begin(), bolts.end());
  support.patterns.emplace_back(grid);
}

void parse_bolts(const Context& context, const TableReader& root, const std::vector<Excavation>& excavations,
                 SupportSettings& support) {
  const std::vector<TableReader> tables = root.each("bolts");
  std::uint32_t last_stage = 1;
  for (const Excavation& excavation : excavations) last_stage = std::max(last_stage, excavation.stage);
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const TableReader& table = tables[i];
    support.groups.push_back(table.text("name").value_or(fmt::format("bolts {}", i + 1)));
    const auto group = static_cast<std::uint32_t>(i);
    const auto length = table.need_number("length");
    const auto type = parse_type(table);
    const TomlEntry* kind = table.one_of();
    if (kind == nullptr) continue;
    const auto misused = [&](std::initializer_list<string_view> others) {
      for (const string_view key : others) {
        if (table.has(key)) table.error(key, fmt::format("has no meaning for bolts of `{}`", kind->key), "remove it");
      }
    };
    const auto stage = table.integer("after_stage").transform([](auto k) { return static_cast<std::uint32_t>(k); });
    if (stage && *stage > last_stage) {
      table.error("after_stage",
                  fmt::format("is {}, and stage {} of the excavations is the last: the bolts would never be installed",
                              *stage, last_stage),
                  "name a stage of [[excavation]]");
    }
    const Length l = metres(length.value_or(1));
    const stability::BoltType t = type.value_or(stability::BoltType{});
    if (kind->key == "tunnel") {
      misused({"direction", "plunge"});
      stability::RingPattern ring;
      ring.length = l;
      ring.type = t;
      ring.group = group;
      ring.after_stage = stage.value_or(0);
      parse_rings(table, excavations, std::move(ring), support);
    } else if (kind->key == "grid") {
      misused({"direction", "arc", "inclination"});
      stability::GridPattern grid;
      grid.length = l;
      grid.type = t;
      grid.group = group;
      grid.after_stage = stage.value_or(0);
      parse_grid(context, table, grid, support);
    } else {
      misused({"spacing", "offset", "arc", "inclination", "stagger", "plunge"});
      const auto at = table.points("at");
      const auto direction = table.need_vec3("direction");
      if (!at || !direction) continue;
      if (!(geometry::norm(*direction) > 0)) {
        table.error("direction", "is the zero vector", "give the way into the rock");
        continue;
      }
      for (const Vec3 collar : *at) {
        const stability::Bolt bolt{.collar = collar,
                                   .direction = geometry::normalized(*direction),
                                   .length = l,
                                   .type = t,
                                   .group = group,
                                   .after_stage = stage.value_or(0)};
        support.single.push_back(bolt);
        support.plan.bolts.push_back(bolt);
      }
    }
  }
}

void parse_spot(const TableReader& owner, SupportSettings& support) {
  const auto table = owner.sub("spot");
  if (!table) return;
  const auto length = table->need_number("length");
  const auto type = parse_type(*table);
  const auto most = static_cast<std::uint32_t>(table->count("max_per_block"));
  if (length && type) support.plan.spot = stability::SpotBolts{.type = *type, .length = metres(*length), .most = most};
}

void parse_design(const TableReader& owner, SupportSettings& support) {
  const auto table = owner.sub("design");
  if (!table) return;
  DesignSettings design;
  if (!table->has("lengths")) {
    table->missing("lengths", "add lengths = [3, 4, 5], m");
    return;
  }
  design.lengths = table->numbers("lengths").value_or(std::vector<double>{});
  if (const auto scale = table->pair("scale")) {
    design.tightest = (*scale)[0];
    design.widest = (*scale)[1];
    if (!(design.tightest < design.widest))
      table->error("scale", "its first number is not below its second", "swap them");
  }
  design.phases = static_cast<std::uint32_t>(table->count("phases"));
  design.offsets = static_cast<std::uint32_t>(table->count("offsets"));
  design.cost_per_bolt = table->value("cost_per_bolt");
  design.cost_per_metre = table->value("cost_per_metre");
  design.spot = table->flag("spot");
  if (design.spot && !support.plan.spot) table->error("spot", "there are none", "add spot to [support]");
  if (support.patterns.empty()) {
    owner.error("design", "there is no pattern to space", "add [[support.bolts]] with tunnel or grid");
    return;
  }
  support.design = std::move(design);
}

/// Bolts in one place with one direction: a table that was copied counts twice.
void note_twice(const TableReader& table, const SupportSettings& support) {
  const auto place = [](const stability::Bolt& b) {
    return std::array{b.collar.x, b.collar.y, b.collar.z, b.direction.x, b.direction.y, b.direction.z};
  };
  std::vector<const stability::Bolt*> bolts;
  for (const stability::Bolt& bolt : support.plan.bolts) bolts.push_back(&bolt);
  const auto before = [&](const auto* a, const auto* b) { return place(*a) < place(*b); };
  std::ranges::stable_sort(bolts, before);
  std::size_t twice = 0;
  const stability::Bolt *first = nullptr, *second = nullptr;
  for (std::size_t k = 1; k < bolts.size(); ++k) {
    if (place(*bolts[k - 1]) != place(*bolts[k])) continue;
    if (twice++ > 0) continue;
    first = bolts[k - 1];
    second = bolts[k];
  }
  if (twice == 0) return;
  table.note("bolts",
             fmt::format("has {} where another stands with the same direction (of \"{}\" and \"{}\"): each counts",
                         twice == 1 ? "1 bolt" : fmt::format("{} bolts", twice), support.groups[first->group],
                         support.groups[second->group]),
             "remove what was copied, or give it another place");
}

}  // namespace

const KeyTable& support_keys() {
  static const KeyTable keys{
      .name = "support",
      .keys = {
          {"bolts", key::tables(&group_keys), "", "groups of bolts, below"},
          {"spot", key::table(&spot_keys), "",
           "bolts added one by one to blocks that pattern and shotcrete do not hold, below"},
          {"shotcrete", key::table(&shotcrete_keys), "",
           "holds blocks of any size by shear along the edge of the sprayed faces that they come out through, against "
           "rock that stays, limited by adhesion where stated; counts together with bolts; bending between bolts is "
           "not checked; below"},
          {"spot_area", key::number(area_rule), "0.5",
           "m2 of free face of a block: below, it is small: no spot bolts, and apart in the summary"},
          {"most_pressure", key::number(rule::strength), "2e6",
           "Pa on free faces that support can give: blocks that need more, because of forces passed to them, are "
           "counted "
           "apart (`passed_on`)"},
          {"action", key::word(actions), "\"passive\"",
           "`\"active\"`: tensioned bolts, in the factor of bolts alone (`factor_with_bolts`) only; what holds is "
           "decided "
           "by the factor with everything"},
          {"key_only", key::flag(), "false", "true: only blocks that need support are stitched together"},
          {"design", key::table(&design_keys), "",
           "for each length the widest multiple of the patterns' spacings at which every one of `phases` offsets "
           "passes both steps; then what share of offsets drawn at random fails, below. A block that no bolt can meet "
           "makes "
           "every pattern fail: give `shotcrete` and leave crumbs out by `[micro_blocks]`"}}};
  return keys;
}

std::optional<SupportSettings> parse_support(const Context& context, const TableReader& root,
                                             const std::optional<geometry::Solid>& domain,
                                             const std::vector<Excavation>& excavations,
                                             const ParsedStability& stability) {
  const auto found = root.sub("support");
  if (!found) return std::nullopt;
  const TableReader& table = *found;
  SupportSettings support;
  support.line = table.line();
  parse_bolts(context, table, excavations, support);
  note_twice(table, support);
  parse_spot(table, support);
  parse_shotcrete(table, domain, excavations, stability.free_domain_tags, support);
  parse_design(table, support);
  support.plan.active = table.choice("action") == std::size_t{1};
  support.plan.spot_area = square_metres(table.value("spot_area"));
  support.plan.most_pressure = pascals(table.value("most_pressure"));
  support.plan.key_only = table.flag("key_only");
  if (stability.settings && stability.settings->target) {
    support.plan.target_falling = stability.settings->target->falling;
    support.plan.target_sliding = stability.settings->target->sliding;
  }
  return support;
}

}  // namespace cleave::scene
