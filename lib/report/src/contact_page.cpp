#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "assets.hpp"
#include "cleave/exchange/json_fields.hpp"
#include "cleave/exchange/text.hpp"
#include "cleave/report/contact.hpp"
#include "html_parts.hpp"
#include "html_table.hpp"
#include "tables2d.hpp"

namespace cleave::report {
namespace {

using bem::Vec2;
using detail::data_script, detail::key_figure, detail::page_begin, detail::page_foot, detail::page_end, detail::script,
    detail::plan_section, detail::cost_section;

/// Frames and rows are thinned so that a page stays below some tens of megabytes.
std::size_t stride(std::size_t count, double each, double most) {
  std::size_t step = 1;
  while (static_cast<double>(count / step) * each > most) ++step;
  return step;
}

template <class Row>
std::vector<const Row*> thinned(const std::vector<Row>& rows, std::size_t step) {
  std::vector<const Row*> out;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (k % step == 0 || k + 1 == rows.size()) out.push_back(&rows[k]);
  }
  return out;
}

std::array<Short, 2> pair(Vec2 v) { return {{{v.x}, {v.y}}}; }
void add(std::vector<Short>& out, Vec2 v) { out.insert(out.end(), {{v.x}, {v.y}}); }

/// One picture: time, places, what deforms beyond them, contacts, points.
void frame_fields(JsonFields& v, const scene::ContactResult& result, const scene::ContactFrame& frame, Vec2 origin) {
  std::vector<Short> places, contacts;
  for (const scene::ContactPlacement& place : frame.places) {
    add(places, place.centroid - origin);
    places.push_back({place.rotation});
  }
  for (const scene::ContactMark& mark : frame.contacts) {
    add(contacts, mark.at - origin);
    add(contacts, mark.force);
    contacts.push_back({mark.state == scene::ContactMarkState::slip ? 1.0 : 0.0});
  }
  v("t", Short{frame.time});
  v("p", places);
  v("d", group([&](auto& d) {
      for (std::size_t b = 0; b < frame.corners.size(); ++b) {
        if (frame.corners[b].empty()) continue;
        const scene::ContactBodyResult& body = result.bodies[b];
        std::vector<Short> beyond;
        for (std::size_t k = 0; k < body.outline.size(); ++k) {
          add(beyond, frame.corners[b][k] - frame.places[b].centroid -
                          rotated(body.outline[k] - body.start, frame.places[b].rotation));
        }
        d(std::to_string(b), beyond);
      }
    }));
  v("c", contacts);
  v("u", each_as(frame.points, pair));
}

std::string page_data(const scene::ContactResult& result) {
  // Relative to the first body: far from the origin digits would be lost.
  const Vec2 origin = result.bodies.empty() ? Vec2{} : result.bodies.front().start;
  double turned = 0, moved = 0;
  for (const scene::ContactBodyResult& body : result.bodies) {
    turned = std::max(turned, std::abs(body.rotation));
    moved = std::max(moved, norm(body.centroid - body.start));
  }
  double each_frame = 3 * static_cast<double>(result.bodies.size());
  std::size_t most_contacts = 0;
  for (const scene::ContactFrame& frame : result.frames) most_contacts = std::max(most_contacts, frame.contacts.size());
  each_frame += 5 * static_cast<double>(most_contacts);
  for (const scene::ContactBodyResult& body : result.bodies) {
    if (body.elastic) each_frame += 2 * static_cast<double>(body.outline.size());
  }
  const auto frames = thinned(result.frames, stride(result.frames.size(), each_frame, 1.5e6));
  const auto rows = thinned(result.history, stride(result.history.size(), 1, 1200));
  JsonWriter json{JsonLayout::compact};
  JsonFields{json}.put(group([&](auto& v) {
    v("way", result.to_rest ? "relaxation time (s)" : "time (s)");
    v("turned", Short{turned});
    v("moved", Short{moved});
    v("bodies", each(result.bodies, [&](auto& b, const scene::ContactBodyResult& body) {
        std::vector<Short> outline;
        for (const Vec2 p : body.outline) add(outline, p - body.start);
        b("n", body.name);
        b("f", body.fixed ? 1U : 0U);
        b("c", pair(body.start - origin));
        b("o", outline);
      }));
    v("frames",
      each(frames, [&](auto& f, const scene::ContactFrame* frame) { frame_fields(f, result, *frame, origin); }));
    v("points", each(result.points, [&](auto& p, const scene::PointSpec& point, std::size_t k) {
        p("k", k);
        p("n", point.name);
        p("x", Short{point.at.x - origin.x});
        p("y", Short{point.at.y - origin.y});
      }));
    v("history", each_as(rows, [](const scene::ContactHistory* row) {
        std::vector<Short> out;
        for (const double value :
             {row->time, row->kinetic, row->elastic, row->gravity, row->work, row->friction, row->lost, row->step,
              static_cast<double>(row->iterations), static_cast<double>(row->sticking + row->slipping)}) {
          out.push_back({value});
        }
        for (const Vec2 u : row->points) add(out, u);
        return out;
      }));
  }));
  return std::move(json).finish();
}

std::string bodies_table(const scene::ContactResult& result) {
  constexpr std::size_t most = 60;
  std::vector<std::size_t> order;
  for (std::size_t b = 0; b < result.bodies.size(); ++b) {
    if (!result.bodies[b].fixed) order.push_back(b);
  }
  if (order.size() > most) {
    std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t b) { return result.bodies[b].largest; });
  }
  HtmlTable table{{{"body"},
                   {"max_displacement_m", "Largest displacement (m)"},
                   {"displacement_x_m", "u<sub>x</sub> (m)"},
                   {"displacement_y_m", "u<sub>y</sub> (m)"},
                   {"rotation_degrees", "Rotation (°)"},
                   {"contact_force_x_n_per_m", "Contact force on it, x (kN/m)"},
                   {"contact_force_y_n_per_m", "y (kN/m)"}},
                  scene::ContactBodyResult{}};
  for (std::size_t k = 0; k < order.size() && k < most; ++k) table.add(result.bodies[order[k]]);
  std::string out = std::move(table).html();
  if (order.size() > most) {
    out += "<p class=\"small\">The " + display_count(most) + " of " + display_count(order.size()) +
           " that moved most; bodies.csv has all.</p>\n";
  }
  return out;
}

