#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "cleave/core/nearest.hpp"
#include "cleave/scene3d/key_tables.hpp"
#include "cleave/stability/block_theory.hpp"
#include "context.hpp"
#include "domain_faces.hpp"

namespace cleave::scene {

std::optional<std::uint32_t> face_named(const TableReader& table, std::string_view key, const std::string& name,
                                        const geometry::Solid& domain) {
  const std::vector<std::string_view> known{domain.tags().begin(), domain.tags().end()};
  const auto it = std::ranges::find(known, name);
  if (it != known.end()) return static_cast<std::uint32_t>(it - known.begin());
  const auto guess = nearest(name, known);
  std::string all;
  for (const std::string_view word : known) all += (all.empty() ? "" : ", ") + std::string{word};
  table.error(key, fmt::format("\"{}\" is no face of the domain", name.substr(0, 60)),
              known.empty() ? "only a box or corners have faces with names: remove it"
                            : (guess ? fmt::format("did you mean \"{}\"? ", *guess) : std::string{}) +
                                  fmt::format("faces are: {}", all));
  return std::nullopt;
}

namespace {

using std::string_view;

std::vector<std::uint32_t> parse_free(const TableReader& table, const std::optional<geometry::Solid>& domain) {
  std::vector<std::uint32_t> tags;
  const auto names = table.texts("free");
  if (!names || !domain) return tags;
  for (const std::string& name : *names) {
    const auto tag = face_named(table, "free", name, *domain);
    if (tag && std::ranges::find(tags, *tag) == tags.end()) tags.push_back(*tag);
  }
  return tags;
}

using Readings = stability::TransferReadings;

constexpr NumberRule gravity_rule = rule::as_gravity({0, false, 1e3, false, " m/s2"});

const KeyTable& partial_keys() {
  static const KeyTable keys{.name = "partial",
                             .keys = {{"friction", key::number(rule::factor), "1", "divides tan(friction)"},
                                      {"cohesion", key::number(rule::factor), "1", "divides cohesion and tension"},
                                      {"weight", key::number(rule::factor), "1", "multiplies the weight"}}};
  return keys;
}

const KeyTable& target_keys() {
  static const KeyTable keys{.name = "target",
                             .keys = {{"falling", key::number(rule::factor), "1.5", "also of lifting"},
                                      {"sliding", key::number(rule::factor), "1.3", "also of wedges"}}};
  return keys;
}

const KeyTable& transfer_keys() {
  static const KeyTable keys{
      .name = "force_transfer",
      .keys = {{"reach", key::word<Readings::Reach>(), "\"any_earlier\"", "batches that forces pass to"},
               {"force", key::word<Readings::Force>(), "\"net\"", "what passes on"},
               {"along", key::word<Readings::Along>(), "\"motion\"", "direction in which it passes"},
               {"receiver", key::word<Readings::Receiver>(), "\"judged_anew\"", "motion of the block that receives"},
               {"stabilised", key::word<Readings::Stabilised>(), "\"keeps_batch\"", "a block that forces make stable"},
               {"interface", key::word<Readings::Interface>(), "\"ignored\"", "shear that a face can carry"},
               {"strengths", key::word<Readings::Strengths>(), "\"full\"",
                "at which blocks behind push on those that `[support]` holds"}}};
  return keys;
}

const KeyTable& maximum_keys() {
  static const KeyTable keys{
      .name = "maximum_blocks",
      .keys = {
          {"tunnel", key::text(), required, "name of an excavation of kind tunnel"},
          {"sets", key::texts(), "", "joint sets, three at least; none: all that have joints"},
          {"trace", key::number(rule::length), "",
           "m, longest trace of a joint on the wall: blocks are scaled down to it"},
          {"size", key::number(rule::length), "", "m, largest extent of a joint face: blocks are scaled down to it"}}};
  return keys;
}

stability::PartialFactors parse_partial(const TableReader& stability) {
  const auto table = stability.sub("partial");
  if (!table) return {};
  for (const std::string_view key : {"friction", "cohesion"}) {
    const double factor = table->value(key);
    if (factor < 1) {
      table->note(
          key, fmt::format("is {:g}: strengths are divided by it, so that one below 1 makes joints stronger", factor),
          fmt::format("for {:g} times the strength set {:.4g}", factor, 1 / factor));
    }
  }
  if (const double weight = table->value("weight"); weight < 1) {
    table->note("weight",
                fmt::format("is {:g}: weight is multiplied by it, so that one below 1 makes rock lighter", weight),
                "that of an unfavourable load is 1 or more");
  }
  const auto made =
      stability::PartialFactors::make(table->value("friction"), table->value("cohesion"), table->value("weight"));
  if (!made) stability.error("partial", describe(made.error()), "");
  return made.value_or(stability::PartialFactors{});
}

std::optional<Targets> parse_target(const TableReader& stability) {
  const auto table = stability.sub("target");
  if (!table) return std::nullopt;
  for (const std::string_view key : {"falling", "sliding"}) {
    if (table->value(key) < 1) table->note(key, "asks for a factor of safety below 1", "what moves would meet it");
  }
  return Targets{.falling = table->value("falling"), .sliding = table->value("sliding")};
}

/// true, false, or a table of readings (docs/stability.md).
void parse_transfer(const TableReader& stability, StabilitySettings& settings) {
  const TomlEntry* entry = stability.find("force_transfer");
  if (entry == nullptr) return;
  if (!std::holds_alternative<TomlTable>(entry->node.value)) {
    settings.force_transfer = stability.flag("force_transfer");
    return;
  }
  const TableReader table = *stability.sub("force_transfer");
  settings.transfer = {.reach = table.word<Readings::Reach>("reach"),
                       .force = table.word<Readings::Force>("force"),
                       .along = table.word<Readings::Along>("along"),
                       .receiver = table.word<Readings::Receiver>("receiver"),
                       .stabilised = table.word<Readings::Stabilised>("stabilised"),
                       .interface = table.word<Readings::Interface>("interface"),
                       .strengths = table.word<Readings::Strengths>("strengths")};
}

std::optional<MaximumBlockSettings> parse_maximum_blocks(const Context& context, const TableReader& stability,
                                                         const std::vector<Excavation>& excavations) {
  const auto found = stability.sub("maximum_blocks");
  if (!found) return std::nullopt;
  const TableReader& table = *found;
  MaximumBlockSettings settings;
  settings.line = table.line();
  settings.trace = table.number("trace").value_or(settings.trace);
  settings.size = table.number("size").value_or(settings.size);
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
    if (table.problems().is_unread(*name)) return std::nullopt;
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
  }
  for (const NamedSet& set : context.sets) {
    constexpr double half = 0.5;
    const JointProperties& p = set.properties;
    const auto median =
        joint_strength(p.friction.quantile(half), p.cohesion.quantile(half), p.tension.quantile(half), p.roughness);
    if (!median) table.problems().error(settings.line, "joints." + set.name, describe(median.error()), "");
    settings.medians.push_back(median.value_or(stability::JointStrength::none()));
  }
  return settings;
}

}  // namespace

