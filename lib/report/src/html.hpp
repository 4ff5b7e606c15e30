#pragma once

#include <cstddef>
#include <string>

#include "cleave/realize/run_result.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::report {

/// Text that report.html may hold for the 3D view, by the number of blocks: 25 MB for 5,000 blocks and more, less for
/// fewer. What does not fit is left out of the picture, never out of the figures, and the page says so.
inline constexpr std::size_t view_budget_bytes = 20'000'000;

/// What report.html shows: a result and its blocks, which may be none (the certificate did not pass).
struct Page {
  const scene::RunResult& result;
  const topology::BlockComplex* complex = nullptr;

  [[nodiscard]] const scene::Figures& figures() const noexcept { return result.figures; }
  [[nodiscard]] double tan_friction(topology::JointId joint) const;
  /// "160°": clockwise from true north, of an azimuth from the scene's y axis; whole degrees.
  [[nodiscard]] std::string azimuth(double from_y) const;
};

/// report.html: one file, nothing is ever loaded from elsewhere. Same page, same bytes.
[[nodiscard]] std::string report_html(const Page& page);

}  // namespace cleave::report