std::string solver_bars(const scene::ContactResult& result) {
  std::uint64_t all = 0;
  for (const scene::SolverShare& share : result.solvers) all += share.groups;
  if (all == 0 && result.steps == 0) return "<p>No step was solved.</p>\n";
  if (all == 0) return "<p>Nothing touched.</p>\n";
  const auto row = [&](auto& v, const scene::SolverShare& share) {
    const double part = static_cast<double>(share.groups) / static_cast<double>(all);
    fields(v, share);
    v("bar", Html{"<i class=\"bar\" style=\"width:" + number(std::round(1000 * part) / 10) + "%\"></i>"});
    v("share", Html{display(100 * part, 3) + " %"});
  };
  return html_table({{"name", "solver"},
                     {"groups", "groups of contacts solved"},
                     {"iterations", "iterations"},
                     {"bar", " "},
                     {"share", "share"}},
                    each(result.solvers, row)) +
         "<p class=\"small\">" + display_count(result.iterations) +
         " linear solves and pivots in all; every answer is accepted by its residual only, the worst was " +
         display(result.residual, 2) + ".</p>\n";
}

/// What became of the bodies, first of all.
std::string verdict_figure(const scene::ContactResult& result) {
  const scene::ContactVerdict verdict = scene::verdict_of(result);
  const std::string until = result.converged ? "" : ", until it stopped at " + display(result.end_time, 4) + " s";
  const std::string name{name_of(verdict)};
  if (!verdict.motion && verdict.known && verdict.going_on > 0) {
    return key_figure("verdict", name,
                      "no body moved by more than 1 % of its size, but " + display_count(verdict.going_on) +
                          (verdict.going_on == 1 ? " goes on moving at the end" : " go on moving at the end"),
                      "bad");
  }
  if (!verdict.motion) {
    return key_figure("verdict", name, "no body moved by more than 1 % of its size" + until,
                      verdict.known ? "good" : "bad");
  }
  return key_figure("verdict", name,
                    "first “" + escape_xml(result.bodies[verdict.first].name) + "”, seen at " +
                        display(verdict.since->si(), 3) + " s; in all " + scene::counts_of(verdict) + until,
                    "warn");
}

/// What contact.js draws in and is steered by.
constexpr std::string_view motion = R"html(<section><h2>Motion</h2>
<p class="controls" id="player"><button id="play">Play</button>
<label>frame <input id="frame" type="range" min="0" max="0" value="0"></label> <span id="time"></span></p>
<p class="controls"><label><input id="arrows" type="checkbox" checked> contact forces</label>
<label>their size <input id="force" type="range" min="-1" max="1.5" step="0.05" value="0"></label>
<label>colour <select id="colour"><option>plain</option><option>displacement</option><option>rotation</option></select></label>
<span class="ramp" id="ramp" hidden><span id="ramp-low"></span><i></i><span id="ramp-high"></span></span>
<label>deformation <input id="scale" type="range" min="-2" max="2" step="0.05" value="0"> <span id="bent"></span></label></p>
<canvas id="view" role="img" aria-label="bodies and contact forces"></canvas>
<noscript><p>The picture and the plots need scripts; the tables and the files of the result do not.</p></noscript>
<p class="small"><span id="states"><span class="key" style="background:#1f5f8b"></span>contact that sticks
<span class="key" style="background:#d1495b;margin-left:1em"></span>that slips; a line through the contact shows its
force on both sides (the largest cut short).</span>
<span id="fixed"><span class="key" style="background:var(--wall)"></span>fixed</span></p>
</section>
<section><h2>Histories</h2>
<div class="plots">
)html";

