#include "cleave/report/bodies.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "assets.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/exchange/json_fields.hpp"
#include "cleave/exchange/text.hpp"
#include "cleave/exchange/vtu_writer.hpp"
#include "cleave/report/summary.hpp"
#include "html_parts.hpp"
#include "html_table.hpp"
#include "tables2d.hpp"

namespace cleave::report {
namespace {

using bem::Vec2;
using detail::data_script, detail::page_begin, detail::page_foot, detail::page_end, detail::script,
    detail::plan_section, detail::cost_section, detail::notes_list;

std::vector<Short> flat(const std::vector<Vec2>& points, Vec2 origin = {}) {
  std::vector<Short> out;
  for (const Vec2 p : points) out.insert(out.end(), {{p.x - origin.x}, {p.y - origin.y}});
  return out;
}

std::vector<Short> short_of(std::span<const double> values) {
  std::vector<Short> out;
  for (const double v : values) out.push_back({v});
  return out;
}

/// The displacements of each loop of a body in a frame.
std::vector<std::vector<Short>> moved(const scene::BodyResult& body, const std::vector<std::vector<Vec2>>& frame) {
  std::vector<std::vector<Short>> loops;
  for (std::size_t l = 0; l < frame.size(); ++l) {
    std::vector<Vec2> u;
    for (std::size_t k = 0; k < frame[l].size(); ++k) u.push_back(frame[l][k] - body.outline[l][k]);
    loops.push_back(flat(u));
  }
  return loops;
}

/// Data of bodies.js: places relative to the first body, displacements a frame.
std::string page_data(const scene::BodiesResult& result) {
  const Vec2 origin = result.bodies.empty() || result.bodies.front().outline.empty()
                          ? Vec2{}
                          : result.bodies.front().outline.front().front();
  JsonWriter json{JsonLayout::compact};
  JsonFields{json}.put(group([&](auto& v) {
    v("times", short_of(result.times));
    v("bodies", each(result.bodies, [&](auto& b, const scene::BodyResult& body) {
        b("name", body.name);
        b("outline", each_as(body.outline, [&](const auto& loop) { return flat(loop, origin); }));
        b("frames", each_as(body.frames, [&](const auto& frame) { return moved(body, frame); }));
        b("mises", each_as(body.mises_frames, [](const auto& frame) {
            std::vector<std::vector<Short>> loops;
            for (const auto& loop : frame) loops.push_back(short_of(loop));
            return loops;
          }));
        std::vector<std::vector<Short>> rim;
        for (std::size_t l = 0; l < body.boundary_stress.size(); ++l) {
          std::vector<double> flat_loop;
          for (std::size_t k = 0; k < body.boundary_stress[l].size(); ++k) {
            const bem::Sym2 s = body.boundary_stress[l][k];
            flat_loop.insert(flat_loop.end(), {s.xx, s.yy, s.xy, body.boundary_out_of_plane[l][k].si()});
          }
          rim.push_back(short_of(flat_loop));
        }
        b("rim", rim);
        b("cells", each_as(body.cells, [&](const scene::StressCell& c) {
            return std::array<Short, 9>{{{c.centre.x - origin.x},
                                         {c.centre.y - origin.y},
                                         {c.size},
                                         {c.displacement.x},
                                         {c.displacement.y},
                                         {c.stress.xx},
                                         {c.stress.yy},
                                         {c.stress.xy},
                                         {c.out_of_plane}}};
          }));
      }));
    v("points", each(result.points, [](auto& p, const scene::PointResult& point) {
        std::vector<double> stress;
        for (const bem::Sym2 s : point.stress) stress.insert(stress.end(), {s.xx, s.yy, s.xy});
        p("name", point.name);
        p("u", flat(point.displacement));
        p("s", short_of(stress));
      }));
    v("energy", each_as(result.energy, [](const auto& e) { return short_of(e); }));
    v("trials", each_as(result.trials, [](const scene::MeshTrial& t) {
        return std::array<Short, 3>{{{static_cast<double>(t.elements)}, {t.seconds}, {t.error}}};
      }));
  }));
  return std::move(json).finish();
}

std::string shape_section(const scene::BodiesResult& result) {
  std::string out =
      "<section><h2>Deformed shape</h2>\n<p class=\"controls\"><label>scale <input "
      "id=\"scale\" "
      "type=\"range\" min=\"-2\" max=\"2\" step=\"0.05\" value=\"0\"></label><span id=\"scaled\"></span> <label>field "
      "<select id=\"field\"></select></label> <span><label>frame <input id=\"frame\" type=\"range\" min=\"0\" "
      "max=\"0\" "
      "value=\"0\"></label><button id=\"play\">Play</button> <span id=\"time\"></span></span></p>\n"
      "<canvas id=\"view\" class=\"paper\" aria-label=\"deformed shape\"></canvas>\n";
  bool cells = false;
  bool rim = false;
  for (const scene::BodyResult& body : result.bodies) {
    cells = cells || !body.cells.empty();
    rim = rim || !body.mises_frames.empty();
  }
  if (rim) {
    out +=
        "<div class=\"legend\"></div><div class=\"legend-ends\"><span id=\"low\"></span><span>Pa, von Mises on the "
        "boundary</span><span id=\"high\"></span></div>\n";
  } else if (cells) {
    out +=
        "<div class=\"legend\"></div><div class=\"legend-ends\"><span id=\"low\"></span><span>Pa, tension positive "
        "(displacement: m)</span><span id=\"high\"></span></div>\n";
  } else {
    out += "<span id=\"low\" hidden></span><span id=\"high\" hidden></span>\n";
  }
  out += "<p>Dashed: undeformed.</p>\n</section>\n";
  return out;
}

std::string points_section(const scene::BodiesResult& result) {
  std::vector<Shown> columns = point_columns();
  columns.insert(columns.end(), {{"stress_xx_pa", {}, 6}, {"stress_yy_pa", {}, 6}, {"stress_xy_pa", {}, 6}});
  HtmlTable table{std::move(columns), StressPointRow{}};
  for (const scene::PointResult& p : result.points) {
    const Vec2 u = p.displacement.empty() ? Vec2{} : p.displacement.back();
    table.add(StressPointRow{{0, p.name, p.at, u}, p.stress.empty() ? std::nullopt : std::optional{p.stress.back()}});
  }
  return "<section><h2>Points</h2>\n" + std::move(table).html() + "</section>\n";
}

std::string trials_section(const scene::BodiesResult& result) {
  return "<section><h2>Error against time</h2>\n<p>The estimate is the change of displacement to the mesh with half as "
         "many elements, over the largest displacement: an upper figure for smooth problems.</p>\n" +
         html_table({{"body", "body"}, {"elements", "elements"}, {"s", "time (s)", 2}, {"error", "estimated error", 2}},
                    each(result.trials,
                         [](auto& v, const scene::MeshTrial& t) {
                           v("body", t.body);
                           v("elements", t.elements);
                           v("s", t.seconds);
                           v("error", t.error);
                         }),
                    {}, Frame::none) +
         "<div id=\"trials\"></div>\n</section>\n";
}

}  // namespace

std::string bodies_report_html(const scene::BodiesResult& result) {
  std::string out = page_begin(escape_xml(result.title.empty() ? "cleave report" : result.title),
                               detail::project_line(result.project) + escape_xml(result.scene_file) +
                                   " · lengths in metres, x to the right, y up",
                               assets::scene2d());
  out += "<section><h2>Result</h2>\n<p>";
  out += result.converged ? "The run converged."
                          : "The run <strong>stopped</strong>: " + escape_xml(result.stopped_why) + ".";
  out += " Largest displacement " + display(result.largest_displacement) + " m";
  if (result.steps > 0) out += ", " + display_count(result.steps) + " steps";
  const bool moving = result.steps > 0;
  out += ".</p>\n<div class=\"wide-table\">" +
         html_table({{"name", "body"},
                     {"elements", "elements"},
                     {"unknowns", "unknowns"},
                     {"max_displacement_m", "largest displacement (m)"},
                     {"rotation", "rotation (°)"},
                     {"estimated_error", "estimated error", 2},
                     moving ? Shown{"rebuilds", "rebuilds"} : Shown{"condition", "condition", 2},
                     {"method", "method"}},
                    each(result.bodies, scene::body_fields(result.steps)), {}, Frame::none) +
         "</div>\n";
  for (const scene::BodyResult& body : result.bodies) {
    if (!body.error && !body.no_estimate.empty()) {
      out += "<p>" + escape_xml(body.name) + ": no estimate of the error: " + escape_xml(body.no_estimate) + ".</p>\n";
    }
    if (body.modes_hz.empty()) continue;
    std::string list;
    for (const double f : body.modes_hz) list += (list.empty() ? "" : ", ") + display(f, 5);
    out += "<p>Natural frequencies of " + escape_xml(body.name) + ": " + list + " Hz.</p>\n";
  }
  out += "</section>\n" + shape_section(result);
  if (result.times.size() > 1) {
    out += "<section><h2>Histories</h2>\n";
    if (!result.points.empty()) out += "<div id=\"ux\"></div><div id=\"uy\"></div>\n";
    out += "<div id=\"energy\"></div>\n";
    if (std::ranges::any_of(result.points, [](const auto& p) { return !p.stress.empty(); }))
      out += "<div id=\"sxx\"></div><div id=\"syy\"></div><div id=\"sxy\"></div>\n";
    out += "</section>\n";
  }
  if (!result.points.empty()) out += points_section(result);
  if (!result.trials.empty()) out += trials_section(result);
  out += plan_section(result.plan) + cost_section(result.cost);
  if (!result.notes.empty()) out += "<section>" + notes_list(result.notes) + "</section>\n";
  constexpr std::array<std::string_view, 3> limits{
      "Rock is linear elastic and the same in all directions; it does not break, and joints are not in it.",
      "The section is plane (strain or stress, as the scene says): nothing moves out of it.",
      "Water, creep and weathering are not counted."};
  out += detail::inputs_section(detail::input_rows("Scene", result.scene_file, result.scene_sha256, {}, result.seed),
                                limits);
  out += page_foot();
  out += data_script(page_data(result)) + script(assets::chart2d()) + script(assets::bodies());
  out += page_end;
  return out;
}

std::string bodies_vtu(const scene::BodiesResult& result, std::size_t frame) {
  std::vector<geometry::Vec3> points, displacement;
  std::vector<std::int64_t> connectivity, offsets;
  std::vector<std::uint8_t> types;
  std::vector<std::int32_t> body_of_point, cell_body;
  std::vector<double> xx, yy, xy;
  const auto add_point = [&](Vec2 x, Vec2 u, std::size_t body, bem::Sym2 s) {
    connectivity.push_back(static_cast<std::int64_t>(points.size()));
    points.push_back({x.x, x.y, 0});
    displacement.push_back({u.x, u.y, 0});
    body_of_point.push_back(static_cast<std::int32_t>(body));
    xx.push_back(s.xx);
    yy.push_back(s.yy);
    xy.push_back(s.xy);
  };
  const auto end_cell = [&](std::uint8_t type, std::size_t body) {
    offsets.push_back(static_cast<std::int64_t>(points.size()));
    types.push_back(type);
    cell_body.push_back(static_cast<std::int32_t>(body));
  };
  for (std::size_t b = 0; b < result.bodies.size(); ++b) {
    const scene::BodyResult& body = result.bodies[b];
    for (std::size_t l = 0; l < body.outline.size(); ++l) {
      for (std::size_t k = 0; k < body.outline[l].size(); ++k) {
        const bem::Sym2 s = !body.stress_frames.empty()     ? body.stress_frames[frame][l][k]
                            : !body.boundary_stress.empty() ? body.boundary_stress[l][k]
                                                            : bem::Sym2{};
        add_point(body.outline[l][k], body.frames[frame][l][k] - body.outline[l][k], b, s);
      }
      end_cell(4, b);  // VTK_POLY_LINE
    }
    for (const scene::StressCell& c : body.cells) {
      const double h = c.size / 2;
      for (const Vec2 corner : {Vec2{-h, -h}, Vec2{h, -h}, Vec2{h, h}, Vec2{-h, h}}) {
        add_point(c.centre + corner, c.displacement, b, c.stress);
      }
      end_cell(9, b);  // VTK_QUAD
    }
  }
  VtuWriter vtu{VtuFormat::ascii};
  vtu.begin_piece(points.size(), types.size());
  vtu.begin("PointData");
  vtu.vectors("displacement", displacement);
  vtu.array("body_of_point", body_of_point);
  vtu.array("stress_xx", xx);
  vtu.array("stress_yy", yy);
  vtu.array("stress_xy", xy);
  vtu.end("PointData");
  vtu.begin("CellData");
  vtu.array("body", cell_body);
  vtu.end("CellData");
  vtu.points(points);
  vtu.cells(connectivity, offsets, types);
  return std::move(vtu).finish();
}

std::string bodies_points_csv(const scene::BodiesResult& result) {
  CsvTable table{StressPointRow{}};
  for (std::size_t f = 0; f < result.times.size(); ++f) {
    for (const scene::PointResult& p : result.points) {
      if (f >= p.displacement.size()) continue;
      table.add(StressPointRow{{result.times[f], p.name, p.at, p.displacement[f]},
                               f < p.stress.size() ? std::optional{p.stress[f]} : std::nullopt});
    }
  }
  return std::move(table).text();
}

std::expected<void, WriteError> write_bodies_files(const scene::BodiesResult& result,
                                                   const std::filesystem::path& folder) {
  if (result.output.csv && !result.points.empty()) {
    CLEAVE_CHECK(write_file(folder / "points.csv", bodies_points_csv(result)));
  }
  if (!result.output.vtu) return {};
  if (result.times.size() == 1) return write_file(folder / "bodies.vtu", bodies_vtu(result, 0));
  return write_frames(
      folder, "bodies", result.times.size(), [&](std::size_t f) { return result.times[f]; },
      [&](std::size_t f) { return bodies_vtu(result, f); });
}

std::expected<void, WriteError> write_bodies_report(const scene::BodiesResult& result,
                                                    const std::filesystem::path& folder) {
  if (!result.output.report) return {};
  return write_file(folder / "report.html", bodies_report_html(result));
}

std::expected<void, WriteError> write_bodies_summary(const scene::BodiesResult& result,
                                                     const std::filesystem::path& folder) {
  return write_file(folder / "summary.json", summary_json(result));
}

}  // namespace cleave::report
