#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace cleave {

/// The candidate that `word` is most likely a slip of: smallest edit distance (a swap of two neighbours counts as one,
/// case does not count), at most a third of the longer length but at least 2; the first in order when several are as
/// near.
[[nodiscard]] std::optional<std::string_view> nearest(std::string_view word,
                                                      std::span<const std::string_view> candidates);

}  // namespace cleave
