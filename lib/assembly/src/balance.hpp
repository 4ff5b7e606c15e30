#pragma once

#include <expected>
#include <vector>

#include "cleave/assembly/groups.hpp"

namespace cleave::assembly {

/// Forces that every contact carries at strengths over `factor`, and what each body lacks of balance under them. That
/// an assembly rests in them is no proof that it stays: only that the search ended in a state at rest. Made by the
/// check alone.
class BalanceCertificate final {
 public:
  [[nodiscard]] double factor() const noexcept { return factor_; }
  /// By body: force, and moment over the reach of its contacts, over its own load; rounded up.
  [[nodiscard]] const std::vector<double>& lack() const noexcept { return lack_; }

 private:
  friend std::expected<BalanceCertificate, Refused> check_balance(const Assembly&, double, const ContactForces&);
  BalanceCertificate(double factor, std::vector<double> lack) : factor_{factor}, lack_{std::move(lack)} {}
  double factor_;
  std::vector<double> lack_;
};
/// Shares no code with the solver; intervals rounded outwards. Refused where a force is not carried: a pull beyond the
/// tension, a shear beyond friction or cohesion (up to rounding of the forces, 1e-9). Cohesion of a contact counts
/// where it presses.
[[nodiscard]] std::expected<BalanceCertificate, Refused> check_balance(const Assembly& assembly, double factor,
                                                                       const ContactForces& forces);

}  // namespace cleave::assembly
