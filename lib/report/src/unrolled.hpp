#pragma once

#include <string>

#include "html.hpp"

namespace cleave::report {

/// Maps of the tunnels' walls, unrolled: traces of joints, faces of key blocks, collars of bolts. Empty without
/// tunnels.
[[nodiscard]] std::string unrolled_section(const Page& page);

}  // namespace cleave::report
