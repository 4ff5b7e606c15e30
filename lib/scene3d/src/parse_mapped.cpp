#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "cleave/core/nearest.hpp"
#include "cleave/geometry/tunnel.hpp"
#include "cleave/scene3d/bounds.hpp"
#include "cleave/scene3d/key_tables.hpp"
#include "context.hpp"
#include "mapped.hpp"

namespace cleave::scene {
namespace {

using geometry::Vec3;
using std::string_view;

constexpr NumberRule error_rule = rule::length.usually(0.001, 5);
constexpr NumberRule turn_rule{0, true, 45, false, " degrees"};

const KeyTable& face_keys() {
  static const KeyTable keys{
      .name = "mapped.face",
      .keys = {{"name", key::text(), "its number", "what the column `face` calls it"},
               {"corners", key::points(), "", "m, `[[x, y, z], ...]`: outline of what was seen, simple and planar"},
               {"excavation", key::text(), "", "a tunnel whose section is the face, in place of `corners`"},
               {"chainage", key::number(rule::length_or_zero), "", "m along the axis of that tunnel"}},
      .one_of = {{"corners", "excavation"}}};
  return keys;
}

const KeyTable& hole_keys() {
  static const KeyTable keys{.name = "mapped.hole",
                             .keys = {{"name", key::text(), "its number", "what the column `hole` calls it"},
                                      {"from", key::vector(rule::coordinate), required, "m: depth counts from here"},
                                      {"to", key::vector(rule::coordinate), required, "m"}}};
  return keys;
}

/// The name of a face or a hole: its own, or its number.
void take_name(const TableReader& table, std::vector<std::string>& names) {
  std::string name = table.text("name").value_or(std::to_string(names.size() + 1));
  if (std::ranges::find(names, name) != names.end()) {
    table.error("name", fmt::format("\"{}\" is used twice", name.substr(0, 60)), "choose another");
  }
  names.push_back(std::move(name));
}

/// The section of a tunnel at a chainage.
std::optional<std::vector<Vec3>> section_at(const TableReader& table, const std::vector<Excavation>& excavations) {
  const auto name = table.text("excavation");
  const auto chainage = table.need_number("chainage");
  if (!name || !chainage) return std::nullopt;
  std::vector<string_view> tunnels;
  for (const Excavation& e : excavations) {
    if (e.tunnel) tunnels.emplace_back(e.name);
  }
  const auto found =
      std::ranges::find_if(excavations, [&](const Excavation& e) { return e.tunnel && e.name == *name; });
  if (found == excavations.end()) {
    if (table.problems().is_unread(*name)) return std::nullopt;
    table.error("excavation", fmt::format("\"{}\" is no excavation of kind \"tunnel\"", name->substr(0, 60)),
                nearest_of(*name, tunnels, "tunnels"));
    return std::nullopt;
  }
  const TunnelLine& line = *found->tunnel;
  const std::vector<geometry::SectionFrame> frames = geometry::section_frames(line.axis, line.up);
  double left = *chainage, whole = 0;
  for (std::size_t s = 0; s < frames.size(); ++s) {
    const double length = norm(line.axis[s + 1] - line.axis[s]);
    whole += length;
    if (left > length) {
      left -= length;
      continue;
    }
    const Vec3 middle = line.axis[s] + left * frames[s].along;
    std::vector<Vec3> corners;
    for (const auto& [u, v] : line.outline) corners.push_back(middle + u * frames[s].right + v * frames[s].up);
    return corners;
  }
  table.error("chainage", fmt::format("is {:g} m, beyond the end of the axis", *chainage),
              fmt::format("its last one is {:.6g} m", whole));
  return std::nullopt;
}

void parse_face(const TableReader& table, const std::vector<Excavation>& excavations, MappedSettings& settings) {
  take_name(table, settings.faces);
  const TomlEntry* kind = table.one_of();
  if (kind == nullptr) return;
  const bool section = kind->key == "excavation";
  if (!section && table.has("chainage")) table.error("chainage", "has a meaning with excavation only", "remove it");
  auto corners = section ? section_at(table, excavations) : table.points("corners");
  if (!corners) return;
  auto outline = geometry::Polygon::make(*std::move(corners));
  if (!outline) {
    table.error(kind->key, describe(outline.error()), "");
    return;
  }
  settings.seen.faces.push_back({*std::move(outline)});
}

void parse_hole(const TableReader& table, MappedSettings& settings) {
  take_name(table, settings.holes);
  const auto from = table.need_vec3("from"), to = table.need_vec3("to");
  if (!from || !to) return;
  if (!(norm(*to - *from) > 0)) {
    table.error("to", "is where the hole begins", "give it a length");
    return;
  }
  settings.seen.holes.push_back({*from, *to});
}

/// Which sets are mapped, by number; all where none are named.
void parse_sets(const Context& context, const TableReader& table, const std::vector<RandomSet>& joint_sets,
                MappedSettings& settings) {
  settings.sets.assign(joint_sets.size(), 0);
  const auto named = table.texts("sets");
  std::vector<string_view> known;
  for (const RandomSet& set : joint_sets) known.emplace_back(context.sets[set.set].name);
  const auto take = [&](std::size_t number) {
    settings.sets[number] = 1;
    if (std::ranges::count(known, known[number]) > 1) {
      table.error("sets",
                  known[number] == "default"
                      ? std::string{"several [[joint_set]] have no name"}
                      : fmt::format("\"{}\" is the name of several [[joint_set]]", known[number].substr(0, 60)),
                  "give each a name of its own, so that rows can say which one they mean");
    } else if (const auto why = dfn::cannot_honour(joint_sets[number].law)) {
      table.error("sets",
                  fmt::format("set \"{}\" (line {}): {} {}", known[number].substr(0, 60), joint_sets[number].line,
                              why->key, why->what),
                  fmt::format("{}, or name the other sets in mapped.sets: this one is then drawn as if nothing had "
                              "been seen",
                              why->remedy));
    } else if (!(joint_sets[number].law.expected_p32(1) > 0)) {
      table.error("sets",
                  fmt::format("set \"{}\" (line {}) has the intensity 0: none of its joints can have been seen",
                              known[number].substr(0, 60), joint_sets[number].line),
                  "give it the intensity that was estimated, or name the other sets in mapped.sets");
    }
  };
  if (!named) {
    if (table.has("sets")) return;
    for (std::size_t i = 0; i < joint_sets.size(); ++i) take(i);
    return;
  }
  if (named->empty()) table.error("sets", "is empty", "name the sets that were mapped, or remove it: then all are");
  for (const std::string& name : *named) {
    const auto at = std::ranges::find(known, name);
    if (at == known.end()) {
      table.error("sets", fmt::format("\"{}\" is no [[joint_set]]", name.substr(0, 60)),
                  nearest_of(name, known, "sets"));
    } else if (settings.sets[static_cast<std::size_t>(at - known.begin())] != 0) {
      table.error("sets", fmt::format("\"{}\" is named twice", name.substr(0, 60)), "name it once");
    } else {
      take(static_cast<std::size_t>(at - known.begin()));
    }
  }
}

}  // namespace

std::string nearest_of(const std::string& name, std::span<const string_view> names, string_view kind) {
  if (names.empty()) return fmt::format("there are no {}", kind);
  if (const auto guess = nearest(name, names)) return fmt::format("did you mean \"{}\"?", *guess);
  std::string all;
  for (const string_view word : names.subspan(0, std::min<std::size_t>(names.size(), 20))) {
    all += (all.empty() ? "" : ", ") + std::string{word};
  }
  return fmt::format("{} are: {}{}", kind, all, names.size() > 20 ? ", ..." : "");
}

const KeyTable& mapped_keys() {
  static const KeyTable keys{
      .name = "mapped",
      .keys = {{"traces", key::text(), "", "CSV, one row a trace: [columns](mapped.md#traces)"},
               {"picks", key::text(), "", "CSV, one row a joint in a hole: [columns](mapped.md#picks)"},
               {"sets", key::texts(), "all `[[joint_set]]`",
                "names of the sets that were mapped; the others are drawn as if nothing had been seen"},
               {"shortest", key::number(rule::length_or_zero), "0", "m: shorter traces were not mapped"},
               {"error", key::number(error_rule), "0.1",
                "m: of the ends of traces, of picks, and of what a joint shows beside what was mapped"},
               {"angle_error", key::number(turn_rule), "3", "degrees: of the direction of a trace on its face"},
               declination_key(),
               {"face", key::tables(&face_keys), "", "`[[mapped.face]]`: where all traces were mapped"},
               {"hole", key::tables(&hole_keys), "", "`[[mapped.hole]]`: where all joints were picked"}}};
  return keys;
}

std::optional<MappedSettings> parse_mapped(Context& context, const TableReader& root,
                                           const std::vector<RandomSet>& joint_sets,
                                           const std::vector<Excavation>& excavations,
                                           const std::optional<geometry::Solid>& domain) {
  const auto found = root.sub("mapped");
  if (!found) return std::nullopt;
  const TableReader& table = *found;
  const std::size_t before = context.problems.errors();
  MappedSettings settings;
  settings.line = table.line();
  settings.seen.shortest = metres(table.value("shortest"));
  settings.seen.error = metres(table.value("error"));
  settings.seen.turn = dfn::Rotation::degrees(table.value("angle_error"));
  for (const TableReader& face : table.each("face")) parse_face(face, excavations, settings);
  for (const TableReader& hole : table.each("hole")) parse_hole(hole, settings);
  const auto wrong = [&](string_view key, std::string what, std::string remedy) {
    table.error(key, std::move(what), std::move(remedy));
  };
  if (settings.faces.empty() && settings.holes.empty()) {
    wrong("face", "is missing: nothing has been seen",
          "add a [[mapped.face]] or a [[mapped.hole]], or remove [mapped]");
  }
  if (table.has("traces") && settings.faces.empty()) {
    wrong("traces", "stands without a face", "add the [[mapped.face]] that the traces lie on");
  }
  if (table.has("picks") && settings.holes.empty()) {
    wrong("picks", "stands without a hole", "add the [[mapped.hole]] that they were picked in");
  }
  const std::size_t drawn = root.tables("joint_set").size();
  if (drawn == 0) wrong("sets", "are none: the scene has no [[joint_set]]", "add one, or remove [mapped]");
  if (drawn == 0 || joint_sets.size() != drawn) return settings;  // what is wrong with the sets is said
  parse_sets(context, table, joint_sets, settings);
  if (context.problems.errors() != before) {
    // Of files that are not looked into at least that they are there.
    for (const string_view key : {"traces", "picks"}) {
      if (table.has(key)) static_cast<void>(context.file(table, key));
    }
    return settings;
  }
  parse_mapped_rows(context, table, joint_sets, settings);
  if (context.problems.errors() == before) note_mapped(context, joint_sets, domain, settings);
  if (root.has("monte_carlo")) {
    context.problems.note(settings.line, "mapped", "how often a joint is not honoured is not counted in ensembles",
                          "cleave replay shows it for one realization");
  }
  return settings;
}

}  // namespace cleave::scene
