#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "newton.hpp"

namespace cleave::assembly {

/// What moves in a solution of the Coulomb problem from rest.
struct Solution {
  State state = {};                          ///< rates are zero of what rests, and of what was not settled
  double residual = 0;                       ///< largest `violation` of a part that moves
  bool settled = true;                       ///< nothing is unsettled
  std::vector<std::uint8_t> unsettled = {};  ///< by body
};
/// Sweeps from free fall over all contacts; what still moves is then solved part by part, the rest fixed, and handed
/// back to the sweeps, until what moves stays the same. Coulomb's problem may have several solutions, and which one
/// sweeps come by hangs on the `order` of contacts: 0 as given, 1 backwards, others are drawn.
[[nodiscard]] Solution settle(const Elements& elements, double divisor, unsigned order = 0);
/// First of what is weaker, then on to its full strength from there. Both are of the same contacts.
[[nodiscard]] std::pair<Solution, Solution> settle(const Elements& weaker, double weaker_divisor,
                                                   const Elements& elements, double divisor);
/// So many orders beside the given one are tried where all are.
inline constexpr unsigned other_orders = 4;

/// Share of its own free fall below which a body is at rest: among few bodies, and among more.
inline constexpr double at_rest_of_few = 1e-8, at_rest = 1e-5;
/// Share of the largest free fall below which what still moves may be on its way to rest.
inline constexpr double creeps = 1e-3;
/// So many count as few; and so many are followed from no friction on by exact solutions.
inline constexpr std::size_t few_bodies = 24, followed_bodies = 8;

}  // namespace cleave::assembly
