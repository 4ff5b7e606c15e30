#pragma once

/// What a pass over fixed contact states costs in other forms of the same equations.

#include <cstddef>
#include <memory>
#include <vector>

#include "cleave/dbem/solver.hpp"

namespace cleave::contact_suite {

/// A square of elastic blocks glued to each other and to a fixed floor, one step of falling.
struct Pass {
  std::size_t blocks, freedoms, contacts;
};

class PassProblem final {
 public:
  /// `per_side` quadratic elements a side: 16 per_side freedoms a block. Contacts at corners of the squares, as the
  /// source has them, or at every node.
  PassProblem(std::size_t side, std::size_t per_side, bool every_node = false);
  ~PassProblem();
  PassProblem(const PassProblem&) = delete;
  PassProblem& operator=(const PassProblem&) = delete;
  [[nodiscard]] Pass size() const;
  /// Normal and tangential impulses of the contacts, all sticking: ours (assembly of W and the solve).
  [[nodiscard]] std::vector<dbem::Vec2> condensed() const;
  /// All nodal freedoms in one sparse matrix, factorised.
  [[nodiscard]] std::vector<dbem::Vec2> sparse_full() const;
  /// That of Fu (2014): block matrices built anew, all in one dense matrix, factorised. `rebuild` false leaves the
  /// first out.
  [[nodiscard]] std::vector<dbem::Vec2> dense_full(bool rebuild) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace cleave::contact_suite
