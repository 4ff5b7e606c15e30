#pragma once

/// The determinants behind the predicates once more, by plain Laplace expansion in integers without bound: slow, and it
/// shares no formula with the library.

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cstddef>
#include <sstream>

#include "cleave/exact/plane.hpp"
#include "cleave/exact/wide.hpp"

namespace cleave::testing {

using Integer = boost::multiprecision::cpp_int;

template <std::size_t N>
using Matrix = std::array<std::array<Integer, N>, N>;

template <std::size_t N>
[[nodiscard]] Integer determinant(const Matrix<N>& m) {
  if constexpr (N == 1) {
    return m[0][0];
  } else {
    Integer sum = 0;
    for (std::size_t column = 0; column < N; ++column) {
      Matrix<N - 1> minor;
      for (std::size_t i = 1; i < N; ++i) {
        for (std::size_t j = 0, k = 0; j < N; ++j) {
          if (j != column) minor[i - 1][k++] = m[i][j];
        }
      }
      const Integer part = m[0][column] * determinant<N - 1>(minor);
      sum += column % 2 == 0 ? part : Integer{-part};
    }
    return sum;
  }
}

/// (n_x, n_y, n_z, d)
[[nodiscard]] inline std::array<Integer, 4> coefficients(const exact::Plane& p) {
  return {Integer{p.normal()[0]}, Integer{p.normal()[1]}, Integer{p.normal()[2]}, Integer{exact::widened(p.offset())}};
}
[[nodiscard]] inline Integer det4(const exact::Plane& p, const exact::Plane& q, const exact::Plane& r,
                                  const exact::Plane& s) {
  return determinant<4>({coefficients(p), coefficients(q), coefficients(r), coefficients(s)});
}
[[nodiscard]] inline Integer det3(const exact::Plane& p, const exact::Plane& q, const exact::Plane& r) {
  Matrix<3> m;
  const std::array rows{coefficients(p), coefficients(q), coefficients(r)};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) m[i][j] = rows[i][j];
  }
  return determinant<3>(m);
}
[[nodiscard]] inline exact::Sign sign(const Integer& value) {
  return value > 0 ? exact::Sign::positive : value < 0 ? exact::Sign::negative : exact::Sign::zero;
}
/// Sides of S on which the meet of P, Q, R lies, from the point itself by Cramer's rule.
[[nodiscard]] inline exact::Sign side_reference(const exact::Plane& p, const exact::Plane& q, const exact::Plane& r,
                                                const exact::Plane& s) {
  const std::array rows{coefficients(p), coefficients(q), coefficients(r)};
  const Integer whole = det3(p, q, r);
  const auto n = coefficients(s);
  Integer value = n[3] * whole;
  for (std::size_t column = 0; column < 3; ++column) {
    Matrix<3> m;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) m[i][j] = j == column ? Integer{-rows[i][3]} : rows[i][j];
    }
    value += n[column] * determinant<3>(m);
  }
  return sign(value) * sign(whole);
}

}  // namespace cleave::testing
