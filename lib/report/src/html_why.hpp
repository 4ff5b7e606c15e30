#pragma once

#include <string>

#include "html.hpp"

namespace cleave::report {

/// Why each key block moves, the largest net force first: its picture, faces, forces and stereonet, and the tornado of
/// those of the first batch. Each is a sheet to print, at the link #sheet-NUMBER.
[[nodiscard]] std::string why_section(const Page& page);

}  // namespace cleave::report
