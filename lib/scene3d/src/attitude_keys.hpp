#pragma once

#include <optional>
#include <vector>

#include "cleave/geometry/orientation.hpp"
#include "context.hpp"

/// How a plane's orientation is written: dip and dip direction, or the trend and plunge of its pole.
namespace cleave::scene {

/// The four keys. `sole`: nothing else states the plane, so one of the two pairs has to stand in the table.
[[nodiscard]] std::vector<Key> attitude_keys(bool sole);
/// Clockwise from the scene's y axis. Exactly one pair has to be there; all else is reported.
[[nodiscard]] std::optional<geometry::Attitude> parse_attitude(const Context& context, const TableReader& table);

}  // namespace cleave::scene
