#include "html_table.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "html_parts.hpp"

namespace cleave::report {
namespace {

/// The longest suffix stands first.
constexpr std::array<ShownUnit, 11> units{{{"_n_per_m", "kN/m", 1e-3},
                                           {"_m_s", "m/s", 1},
                                           {"_pa", "kPa", 1e-3},
                                           {"_m3", "m³", 1},
                                           {"_m2", "m²", 1},
                                           {"_deg", "°", 1},
                                           {"share", "%", 100},
                                           {"_m", "m", 1},
                                           {"_n", "kN", 1e-3},
                                           {"_s", "s", 1},
                                           {"_j", "kJ", 1e-3}}};

/// Of one figure under several conditions these come last, behind the unit: "net_force_n_transferred".
constexpr std::array<std::string_view, 3> conditions{"_transferred", "_supported", "_clamped"};

/// The condition that a name ends with, or nothing.
std::string_view condition_of(std::string_view name) {
  const auto* const found = std::ranges::find_if(conditions, [&](std::string_view c) { return name.ends_with(c); });
  return found != conditions.end() ? *found : std::string_view{};
}

std::string_view without_condition(std::string_view name) {
  name.remove_suffix(condition_of(name).size());
  return name;
}

std::string words_of(std::string_view name) {
  std::string words{without_condition(name)};
  const ShownUnit* const unit = unit_of(name);
  if (unit != nullptr && unit->suffix.starts_with('_')) words.resize(words.size() - unit->suffix.size());
  words += condition_of(name);
  std::ranges::replace(words, '_', ' ');
  if (!words.empty()) words.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(words.front())));
  return words;
}

std::string class_of(const Shown& column) {
  return column.kind.empty() ? std::string{} : " class=\"" + std::string{column.kind} + "\"";
}

}  // namespace

const ShownUnit* unit_of(std::string_view name) {
  name = without_condition(name);
  const auto* const found = std::ranges::find_if(units, [&](const ShownUnit& u) { return name.ends_with(u.suffix); });
  return found != units.end() ? found : nullptr;
}

std::string heading_of(std::string_view name) {
  const ShownUnit* const unit = unit_of(name);
  return unit != nullptr ? words_of(name).append(" (").append(unit->unit).append(")") : words_of(name);
}

void HtmlTable::head(const std::vector<ChosenFigures::Cell>& cells, std::string_view attributes) {
  text_ = frame_ == Frame::scroll ? "<div class=\"scroll\"><table" : "<table";
  if (!attributes.empty()) text_.append(" ").append(attributes);
  text_ += "><thead><tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!cells[i].found) continue;
    text_ += "<th" + class_of(columns_[i]);
    if (!cells[i].help.empty()) text_ += " title=\"" + escape_xml(cells[i].help) + "\"";
    const std::string_view heading = columns_[i].heading;
    text_ += ">" + (heading.empty() ? heading_of(columns_[i].name) : std::string{heading}) + "</th>";
  }
  text_ += "</tr></thead><tbody>\n";
}

void HtmlTable::add_cells(const std::vector<ChosenFigures::Cell>& cells, std::string_view attributes) {
  text_ += "<tr";
  if (!attributes.empty()) text_.append(" ").append(attributes);
  text_ += ">";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const ChosenFigures::Cell& cell = cells[i];
    if (!cell.found) continue;
    text_ += "<td" + class_of(columns_[i]);
    if (sortable_ && cell.value.sort) text_ += " data-v=\"" + number(*cell.value.sort) + "\"";
    text_ += ">" + cell.value.text + "</td>";
  }
  text_ += "</tr>\n";
}

std::string HtmlTable::html() && {
  return std::move(text_) + (frame_ == Frame::scroll ? "</tbody></table></div>\n" : "</tbody></table>\n");
}

std::string fact_rows(const std::vector<Shown>& chosen, const std::vector<ChosenFigures::Cell>& cells,
                      std::string_view kind) {
  std::string out;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!cells[i].found || cells[i].value.text == "–") continue;
    const ShownUnit* const unit = cells[i].value.sort ? unit_of(chosen[i].name) : nullptr;
    out +=
        detail::fact(chosen[i].heading.empty() ? words_of(chosen[i].name) : std::string{chosen[i].heading},
                     unit != nullptr ? cells[i].value.text + " " + std::string{unit->unit} : cells[i].value.text, kind);
  }
  return out;
}

}  // namespace cleave::report
