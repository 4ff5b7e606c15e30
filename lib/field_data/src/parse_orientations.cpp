#include "parse_orientations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cleave/core/fields.hpp"
#include "cleave/geometry/orientation.hpp"

namespace cleave::scene {
namespace {

using geometry::Vec3;
using std::string_view;

const KeyTable& line_direction_keys() {
  static const KeyTable keys{.name = "orientations.line",
                             .keys = {{"trend", key::number(trend_rule), required, "degrees"},
                                      {"plunge", key::number(plunge_rule), required, "degrees below horizontal"},
                                      core_reference_key()}};
  return keys;
}

const KeyTable& outcrop_keys() {
  static const KeyTable keys{
      .name = "orientations.outcrop",
      .keys = {{"dip", key::number(rule::dip), required, "degrees"},
               {"dip_direction", key::number(rule::dip_direction), required, "degrees"},
               {"width", key::number(rule::length), "", "m, along its strike"},
               {"height", key::number(rule::length), "", "m, up its dip"},
               {"diameter", key::number(rule::length), "",
                "m, of the joints, as discs: with `width` and `height` joints count by how many of them such an "
                "outcrop meets (Kulatilake & Wu 1984), else by 1/sin V"}}};
  return keys;
}

const KeyTable& traverse_keys() {
  static const KeyTable keys{
      .name = "orientations.traverse",
      .keys = {{"name", key::text(), required, "as the table's column `traverse` has it"},
               {"line", key::table(&line_direction_keys), "", "`{ trend, plunge }` of a line or borehole"},
               {"outcrop", key::table(&outcrop_keys), "", "`{ dip, dip_direction }` of an outcrop"}}};
  return keys;
}

/// How joints were met.
struct Traverse {
  std::optional<Vec3> line = {}, window = {};
  std::optional<survey::OutcropSize> outcrop = {};
  std::optional<Core> core = {};
};

class OrientationsParser final {
 public:
  OrientationsParser(InputContext& context, const TableReader& table, survey::SurveyInput& input)
      : context_{context}, table_{table}, in_{input} {}

  void run(std::size_t& empty) {
    const auto file = context_.file(table_, "file");
    if (!file && !table_.has("file")) table_.missing("file", "add file = \"poles.csv\"");
    if (!file) return;
    const auto data = read_survey_table(context_, *file, table_.texts("columns").value_or(std::vector<std::string>{}));
    if (!data) return;
    core_ = has_core_angles(*data);
    if (!check_halves(context_, *file, *data)) return;
    if (!core_ && !has_orientation(*data)) {
      context_.problems.error_in(file->shown, 1, "columns", "lacks the columns of an orientation",
                                 "give dip with dip_direction or strike (right-hand rule), trend and plunge of the "
                                 "pole, or alpha and beta of an oriented core");
      return;
    }
    const bool good = check_columns(
        context_, *file, *data,
        {"dip", "dip_direction", "strike", "trend", "plunge", "alpha", "beta", "set", "quantity", "traverse"},
        "trace lengths and distances are of a [[scanline]] or [[borehole]], traces of a [[window]]: "
        "they say how joints were met; for a spacing alone write the set into the scene");
    if (!good) return;
    note_radians(context_, *file, *data);
    const Traverse whole = traverse_of(table_);
    read_traverses(*file, *data);
    rows(*file, *data, whole, empty);
  }

 private:
  void rows(const LoadedFile& file, const SurveyTable& data, const Traverse& whole, std::size_t& empty) {
    RowRules rules{.wrap = table_.flag("wrap"), .declination = table_.value("declination")};
    const auto set = table_.text("set");
    std::size_t wrong = 0;
    for (const SurveyTable::Row& row : data.rows) {
      const std::size_t before = context_.problems.errors();
      const Traverse* met = met_on(file, data, row, whole);
      std::optional<Vec3> normal;
      if (met != nullptr) {
        rules.core = met->core;
        if (core_ && !rules.core) {
          context_.problems.error_in(file.shown, row.line, "alpha", "needs the line of its core",
                                     "add line = { trend, plunge } to the table, or to the traverse of this row");
          return;
        }
        normal = normal_of_row(context_, file, data, row, rules);
      }
      if (normal) {
        const std::string name = set_of_row(context_, file, data, row, set.value_or(""));
        for (std::size_t i = quantity_of(context_, file, data, row); i > 0; --i) {
          in_.orientations.push_back({*normal, name, met->line, met->window, met->outcrop});
        }
        if (too_many(context_, file, in_.orientations.size())) return;
      }
      if (context_.problems.errors() != before) {
        if (++wrong >= 20) return;
      } else if (!normal) {
        ++empty;
      }
    }
  }

  /// Empty after a report.
  const Traverse* met_on(const LoadedFile& file, const SurveyTable& data, const SurveyTable::Row& row,
                         const Traverse& whole) {
    const auto at = data.column("traverse");
    if (!at || traverses_.empty() || *at >= row.cells.size() || row.cells[*at].empty()) return &whole;
    const auto found = traverses_.find(row.cells[*at]);
    if (found != traverses_.end()) return &found->second;
    context_.problems.error_in(file.shown, row.line, "traverse",
                               fmt::format("\"{}\" is not described", row.cells[*at].substr(0, 40)),
                               "add an [[orientations.traverse]] of that name");
    return nullptr;
  }

