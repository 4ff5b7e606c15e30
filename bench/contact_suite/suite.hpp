#pragma once

/// A fixed list of contact problems, easy and extreme, and a judge of answers that shares no code with the solvers.

#include <cstdint>
#include <string>
#include <vector>

#include "cleave/dbem/world.hpp"

namespace cleave::contact_suite {

struct SuiteProblem {
  std::string family;  ///< carries the mass ratio as m1e3; none: at most 100
  std::uint64_t seed = 0;
  bool elastic = false;
  std::vector<dbem::ContactProblem> groups;  ///< all cold
  [[nodiscard]] std::size_t contacts() const;
};

/// Every family with its seeds; `quick`: two seeds each of the small families.
[[nodiscard]] std::vector<SuiteProblem> suite(bool quick);

/// Residual of the contact law in impulse units over the largest impulse (or load), worst of the contacts:
/// complementarity, penetration and cone, written from the law itself.
[[nodiscard]] double judge(const dbem::ContactProblem& problem, const std::vector<dbem::Vec2>& impulse);

}  // namespace cleave::contact_suite
