#include <Eigen/Dense>
#include <cmath>
#include <complex>

#include "block_build.hpp"
#include "with_eigen.hpp"

namespace cleave::bem {
namespace {

/// Coefficients of x^i y^j by degree i + j, then j.
using Polynomial = std::vector<double>;

std::size_t place_of(std::size_t i, std::size_t j) { return (i + j) * (i + j + 1) / 2 + j; }
std::size_t terms(std::size_t degree) { return (degree + 1) * (degree + 2) / 2; }

template <class Visit>
void each_term(std::size_t degree, const Visit& visit) {
  for (std::size_t n = 0; n <= degree; ++n) {
    for (std::size_t j = 0; j <= n; ++j) visit(n - j, j);
  }
}

/// A polynomial of two degrees more whose Laplacian is the given one.
Polynomial inverse_laplace(const Polynomial& p, std::size_t degree) {
  Polynomial out(terms(degree + 2), 0.0);
  each_term(degree, [&](std::size_t i, std::size_t j) {
    double c = p[place_of(i, j)];
    if (c == 0) return;
    // Twice along x; what the Laplacian then leaves along y is taken back, and again.
    for (std::size_t x = i + 2, y = j;; x += 2, y -= 2) {
      c /= static_cast<double>(x * (x - 1));
      out[place_of(x, y)] += c;
      if (y < 2) break;
      c *= -static_cast<double>(y * (y - 1));
    }
  });
  return out;
}

Polynomial derivative(const Polynomial& p, std::size_t degree, std::size_t axis) {
  Polynomial out(terms(degree - 1), 0.0);
  each_term(degree, [&](std::size_t i, std::size_t j) {
    const std::size_t power = axis == 0 ? i : j;
    if (power == 0) return;
    out[axis == 0 ? place_of(i - 1, j) : place_of(i, j - 1)] += static_cast<double>(power) * p[place_of(i, j)];
  });
  return out;
}

double value_of(const Polynomial& p, std::size_t degree, const Polynomial& powers) {
  double sum = 0;
  for (std::size_t k = 0; k < terms(degree); ++k) sum += p[k] * powers[k];
  return sum;
}

/// x^i y^j, in the order of the coefficients.
Polynomial powers_at(Vec2 x, std::size_t degree) {
  Polynomial out(terms(degree), 1.0);
  for (std::size_t n = 1; n <= degree; ++n) {
    out[place_of(n, 0)] = out[place_of(n - 1, 0)] * x.x;
    for (std::size_t j = 1; j <= n; ++j) out[place_of(n - j, j)] = out[place_of(n - j, j - 1)] * x.y;
  }
  return out;
}

/// Answer of the plane to the body force p e_axis (shear modulus 1) by Galerkin's vector: the Laplacian of G less
/// grad div G / (2 (1 - nu)), where twice the Laplacian of G is -p.
std::array<Polynomial, 2> answer_to(const Polynomial& p, std::size_t degree, std::size_t axis, double nu) {
  Polynomial inner = inverse_laplace(p, degree);
  for (double& c : inner) c = -c;
  const Polynomial g = inverse_laplace(inner, degree + 2);
  const Polynomial div = derivative(g, degree + 4, axis);
  std::array<Polynomial, 2> u;
  for (std::size_t k = 0; k < 2; ++k) {
    u[k] = derivative(div, degree + 3, k);
    for (double& c : u[k]) c *= -0.5 / (1 - nu);
    if (k != axis) continue;
    for (std::size_t t = 0; t < u[k].size(); ++t) u[k][t] += inner[t];
  }
  return u;
}

/// Fields without body force up to a degree, by Kolosov's formula: kappa phi - z conj(phi') - conj(psi), phi and psi
/// powers of z and i times them.
std::vector<std::array<Polynomial, 2>> free_fields(std::size_t degree, double nu) {
  using Complex = std::complex<double>;
  std::vector<std::vector<Complex>> power(degree + 1, std::vector<Complex>(terms(degree)));  // of z
  power[0][0] = 1;
  const auto times = [&](const std::vector<Complex>& p, Complex y) {  // by x + y-factor * y
    std::vector<Complex> out(terms(degree));
    each_term(degree - 1, [&](std::size_t i, std::size_t j) {
      out[place_of(i + 1, j)] += p[place_of(i, j)];
      out[place_of(i, j + 1)] += y * p[place_of(i, j)];
    });
    return out;
  };
  for (std::size_t n = 1; n <= degree; ++n) power[n] = times(power[n - 1], {0, 1});
  std::vector<std::array<Polynomial, 2>> out;
  const auto keep = [&](const std::vector<Complex>& u) {
    std::array<Polynomial, 2> field{Polynomial(u.size()), Polynomial(u.size())};
    for (std::size_t t = 0; t < u.size(); ++t) field[0][t] = u[t].real(), field[1][t] = u[t].imag();
    out.push_back(std::move(field));
  };
  const double kappa = 3 - 4 * nu;
  for (std::size_t n = 0; n <= degree; ++n) {
    for (const Complex c : {Complex{1, 0}, Complex{0, 1}}) {
      std::vector<Complex> psi(terms(degree)), phi(terms(degree));
      std::vector<Complex> slope(terms(degree));  // conj(phi')
      for (std::size_t t = 0; t < psi.size(); ++t) {
        psi[t] = -std::conj(c * power[n][t]);
        if (n > 0) slope[t] = std::conj(static_cast<double>(n) * c * power[n - 1][t]);
      }
      keep(psi);
      if (n == 0) continue;
      const std::vector<Complex> other = times(slope, {0, 1});
      for (std::size_t t = 0; t < phi.size(); ++t) phi[t] = kappa * c * power[n][t] - other[t];
      keep(phi);
    }
  }
  return out;
}

/// Takes free fields out of answers of the plane so that as little as possible is left of them on the boundary: the
/// static extension of what is left is then good on a coarse mesh, too.
void quiet_on_boundary(const Mesh& mesh, double size, double nu, std::size_t degree,
                       std::vector<std::array<Polynomial, 2>>& answers) {
  const auto free = free_fields(degree, nu);
  constexpr std::array<double, 4> samples{-0.75, -0.25, 0.25, 0.75};
  const std::size_t rows = 2 * samples.size() * mesh.elements.size();
  Eigen::MatrixXd a(ix(rows), ix(free.size())), b(ix(rows), ix(answers.size()));
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const Polynomial powers = powers_at(mesh.elements[e].at(samples[k]) / size, degree);
      const double w = std::sqrt(norm(mesh.elements[e].derivative(samples[k])));
      const auto row = ix(2 * (e * samples.size() + k));
      const auto put = [&](Eigen::MatrixXd& m, const std::vector<std::array<Polynomial, 2>>& fields) {
        for (std::size_t f = 0; f < fields.size(); ++f) {
          for (std::size_t c = 0; c < 2; ++c) m(row + ix(c), ix(f)) = w * value_of(fields[f][c], degree, powers);
        }
      };
      put(a, free);
      put(b, answers);
    }
  }
  const Eigen::MatrixXd share = a.completeOrthogonalDecomposition().solve(b);
  for (std::size_t k = 0; k < answers.size(); ++k) {
    for (std::size_t f = 0; f < free.size(); ++f) {
      for (std::size_t c = 0; c < 2; ++c) {
        for (std::size_t t = 0; t < answers[k][c].size(); ++t) answers[k][c][t] -= share(ix(f), ix(k)) * free[f][c][t];
      }
    }
  }
}

