#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "cleave/core/nearest.hpp"
#include "cleave/scene/common_keys.hpp"

namespace cleave::scene {
namespace {

using std::string_view;

constexpr std::array<string_view, 2> extents{"all", "key"};

const KeyTable& cross_section_keys() {
  static const KeyTable keys{
      .name = "output.section",
      .keys = {{"name", key::text(), "", "makes the file `section_NAME.toml`"},
               {"through", key::vector(rule::coordinate), "", "m, a point of a vertical section"},
               {"azimuth", key::number(rule::turn), "90",
                "degrees clockwise from north: where the x axis of a vertical section points"},
               {"level", key::number(rule::coordinate), "", "m, z of a horizontal section"}},
      .one_of = {{"azimuth", "level"}}};
  return keys;
}

}  // namespace

const KeyTable& project_keys() {
  static const KeyTable keys{.name = "project",
                             .keys = {{"name", key::text(), "", "of the project"},
                                      {"author", key::text(), "", "who made the scene"},
                                      {"client", key::text(), "", "for whom"},
                                      {"date", key::text(), "", "as it shall be shown: `\"2025-03-01\"`"}}};
  return keys;
}

Project parse_project(const TableReader& root) {
  const auto table = root.sub("project");
  if (!table) return {};
  const auto text = [&](string_view key) { return table->text(key).value_or(""); };
  return {.name = text("name"), .author = text("author"), .client = text("client"), .date = text("date")};
}

const KeyTable& output_keys() {
  static const KeyTable keys{
      .name = "output",
      .keys = {
          {"vtu", key::flag(), "true", "write `blocks.vtu`"},
          {"csv", key::flag(), "true", "write `key_blocks.csv`"},
          {"report", key::flag(), "true", "write `report.html`"},
          {"exports", key::array(key::word(known_exports)), "[]",
           "the blocks for other programs, as `blocks.obj` and so on, below"},
          {"blocks", key::word(extents), "\"all\"", "`\"key\"`: only key blocks are asked for, below"},
          {"section", key::tables(&cross_section_keys), "", "sections of the blocks as scenes of contact, below"}}};
  return keys;
}

OutputSettings parse_output(const TableReader& root) {
  OutputSettings output;
  const auto found = root.sub("output");
  if (!found) return output;
  const TableReader& table = *found;
  output.vtu = table.flag("vtu");
  output.csv = table.flag("csv");
  output.report = table.flag("report");
  output.only_key_blocks = table.choice("blocks") == std::size_t{1};
  for (const std::string& name : table.texts("exports").value_or(std::vector<std::string>{})) {
    if (std::ranges::find(known_exports, name) == known_exports.end()) {
      table.error("exports", fmt::format("\"{}\" is not known", name),
                  fmt::format("did you mean {}? There are {}", nearest(name, known_exports).value_or("obj"),
                              fmt::join(known_exports, ", ")));
    } else if (std::ranges::find(output.exports, name) == output.exports.end()) {
      output.exports.push_back(name);
    }
  }
  for (const TableReader& section : table.each("section")) {
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
    const TomlEntry* kind = section.one_of();
    if (kind == nullptr) continue;
    spec.horizontal = kind->key == "level";
    if (spec.horizontal) {
      spec.through.z = section.number("level").value_or(0);
    } else {
      spec.through = section.need_vec3("through").value_or(geometry::Vec3{});
      spec.azimuth = section.value("azimuth") + root.value("north");
    }
    output.sections.push_back(std::move(spec));
  }
  return output;
}

}  // namespace cleave::scene
