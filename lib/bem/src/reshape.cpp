#include "cleave/bem/motion.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "block_build.hpp"
#include "cleave/bem/block.hpp"
#include "gauss.hpp"
#include "with_eigen.hpp"

namespace cleave::bem {
namespace {

constexpr std::size_t points = 3;  ///< of an element, where stress is kept

Vec2 slope_along(const BlockOperator& block, BoundaryPlace at, const std::vector<double>& u) {
  const Element& e = block.mesh().elements[at.element];
  const auto d = shape_slope(block.mesh().order, at.s);
  Vec2 out;
  for (std::size_t a = 0; a < block.mesh().per_element(); ++a) {
    out += d[a] * Vec2{u[2 * e.node[a]], u[2 * e.node[a] + 1]};
  }
  return out / norm(e.derivative(at.s));
}

/// Half the logarithm of F F^T, and the angle of F's rotation.
struct Finite {
  Sym2 strain;
  double angle;
};
Finite finite(Mat2 f) {
  const double xx = f.xx * f.xx + f.xy * f.xy, yy = f.yx * f.yx + f.yy * f.yy, xy = f.xx * f.yx + f.xy * f.yy;
  const double mean = 0.5 * (xx + yy), half = 0.5 * (xx - yy);
  const double radius = std::hypot(half, xy);
  // Eigenvalues mean +- radius; their product by the determinant, which does not cancel.
  const double det = f.xx * f.yy - f.xy * f.yx;
  const double big = mean + radius;
  const double small = det * det / big;
  const double sum = 0.5 * (0.5 * std::log(big) + 0.5 * std::log(small));
  const double spread = radius < 1e-12 ? 0.5 / mean : 0.25 * std::log(big / small) / radius;
  return {{sum + spread * half, spread * xy, sum - spread * half}, std::atan2(f.yx - f.xy, f.xx + f.yy)};
}

Sym2 turned(Sym2 v, double angle) {
  const double c = std::cos(angle), d = std::sin(angle);
  return {c * c * v.xx - 2 * c * d * v.xy + d * d * v.yy, c * d * (v.xx - v.yy) + (c * c - d * d) * v.xy,
          d * d * v.xx + 2 * c * d * v.xy + c * c * v.yy};
}

/// Displacement gradient since the build.
Mat2 gradient_at(const BlockOperator& block, BoundaryPlace at, const std::vector<double>& u, Sym2 stress) {
  const Sym2 strain = block.material().strain(stress);
  const Vec2 n = block.mesh().elements[at.element].normal(at.s);
  // n.(grad u).tau is n.strain.tau less the rotation.
  const double turn = dot(turned_left(n), strain * n) - dot(n, slope_along(block, at, u));
  return {strain.xx, strain.xy - turn, strain.xy + turn, strain.yy};
}

/// Nodal displacement whose boundary stress, with that of the inner motions, is closest to the one given.
Eigen::VectorXd closest(const BlockOperator& block, const std::vector<Sym2>& stress, const Eigen::VectorXd& inner) {
  const Mesh& mesh = block.mesh();
  const std::size_t per = mesh.per_element();
  const auto n = ix(block.freedoms());
  const Eigen::Map<const Eigen::MatrixXd> traction_of = view(block.traction_of());
  Eigen::MatrixXd a(ix(3 * stress.size()), n);
  Eigen::VectorXd b(ix(3 * stress.size()));
  const GaussRule& rule = gauss(points);
  const double nu = block.material().nu();
  const double scale = 1 / block.material().mu();
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const Element& element = mesh.elements[e];
    for (std::size_t g = 0; g < points; ++g) {
      const double s = rule.s[g];
      const Vec2 normal = element.normal(s), along = turned_left(normal);
      const double length = norm(element.derivative(s));
      const auto value = shape(mesh.order, s);
      const auto slope = shape_slope(mesh.order, s);
      Eigen::RowVectorXd nn = Eigen::RowVectorXd::Zero(n), nt = nn, tt = nn;
      for (std::size_t k = 0; k < per; ++k) {
        const auto row = ix(2 * (e * per + k));
        nn += value[k] * (normal.x * traction_of.row(row) + normal.y * traction_of.row(row + 1));
        nt += value[k] * (along.x * traction_of.row(row) + along.y * traction_of.row(row + 1));
      }
      tt = nu / (1 - nu) * nn;
      for (std::size_t k = 0; k < per; ++k) {
        const auto column = ix(2 * element.node[k]);
        const double d = 2 * block.material().mu() / (1 - nu) * slope[k] / length;
        tt(column) += d * along.x;
        tt(column + 1) += d * along.y;
      }
      const auto row = ix(3 * (e * points + g));
      const double w = scale * std::sqrt(rule.w[g] * length);
      const Sym2 given = stress[e * points + g];
      a.row(row) = w * nn;
      a.row(row + 1) = std::sqrt(2.0) * w * nt;
      a.row(row + 2) = w * tt;
      b(row) = w * dot(normal, given * normal);
      b(row + 1) = std::sqrt(2.0) * w * dot(along, given * normal);
      b(row + 2) = w * dot(along, given * along);
    }
  }
  // Rigid motions carry no stress: the solution without them.
  const auto nodal = n - inner.size();
  b -= a.rightCols(inner.size()) * inner;
  return a.leftCols(nodal).completeOrthogonalDecomposition().solve(b);
}

}  // namespace

