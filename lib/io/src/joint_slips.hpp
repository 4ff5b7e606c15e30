#pragma once

#include <optional>
#include <span>
#include <string>

#include "cleave/io/joint_csv.hpp"

/// What in a table of joints may be read as it stands and is likely a slip of who wrote it.
namespace cleave::io {

/// A note on joints without a size in a table that has sizes; empty: all have one.
[[nodiscard]] std::optional<std::string> note_on_endless(std::span<const JointRow> rows);
/// A note on joints with the plane, place and size of an earlier one; empty: there are none. Rows without a place are
/// orientations, of which many may be the same.
[[nodiscard]] std::optional<std::string> note_on_repeated(std::span<const JointRow> rows);

}  // namespace cleave::io
