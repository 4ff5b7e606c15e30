#include "survey_windows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "cleave/exchange/text.hpp"
#include "html_table.hpp"
#include "svg.hpp"

namespace cleave::report::detail {

using geometry::Vec3;
using survey::Estimate;

std::string estimate_text(const Estimate& e) {
  if (!e.value) return "not estimable: " + escape_xml(e.note);
  if (!bounded(e)) return display(*e.value) + " (" + escape_xml(e.note.empty() ? "no interval" : e.note) + ")";
  return display(*e.value) + " (" + (std::isfinite(e.low) ? display(e.low) : "−∞") + " … " +
         (std::isfinite(e.high) ? display(e.high) : "∞") + ")";
}

namespace {

constexpr double pi = std::numbers::pi;

/// Half rose of trace azimuths, mirrored: area of a petal proportional to trace length.
std::string rosette(const survey::WindowSurvey& window, const std::vector<survey::Polyline>& traces, double border) {
  constexpr std::size_t petals = 18;
  std::array<double, petals> sums{};
  const Vec3 y = cross(window.normal, window.x_axis);
  for (const survey::SeenTrace& t : seen_through(window.window, traces, border)) {
    const Vec3 d = t.direction.x * window.x_axis + t.direction.y * y;
    double a = std::remainder(std::atan2(d.x, d.y) - window.north * pi / 180, pi);
    if (a < 0) a += pi;
    sums[std::min(static_cast<std::size_t>(a / pi * petals), petals - 1)] += t.length;
  }
  const double most = std::max(*std::ranges::max_element(sums), 1e-300);
  std::string out = "<svg viewBox=\"-110 -110 220 220\" role=\"img\" aria-label=\"Rosette of trace directions\">";
  for (std::size_t i = 0; i < petals; ++i) {
    const double r = 100 * std::sqrt(sums[i] / most);
    for (const double turn : {0.0, pi}) {
      const double a = pi * static_cast<double>(i) / petals + turn, b = pi * static_cast<double>(i + 1) / petals + turn;
      out += "<path fill=\"#D55E00\" fill-opacity=\".65\" d=\"M0,0L" + fixed(r * std::sin(a)) + ',' +
             fixed(-r * std::cos(a)) + 'L' + fixed(r * std::sin(b)) + ',' + fixed(-r * std::cos(b)) + "Z\"/>";
    }
  }
  return out + "<circle class=\"net-rim\" r=\"100\"/><path class=\"net-tick\" d=\"M0,-100V-105\"/></svg>";
}

/// Traces are cut off at the window's border; `id` is that of the clip path.
std::string trace_map(const survey::WindowSurvey& window, const std::vector<survey::Polyline>& traces,
                      const std::string& id) {
  double low_x = INFINITY, high_x = -INFINITY, low_y = INFINITY, high_y = -INFINITY;
  const auto grow = [&](double x, double y) {
    low_x = std::min(low_x, x);
    high_x = std::max(high_x, x);
    low_y = std::min(low_y, y);
    high_y = std::max(high_y, y);
  };
  std::string outline;
  if (const auto* circle = std::get_if<survey::CircleWindow>(&window.window)) {
    grow(circle->centre.x - circle->radius, circle->centre.y - circle->radius);
    grow(circle->centre.x + circle->radius, circle->centre.y + circle->radius);
  } else {
    for (const auto& p : std::get<survey::PolygonWindow>(window.window).corners) grow(p.x, p.y);
  }
  const double scale = 500 / std::max(high_x - low_x, high_y - low_y);
  const auto at = [&](survey::MapPoint p) {
    return fixed(10 + scale * (p.x - low_x)) + ',' + fixed(10 + scale * (high_y - p.y));
  };
  std::string out = "<svg viewBox=\"0 0 520 520\" role=\"img\" aria-label=\"Trace map\">";
  if (const auto* polygon = std::get_if<survey::PolygonWindow>(&window.window)) {
    for (const auto& p : polygon->corners) outline += (outline.empty() ? "M" : "L") + at(p);
    outline = "d=\"" + outline + "Z\"/>";
    outline.insert(0, "<path ");
  } else {
    outline = "<circle cx=\"260\" cy=\"260\" r=\"250\"/>";
  }
  out += "<clipPath id=\"" + id + "\">" + outline + "</clipPath><g class=\"net-grid\">" + outline + "</g>";
  const std::size_t stride = std::max<std::size_t>(1, traces.size() / 3000);
  std::string path;
  for (std::size_t i = 0; i < traces.size(); i += stride) {
    const auto seen = seen_through(window.window, std::span{traces}.subspan(i, 1), window.border.si());
    if (seen.empty()) continue;
    bool first = true;
    for (const auto& p : traces[i]) path += (std::exchange(first, false) ? "M" : "L") + at(p);
  }
  return out + "<path clip-path=\"url(#" + id + ")\" fill=\"none\" stroke=\"#0072B2\" stroke-width=\"1\" d=\"" + path +
         "\"/></svg>";
}

/// The measured map and simulated ones as figures.
std::string beside(const scene::SimulatedTraceMaps& both) {
  const std::vector<scene::MapFigures>& maps = both.simulated;
  if (maps.empty()) return {};
  const scene::MapFigures& measured = both.measured;
  using scene::MapFigures;
  struct MapRow {
    std::string_view name = {};
    double MapFigures::* figure = &MapFigures::traces;
  };
  const std::array<MapRow, 7> rows{{{"Traces that meet the window", &MapFigures::traces},
                                    {"P20 (1/m²)", &MapFigures::p20},
                                    {"P21 (1/m)", &MapFigures::p21},
                                    {"Mean trace length (m)", &MapFigures::mean_length},
                                    {"Connections per trace", &MapFigures::connections},
                                    {"Mean direction of the traces (°)", &MapFigures::direction},
                                    {"Alignment of the traces (0 … 1)", &MapFigures::alignment}}};
  const auto row = [&](auto& v, const MapRow& shown) {
    const auto [name, figure] = shown;
    double sum = 0, least = INFINITY, most = -INFINITY;
    for (const MapFigures& map : maps) {
      double value = map.*figure;
      // Directions near those of the measured map, across 0 and 180.
      if (figure == &MapFigures::direction)
        value = measured.direction + std::remainder(value - measured.direction, 180);
      sum += value;
      least = std::min(least, value);
      most = std::max(most, value);
    }
    const double value = measured.*figure;
    v("figure", name);
    v("measured", Html{display(value, 3) + (maps.size() > 1 && (value < least || value > most) ? " (outside)" : "")});
    v("simulated", Html{display(sum / static_cast<double>(maps.size()), 3) + " (" + display(least, 3) + " … " +
                        display(most, 3) + ")"});
  };
  const std::string heading = "Simulated, mean of " + std::to_string(maps.size()) + " maps (least … most)";
  return html_table(
             {{.name = "figure", .heading = "Map as a whole", .kind = "wide"}, {"measured"}, {"simulated", heading}},
             each(rows, row), {}, Frame::none) +
         "<p class=\"small\">Outside all of 19 maps lies a figure of the right network once in ten.</p>\n";
}

}  // namespace

std::string survey_windows(const scene::SurveyScene& scene, const survey::SurveyResult& result,
                           std::span<const scene::SimulatedTraceMaps> maps) {
  std::string out;
  for (std::size_t w = 0; w < scene.input.windows.size(); ++w) {
    const survey::WindowSurvey& window = scene.input.windows[w];
    const survey::WindowResult& figures = result.windows[w];
    const std::string id = "map" + std::to_string(w);
    out += "<section><h2>Outcrop " + escape_xml(window.name) + "</h2>\n<div class=\"columns\"><figure>" +
           trace_map(window, window.traces, id) + "<figcaption>Measured: " + display_count(figures.counts.traces()) +
           " traces meet the window.</figcaption></figure>";
    const auto& simulated = maps[w].first;
    const bool laid_beside = simulated && !simulated->empty();
    if (laid_beside) {
      out += "<figure>" + trace_map(window, *simulated, id + "s") +
             "<figcaption>Simulated: one realization of the fitted sets.</figcaption></figure>";
    }
    out += "<figure class=\"net\">" + rosette(window, window.traces, window.border.si()) +
           "<figcaption>Directions of traces, by length: measured.</figcaption></figure>";
    if (laid_beside) {
      out += "<figure class=\"net\">" + rosette(window, *simulated, 0) + "<figcaption>Simulated.</figcaption></figure>";
    }
    std::vector<Estimate> estimates = figures.estimates;
    if (figures.nodes) estimates.push_back(figures.nodes->connections);
    for (const Estimate& e : maps[w].measured.estimates) {
      if (e.name == "direction" || e.name == "alignment") estimates.push_back(e);
    }
    const auto row = [](auto& v, const Estimate& e) {
      v("figure", e.name + (e.note.empty() ? "" : " (" + e.note + ")"));
      v("method", Html{escape_xml(e.method)});
      v("measured", Html{estimate_text(e)});
    };
    out += "</div>\n" +
           html_table({{.name = "figure", .kind = "wide"},
                       {.name = "method", .kind = "wide"},
                       {"measured", "Measured (interval)"}},
                      each(estimates, row), {}, Frame::none) +
           beside(maps[w]) + "</section>\n";
  }
  return out;
}

}  // namespace cleave::report::detail
