#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "cleave/linear/block_system.hpp"
#include "cleave/linear/cone.hpp"
#include "elements.hpp"

namespace cleave::assembly {

/// What a contact can carry.
enum class Law : std::uint8_t {
  frictionless,  ///< n >= 0
  cone,          ///< |t| <= mu n, opening mu |u_t| as it slips: the associated law
  coulomb,       ///< |t| <= mu n against the slip, which does not open
  tresca,        ///< n >= 0, |t| <= threshold
};

struct Problem {
  Law law = Law::frictionless;
  double divisor = 1;                  ///< of all strengths
  std::vector<double> threshold = {};  ///< by element, law tresca
  std::vector<double> slid = {};       ///< by element, law cone: |u_t| that the opening is counted from (de Saxce 1992)
  std::vector<std::uint8_t> pressing = {};  ///< by element: bonds marked 0 have no cohesion; empty: all have
  double least_normal = 0;                  ///< n of corners, in units of its unknown: prestress
};

struct State {
  Eigen::VectorXd v;
  std::vector<Eigen::Vector3d> x;
};

struct Settled {
  double off = 0;        ///< largest lack of balance
  double violation = 0;  ///< largest relative velocity against the law
  unsigned factors = 0;
};

/// Solves v = r + G x with the law between x and G^T v by proximal points on the forces (Rockafellar 1976), each by a
/// semismooth Newton iteration in the velocities (Qi and Sun 1993; Li, Sun and Toh 2018 for the pair). All laws but
/// coulomb are convex: v is unique, and x is near the forces of the start: from none no self-stress enters.
class Newton final {
 public:
  explicit Newton(const Elements& elements);
  Newton(const Elements&&) = delete;

  /// Rest under no forces.
  [[nodiscard]] State none() const;
  /// Goes on from `state`. `rough`: of the first proximal weight.
  Settled solve(const Problem& problem, State& state, double rough = 1e-1);
  [[nodiscard]] const Elements& elements() const noexcept { return *elements_; }
  [[nodiscard]] unsigned factors() const noexcept { return static_cast<unsigned>(system_.factors()); }

 private:
  using Local = linear::Projection;
  [[nodiscard]] Local local(const Problem& problem, std::size_t k, const Eigen::Vector3d& w) const;
  /// Residual v - r - G P(x - u / rho), and the convex function that it is the gradient of.
  double evaluate(const Problem& problem, const State& at, double rho, const Eigen::VectorXd& v,
                  Eigen::VectorXd& gradient, std::vector<Local>* locals) const;
  [[nodiscard]] bool direct(const std::vector<Local>& locals, double rho, bool symmetric,
                            const Eigen::VectorXd& gradient, Eigen::VectorXd& step);
  double inner(const Problem& problem, State& state, double rho);

  const Elements* elements_;
  linear::BlockSystem system_;
};

}  // namespace cleave::assembly
