#include "cleave/bem/motion.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>

#include "cleave/core/overloaded.hpp"

namespace cleave::bem {

std::string name_of(const Scheme& scheme) {
  return std::visit(
      overloaded{[](const Newmark& n) { return fmt::format("newmark beta={} gamma={}", n.beta, n.gamma); },
                 [](const Houbolt&) { return std::string{"houbolt"}; },
                 [](const GeneralizedAlpha& g) { return fmt::format("generalized_alpha rho={}", g.rho); },
                 [](const BackwardEuler&) { return std::string{"backward_euler"}; }},
      scheme);
}

AlphaNumbers numbers_of(const Scheme& scheme) {
  return std::visit(overloaded{[](const Newmark& n) { return AlphaNumbers{0, 0, n.beta, n.gamma}; },
                               [](const Houbolt&) { return AlphaNumbers{}; },
                               [](const GeneralizedAlpha& g) {
                                 const double am = (2 * g.rho - 1) / (g.rho + 1);
                                 const double af = g.rho / (g.rho + 1);
                                 const double b = 1 - am + af;
                                 return AlphaNumbers{am, af, 0.25 * b * b, 0.5 - am + af};
                               },
                               [](const BackwardEuler&) { return AlphaNumbers{0, 0, 1, 1}; }},
                    scheme);
}

namespace {
using Complex = std::complex<double>;
}

double spectral_radius(const Scheme& scheme, Complex z) {
  if (std::holds_alternative<BackwardEuler>(scheme)) {
    // (1 + z) u+ = u + v, v+ = v - z u+.
    const Complex root = std::sqrt(-z);
    return std::max(1 / std::abs(1.0 + root), 1 / std::abs(1.0 - root));
  }
  Eigen::MatrixXcd step;
  if (std::holds_alternative<Houbolt>(scheme)) {
    step = Eigen::MatrixXcd::Zero(3, 3);
    const Complex d = 2.0 + z;
    step << 5.0 / d, -4.0 / d, 1.0 / d, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  } else {
    const AlphaNumbers n = numbers_of(scheme);
    Eigen::Matrix3cd left, right;  // of (u, dt v, dt^2 a)
    left << 1.0, 0.0, -n.beta, 0.0, 1.0, -n.gamma, (1 - n.af) * z, 0.0, 1 - n.am;
    right << 1.0, 1.0, 0.5 - n.beta, 0.0, 1.0, 1 - n.gamma, -n.af * z, 0.0, -n.am;
    step = left.partialPivLu().solve(right);
  }
  return step.eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace cleave::bem
