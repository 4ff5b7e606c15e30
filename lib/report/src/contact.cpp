#include "cleave/report/contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "cleave/core/expected.hpp"
#include "cleave/report/json.hpp"
#include "cleave/report/text.hpp"
#include "plane_parts.hpp"

namespace cleave::report {
namespace {

using bem::Vec2;

double degrees(double radians) { return radians * 180 / std::numbers::pi; }

void energy_part(JsonWriter& json, const scene::ContactResult& result) {
  const scene::ContactHistory last = result.history.empty() ? scene::ContactHistory{} : result.history.back();
  json.key("energy");
  json.begin_object();
  json.member("kinetic_j", last.kinetic);
  json.member("elastic_j", last.elastic);
  json.member("gravity_j", last.gravity);
  json.member("work_j", last.work);
  json.member("friction_j", last.friction);
  json.member("lost_j", last.lost);
  json.member("largest_gain_j", result.energy_gain);
  json.end_object();
}

std::string rows_of_points(const scene::ContactResult& result) {
  std::string out = "time_s,point,x_m,y_m,displacement_x_m,displacement_y_m\n";
  for (const scene::ContactHistory& row : result.history) {
    for (std::size_t p = 0; p < result.points.size(); ++p) {
      out += number(row.time) + "," + csv_field(result.points[p].name) + "," + number(result.points[p].at.x) + "," +
             number(result.points[p].at.y) + "," + number(row.points[p].x) + "," + number(row.points[p].y) + "\n";
    }
  }
  return out;
}

}  // namespace

std::string contact_summary_json(const scene::ContactResult& result) {
  JsonWriter json;
  json.begin_object();
  write_plane_head(json, result);
  json.key("contact");
  json.begin_object();
  json.member("status", result.converged ? "converged" : "stopped");
  if (!result.converged) json.member("reason", result.stopped_why);
  json.member("steps", result.steps);
  json.member("residual", result.residual);
  json.member("max_displacement_m", result.largest_displacement);
  json.key("bodies");
  json.begin_array();
  for (const scene::ContactBodyResult& body : result.bodies) {
    json.begin_object();
    json.member("name", body.name);
    write_pair(json, "centroid", body.centroid);
    json.member("rotation", degrees(body.rotation));
    json.member("fixed", body.fixed);
    json.member("max_displacement_m", body.largest);
    write_pair(json, "contact_force", body.force);
    json.end_object();
  }
  json.end_array();
  json.key("points");
  json.begin_array();
  for (std::size_t p = 0; p < result.points.size(); ++p) {
    json.begin_object();
    json.member("name", result.points[p].name);
    write_pair(json, "displacement", result.history.empty() ? Vec2{} : result.history.back().points[p]);
    json.end_object();
  }
  json.end_array();
  json.key("estimated_error");
  if (result.error) {
    json.value(*result.error);
  } else {
    json.null();
    json.member("no_estimate", result.no_estimate);
  }
  json.member("mode", result.elastic ? "elastic" : "rigid");
  json.member("end_time_s", result.end_time);
  json.member("cut_steps", result.cut_steps);
  json.member("largest_penetration_m", result.largest_penetration);
  energy_part(json, result);
  json.key("drift");
  json.begin_object();
  json.member("momentum", result.drift_momentum);
  json.member("angular_momentum", result.drift_angular);
  json.end_object();
  json.key("solvers");
  json.begin_array();
  for (const scene::SolverShare& share : result.solvers) {
    json.begin_object();
    json.member("name", share.name);
    json.member("groups", share.groups);
    json.member("iterations", share.iterations);
    json.end_object();
  }
  json.end_array();
  json.member("iterations", result.iterations);
  json.end_object();
  json.end_object();
  return std::move(json).finish();
}

std::string contact_vtu(const scene::ContactResult& result, std::size_t frame) {
  const scene::ContactFrame& now = result.frames[frame];
  std::string points, connectivity, offsets, types, displacement, force, body, fixed, state, rotation;
  std::string stress, mises, safety;
  const auto stressed = [&](const scene::NodeStress* at) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    const auto put = [](std::string& out, double v, char end) { out += (std::isnan(v) ? "nan" : number(v)) + end; };
    const bem::Sym2 s = at != nullptr ? at->stress : bem::Sym2{none, none, none};
    for (const double v : {s.xx, s.xy, 0.0, s.xy, s.yy, 0.0, 0.0, 0.0}) put(stress, v, ' ');
    put(stress, at != nullptr ? at->out_of_plane : none, '\n');
    put(mises, at != nullptr ? at->von_mises : none, '\n');
    put(safety, at != nullptr ? at->safety : none, '\n');
  };
  std::size_t count = 0, cells = 0;
  const auto point = [&](Vec2 x, Vec2 u, Vec2 f) {
    points += number(x.x) + " " + number(x.y) + " 0\n";
    displacement += number(u.x) + " " + number(u.y) + " 0\n";
    force += number(f.x) + " " + number(f.y) + " 0\n";
    connectivity += std::to_string(count++) + " ";
  };
  const auto cell = [&](int type, std::size_t of, bool is_fixed, int how, double turned) {
    offsets += std::to_string(count) + "\n";
    types += std::to_string(type) + "\n";
    body += std::to_string(of) + "\n";
    fixed += is_fixed ? "1\n" : "0\n";
    state += std::to_string(how) + "\n";
    rotation += number(turned) + "\n";
    ++cells;
  };
  for (std::size_t b = 0; b < result.bodies.size(); ++b) {
    const auto corners = scene::corners_at(result, frame, b);
    const auto& start = result.bodies[b].outline;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      point(corners[k], corners[k] - start[k], {});
      stressed(k < now.stress[b].size() ? &now.stress[b][k] : nullptr);
    }
    cell(7, b, result.bodies[b].fixed, -1, degrees(now.places[b].rotation));
  }
  for (const scene::ContactMark& mark : now.contacts) {
    point(mark.at, {}, mark.force);
    stressed(nullptr);
    cell(1, mark.first, false, mark.state == scene::ContactMarkState::slip ? 1 : 0, 0);
  }
  const auto array = [](std::string_view type, std::string_view name, int components, const std::string& values) {
    return "<DataArray type=\"" + std::string{type} + "\" Name=\"" + std::string{name} + "\"" +
           (components > 1 ? " NumberOfComponents=\"" + std::to_string(components) + "\"" : "") +
           " format=\"ascii\">\n" + values + "</DataArray>\n";
  };
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
         "<UnstructuredGrid>\n<Piece NumberOfPoints=\"" +
         std::to_string(count) + "\" NumberOfCells=\"" + std::to_string(cells) + "\">\n<PointData>\n" +
         array("Float64", "displacement", 3, displacement) + array("Float64", "force", 3, force) +
         array("Float64", "stress", 9, stress) + array("Float64", "von_mises", 1, mises) +
         array("Float64", "safety", 1, safety) + "</PointData>\n<CellData>\n" + array("Int32", "body", 1, body) +
         array("Int32", "fixed", 1, fixed) + array("Int32", "state", 1, state) +
         array("Float64", "rotation", 1, rotation) + "</CellData>\n<Points>\n" + array("Float64", "Points", 3, points) +
         "</Points>\n<Cells>\n" + array("Int64", "connectivity", 1, connectivity + "\n") +
         array("Int64", "offsets", 1, offsets) + array("UInt8", "types", 1, types) +
         "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

