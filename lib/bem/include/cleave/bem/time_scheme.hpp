#pragma once

#include <complex>
#include <string>
#include <variant>

namespace cleave::bem {

/// Newmark (1959). (1/2, 1) is the thesis's and DDA's choice: first order, rings for ever at large steps.
struct Newmark {
  double beta = 0.25;
  double gamma = 0.5;
};
/// Houbolt (1950).
struct Houbolt {};
/// Chung and Hulbert (1993): second order, damps what the step cannot follow; rho in [0, 1] is the spectral radius at
/// infinite frequency.
struct GeneralizedAlpha {
  double rho = 0.8;
};
/// First order, damps all: to reach a state of rest.
struct BackwardEuler {};
using Scheme = std::variant<Newmark, Houbolt, GeneralizedAlpha, BackwardEuler>;

[[nodiscard]] std::string name_of(const Scheme& scheme);

/// Largest factor by which one step multiplies a free motion u'' = -lambda u, for z = lambda dt^2; complex lambda
/// belong to unsymmetric operators. Above 1 the motion grows.
[[nodiscard]] double spectral_radius(const Scheme& scheme, std::complex<double> z);

/// The four numbers Newmark and generalized-alpha have in common.
struct AlphaNumbers {
  double am = 0, af = 0, beta = 0.25, gamma = 0.5;
};
[[nodiscard]] AlphaNumbers numbers_of(const Scheme& scheme);

}  // namespace cleave::bem
