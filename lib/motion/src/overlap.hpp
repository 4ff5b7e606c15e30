#pragma once

#include "touch.hpp"

/// Overlaps of cells as they lie: what every step is judged by. Shares nothing with the search for contacts.
namespace cleave::motion {

/// How deep two cells overlap: the least width, along a normal of either, of what they have in common. At most `enough`
/// may be missing.
[[nodiscard]] double overlap_depth(const Placed& a, const Placed& b, double enough);

}  // namespace cleave::motion