std::string inputs_of(const scene::ContactResult& result) {
  const std::array<std::string_view, 6> limits{
      "The section is plane: forces and masses are those of one metre of thickness, nothing moves out of it.",
      result.elastic ? "Bodies deform by their modes of linear elasticity; they do not break."
                     : "Bodies are rigid; they do not break.",
      "Joints have the Coulomb friction, cohesion, tension and stiffness of the scene, and no others.",
      "Water presses as the scene states; it does not flow, and rock that moves does not change it.",
      "In-situ stress, creep and weathering are not counted.",
      "What comes to rest here has been shown to stay for this path of loads and this start only."};
  return detail::inputs_section(detail::input_rows("Scene", result.scene_file, result.scene_sha256, {}, result.seed),
                                limits);
}

}  // namespace

std::string contact_report_html(const scene::ContactResult& result) {
  std::string out = page_begin(escape_xml(result.title.empty() ? "cleave report" : result.title),
                               detail::project_line(result.project) + escape_xml(result.scene_file) +
                                   " · lengths in metres, x to the right, y up; forces and "
                                   "energies per metre of thickness",
                               assets::scene2d());
  out += "<section class=\"cards\">\n";
  out += verdict_figure(result);
  out += result.converged ? key_figure("run", "converged", display_count(result.steps) + " steps", "good")
                          : key_figure("run", "stopped", display_count(result.steps) + " steps", "bad");
  out += key_figure("largest displacement", display(result.largest_displacement, 3) + " m",
                    !result.to_rest    ? "after " + display(result.end_time, 4) + " s"
                    : result.converged ? "at rest"
                                       : "not at rest: means nothing");
  const auto moving =
      static_cast<std::uint64_t>(std::ranges::count_if(result.bodies, [](const auto& b) { return !b.fixed; }));
  out += key_figure("bodies that move", display_count(moving), result.elastic ? "elastic" : "rigid");
  out += key_figure("penetration", display(result.largest_penetration, 2) + " m", "largest, after a step");
  out += key_figure("energy gained", display(result.energy_gain, 2) + " J/m",
                    "from nothing; momentum drift " + display(result.drift_momentum, 2));
  if (result.error) {
    out += key_figure("error of the steps", display(*result.error, 2), "estimated, of the largest displacement");
  }
  out += "</section>\n";
  if (!result.converged) {
    out += "<p class=\"note bad\">Stopped: " + escape_xml(result.stopped_why) +
           ". What follows is the state that was reached.</p>\n";
  }
  if (!result.error && !result.no_estimate.empty()) {
    out += "<p class=\"note\">No estimate of the error of the steps: " + escape_xml(result.no_estimate) + ".</p>\n";
  }
  if (!result.notes.empty()) out += "<div id=\"notes\">";
  for (const std::string& note : result.notes) out += "<p class=\"note\">Note: " + escape_xml(note) + "</p>\n";
  if (!result.notes.empty()) out += "</div>\n";
  out += motion;
  if (!result.points.empty()) out += "<div id=\"ux\"></div><div id=\"uy\"></div>\n";
  out += "<div id=\"energy\"></div><div id=\"contacts\"></div>\n</div>\n</section>\n";
  if (!result.points.empty()) {
    HtmlTable table{point_columns(), PointRow{}};
    for (std::size_t p = 0; p < result.points.size(); ++p) {
      const Vec2 u = result.history.empty() ? Vec2{} : result.history.back().points[p];
      table.add(PointRow{0, result.points[p].name, result.points[p].at, u});
    }
    out += "<section><h2>Points</h2>\n" + std::move(table).html() + "</section>\n";
  }
  if (!result.bolts.empty()) {
    HtmlTable table{{{"name", "bolt"},
                     {"first", "from"},
                     {"second", "to"},
                     {"state"},
                     {"force_n", "Force (kN)"},
                     {"largest_force_n", "Largest (kN)"},
                     {"capacity_n", "Capacity (kN)"},
                     {"lengthened_m", "Lengthened (m)"}},
                    scene::ContactBoltResult{}};
    for (const scene::ContactBoltResult& bolt : result.bolts) table.add(bolt);
    out += "<section><h2>Bolts</h2>\n" + std::move(table).html() + "</section>\n";
  }
  out += "<section><h2>Bodies</h2>\n" + bodies_table(result) + "</section>\n<section><h2>Solvers</h2>\n" +
         solver_bars(result) + "<div class=\"plots\"><div id=\"steps\"></div>" +
         (result.solvers.empty() ? "" : "<div id=\"iterations\"></div>") + "</div>\n" + "</section>\n";
  out += plan_section(result.plan) + cost_section(result.cost) + inputs_of(result) + page_foot();
  out += data_script(page_data(result)) + script(assets::chart2d()) + script(assets::contact());
  out += page_end;
  return out;
}

}  // namespace cleave::report