double steepest(const BlockOperator& block, const std::vector<double>& freedoms) {
  double most = 0;
  for (std::size_t e = 0; e < block.mesh().elements.size(); ++e) {
    for (const double s : {-1.0, 0.0, 1.0}) most = std::max(most, norm(slope_along(block, {e, s}, freedoms)));
  }
  return most;
}

std::vector<double> expanded(const Modes& modes, std::span<const double> amplitudes, std::size_t freedoms) {
  std::vector<double> out(freedoms, 0.0);
  for (std::size_t k = 0; k < amplitudes.size(); ++k) {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += amplitudes[k] * modes.shapes(i, k);
  }
  return out;
}

std::vector<double> steepest_of(const BlockOperator& block, const Modes& modes) {
  std::vector<double> out, one(modes.shapes.rows);
  for (std::size_t k = 0; k < modes.eigenvalues.size(); ++k) {
    for (std::size_t i = 0; i < one.size(); ++i) one[i] = modes.shapes(i, k);
    out.push_back(steepest(block, one));
  }
  return out;
}

double energy_of(const BlockOperator& block, const std::vector<double>& freedoms) {
  const Eigen::Map<const Eigen::VectorXd> u{freedoms.data(), ix(freedoms.size())};
  return 0.5 * u.dot(view(block.stiffness()) * u);
}

CarriedStress::CarriedStress(const BlockOperator& block)
    : stress_(points * block.mesh().elements.size()), strained_(block.freedoms(), 0.0) {}

std::expected<BlockOperator, BlockError> CarriedStress::advance(const BlockOperator& now,
                                                                const std::vector<double>& freedoms,
                                                                const BlockOptions& options) {
  auto next = now.deformed(freedoms, options);
  if (!next) return next;
  const auto tractions = tractions_of(now, freedoms);
  const GaussRule& rule = gauss(points);
  for (std::size_t e = 0; e < now.mesh().elements.size(); ++e) {
    for (std::size_t g = 0; g < points; ++g) {
      const BoundaryPlace at{e, rule.s[g]};
      const Mat2 h = gradient_at(now, at, freedoms, boundary_stress(now, at, freedoms, tractions));
      const Finite f = finite({1 + h.xx, h.xy, h.yx, 1 + h.yy});
      Sym2& kept = stress_[e * points + g];
      kept = turned(kept, f.angle) + now.material().stress(f.strain);
    }
  }
  // Inner motions go on from where they are.
  const std::size_t nodal = now.boundary_freedoms();
  for (std::size_t i = nodal; i < freedoms.size(); ++i) strained_[i] += freedoms[i];
  const auto own = std::span{strained_}.subspan(nodal);
  const Eigen::Map<const Eigen::VectorXd> inner{own.data(), ix(own.size())};
  const Eigen::VectorXd u = closest(*next, stress_, inner);
  std::copy(u.begin(), u.end(), strained_.begin());
  return next;
}

}  // namespace cleave::bem
