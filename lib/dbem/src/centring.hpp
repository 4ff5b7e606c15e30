#pragma once

#include <deque>
#include <vector>

#include "cleave/dbem/solver.hpp"

namespace cleave::dbem {

/// What the regularisation of a problem hides of its answer.
struct Creep {
  double most = 0;   // velocity the regularisation lets contacts give way with, m/s
  double speed = 0;  // largest velocity that contacts close or slip with when nothing acts in them, m/s
};

/// The regularisation of a problem, centred on the forces found and again, until it moves nothing. Where heavy bodies
/// yield less than the regularisation does between light ones, the forces found come nearer by a constant share only:
/// the next centre is extrapolated from those before (Anderson 1965). A centre is where a problem starts from; what is
/// an answer is judged by the creep about it.
class Centring final {
 public:
  /// `viscous`: velocity for each unit of impulse away from the centre.
  Centring(ContactProblem& problem, const std::vector<Vec2>& viscous) : problem_{problem}, viscous_{viscous} {}

  [[nodiscard]] Creep creep_at(const std::vector<Vec2>& found) const;
  /// Centres on these impulses.
  void plain(const std::vector<Vec2>& found);
  /// Centres on what the impulses found lead to; true where that is not the impulses themselves.
  bool onwards(const std::vector<Vec2>& found);

 private:
  struct Round {
    std::vector<Vec2> found;   // impulses
    std::vector<Vec2> change;  // from the centre to them, as velocities
  };
  void move_to(const std::vector<Vec2>& centre);
  [[nodiscard]] std::vector<Vec2> extrapolated() const;

  ContactProblem& problem_;
  const std::vector<Vec2>& viscous_;
  std::deque<Round> rounds_;
};

}  // namespace cleave::dbem
