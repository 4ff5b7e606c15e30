#pragma once

#include <string>

#include "html.hpp"

namespace cleave::report {

/// Blocks, bolts and combined blocks of the support check.
[[nodiscard]] std::string support_section(const Page& page);
/// Largest key blocks of block theory.
[[nodiscard]] std::string maximum_section(const Page& page);

}  // namespace cleave::report
