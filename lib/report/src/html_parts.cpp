#include "html_parts.hpp"

#include <algorithm>
#include <cmath>

#include "assets.hpp"
#include "cleave/core/version.hpp"
#include "cleave/exchange/text.hpp"

namespace cleave::report::detail {
namespace {

void append(std::string& out, std::span<const std::string_view> pieces) {
  for (const std::string_view piece : pieces) out += piece;
}

}  // namespace

std::string page_begin(const std::string& title, const std::string& sub, std::span<const std::string_view> style) {
  std::string out =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta name=\"color-scheme\" "
      "content=\"light dark\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data: blob:; "
      "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n<title>";
  out += title + "</title>\n<style>\n";
  append(out, assets::style());
  append(out, style);
  return out + "</style>\n</head>\n<body>\n<header><p class=\"kicker\">cleave " CLEAVE_VERSION "</p><h1>" + title +
         "</h1>\n<p class=\"sub\">" + sub + "</p></header>\n<main>\n";
}

std::string project_line(const scene::Project& project) {
  std::string line;
  for (const std::string* part : {&project.name, &project.client, &project.author, &project.date}) {
    if (!part->empty()) line += escape_xml(*part) + " · ";
  }
  return line;
}

std::string page_foot(std::string_view more) {
  return "</main>\n<footer>Made by cleave " CLEAVE_VERSION "." + std::string{more} + "</footer>\n";
}

std::string script(std::span<const std::string_view> pieces) {
  std::string out = "<script>\n";
  append(out, pieces);
  return out + "</script>\n";
}

std::string data_script(std::string_view json) {
  return "<script type=\"application/json\" id=\"data\">\n" + std::string{json} + "</script>\n";
}

std::string key_figure(std::string_view label, const std::string& figure, const std::string& below,
                       std::string_view kind) {
  std::string out = "<div class=\"card ";
  out += kind;
  out += "\"><span class=\"label\">";
  out += label;
  return out + "</span><strong>" + figure + "</strong><span class=\"below\">" + below + "</span></div>\n";
}

std::string table_row(std::initializer_list<std::string> cells, bool head) {
  std::string out = "<tr>";
  for (const std::string& cell : cells) out += (head ? "<th>" : "<td>") + cell + (head ? "</th>" : "</td>");
  return out + "</tr>\n";
}

std::string fact(std::string_view name, const std::string& value, std::string_view kind) {
  std::string out = "<tr><th scope=\"row\">";
  out += name;
  out += "</th><td";
  if (!kind.empty()) out.append(" class=\"").append(kind).append("\"");
  return out + ">" + value + "</td></tr>\n";
}

std::string plan_section(const scene::Plan& plan) {
  std::string out =
      "<section id=\"plan\"><h2>What ran, what was left out, and "
      "why</h2>\n<table><thead><tr><th>Stage</th><th></th><th class=\"wide\">Why</th></tr></thead><tbody>\n";
  for (const scene::PlannedStage& row : plan.stages) {
    out += "<tr" + std::string{row.run ? "" : " class=\"off\""} + "><td>" + std::string{name_of(row.stage)} +
           "</td><td>" + (row.run ? "ran" : "left out") + "</td><td class=\"wide\">" + escape_xml(row.why) +
           "</td></tr>\n";
  }
  return out + "</tbody></table></section>\n";
}

std::string cost_section(const scene::RunCost& cost) {
  double longest = 0;
  for (const scene::StageCost& row : cost.stages) longest = std::max(longest, row.wall_s);
  std::string out =
      "<section id=\"cost\"><h2>Cost by stage</h2>\n<table><thead><tr><th>Stage</th><th>Wall (s)</th><th "
      "class=\"bar\"></th><th>CPU (s)</th>"
      "<th>Peak memory (MB)</th></tr></thead><tbody>\n";
  for (const scene::StageCost& row : cost.stages) {
    const double share = longest > 0 ? 100 * row.wall_s / longest : 0;
    out += "<tr><td>" + std::string{name_of(row.stage)} + "</td><td>" + display(row.wall_s, 3) +
           "</td><td class=\"bar\"><i style=\"width:" + number(std::round(share * 10) / 10) + "%\"></i></td><td>" +
           display(row.cpu_s, 3) + "</td><td>" + display(row.peak_rss_mb, 4) + "</td></tr>\n";
  }
  return out +
         "</tbody></table>\n<p class=\"small\">Up to the writing of this page; summary.json has the "
         "rest.</p></section>\n";
}

std::string notes_list(std::span<const std::string> notes) {
  if (notes.empty()) return {};
  std::string out = "<h3>Notes</h3>\n<ul>\n";
  for (const std::string& note : notes) out += "<li>" + escape_xml(note) + "</li>\n";
  return out + "</ul>\n";
}

}  // namespace cleave::report::detail