const KeyTable& stability_keys() {
  static const KeyTable keys = [] {
    KeyTable table{
        .name = "stability",
        .keys = {
            {"free", key::texts(), "[]", "faces of the domain that are free; all others are rock that stays"},
            {"gravity", key::either({key::number(gravity_rule), key::vector(rule::acceleration)}), "9.81",
             "m/s2 downwards, or a vector"},
        }};
    for (Key& key : load_set_keys()) table.keys.push_back(std::move(key));
    const std::vector<Key> more{
        {"target", key::table(&target_keys), "",
         "`{ falling = 1.5, sliding = 1.3 }`: required factors of safety. Blocks below are counted (`below_target`) "
         "and "
         "`[support]` is checked against them"},
        {"partial", key::table(&partial_keys), "",
         "`{ friction, cohesion, weight }`: tan(friction), cohesion and tension are divided, weight is multiplied"},
        {"force_transfer", key::either({key::flag(), key::table(&transfer_keys)}), "true",
         "net forces of later batches pass to earlier ones; a table chooses between readings of Fu (2014): `{ reach = "
         "\"any_earlier\"/\"adjacent\", force = \"net\"/\"driving\", along = \"motion\"/\"normals\", receiver = "
         "\"judged_anew\"/\"keeps_mode\", stabilised = \"keeps_batch\"/\"batches_anew\", interface = "
         "\"ignored\"/\"strength\", strengths = \"full\"/\"target\" }`, [stability.md](stability.md)"},
        {"rotation", key::word<stability::RotationCheck>(), "\"flag\"",
         "single blocks that cannot slide are asked whether they turn (topple, twist): `\"flag\"` tells, `\"decide\"` "
         "makes those that do key blocks, `\"off\"` does not ask. Ensembles ask, too"},
        {"groups", key::word<stability::GroupsCheck>(), "\"note\"",
         "blocks near free faces are judged together too (key groups): `\"note\"` tells, in `key_groups.csv`, "
         "`\"decide\"` makes blocks of such groups key blocks, `\"off\"` does not ask. Ensembles ask with `\"decide\"` "
         "alone"},
        {"group_factor", key::flag(), "false",
         "true: the factor of safety of all blocks near free faces together, single ones too, without support: a "
         "bracket, `key_groups.stands_to` and `key_groups.moves_at` in `summary.json`. Costs some twenty searches for "
         "groups. Not in ensembles"},
        {"maximum_blocks", key::table(&maximum_keys), "",
         "`{ tunnel = \"NAME\", sets = [\"A\", \"B\", \"C\"] }`: largest key blocks that persistent joints of the "
         "sets' "
         "mean orientations can make at a straight tunnel with a convex section; without `sets` all that have joints, "
         "three "
         "at least; "
         "with `trace` (on the wall) or `size` (of a joint face), m, scaled down to joints that long"},
        {"max_batches", key::whole(1, 1'000'000), "50", "batches at most"},
        {"require_open_cone", key::flag(), "false",
         "true: a block counts as removable only when it can leave all its contacts at once", "strict"},
        {"cohesion_on_parallel_faces", key::flag(), "false",
         "true: cohesion counts on faces that are only brushed, too", "parallel_contact"},
        {"group_friction", key::word<stability::GroupFriction>(), "\"area_mean\"",
         "friction of coplanar contacts with several joints: mean by area, or `\"smallest\"`"}};
    table.keys.insert(table.keys.end(), more.begin(), more.end());
    return table;
  }();
  return keys;
}

