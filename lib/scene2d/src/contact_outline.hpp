#pragma once

#include <cstddef>
#include <vector>

#include "cleave/bem/problem.hpp"
#include "cleave/scene/table_reader.hpp"

namespace cleave::scene {

/// The outline of a body in contact.
struct ContactOutline {
  std::vector<bem::Vec2> corners;    ///< counter-clockwise; empty when wrong (reported)
  std::vector<std::size_t> side_of;  ///< number among `corners` of each side as written
};

/// One of `outline`, `rectangle`, `polygon`, `circle`, `voussoir`; simple, counter-clockwise (turned with a note when
/// not). Keys of the outline of a body; exactly one is given.
[[nodiscard]] std::vector<Key> outline_keys();
[[nodiscard]] ContactOutline parse_contact_outline(const TableReader& body);

}  // namespace cleave::scene
