#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include "cleave/core/special.hpp"
#include "cleave/scene3d/key_tables.hpp"
#include "context.hpp"

namespace cleave::scene {
namespace {

using std::string_view;
using Kind = FrictionLaw::Kind;

/// What a [joints.NAME] states; what it does not state comes from [joints.default].
struct Stated {
  std::optional<FrictionLaw> friction;
  std::optional<StressLaw> cohesion, tension;
  std::optional<double> correlation, jrc, jcs, normal_stiffness, shear_stiffness;
  std::optional<NumberLaw> aperture;
};

/// A law as it is written, whatever it is of.
struct Law {
  Kind kind = Kind::constant;
  std::optional<double> mean, std, min, max;
};

constexpr NumberRule correlation_rule{-1, false, 1, false, ""};
constexpr NumberRule roughness_rule{0, true, 20, false, ""};
constexpr NumberRule wall_rule = NumberRule{0, true, 1e15, false, " Pa"}.usually(1e5, 1e9);
constexpr NumberRule stiffness_rule = NumberRule{0, true, 1e18, false, " Pa/m"}.usually(1e7, 1e13);
constexpr NumberRule aperture_rule = NumberRule{0, true, 1, false, " m"}.usually(1e-7, 2e-2);
constexpr NumberRule young_rule = NumberRule{0, true, 1e15, false, " Pa"}.usually(1e8, 1e13);
constexpr NumberRule poisson_rule{-1, true, 0.5, true, ""};

std::optional<Law> parse_law(const TableReader& owner, string_view key) {
  const TomlEntry* entry = owner.find(key);
  if (entry == nullptr) return std::nullopt;
  if (!std::holds_alternative<TomlTable>(entry->node.value)) {
    const auto value = owner.number(key);
    if (!value) return std::nullopt;
    return Law{.kind = Kind::constant, .mean = *value, .std = {}, .min = {}, .max = {}};
  }
  const std::size_t before = owner.problems().errors();
  const TableReader table = *owner.sub(key);
  const string_view unit = table.rule_of("min").unit;
  if (!table.has("distribution")) {
    table.missing("distribution",
                  "add distribution = \"uniform\" (with min and max) or \"normal\" (with mean and std)");
    return std::nullopt;
  }
  const auto kind = table.given_word<Kind>("distribution");
  if (!kind) return std::nullopt;
  Law law{.kind = *kind, .mean = {}, .std = {}, .min = {}, .max = {}};
  const bool uniform = law.kind == Kind::uniform;
  const bool with_std = law.kind == Kind::normal || law.kind == Kind::lognormal;
  if (uniform && (!table.has("min") || !table.has("max"))) {
    table.missing(table.has("min") ? "max" : "min",
                  unit.empty() ? "add min and max" : fmt::format("add min and max, in{}", unit));
  }
  law.min = table.number("min");
  law.max = table.number("max");
  // Of a uniform law the larger limit tells the unit; limits of other laws may lie anywhere.
  if (uniform) table.note_unusual("max", owner.rule_of(key));
  law.mean = uniform ? table.number("mean") : table.need_number("mean");
  law.std = with_std ? table.need_number("std") : table.number("std");
  if (uniform && law.mean) table.error("mean", "has no meaning for the distribution \"uniform\"", "remove it");
  if (!with_std && law.std) table.error("std", "has no meaning for this distribution", "remove it");
  if (owner.problems().errors() != before) return std::nullopt;
  if (law.min && law.max && *law.min > *law.max) {
    table.error("min", fmt::format("is {}, above max = {}", *law.min, *law.max), "swap them");
    return std::nullopt;
  }
  const bool positive = law.kind == Kind::lognormal || law.kind == Kind::exponential;
  if (positive && *law.mean <= 0) {
    table.error("mean", "is 0", fmt::format("give a mean above 0{}", unit));
    return std::nullopt;
  }
  // A law that lies almost wholly outside its limits would put every draw on a limit.
  if (with_std &&
      ((law.min && *law.mean < *law.min - 5 * *law.std) || (law.max && *law.mean > *law.max + 5 * *law.std))) {
    table.error("mean", fmt::format("is {}, more than 5 std outside of min..max", *law.mean),
                "move the limits or the mean");
    return std::nullopt;
  }
  if (!uniform && law.mean && ((law.min && *law.mean < *law.min) || (law.max && *law.mean > *law.max))) {
    table.note("mean", fmt::format("is {:g}, outside of min..max: no more than a tail of the law is drawn", *law.mean),
               "mean and std are those of the law before it is cut to min..max");
  }
  return law;
}

/// Where a normal law has a tail beyond a limit that nobody stated: joints get more than `mean` then.
void note_tail(const TableReader& owner, string_view key, const Law& law, double lowest) {
  if (law.kind != Kind::normal || law.min || !(*law.std > 0)) return;
  constexpr double seldom = 0.02;
  const double limit = (lowest - *law.mean) / *law.std;
  const double below = special::normal_cdf(limit);
  if (below < seldom) return;
  const double density = std::exp(-limit * limit / 2) / std::sqrt(2 * std::numbers::pi);
  owner.note(
      key,
      fmt::format("{:.2g} % of this normal law lie below {:g} and are drawn again: the values drawn are {:.3g} on "
                  "average, not {:g}",
                  100 * below, lowest, *law.mean + *law.std * density / special::normal_cdf(-limit), *law.mean),
      fmt::format("a lognormal law keeps the mean and stays above 0; min = {:g} says that the tail is to be cut",
                  lowest));
}

/// The law in its own type, whose limits are those of `own` where the scene states none.
template <class Own>
std::optional<Own> own_law(const TableReader& owner, string_view key, Own own = {}) {
  const std::optional<Law> law = parse_law(owner, key);
  if (!law) return std::nullopt;
  // Laws of positive numbers begin at 0.
  if (law->kind == Kind::lognormal || law->kind == Kind::exponential) own.min = std::max(own.min, 0.0);
  own.kind = law->kind;
  own.mean = law->mean.value_or(own.mean);
  own.std = law->std.value_or(0.0);
  own.min = law->min.value_or(own.min);
  own.max = law->max.value_or(own.max);
  note_tail(owner, key, *law, own.min);
  return own;
}

Stated parse_one(const TableReader& table) {
  Stated stated{parse_friction(table, "friction"),
                own_law<StressLaw>(table, "cohesion"),
                own_law<StressLaw>(table, "tension"),
                table.number("friction_cohesion_correlation"),
                table.number("jrc"),
                table.number("jcs"),
                table.number("normal_stiffness"),
                table.number("shear_stiffness"),
                parse_number_law(table, "aperture", aperture_rule.low, aperture_rule.high)};
  if (table.has("jrc") != table.has("jcs")) {
    table.missing(table.has("jrc") ? "jcs" : "jrc", "Barton-Bandis needs both: jrc = 8, jcs = 50e6");
  }
  if (table.has("normal_stiffness") != table.has("shear_stiffness")) {
    table.missing(table.has("normal_stiffness") ? "shear_stiffness" : "normal_stiffness",
                  "give both: normal_stiffness = 10e9, shear_stiffness = 1e9, in Pa/m");
  }
  const auto constant = [](const auto& law) { return law && law->kind == Kind::constant; };
  if (stated.jrc && stated.cohesion && !(constant(stated.cohesion) && stated.cohesion->mean == 0)) {
    table.error("cohesion", "has no meaning beside jrc and jcs", "remove one of them");
  }
  return stated;
}

JointProperties with(JointProperties base, const Stated& stated) {
  if (stated.friction) base.friction = *stated.friction;
  if (stated.cohesion) base.cohesion = *stated.cohesion;
  if (stated.tension) base.tension = *stated.tension;
  if (stated.aperture) base.aperture = *stated.aperture;
  if (stated.correlation) base.friction_cohesion = *stated.correlation;
  if (stated.cohesion) base.roughness.reset();  // a straight law of its own
  if (stated.normal_stiffness && stated.shear_stiffness) {
    base.stiffness = {pascals_per_metre(*stated.normal_stiffness), pascals_per_metre(*stated.shear_stiffness)};
  }
  if (stated.jrc && stated.jcs) {
    base.roughness = {*stated.jrc, pascals(*stated.jcs)};
    base.cohesion = StressLaw{};
  }
  return base;
}

/// Tension that no point of the Mohr-Coulomb line has. Each number stands for a joint that is strong in pull and has
/// nothing along itself.
void note_apex(Context& context, std::string_view name, std::uint32_t line, const JointProperties& of) {
  constexpr auto constant = FrictionLaw::Kind::constant;
  if (of.roughness || of.friction.kind != constant || of.cohesion.kind != constant || of.tension.kind != constant)
    return;
  const double tangent = std::tan(FrictionAngle::degrees(of.friction.mean).radians());
  if (!(of.tension.mean * tangent > of.cohesion.mean)) return;
  context.problems.note(
      line, fmt::format("joints.{}.tension", name),
      fmt::format("is above cohesion / tan(friction) = {:.6g} Pa, the apex of the Mohr-Coulomb line",
                  tangent > 0 ? of.cohesion.mean / tangent : 0.0),
      "it is used as given, and factors of single blocks that lift or fall count it whatever the joint "
      "bears along itself; blocks in [motion] have it up to that apex alone. Check it");
}

}  // namespace

KeyTable make_law_keys(const NumberRule& rule) {
  NumberRule limit = rule;
  limit.usual.reset();
  NumberRule least = limit;  // what is drawn lies above an open end all the same
  least.low_open = false;
  return {.name = rule.unit.empty() ? std::string{"law"} : fmt::format("law in{}", rule.unit),
          .keys = {{"distribution", key::word<FrictionLaw::Kind>(), required,
                    "`uniform` has `min` and `max`, `normal` and "
                    "`lognormal` have `mean` and `std`, `exponential` and `constant` have `mean`"},
                   {"mean", key::number(rule), "", "of the law before it is cut to `min`..`max`"},
                   {"std", key::number(least), "", "of the law before it is cut"},
                   {"min", key::number(least), "", "lower limit"},
                   {"max", key::number(limit), "", "upper limit"}}};
}

namespace {

/// Lengths have a law of their own, in the same unit.
const KeyTable& aperture_law_keys() {
  static const KeyTable keys = [] {
    KeyTable law = make_law_keys(aperture_rule);
    law.name = "law of aperture in m";
    return law;
  }();
  return keys;
}

}  // namespace

const KeyTable& strength_keys() {
  static const KeyTable keys{
      .name = "joints",
      .keys = {
          {"friction", number_or_law<rule::friction>(), "30",
           "degrees, a number or a law: `uniform` with `min`, `max`; `normal`, `lognormal` with `mean`, `std`; "
           "`exponential` with `mean`; each with optional `min`, `max`; one value a joint"},
          {"cohesion", number_or_law<rule::strength>(), "0", "Pa, a number or a law"},
          {"tension", number_or_law<rule::strength>(), "0", "Pa, strength of a joint that opens; a number or a law"},
          {"friction_cohesion_correlation", key::number(correlation_rule), "0",
           "ties friction and cohesion of a joint together (Gaussian copula; each keeps its law)"},
          {"jrc", key::number(roughness_rule), "",
           "joint roughness: with `jcs` the law of Barton and Bandis takes the place of the straight one: "
           "`friction` is then the residual angle, there is no cohesion, and the angle stays between residual and "
           "70 degrees"},
          {"jcs", key::number(wall_rule), "", "Pa, strength of the joint walls"},
          {"normal_stiffness", key::number(stiffness_rule), "",
           "Pa/m, with `shear_stiffness`, of every set or of none: how the forces of `[field_stress]` change as a "
           "block "
           "comes out"},
          {"shear_stiffness", key::number(stiffness_rule), "", "Pa/m"},
          {"aperture", key::either({key::number(aperture_rule), key::table(&aperture_law_keys)}), "",
           "m, hydraulic, for `[flow]`: a number or a law, one value a joint. Transmissivity is g a^3 / (12 "
           "viscosity)"}}};
  return keys;
}

const KeyTable& rock_keys() {
  static const KeyTable keys{
      .name = "rock",
      .keys = {{"density", key::number(rule::density), "2700",
                "kg/m3; a text may state a unit weight (`\"26 kN/m3\"`), which is divided by 9.81 m/s2"},
               {"young", key::number(young_rule), "", "Pa, of bodies that state none"},
               {"poisson", key::number(poisson_rule), "",
                "Poisson's ratio of bodies that state none, and of `[field_stress]`"}}};
  return keys;
}

std::optional<FrictionLaw> parse_friction(const TableReader& owner, string_view key) {
  return own_law<FrictionLaw>(owner, key);
}

std::optional<NumberLaw> parse_number_law(const TableReader& owner, string_view key, double min, double max) {
  return own_law<NumberLaw>(owner, key, {.min = min, .max = max});
}

void parse_properties(Context& context, const TableReader& root) {
  const TomlTable* found = root.table("joints");
  if (found == nullptr) return;
  struct OfSet {
    std::string name;
    Stated properties;
    std::uint32_t line, tension_line;
  };
  std::vector<OfSet> stated;
  for (const TomlEntry& entry : found->entries) {
    const std::string path = "joints." + entry.key;
    const auto* table = std::get_if<TomlTable>(&entry.node.value);
    if (table == nullptr) {
      const bool property = strength_keys().find(entry.key, std::nullopt) != nullptr;
      context.problems.error(entry.line, path,
                             fmt::format("is {} but must be a table of a joint set", kind_of(entry.node)),
                             property ? "put it under [joints.default]" : "write [joints.NAME] with the name of a set");
      continue;
    }
    const TableReader reader{*table, entry.line, path, context.problems, strength_keys()};
    stated.push_back({entry.key, parse_one(reader), entry.line, reader.line_of("tension")});
  }
  JointProperties base;
  for (const auto& [name, properties, line, tension_line] : stated) {
    if (name == "default") base = with(base, properties);
  }
  for (const auto& [name, properties, line, tension_line] : stated) {
    if (properties.tension) note_apex(context, name, tension_line, name == "default" ? base : with(base, properties));
  }
  std::vector<string_view> names;
  for (const SetId id : context.sets.ids()) {
    context.sets[id].properties = base;
    names.emplace_back(context.sets[id].name);
  }
  for (const auto& [name, properties, line, tension_line] : stated) {
    if (name == "default") continue;
    bool used = false;
    for (const SetId id : context.sets.ids()) {
      if (context.sets[id].name != name) continue;
      context.sets[id].properties = with(base, properties);
      used = true;
    }
    if (used || context.problems.errors() != 0) continue;  // its joints may be among what is wrong
    report_unused_joints(context.problems, line, name, names, "no joint belongs to this set",
                         "remove it, or name a set so");
  }
}

Rock parse_rock(const TableReader& root) {
  Rock rock;
  const auto table = root.sub("rock");
  if (!table) return rock;
  if (const auto mass = stability::RockMass::make(kilograms_per_cubic_metre(table->value("density")))) {
    rock.mass = *mass;
  } else {
    table->error("density", describe(mass.error()), "");
  }
  static_cast<void>(table->number("young"));  // stresses around a tunnel do not depend on it
  rock.poisson = table->number("poisson");
  return rock;
}

}  // namespace cleave::scene