void check_maximum_blocks(const Context& context, const std::optional<StabilitySettings>& stability,
                          const std::set<SetId>& used, const std::vector<RandomSet>& joint_sets) {
  if (!stability || !stability->maximum_blocks || context.problems.errors() != 0) return;
  const MaximumBlockSettings& wanted = *stability->maximum_blocks;
  const auto refuse = [&](std::string what, std::string remedy) {
    context.problems.error(wanted.line, "stability.maximum_blocks", std::move(what), std::move(remedy));
  };
  const std::set<SetId> sets = wanted.sets.empty() ? used : std::set<SetId>(wanted.sets.begin(), wanted.sets.end());
  for (const SetId set : sets) {
    if (!used.contains(set)) {
      refuse(fmt::format("names the set \"{}\", and no joint belongs to it", context.sets[set].name), "name another");
    }
    if (std::ranges::count(joint_sets, set, &RandomSet::set) > 1) {
      refuse("takes the joint sets without a name as one, with the orientation of the first", "give each a name");
    }
  }
  if (sets.size() < 3) {
    refuse(fmt::format("has {} of the three joint sets that make a block at a tunnel", sets.size()),
           wanted.sets.empty() ? "add joints of other sets, or remove it" : "name three sets, each once");
  }
}

ParsedStability parse_stability(const Context& context, const TableReader& root,
                                const std::optional<geometry::Solid>& domain,
                                const std::vector<Excavation>& excavations) {
  ParsedStability result;
  StabilitySettings settings;
  StatedLoads loads;
  geometry::Vec3 gravity = settings.loads.body.gravity();
  if (const auto found = root.sub("stability")) {
    const TableReader& table = *found;
    result.free_domain_tags = parse_free(table, domain);
    if (const TomlEntry* entry = table.find("gravity")) {
      if (std::holds_alternative<TomlArray>(entry->node.value)) {
        if (const auto vector = table.vec3("gravity")) gravity = *vector;
      } else {
        gravity = {0, 0, -table.value("gravity")};
      }
      if (gravity == geometry::Vec3{}) {
        table.note("gravity", "is 0, so that blocks have no weight", "that of the earth is 9.81");
      } else if (gravity.z > 0) {
        table.note("gravity", "points upwards, as z does: what is taken out of a roof would fall upwards",
                   "write gravity = 9.81, or [0, 0, -9.81]");
      } else if (std::hypot(gravity.x, gravity.y) > -gravity.z) {
        table.note("gravity", "acts more sideways than down",
                   "z is up: write gravity = 9.81, or [0, 0, -9.81]; an earthquake is `seismic`");
      }
    }
    loads = parse_load_set(context, table, domain, excavations);
    settings.loads = checked(context, loads, gravity);
    settings.partial = parse_partial(table);
    settings.target = parse_target(table);
    parse_transfer(table, settings);
    settings.rotation = table.word<stability::RotationCheck>("rotation");
    settings.groups = table.word<stability::GroupsCheck>("groups");
    settings.group_factor = table.flag("group_factor");
    if (settings.group_factor && settings.groups == stability::GroupsCheck::off) {
      table.error("group_factor", "is of blocks judged together, but groups is \"off\"", "set groups = \"note\"");
    }
    settings.maximum_blocks = parse_maximum_blocks(context, table, excavations);
    settings.max_batches = static_cast<std::uint32_t>(table.count("max_batches"));
    settings.strict = table.flag("require_open_cone");
    settings.parallel_contact = table.flag("cohesion_on_parallel_faces");
    settings.group_friction = table.word<stability::GroupFriction>("group_friction");
  }
  settings.cases = parse_load_cases(context, root, domain, excavations, loads, settings.target, gravity);
  // Without anything free no block can move, so there is nothing to judge, [stability] or not.
  if (!excavations.empty() || !result.free_domain_tags.empty()) result.settings = settings;
  return result;
}

}  // namespace cleave::scene
