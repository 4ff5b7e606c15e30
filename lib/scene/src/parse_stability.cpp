#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "cleave/stability/maximum_blocks.hpp"
#include "context.hpp"
#include "nearest.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

std::vector<std::uint32_t> parse_free(const TableReader& table, const std::optional<geometry::Solid>& domain) {
  std::vector<std::uint32_t> tags;
  const auto names = table.texts("free");
  if (!names || !domain) return tags;
  std::vector<string_view> known{domain->tags().begin(), domain->tags().end()};
  for (const std::string& name : *names) {
    const auto it = std::ranges::find(known, name);
    if (it == known.end()) {
      const auto guess = nearest(name, known);
      std::string all;
      for (const string_view word : known) all += (all.empty() ? "" : ", ") + std::string{word};
      table.error("free", fmt::format("\"{}\" is no face of the domain", name.substr(0, 60)),
                  known.empty() ? "only a box or corners have faces with names: remove it"
                                : (guess ? fmt::format("did you mean \"{}\"? ", *guess) : std::string{}) +
                                      fmt::format("faces are: {}", all));
      continue;
    }
    const auto tag = static_cast<std::uint32_t>(it - known.begin());
    if (std::ranges::find(tags, tag) == tags.end()) tags.push_back(tag);
  }
  return tags;
}

PartialFactors parse_partial(const TableReader& stability) {
  PartialFactors factors;
  const TomlTable* found = stability.table("partial");
  if (found == nullptr) return factors;
  constexpr std::array<string_view, 3> keys{"friction", "cohesion", "weight"};
  constexpr NumberRule factor{0, true, 100, false, ""};
  const TableReader table{*found, stability.line_of("partial"), stability.path_of("partial"), stability.problems(),
                          keys};
  factors.friction = table.number("friction", factor).value_or(1);
  factors.cohesion = table.number("cohesion", factor).value_or(1);
  factors.weight = table.number("weight", factor).value_or(1);
  return factors;
}

std::optional<Targets> parse_target(const TableReader& stability) {
  const TomlTable* found = stability.table("target");
  if (found == nullptr) return std::nullopt;
  constexpr std::array<string_view, 2> keys{"falling", "sliding"};
  constexpr NumberRule factor{0, true, 100, false, ""};
  const TableReader table{*found, stability.line_of("target"), stability.path_of("target"), stability.problems(), keys};
  Targets targets;
  targets.falling = table.number("falling", factor).value_or(targets.falling);
  targets.sliding = table.number("sliding", factor).value_or(targets.sliding);
  return targets;
}

/// true, false, or a table of readings (docs/stability.md).
void parse_transfer(const TableReader& stability, StabilitySettings& settings) {
  const TomlEntry* entry = stability.find("force_transfer");
  if (entry == nullptr) return;
  if (!std::holds_alternative<TomlTable>(entry->node.value)) {
    if (const auto transfer = stability.boolean("force_transfer")) settings.force_transfer = *transfer;
    return;
  }
  using Readings = stability::TransferReadings;
  constexpr std::array<string_view, 6> keys{"reach", "force", "along", "receiver", "stabilised", "interface"};
  const TableReader table{std::get<TomlTable>(entry->node.value), stability.line_of("force_transfer"),
                          stability.path_of("force_transfer"), stability.problems(), keys};
  const auto second = [&](string_view key, string_view first, string_view other) {
    const std::array<string_view, 2> words{first, other};
    return table.choice(key, words).value_or(0) == 1;
  };
  Readings& readings = settings.transfer;
  if (second("reach", "any_earlier", "adjacent")) readings.reach = Readings::Reach::adjacent;
  if (second("force", "net", "driving")) readings.force = Readings::Force::driving;
  if (second("along", "motion", "normals")) readings.along = Readings::Along::normals;
  if (second("receiver", "judged_anew", "keeps_mode")) readings.receiver = Readings::Receiver::keeps_mode;
  if (second("stabilised", "keeps_batch", "batches_anew")) readings.stabilised = Readings::Stabilised::batches_anew;
  if (second("interface", "ignored", "strength")) readings.interface = Readings::Interface::strength;
}

