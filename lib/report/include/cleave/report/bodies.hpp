#pragma once

#include <expected>
#include <filesystem>
#include <string>

#include "cleave/report/write.hpp"
#include "cleave/scene2d/bodies.hpp"

namespace cleave::report {

/// report.html: deformed shape with a slider of scale, animation, contours of stress, histories, error against time.
[[nodiscard]] std::string bodies_report_html(const scene::BodiesResult& result);
/// Outlines as poly-lines and the stress cells as quads at one frame, undeformed, with displacement as an array.
[[nodiscard]] std::string bodies_vtu(const scene::BodiesResult& result, std::size_t frame);
/// time,point,x,y,displacement_x,displacement_y
[[nodiscard]] std::string bodies_points_csv(const scene::BodiesResult& result);

/// bodies.vtu, or bodies_0000.vtu ... and bodies.pvd with their times; points.csv; as the scene asks.
[[nodiscard]] std::expected<void, WriteError> write_bodies_files(const scene::BodiesResult& result,
                                                                 const std::filesystem::path& folder);
[[nodiscard]] std::expected<void, WriteError> write_bodies_report(const scene::BodiesResult& result,
                                                                  const std::filesystem::path& folder);
[[nodiscard]] std::expected<void, WriteError> write_bodies_summary(const scene::BodiesResult& result,
                                                                   const std::filesystem::path& folder);

}  // namespace cleave::report