  void read_traverses(const LoadedFile& file, const SurveyTable& data) {
    for (const TableReader& one : table_.each("traverse")) {
      const auto name = one.need_text("name");
      if (!one.has("line") && !one.has("outcrop")) {
        one.missing("line", "add line = { trend, plunge } or outcrop = { dip, dip_direction }");
      }
      Traverse traverse = traverse_of(one);
      if (name && !traverses_.emplace(*name, std::move(traverse)).second) {
        one.error("name", "is that of another traverse", "choose another");
      }
    }
    if (!traverses_.empty() && !data.column("traverse")) {
      context_.problems.error_in(file.shown, 1, "columns", "lacks the column traverse",
                                 "add it, or remove [[orientations.traverse]]");
    }
    if (traverses_.empty() && data.column("traverse")) {
      context_.problems.note_in(file.shown, 1, "traverse", "is not used: how each was laid is not described",
                                "add [[orientations.traverse]] with name and line or outcrop");
    }
  }

  Traverse traverse_of(const TableReader& table) {
    Traverse traverse;
    if (table.has("line") && table.has("outcrop")) {
      table.error("outcrop", "stands beside line", "give one of them");
    }
    if (const auto reader = table.sub("line")) {
      const auto trend = reader->need_number("trend"), plunge = reader->need_number("plunge");
      if (trend && plunge) traverse.line = line_of(context_, *trend, *plunge);
      if (reader->has("reference") && !core_) {
        reader->error("reference", "belongs to a table with the columns alpha and beta", "remove it, or add them");
      }
      if (traverse.line && core_) traverse.core = parse_core(context_, *reader, *traverse.line);
    }
    if (const auto reader = table.sub("outcrop")) outcrop(*reader, traverse);
    return traverse;
  }

  void outcrop(const TableReader& reader, Traverse& traverse) {
    const auto dip = reader.need_number("dip"), direction = reader.need_number("dip_direction");
    if (!dip || !direction) return;
    traverse.window = normal_of(context_, *dip, *direction);
    const auto width = reader.number("width"), height = reader.number("height"), diameter = reader.number("diameter");
    if (width && height && diameter) {
      traverse.outcrop = {geometry::strike_vector(context_.turned(*direction)), metres(*width), metres(*height),
                          metres(*diameter)};
    } else if (width || height || diameter) {
      reader.missing(!width ? "width" : !height ? "height" : "diameter", "give width, height and diameter, or none");
    }
  }

  InputContext& context_;
  const TableReader& table_;
  survey::SurveyInput& in_;
  bool core_ = false;
  std::map<std::string, Traverse, std::less<>> traverses_;
};

}  // namespace

Key core_reference_key() {
  return {
      "reference", key::either({key::word<CoreReference>(), key::number(trend_rule)}), "\"bottom\"",
      "where the line along an oriented core lies that `beta` is measured from, clockwise seen down the hole, to "
      "the lower end of the ellipse: `\"bottom\"` or `\"top\"` of the hole, or towards an azimuth (degrees; vertical "
      "holes)"};
}

std::optional<Core> parse_core(InputContext& context, const TableReader& table, Vec3 line) {
  const TomlEntry* entry = table.find("reference");
  std::optional<Core> core;
  if (entry != nullptr && !std::holds_alternative<std::string>(entry->node.value)) {
    const auto azimuth = table.number("reference");
    if (!azimuth) return std::nullopt;
    core = core_of(context, line, *azimuth);
    if (!core) table.error("reference", "is the direction of the hole itself", "give another azimuth, bottom or top");
    return core;
  }
  const std::size_t before = context.problems.errors();
  core = core_of(line, table.word<CoreReference>("reference"));
  if (!core && context.problems.errors() == before) {
    table.error("reference", "is missing: a vertical hole has no lower side",
                "give the azimuth of the line along the core: reference = 30");
  }
  return core;
}

bool too_many(InputContext& context, const LoadedFile& file, std::size_t joints) {
  constexpr std::size_t most = 1'000'000;
  if (joints <= most) return false;
  context.problems.error_in(file.shown, 1, "quantity", fmt::format("the rows stand for more than {} joints", most),
                            "give fewer");
  return true;
}

const KeyTable& orientations_keys() {
  static const KeyTable keys{
      .name = "orientations",
      .keys = {{"file", key::text(), required,
                "table with `dip` and `dip_direction` or `strike` (right-hand rule), `trend` and `plunge` of the pole, "
                "or `alpha` and `beta` of an oriented core; `set`, `quantity` (of like joints) and `traverse` where "
                "there are such columns"},
               {"set", key::text(), "", "of all rows; or a column `set`"},
               {"columns", key::texts(), "[]", "names of the columns of a table without a header"},
               {"wrap", key::flag(), "false", "true: accept angles outside their range: -35/400 is 35/220"},
               declination_key(),
               {"line", key::table(&line_direction_keys), "", "`{ trend, plunge }` they were met on"},
               {"outcrop", key::table(&outcrop_keys), "", "`{ dip, dip_direction }` they were met on"},
               {"traverse", key::tables(&traverse_keys), "[]",
                "`name` with `line` or `outcrop`: rows with that word in the column `traverse` were met on it"}}};
  return keys;
}

void parse_orientations(InputContext& context, const TableReader& table, survey::SurveyInput& input,
                        std::size_t& empty) {
  OrientationsParser{context, table, input}.run(empty);
}

}  // namespace cleave::scene