std::optional<MaximumBlockSettings> parse_maximum_blocks(const Context& context, const TableReader& stability,
                                                         const std::vector<Excavation>& excavations) {
  const TomlTable* found = stability.table("maximum_blocks");
  if (found == nullptr) return std::nullopt;
  constexpr std::array<string_view, 2> keys{"tunnel", "sets"};
  MaximumBlockSettings settings;
  settings.line = stability.line_of("maximum_blocks");
  const TableReader table{*found, settings.line, stability.path_of("maximum_blocks"), stability.problems(), keys};
  const auto name = table.need_text("tunnel");
  if (!name) return std::nullopt;
  std::vector<string_view> tunnels;
  const Excavation* tunnel = nullptr;
  for (std::uint32_t i = 0; i < excavations.size(); ++i) {
    if (excavations[i].tunnel) tunnels.emplace_back(excavations[i].name);
    if (!excavations[i].tunnel || excavations[i].name != *name || tunnel != nullptr) continue;
    tunnel = &excavations[i];
    settings.excavation = i;
  }
  if (tunnel == nullptr) {
    const auto guess = nearest(*name, tunnels);
    table.error("tunnel", fmt::format("\"{}\" is no excavation of kind \"tunnel\"", name->substr(0, 60)),
                guess ? fmt::format("did you mean \"{}\"?", *guess) : "name an [[excavation]] of that kind");
    return std::nullopt;
  }
  if (tunnel->tunnel->axis.size() != 2) {
    table.error("tunnel", "is not straight", "block theory needs a tunnel whose axis has two points");
  }
  if (!stability::is_convex(tunnel->tunnel->outline)) {
    table.error("tunnel", "has a section that is not convex", "block theory needs a convex section");
  }
  if (const auto names = table.texts("sets")) {
    std::vector<string_view> known;
    for (const NamedSet& set : context.sets) known.emplace_back(set.name);
    for (const std::string& set : *names) {
      const auto it = std::ranges::find(known, set);
      if (it == known.end()) {
        const auto guess = nearest(set, known);
        table.error("sets", fmt::format("\"{}\" is no joint set", set.substr(0, 60)),
                    guess ? fmt::format("did you mean \"{}\"?", *guess) : "name sets of [[joint]] or [[joint_set]]");
        continue;
      }
      const SetId id{static_cast<std::size_t>(it - known.begin())};
      if (std::ranges::find(settings.sets, id) == settings.sets.end()) settings.sets.push_back(id);
    }
    if (settings.sets.size() < 3 && settings.sets.size() == names->size()) {
      table.error("sets", "names fewer than three sets", "three planes make a block at a tunnel");
    }
  }
  return settings;
}

}  // namespace

ParsedStability parse_stability(const Context& context, const TableReader& root,
                                const std::optional<geometry::Solid>& domain,
                                const std::vector<Excavation>& excavations) {
  constexpr std::array<string_view, 16> keys{
      "rotation", "maximum_blocks", "free",      "gravity", "seismic", "partial", "force_transfer",   "max_batches",
      "target",   "water",          "surcharge", "point",   "line",    "strict",  "parallel_contact", "group_friction"};
  constexpr std::array<string_view, 2> frictions{"area_mean", "smallest"};
  ParsedStability result;
  StabilitySettings settings;
  const TomlTable* found = root.table("stability");
  if (found != nullptr) {
    const TableReader table{*found, root.line_of("stability"), "stability", root.problems(), keys};
    result.free_domain_tags = parse_free(table, domain);
    if (const TomlEntry* gravity = table.find("gravity")) {
      constexpr NumberRule strength{0, false, 1e3, false, " m/s2"};
      if (std::holds_alternative<TomlArray>(gravity->node.value)) {
        if (const auto vector = table.vec3("gravity", rule::acceleration)) settings.gravity = *vector;
      } else if (const auto value = table.number("gravity", strength)) {
        settings.gravity = {0, 0, -*value};
      }
    }
    settings.loads = parse_load_set(context, table, domain, excavations);
    settings.seismic = settings.loads.seismic;
    settings.partial = parse_partial(table);
    settings.target = parse_target(table);
    parse_transfer(table, settings);
    constexpr std::array<string_view, 3> rotations{"off", "flag", "decide"};
    constexpr std::array checks{stability::RotationCheck::off, stability::RotationCheck::flag,
                                stability::RotationCheck::decide};
    if (const auto word = table.choice("rotation", rotations)) settings.rotation = checks.at(*word);
    settings.maximum_blocks = parse_maximum_blocks(context, table, excavations);
    if (const auto most = table.integer("max_batches", 1, 1'000'000)) {
      settings.max_batches = static_cast<std::uint32_t>(*most);
    }
    settings.strict = table.boolean("strict").value_or(false);
    settings.parallel_contact = table.boolean("parallel_contact").value_or(false);
    if (table.choice("group_friction", frictions).value_or(0) == 1) {
      settings.group_friction = stability::GroupFriction::smallest;
    }
  }
  settings.cases = parse_load_cases(context, root, domain, excavations, settings.loads);
  // Without anything free no block can move, so there is nothing to judge, [stability] or not.
  if (!excavations.empty() || !result.free_domain_tags.empty()) result.settings = settings;
  return result;
}

