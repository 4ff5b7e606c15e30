#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>
#include <variant>

#include "context.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

constexpr NumberRule thickness_rule = rule::length.usually(0.005, 2);
constexpr NumberRule shotcrete_rule = NumberRule{0, true, 1e12, false, " Pa"}.usually(
    1e4, 1e7, "in shear it is a tenth of that in compression or less: check it");
constexpr NumberRule adhesion_rule = NumberRule{0, false, 1e15, false, " Pa"}.usually(1e3, 1e7);
constexpr NumberRule bond_width_rule = rule::length.usually(0.001, 0.5);

/// What is sprayed, of free faces only; an error where that is nothing.
std::vector<stability::FreeSurface> parse_sprayed(const TableReader& table,
                                                  const std::optional<geometry::Solid>& domain,
                                                  const std::vector<Excavation>& excavations,
                                                  const std::vector<std::uint32_t>& free) {
  std::vector<stability::FreeSurface> on;
  if (!table.has("on")) {
    if (excavations.empty() && table.problems().all_read()) {
      table.missing("on",
                    "the walls of excavations are sprayed, and there are none: add on = \"all\", or the free "
                    "faces of the domain that are sprayed");
    }
    return on;
  }
  std::vector<std::string> names;
  if (std::holds_alternative<TomlArray>(table.find("on")->node.value)) {
    const auto given = table.texts("on");
    if (given && given->empty()) table.error("on", "names nothing", "name what is sprayed, or remove shotcrete");
    names = given.value_or(std::vector<std::string>{});
  } else if (const auto name = table.text("on")) {
    names.emplace_back(*name);
  }
  for (const std::string& name : names) {
    const auto surface = free_surface(table, "on", name, domain, excavations);
    if (!surface) continue;
    const auto* side = std::get_if<stability::DomainSide>(&*surface);
    if (side != nullptr && std::ranges::find(free, side->tag) == free.end()) {
      table.error("on", fmt::format("\"{}\" is a face of the domain that is not free", name.substr(0, 60)),
                  "add it to stability.free, or name what is sprayed");
    }
    on.push_back(*surface);
  }
  return on;
}

}  // namespace

const KeyTable& shotcrete_keys() {
  static const KeyTable keys{
      .name = "support.shotcrete",
      .keys = {{"thickness", key::number(thickness_rule), required, "m"},
               {"strength", key::number(shotcrete_rule), required, "Pa, in shear"},
               {"adhesion", key::number(adhesion_rule), "0", "Pa, of the bond to the rock; 0: it is no limit"},
               {"bond_width", key::number(bond_width_rule), "0.03", "m"},
               {"on", key::either({key::text(), key::texts()}), "the walls of all excavations",
                "what is sprayed: excavations, and free faces of the domain; `\"all\"`: every free face. Needed where "
                "nothing is excavated. It holds blocks that come out through these faces"}}};
  return keys;
}

void parse_shotcrete(const TableReader& owner, const std::optional<geometry::Solid>& domain,
                     const std::vector<Excavation>& excavations, const std::vector<std::uint32_t>& free,
                     SupportSettings& support) {
  const auto table = owner.sub("shotcrete");
  if (!table) return;
  const auto thickness = table->need_number("thickness"), strength = table->need_number("strength");
  const double adhesion = table->value("adhesion"), width = table->value("bond_width");
  auto on = parse_sprayed(*table, domain, excavations, free);
  if (!thickness || !strength) return;
  support.plan.shotcrete = stability::Shotcrete{.thickness = metres(*thickness),
                                                .shear_strength = pascals(*strength),
                                                .bond_width = metres(width),
                                                .on = std::move(on)};
  if (adhesion > 0) support.plan.shotcrete->adhesion = pascals(adhesion);
}

}  // namespace cleave::scene
