#include "plane_parts.hpp"

#include <utility>

#include "assets.hpp"
#include "cleave/report/text.hpp"

namespace cleave::report {

Summary head_of(std::string title, std::uint64_t seed, std::string scene_sha256, const scene::Plan& plan,
                const scene::RunCost& cost) {
  Summary summary;
  summary.title = std::move(title);
  summary.seed = seed;
  summary.scene_sha256 = std::move(scene_sha256);
  for (const scene::PlannedStage& stage : plan.stages) {
    summary.plan.push_back({.stage = std::string{scene::name_of(stage.stage)}, .run = stage.run, .why = stage.why});
  }
  summary.cost = {.wall_s = cost.wall_s,
                  .cpu_s = cost.cpu_s,
                  .peak_rss_mb = cost.peak_rss_mb,
                  .threads = cost.threads,
                  .stages = {}};
  for (const scene::StageCost& stage : cost.stages) {
    summary.cost.stages.push_back({.stage = std::string{scene::name_of(stage.stage)},
                                   .wall_s = stage.wall_s,
                                   .cpu_s = stage.cpu_s,
                                   .peak_rss_mb = stage.peak_rss_mb});
  }
  return summary;
}

void write_pair(JsonWriter& json, std::string_view key, bem::Vec2 v) {
  json.key(key);
  json.begin_array();
  json.value(v.x);
  json.value(v.y);
  json.end_array();
}

std::string plane_page_head(std::string_view title, std::string_view sub, std::string_view style) {
  const std::string shown = escape_xml(title);
  std::string out =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
      "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n<title>";
  out += shown + "</title>\n<style>\n";
  for (const std::string_view piece : assets::style()) out += piece;
  out += "\n";
  out += style;
  out += "\n</style>\n</head>\n<body>\n<header><p class=\"kicker\">cleave " CLEAVE_VERSION "</p><h1>";
  out += shown + "</h1>\n<p class=\"sub\">";
  out += sub;
  return out + "</p></header>\n<main>\n";
}

}  // namespace cleave::report