OutputSettings parse_output(const TableReader& root) {
  constexpr std::array<string_view, 6> keys{"vtu", "report", "csv", "exports", "blocks", "section"};
  OutputSettings output;
  const TomlTable* found = root.table("output");
  if (found == nullptr) return output;
  const TableReader table{*found, root.line_of("output"), "output", root.problems(), keys};
  output.vtu = table.boolean("vtu").value_or(output.vtu);
  output.csv = table.boolean("csv").value_or(output.csv);
  output.report = table.boolean("report").value_or(output.report);
  if (table.has("blocks")) {
    constexpr std::array<string_view, 2> extents{"all", "key"};
    output.only_key_blocks = table.choice("blocks", extents) == std::size_t{1};
  }
  for (const std::string& name : table.texts("exports").value_or(std::vector<std::string>{})) {
    if (std::ranges::find(known_exports, name) == known_exports.end()) {
      table.error("exports", fmt::format("\"{}\" is not known", name),
                  fmt::format("did you mean {}? There are {}", nearest(name, known_exports).value_or("obj"),
                              fmt::join(known_exports, ", ")));
    } else if (std::ranges::find(output.exports, name) == output.exports.end()) {
      output.exports.push_back(name);
    }
  }
  const auto sections = table.tables("section");
  for (std::size_t i = 0; i < sections.size(); ++i) {
    constexpr std::array<string_view, 4> section_keys{"name", "through", "azimuth", "level"};
    constexpr std::array<string_view, 2> kinds{"azimuth", "level"};
    const TableReader section{*std::get_if<TomlTable>(&sections[i]->value), sections[i]->line,
                              sections.size() == 1 ? "output.section" : fmt::format("output.section[{}]", i + 1),
                              root.problems(), section_keys};
    SectionSpec spec;
    spec.name = section.text("name").value_or("");
    if (!std::ranges::all_of(spec.name, [](char c) {
          return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
        })) {
      section.error("name", "becomes part of a file's name", "use letters, digits, - and _ only");
    }
    if (std::ranges::find(output.sections, spec.name, &SectionSpec::name) != output.sections.end()) {
      section.error("name", "is that of an earlier section", "give each section a name of its own");
    }
    const TomlEntry* kind = section.one_of(kinds);
    if (kind == nullptr) continue;
    spec.horizontal = kind->key == "level";
    if (spec.horizontal) {
      spec.through.z = section.number("level", rule::coordinate).value_or(0);
    } else {
      spec.through = section.need_vec3("through", rule::coordinate).value_or(geometry::Vec3{});
      spec.azimuth = section.number("azimuth", rule::turn).value_or(90) + root.number("north", rule::turn).value_or(0);
    }
    output.sections.push_back(std::move(spec));
  }
  return output;
}

}  // namespace cleave::scene
