#include "cleave/report/contact.hpp"

#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "cleave/core/expected.hpp"
#include "cleave/exchange/vtu_writer.hpp"
#include "cleave/report/summary.hpp"
#include "tables2d.hpp"

namespace cleave::report {
namespace {

using bem::Vec2;

double degrees(double radians) { return radians * 180 / std::numbers::pi; }

/// Of the last frame.
std::string contact_stress_csv(const scene::ContactResult& result) {
  CsvTable table{NodeStressRow{}};
  if (result.frames.empty()) return std::move(table).text();
  const scene::ContactFrame& last = result.frames.back();
  for (std::size_t b = 0; b < last.stress.size(); ++b) {
    for (std::size_t v = 0; v < last.stress[b].size(); ++v) {
      table.add(NodeStressRow{result.bodies[b].name, v + 1, last.corners[b][v], last.stress[b][v]});
    }
  }
  return std::move(table).text();
}

}  // namespace

std::string contact_vtu(const scene::ContactResult& result, std::size_t frame) {
  const scene::ContactFrame& now = result.frames[frame];
  std::vector<geometry::Vec3> points, displacement, force;
  std::vector<std::int64_t> connectivity, offsets;
  std::vector<std::uint8_t> types;
  std::vector<std::int32_t> body, fixed, state;
  std::vector<double> rotation, stress, mises, safety;
  const auto stressed = [&](const scene::NodeStress* at) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    const bem::Sym2 s = at != nullptr ? at->stress : bem::Sym2{none, none, none};
    const double zz = at != nullptr ? at->out_of_plane : none;
    for (const double v : {s.xx, s.xy, 0.0, s.xy, s.yy, 0.0, 0.0, 0.0, zz}) stress.push_back(v);
    mises.push_back(at != nullptr ? at->von_mises : none);
    safety.push_back(at != nullptr ? at->safety.value_or(none) : none);
  };
  const auto point = [&](Vec2 x, Vec2 u, Vec2 f) {
    connectivity.push_back(static_cast<std::int64_t>(points.size()));
    points.push_back({x.x, x.y, 0});
    displacement.push_back({u.x, u.y, 0});
    force.push_back({f.x, f.y, 0});
  };
  const auto cell = [&](std::uint8_t type, std::size_t of, bool is_fixed, std::int32_t how, double turned) {
    offsets.push_back(static_cast<std::int64_t>(points.size()));
    types.push_back(type);
    body.push_back(static_cast<std::int32_t>(of));
    fixed.push_back(is_fixed ? 1 : 0);
    state.push_back(how);
    rotation.push_back(turned);
  };
  for (std::size_t b = 0; b < result.bodies.size(); ++b) {
    const auto corners = scene::corners_at(result, frame, b);
    const auto& start = result.bodies[b].outline;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      point(corners[k], corners[k] - start[k], {});
      stressed(b < now.stress.size() && k < now.stress[b].size() ? &now.stress[b][k] : nullptr);
    }
    cell(7, b, result.bodies[b].fixed, -1, degrees(now.places[b].rotation));  // VTK_POLYGON
  }
  for (const scene::ContactMark& mark : now.contacts) {
    point(mark.at, {}, mark.force);
    stressed(nullptr);
    cell(1, mark.first, false, mark.state == scene::ContactMarkState::slip ? 1 : 0, 0);  // VTK_VERTEX
  }
  VtuWriter vtu{VtuFormat::ascii};
  vtu.begin_piece(points.size(), types.size());
  vtu.begin("PointData");
  vtu.vectors("displacement", displacement);
  vtu.vectors("force", force);
  if (result.elastic) {
    vtu.array("stress", stress, 9);
    vtu.array("von_mises", mises);
    vtu.array("safety", safety);
  }
  vtu.end("PointData");
  vtu.begin("CellData");
  vtu.array("body", body);
  vtu.array("fixed", fixed);
  vtu.array("state", state);
  vtu.array("rotation", rotation);
  vtu.end("CellData");
  vtu.points(points);
  vtu.cells(connectivity, offsets, types);
  return std::move(vtu).finish();
}

std::string contact_history_csv(const scene::ContactResult& result) {
  return csv_table(scene::ContactHistory{}, result.history);
}

std::string contact_points_csv(const scene::ContactResult& result) {
  CsvTable table{PointRow{}};
  for (const scene::ContactHistory& row : result.history) {
    for (std::size_t p = 0; p < result.points.size(); ++p) {
      table.add(PointRow{row.time, result.points[p].name, result.points[p].at, row.points[p]});
    }
  }
  return std::move(table).text();
}

std::string contact_bodies_csv(const scene::ContactResult& result) {
  return csv_table(scene::ContactBodyResult{}, result.bodies);
}

std::expected<void, WriteError> write_contact_files(const scene::ContactResult& result,
                                                    const std::filesystem::path& folder) {
  if (result.output.csv) {
    CLEAVE_CHECK(write_file(folder / "history.csv", contact_history_csv(result)));
    CLEAVE_CHECK(write_file(folder / "bodies.csv", contact_bodies_csv(result)));
    if (result.elastic) CLEAVE_CHECK(write_file(folder / "stress.csv", contact_stress_csv(result)));
    if (!result.points.empty()) CLEAVE_CHECK(write_file(folder / "points.csv", contact_points_csv(result)));
  }
  if (!result.state.empty()) {
    CLEAVE_CHECK(write_file(folder / scene::contact_state_name, result.state));
  }
  if (!result.output.vtu) return {};
  return write_frames(
      folder, "contact", result.frames.size(), [&](std::size_t f) { return result.frames[f].time; },
      [&](std::size_t f) { return contact_vtu(result, f); });
}

std::expected<void, WriteError> write_contact_report(const scene::ContactResult& result,
                                                     const std::filesystem::path& folder) {
  if (!result.output.report) return {};
  return write_file(folder / "report.html", contact_report_html(result));
}

std::expected<void, WriteError> write_contact_summary(const scene::ContactResult& result,
                                                      const std::filesystem::path& folder) {
  return write_file(folder / "summary.json", summary_json(result));
}

}  // namespace cleave::report
