#pragma once

#include <cstddef>
#include <expected>
#include <filesystem>
#include <string>

#include "cleave/report/write.hpp"
#include "cleave/scene2d/contact.hpp"

namespace cleave::report {

/// report.html: animation with contact forces, energy, histories of points, what each solver did.
[[nodiscard]] std::string contact_report_html(const scene::ContactResult& result);
/// Bodies as polygons and closed contacts as points at one frame, where they are then. Cell arrays `body` (of contacts:
/// the first one), `fixed`, `state` (-1 for bodies, 0 stick, 1 slip), `rotation` (degrees); point arrays
/// `displacement` and `force` (N/m, of contacts).
[[nodiscard]] std::string contact_vtu(const scene::ContactResult& result, std::size_t frame);
/// time_s,step_s,kinetic_j,...: one row a recorded step.
[[nodiscard]] std::string contact_history_csv(const scene::ContactResult& result);
/// time_s,point,x_m,y_m,displacement_x_m,displacement_y_m
[[nodiscard]] std::string contact_points_csv(const scene::ContactResult& result);
/// One row a body at the end of the run.
[[nodiscard]] std::string contact_bodies_csv(const scene::ContactResult& result);

/// contact_0000.vtu ... and contact.pvd; history.csv, points.csv, bodies.csv; as the scene asks.
[[nodiscard]] std::expected<void, WriteError> write_contact_files(const scene::ContactResult& result,
                                                                  const std::filesystem::path& folder);
[[nodiscard]] std::expected<void, WriteError> write_contact_report(const scene::ContactResult& result,
                                                                   const std::filesystem::path& folder);
[[nodiscard]] std::expected<void, WriteError> write_contact_summary(const scene::ContactResult& result,
                                                                    const std::filesystem::path& folder);

}  // namespace cleave::report
