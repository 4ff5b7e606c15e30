#pragma once

#include <string>

#include "html.hpp"

namespace cleave::report {

/// Why each key block of the first batches moves: its faces, forces and stereonet; the tornado of the first batch.
[[nodiscard]] std::string why_section(const Page& page);
/// Blocks, bolts and combined blocks of the support check.
[[nodiscard]] std::string support_section(const Page& page);
/// Largest key blocks of block theory.
[[nodiscard]] std::string maximum_section(const Page& page);

}  // namespace cleave::report
