#include "html_parts.hpp"

#include <algorithm>
#include <cmath>

#include "assets.hpp"
#include "cleave/core/version.hpp"
#include "cleave/exchange/text.hpp"
#include "html_table.hpp"

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

std::string facts_table(std::string_view rows) {
  return "<table class=\"facts\"><tbody>\n" + std::string{rows} + "</tbody></table>\n";
}

std::string fact(std::string_view name, const std::string& value, std::string_view kind) {
  std::string out = "<tr><th scope=\"row\">";
  out += name;
  out += "</th><td";
  if (!kind.empty()) out.append(" class=\"").append(kind).append("\"");
  return out + ">" + value + "</td></tr>\n";
}

std::string plan_section(const scene::Plan& plan) {
  const auto shown = [](const scene::PlannedStep& x) {
    return group([&x](auto& v) {
      fields(v, x);
      v("done", x.run ? "ran" : "left out");
    });
  };
  HtmlTable table{
      {{"stage"}, {"done", " "}, {.name = "why", .kind = "wide"}}, shown(scene::PlannedStep{}), {}, Frame::none};
  for (const scene::PlannedStep& row : plan.steps) table.add(shown(row), row.run ? "" : "class=\"off\"");
  return "<section id=\"plan\"><h2>What ran, what was left out, and why</h2>\n" + std::move(table).html() +
         "</section>\n";
}

std::string cost_section(const scene::RunCost& cost) {
  double longest = 0;
  for (const scene::StepCost& row : cost.steps) longest = std::max(longest, row.wall_s);
  const auto shown = [&](auto& v, const scene::StepCost& row) {
    const double share = longest > 0 ? 100 * row.wall_s / longest : 0;
    fields(v, row);
    v("bar", Html{"<i style=\"width:" + number(std::round(share * 10) / 10) + "%\"></i>"});
  };
  return "<section id=\"cost\"><h2>Cost by stage</h2>\n" +
         html_table({{"stage"},
                     {"wall_s", {}, 3},
                     {.name = "bar", .heading = " ", .kind = "bar"},
                     {"cpu_s", "CPU (s)", 3},
                     {"peak_rss_mb", "Peak memory (MB)"}},
                    each(cost.steps, shown), {}, Frame::none) +
         "<p class=\"small\">Up to the writing of this page; summary.json has the rest.</p></section>\n";
}

std::string notes_list(std::span<const std::string> notes) {
  if (notes.empty()) return {};
  std::string out = "<h3 id=\"notes\">Notes</h3>\n<ul>\n";
  for (const std::string& note : notes) out += "<li>" + escape_xml(note) + "</li>\n";
  return out + "</ul>\n";
}

std::string notes_figure(std::size_t count) {
  if (count == 0) return {};
  return key_figure("Notes", "<a href=\"#notes\">" + display_count(count) + "</a>",
                    "to know before these figures are used", "warn");
}

std::string input_rows(std::string_view kind, const std::string& file, const std::string& sha256,
                       std::span<const scene::InputFile> files, std::optional<std::uint64_t> seed) {
  std::string out = fact(kind, escape_xml(file) + " <code>" + escape_xml(sha256) + "</code>", "wide");
  for (const scene::InputFile& input : files) {
    out += fact("File",
                escape_xml(input.name) + ", " + display_count(input.bytes) + " bytes <code>" +
                    escape_xml(input.sha256) + "</code>",
                "wide");
  }
  if (seed) out += fact("Seed", std::to_string(*seed), "wide");
  return out + fact("Version", "cleave " CLEAVE_VERSION, "wide");
}

std::string limits_list(std::span<const std::string_view> limits) {
  std::string out = "<h3>Assumptions and limits</h3>\n<ul>\n";
  for (const std::string_view limit : limits) out += "<li>" + std::string{limit} + "</li>\n";
  return out + "</ul>\n";
}

std::string inputs_section(std::string_view rows, std::span<const std::string_view> limits) {
  return "<section id=\"inputs\"><h2>Inputs</h2>\n" + facts_table(rows) + limits_list(limits) + "</section>\n";
}

}  // namespace cleave::report::detail
