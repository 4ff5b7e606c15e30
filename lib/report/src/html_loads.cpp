#include "html_loads.hpp"

#include <algorithm>
#include <string_view>
#include <variant>

#include "cleave/core/overloaded.hpp"
#include "cleave/exchange/text.hpp"
#include "html_parts.hpp"

namespace cleave::report {
namespace {

using detail::fact, detail::key_figure;

std::string vector(geometry::Vec3 v) { return "(" + display(v.x) + ", " + display(v.y) + ", " + display(v.z) + ")"; }

std::string place_of(const stability::Surcharge& surcharge, const scene::RunResult& result) {
  const std::string on =
      std::visit(overloaded{[](stability::AnyFreeFace) -> std::string { return "free faces"; },
                            [&](stability::DomainSide side) { return "side " + result.input.domain.tags()[side.tag]; },
                            [&](stability::ExcavationWall wall) { return result.excavations[wall.excavation].name; }},
                 surcharge.on);
  if (!surcharge.within) return on;
  return on + " within " + vector(surcharge.within->min) + " … " + vector(surcharge.within->max);
}

std::string forces_of(const stability::ActionSpec& actions, const scene::RunResult& result) {
  std::string out;
  for (const stability::Surcharge& s : actions.surcharges) {
    out += ", on " + place_of(s, result) + " ";
    if (norm(s.traction) > 0) out += vector(s.traction / 1000) + " kPa";
    if (s.pressure != Stress{}) out += display(s.pressure.si() / 1000) + " kPa against the rock";
  }
  for (const stability::PointForce& p : actions.points) {
    out += ", force " + vector(p.force / 1000) + " kN at " + vector(p.at);
  }
  for (const stability::LineForce& l : actions.lines) {
    out += ", force " + vector(l.per_metre / 1000) + " kN/m from " + vector(l.from) + " to " + vector(l.to);
  }
  return out;
}

std::string water_of(const scene::LoadSet& loads, const scene::RunResult& result) {
  const stability::ActionSpec& actions = loads.actions.spec();
  std::string out;
  if (actions.water) {
    out += ", water table at " + display(actions.water->level) + " m" +
           (loads.water_level ? " (median; its level is drawn)" : "") +
           (actions.water->on_free_faces ? ", standing on free faces too" : "");
  }
  std::size_t set = 0;
  for (const scene::SetInfo& info : result.sets) {
    const auto pressure = set < actions.joint_pressure.size() ? actions.joint_pressure[set] : std::nullopt;
    if (pressure) out += ", water of " + display(*pressure / 1000) + " kPa in joints of " + info.name;
    ++set;
  }
  if (loads.flow) out += ", water pressures of the flow in the joints";
  return out;
}

std::string text_of(const scene::LoadSet& loads, const std::optional<scene::Targets>& target,
                    const scene::RunResult& result) {
  std::string out;
  if (norm(loads.body.seismic()) > 0) out += ", seismic force / weight " + vector(loads.body.seismic());
  out += water_of(loads, result) + forces_of(loads.actions.spec(), result);
  if (target) {
    out += "; required factors of safety " + display(target->falling) + " (falling), " + display(target->sliding) +
           " (sliding)";
  }
  return out;
}

}  // namespace

std::string load_rows(const scene::RunResult& result) {
  if (!result.stability) return {};
  const scene::StabilitySettings& s = *result.stability;
  const auto row = [](const std::string& name, const std::string& value) {
    return fact(escape_xml(name), escape_xml(value), "wide");
  };
  std::string out = row("Loads", "rock of " + display(result.rock.mass.density().si()) + " kg/m³, gravity " +
                                     vector(s.loads.body.gravity()) + " m/s²" + text_of(s.loads, s.target, result));
  for (const scene::LoadCase& load : s.cases) {
    out += row("Load case " + load.name, "gravity " + vector(load.loads.body.gravity()) + " m/s²" +
                                             text_of(load.loads, load.target ? load.target : s.target, result));
  }
  return out;
}

std::string governing_card(const scene::Figures& figures) {
  if (!figures.governing_case) return {};
  const auto governs = std::ranges::find(figures.load_cases, *figures.governing_case, &scene::CaseFigures::name);
  if (governs == figures.load_cases.end()) return {};
  const scene::KeyBlockFigures& key = governs->figures;
  std::string told = display(key.volume_m3) + " m³";
  bool moves = key.count > 0;
  if (governs->groups && governs->groups->judged) {
    const scene::KeyGroupFigures& groups = *governs->groups;
    told += "; " + display_count(groups.count) + (groups.count == 1 ? " key group, " : " key groups, ") +
            display_count(groups.in_doubt) + " in doubt";
    moves = moves || groups.count + groups.in_doubt > 0;
  }
  return key_figure("Key blocks under " + escape_xml(governs->name),
                    "<a href=\"#load-cases\">" + display_count(key.count) + "</a>", told, moves ? "warn" : "");
}

}  // namespace cleave::report