/// Of the free fields that quieten the answers to forces below a degree.
std::size_t degree_of_answers(std::size_t forces) { return forces + 5; }

}  // namespace

void Bubbles::evaluate(Vec2 at, const Material& material, std::vector<Value>& out) const {
  const Vec2 x = at / size;
  out.clear();
  if (count() == 0) return;
  const std::size_t top = degree_of_answers(degree);
  const Polynomial powers = powers_at(x, top);
  for (const Field& f : fields) {
    Value v;
    v.displacement = {value_of(f.displacement[0], top, powers), value_of(f.displacement[1], top, powers)};
    const auto slope = [&](std::size_t k, std::size_t axis) {
      return value_of(f.slope[2 * k + axis], top - 1, powers) / size;
    };
    v.stress = material.stress({slope(0, 0), 0.5 * (slope(0, 1) + slope(1, 0)), slope(1, 1)});
    out.push_back(v);
  }
}

Bubbles bubbles_of(const Mesh& mesh, const std::vector<DomainPoint>& points, const Material& material,
                   std::size_t degree) {
  Bubbles out;
  if (degree == 0) return out;
  for (const DomainPoint& p : points) out.size = std::max({out.size, std::abs(p.x.x), std::abs(p.x.y)});
  out.degree = degree;
  // Polynomials below the degree, orthogonal on the body.
  const std::size_t top = degree - 1;
  Eigen::MatrixXd values(ix(points.size()), ix(terms(top)));
  for (std::size_t q = 0; q < points.size(); ++q) {
    const Polynomial powers = powers_at(points[q].x / out.size, top);
    for (std::size_t k = 0; k < powers.size(); ++k) values(ix(q), ix(k)) = std::sqrt(points[q].w) * powers[k];
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr{values};
  const Eigen::MatrixXd r = qr.matrixQR().topRows(ix(terms(top))).triangularView<Eigen::Upper>();
  const double area = values.col(0).squaredNorm();
  const Eigen::MatrixXd back =
      std::sqrt(area) * r.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(r.rows(), r.cols()));
  std::vector<std::array<Polynomial, 2>> answers;
  const std::size_t high = degree_of_answers(degree);
  for (Eigen::Index k = 0; k < back.cols(); ++k) {
    Polynomial p(terms(top));
    for (std::size_t t = 0; t < p.size(); ++t) p[t] = back(ix(t), k);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      answers.push_back(answer_to(p, top, axis, material.nu()));
      for (Polynomial& u : answers.back()) u.resize(terms(high), 0.0);
      out.fields.push_back({.force = p, .displacement = {}, .slope = {}});
    }
  }
  quiet_on_boundary(mesh, out.size, material.nu(), high, answers);
  for (std::size_t k = 0; k < answers.size(); ++k) {
    Bubbles::Field& f = out.fields[k];
    f.displacement = answers[k];
    for (std::size_t c = 0; c < 4; ++c) f.slope[c] = derivative(f.displacement[c / 2], high, c % 2);
  }
  return out;
}

double Bubbles::force(std::size_t field, Vec2 at) const {
  return value_of(fields[field].force, degree - 1, powers_at(at / size, degree - 1));
}

}  // namespace cleave::bem
