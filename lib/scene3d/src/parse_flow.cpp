#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <variant>

#include "cleave/scene3d/key_tables.hpp"
#include "context.hpp"
#include "domain_faces.hpp"

namespace cleave::scene {
namespace {

constexpr NumberRule viscosity_rule = NumberRule{0, true, 1e3, false, " m2/s"}.usually(2e-7, 1e-4);
constexpr NumberRule tolerance_rule{1e-6, false, 10, false, ""};
constexpr std::array<std::string_view, 1> known_meshes{"pflotran"};

const KeyTable& flow_side_keys() {
  static const KeyTable keys{
      .name = "flow.side",
      .keys = {{"face", key::text(), required, "a face of the domain, as `stability.free` names them"},
               {"level", key::number(rule::coordinate), "", "m, z: water stands there to this level"},
               {"closed", key::flag(), "false", "no water passes"}}};
  return keys;
}

void parse_exports(const TableReader& table, bool ensemble, FlowSettings& settings) {
  for (const std::string& name : table.texts("exports").value_or(std::vector<std::string>{})) {
    if (std::ranges::find(known_meshes, name) == known_meshes.end()) {
      table.error("exports", fmt::format("\"{}\" is not known", name), "the mesh is written for \"pflotran\"");
      continue;
    }
    settings.pflotran = true;
  }
  if (settings.pflotran && !settings.flows()) {
    table.error("exports", "wants heads, and no water stands anywhere",
                "give [flow] a level, or [[flow.side]] one; flow.vtu has the mesh without water");
  }
  if (settings.pflotran && ensemble) {
    table.note("exports", "writes the mesh of one network, and an ensemble has many",
               "cleave replay writes that of a realization");
  }
}

/// Whether [joints] says something of it, right or wrong.
bool states_aperture(const TableReader& root, std::string_view set) {
  const TomlEntry* joints = root.find("joints");
  const auto* tables = joints != nullptr ? std::get_if<TomlTable>(&joints->node.value) : nullptr;
  if (tables == nullptr) return false;
  return std::ranges::any_of(tables->entries, [&](const TomlEntry& entry) {
    const auto* table = std::get_if<TomlTable>(&entry.node.value);
    return (entry.key == set || entry.key == "default") && table != nullptr &&
           std::ranges::find(table->entries, "aperture", &TomlEntry::key) != table->entries.end();
  });
}

void parse_side(const TableReader& table, const std::optional<geometry::Solid>& domain, FlowSettings& settings) {
  const auto name = table.need_text("face");
  const auto level = table.number("level");
  const bool closed = table.flag("closed");
  if (level.has_value() == closed) {
    table.error(closed ? "closed" : "level", closed ? "stands beside a level" : "is missing",
                "give either level = 80, or closed = true");
  }
  if (!name || !domain) return;
  const auto tag = face_named(table, "face", *name, *domain);
  if (!tag) return;
  if (std::ranges::find(settings.sides, *tag, &FlowSide::tag) != settings.sides.end()) {
    table.error("face", fmt::format("\"{}\" is named twice", *name), "name it once");
    return;
  }
  settings.sides.push_back({*tag, closed || !level ? std::nullopt : std::optional{metres(*level)}});
}

}  // namespace

const KeyTable& flow_keys() {
  static const KeyTable keys{
      .name = "flow",
      .keys = {{"level", key::number(rule::coordinate), "",
                "m, z: water stands to this level on all fixed sides of the domain that no `side` names and no opening "
                "cuts. "
                "Without any level only what hangs together is looked at"},
               {"side", key::tables(&flow_side_keys), "", "`[[flow.side]]`: a level of its own for one face, or none"},
               {"viscosity", key::number(viscosity_rule), "1.004e-6", "m2/s, kinematic: water at 20 degrees"},
               {"tolerance", key::number(tolerance_rule), "0.02",
                "half width of the bounds of the inflow over the inflow: the mesh is refined until then"},
               {"max_triangles", key::whole(1000, 20'000'000), "1000000", "the mesh grows no further"},
               {"exports", key::array(key::word(known_meshes)), "[]",
                "the mesh with its water for other programs, as `flow_mesh.uge` and so on ([flow.md](flow.md))"}}};
  return keys;
}

std::optional<FlowSettings> parse_flow(const TableReader& root, const Context& context, const std::set<SetId>& used,
                                       const std::optional<geometry::Solid>& domain) {
  const auto found = root.sub("flow");
  if (!found) return std::nullopt;
  const TableReader& table = *found;
  FlowSettings settings;
  settings.line = table.line();
  if (const auto level = table.number("level")) settings.level = metres(*level);
  for (const TableReader& side : table.each("side")) parse_side(side, domain, settings);
  settings.viscosity = Transmissivity::from_si(table.value("viscosity"));
  settings.tolerance = table.value("tolerance");
  settings.most_triangles = static_cast<std::size_t>(table.count("max_triangles"));
  parse_exports(table, root.has("monte_carlo"), settings);
  if (!settings.flows()) return settings;
  for (const SetId set : used) {
    if (context.sets[set].properties.aperture || states_aperture(root, context.sets[set].name)) continue;
    table.problems().error(table.line(), "joints." + context.sets[set].name + ".aperture",
                           "is missing, and water flows in all joints",
                           "give every set an aperture in m, or one for all: [joints.default] aperture = 1e-4");
  }
  return settings;
}

void check_flow_water(const Context& context, const std::optional<StabilitySettings>& stability,
                      const std::optional<FlowSettings>& flow, bool stages) {
  if (!stability) return;
  const auto check = [&](const LoadSet& loads) {
    if (!loads.flow) return;
    const auto refuse = [&](const char* what, const char* remedy) {
      context.problems.error(loads.line, "water.flow", what, remedy);
    };
    if (!flow || !flow->flows()) {
      refuse("asks for pressures of [flow], and no water flows there",
             "add [flow] with a level, or give water a table");
    } else if (stages) {
      refuse("asks for pressures of [flow], which are found for the final state, not for stages of excavation",
             "give water a table, or judge the final state alone: one stage");
    }
  };
  check(stability->loads);
  for (const LoadCase& load : stability->cases) check(load.loads);
}

}  // namespace cleave::scene
