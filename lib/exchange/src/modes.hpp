#pragma once

#include <array>

#include "cleave/stability/result.hpp"

namespace cleave::report {

/// In the order of their numbers: all_modes[i] has the number i in blocks.vtu. The first four are those a block moves
/// in.
inline constexpr std::array all_modes{stability::Mode::falling, stability::Mode::lifting, stability::Mode::sliding,
                                      stability::Mode::wedge,   stability::Mode::stable,  stability::Mode::tapered};

}  // namespace cleave::report
