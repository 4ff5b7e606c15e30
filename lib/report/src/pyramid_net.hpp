#pragma once

#include <span>
#include <string>

#include "cleave/report/key_blocks.hpp"

namespace cleave::report {

/// Joint pyramids of three sets in the stereographic projection of the whole sphere (Goodman & Shi 1985): the lower
/// hemisphere inside the rim, the upper one outside. The planes' great circles, the eight pyramids with their codes
/// (1: below that set's plane), and filled those that can come out at the tunnel. `rows` are of the same three sets and
/// not empty.
[[nodiscard]] std::string pyramid_net(std::span<const scene::MaximumRow> rows);

}  // namespace cleave::report