std::string contact_history_csv(const scene::ContactResult& result) {
  std::string out =
      "time_s,step_s,kinetic_j,elastic_j,gravity_j,work_j,friction_j,lost_j,contacts,sticking,slipping,iterations,"
      "residual\n";
  for (const scene::ContactHistory& row : result.history) {
    for (const double v :
         {row.time, row.step, row.kinetic, row.elastic, row.gravity, row.work, row.friction, row.lost}) {
      out += number(v) + ",";
    }
    for (const std::uint64_t n : {row.contacts, row.sticking, row.slipping, row.iterations}) {
      out += std::to_string(n) + ",";
    }
    out += number(row.residual) + "\n";
  }
  return out;
}

std::string contact_points_csv(const scene::ContactResult& result) { return rows_of_points(result); }

std::string contact_bodies_csv(const scene::ContactResult& result) {
  std::string out =
      "body,fixed,elastic,centroid_x_m,centroid_y_m,displacement_x_m,displacement_y_m,rotation_degrees,"
      "max_displacement_m,contact_force_x_n_per_m,contact_force_y_n_per_m\n";
  for (const scene::ContactBodyResult& body : result.bodies) {
    out += csv_field(body.name) + (body.fixed ? ",1," : ",0,") + (body.elastic ? "1," : "0,");
    for (const double v : {body.centroid.x, body.centroid.y, body.centroid.x - body.start.x,
                           body.centroid.y - body.start.y, degrees(body.rotation), body.largest, body.force.x}) {
      out += number(v) + ",";
    }
    out += number(body.force.y) + "\n";
  }
  return out;
}

