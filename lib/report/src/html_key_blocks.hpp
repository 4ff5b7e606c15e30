#pragma once

#include <string>
#include <vector>

#include "html.hpp"

namespace cleave::report {

/// Blocks that move, or would without friction: the largest net force first, then those that stay by their factor.
[[nodiscard]] std::vector<const stability::Judgement*> by_severity(const stability::Analysis& analysis);
/// Batches, and the table of key blocks.
[[nodiscard]] std::string key_blocks_section(const Page& page);

}  // namespace cleave::report
