#pragma once

#include <optional>

#include "contacts.hpp"
#include "verdict.hpp"

namespace cleave::stability {

/// How a block of the border moves where its fixed sides are smooth joints; none: it stays, or stands on one of them.
[[nodiscard]] std::optional<Verdict> motion_off_border(Model& model, topology::BlockId id, std::uint32_t state);
/// Whether it has a side that looks up by more than 45 degrees and is not free: it holds as rock does.
[[nodiscard]] bool stands_on_border(Model& model, topology::BlockId id);
/// Of the free faces of a block.
[[nodiscard]] Area free_area_of(const topology::BlockComplex& complex, topology::BlockId id);

}  // namespace cleave::stability