/// Of the last frame: stress, principal stresses and their direction at the nodes of bodies that deform.
std::string contact_stress_csv(const scene::ContactResult& result) {
  std::string out =
      "body,node,x_m,y_m,stress_xx_pa,stress_yy_pa,stress_xy_pa,stress_zz_pa,principal_1_pa,principal_2_pa,"
      "direction_1_degrees,von_mises_pa,safety\n";
  if (result.frames.empty()) return out;
  const scene::ContactFrame& last = result.frames.back();
  for (std::size_t b = 0; b < last.stress.size(); ++b) {
    for (std::size_t v = 0; v < last.stress[b].size(); ++v) {
      const scene::NodeStress& node = last.stress[b][v];
      const bem::Sym2 s = node.stress;
      const double mean = 0.5 * (s.xx + s.yy), radius = std::hypot(0.5 * (s.xx - s.yy), s.xy);
      out += csv_field(result.bodies[b].name) + "," + std::to_string(v + 1);
      for (const double x :
           {last.corners[b][v].x, last.corners[b][v].y, s.xx, s.yy, s.xy, node.out_of_plane, mean + radius,
            mean - radius, degrees(0.5 * std::atan2(2 * s.xy, s.xx - s.yy)), node.von_mises}) {
        out += "," + number(x);
      }
      out += std::isnan(node.safety) ? std::string{","} : "," + number(node.safety);
      out += "\n";
    }
  }
  return out;
}

std::expected<void, WriteError> write_contact_files(const scene::ContactResult& result,
                                                    const std::filesystem::path& folder) {
  if (result.output.csv) {
    CLEAVE_CHECK(write_file(folder / "history.csv", contact_history_csv(result)));
    CLEAVE_CHECK(write_file(folder / "bodies.csv", contact_bodies_csv(result)));
    if (result.elastic) CLEAVE_CHECK(write_file(folder / "stress.csv", contact_stress_csv(result)));
    if (!result.points.empty()) CLEAVE_CHECK(write_file(folder / "points.csv", contact_points_csv(result)));
  }
  if (!result.output.vtu) return {};
  std::string series =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
      "byte_order=\"LittleEndian\">\n<Collection>\n";
  for (std::size_t f = 0; f < result.frames.size(); ++f) {
    std::string digits = std::to_string(f);
    digits.insert(0, 4 - std::min<std::size_t>(4, digits.size()), '0');
    const std::string name = "contact_" + digits + ".vtu";
    CLEAVE_CHECK(write_file(folder / name, contact_vtu(result, f)));
    series += "<DataSet timestep=\"" + number(result.frames[f].time) + "\" part=\"0\" file=\"" + name + "\"/>\n";
  }
  return write_file(folder / "contact.pvd", series + "</Collection>\n</VTKFile>\n");
}

std::expected<void, WriteError> write_contact_report(const scene::ContactResult& result,
                                                     const std::filesystem::path& folder) {
  if (!result.output.report) return {};
  return write_file(folder / "report.html", contact_report_html(result));
}

std::expected<void, WriteError> write_contact_summary(const scene::ContactResult& result,
                                                      const std::filesystem::path& folder) {
  return write_file(folder / "summary.json", contact_summary_json(result));
}

}  // namespace cleave::report
