#pragma once

#include <string>

#include "cleave/stability/key_groups.hpp"

namespace cleave::report {

/// key_groups.csv: a row a group, in order; numbers of blocks parted by spaces; empty where there is no such number
/// (factors of a group that is too large for them), `inf` where a factor has no end.
[[nodiscard]] std::string key_groups_csv(const stability::KeyGroups& groups);

/// The same as a table of the report; empty without groups.
[[nodiscard]] std::string key_groups_section(const stability::KeyGroups& groups);

}  // namespace cleave::report
