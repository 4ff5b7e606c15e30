#include "drbem.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "block_build.hpp"
#include "cleave/bem/statics.hpp"
#include "cleave/core/overloaded.hpp"
#include "element_rows.hpp"
#include "with_eigen.hpp"

namespace cleave::bem {

std::string describe(const DrbemError& error) {
  return std::visit(
      overloaded{[](const SolveError& e) { return describe(e); },
                 [](const BlockNeedsDensity& e) { return describe(BlockError{e}); },
                 [](const UnstableStep& e) {
                   return fmt::format(
                       "with a step of {:.3g} s the dual reciprocity operator multiplies its worst motion by {:.6f} a "
                       "step; {}, or use the symmetric operator (the default)",
                       e.step_s, e.radius,
                       std::isfinite(e.smallest_stable_s)
                           ? fmt::format("steps above about {:.3g} s do not grow with Newmark (1/2, 1)",
                                         e.smallest_stable_s)
                           : std::string{"no step is stable"});
                 }},
      error);
}

namespace {

using Eigen::MatrixXd;

/// A particular solution of Navier's equation L u = f e_m: u_mj and its traction, mu = 1.
struct ParticularPair {
  Mat2 u, t;
};

/// f = r^k about a node, k = 0 or 1.
ParticularPair of_power(Vec2 d, Vec2 n, double nu, int k) {
  const double a = 1.0 / ((k + 2) * (k + 2)) - 1 / (2 * (1 - nu) * (k + 4) * (k + 2) * (k + 2));
  const double b = -1 / (2 * (1 - nu) * (k + 4) * (k + 2));
  const double r2 = dot(d, d);
  const double rk = k == 0 ? 1 : std::sqrt(r2);
  ParticularPair p;
  p.u = rk * Mat2{a * r2 + b * d.x * d.x, b * d.x * d.y, b * d.x * d.y, a * r2 + b * d.y * d.y};
  // t = r^k { 2nu/(1-2nu) [(k+2)A+(k+3)B] d_m n_j + [(k+2)A+B](n_m d_j + d.n delta) + 2B d_m n_j + 2kB d_m d_j d.n/r^2
  // }
  const double c1 = 2 * nu / (1 - 2 * nu) * ((k + 2) * a + (k + 3) * b) + 2 * b;
  const double c2 = (k + 2) * a + b;
  const double dn = dot(d, n);
  const double c3 = k == 0 || r2 == 0 ? 0 : 2 * k * b * dn / r2;
  p.t = rk * Mat2{c1 * d.x * n.x + c2 * (n.x * d.x + dn) + c3 * d.x * d.x,
                  c1 * d.x * n.y + c2 * n.x * d.y + c3 * d.x * d.y, c1 * d.y * n.x + c2 * n.y * d.x + c3 * d.x * d.y,
                  c1 * d.y * n.y + c2 * (n.y * d.y + dn) + c3 * d.y * d.y};
  return p;
}

/// f = x_l, from the Galerkin vector x_l r^4 / 192.
ParticularPair of_linear(Vec2 x, Vec2 n, double nu, std::size_t l) {
  const double lambda = 2 * nu / (1 - 2 * nu);
  const double c = 1 / (2 * (1 - nu));
  const std::array<double, 2> d{x.x, x.y};
  const std::array<double, 2> normal{n.x, n.y};
  const double r2 = dot(x, x);
  const auto del = [](std::size_t i, std::size_t j) { return i == j ? 1.0 : 0.0; };
  std::array<std::array<double, 2>, 2> u{};
  std::array<std::array<std::array<double, 2>, 2>, 2> g{};  // u_mj,q
  for (std::size_t m = 0; m < 2; ++m) {
    for (std::size_t j = 0; j < 2; ++j) {
      const double phi =
          (4 * r2 * (del(l, m) * d[j] + del(l, j) * d[m]) + d[l] * (4 * r2 * del(m, j) + 8 * d[m] * d[j])) / 192;
      u[m][j] = del(m, j) * d[l] * r2 / 8 - c * phi;
      for (std::size_t q = 0; q < 2; ++q) {
        const double lap = (del(l, q) * r2 + 2 * d[l] * d[q]) / 8;
        const double dphi = (8 * d[q] * (del(l, m) * d[j] + del(l, j) * d[m]) +
                             4 * r2 * (del(l, m) * del(j, q) + del(l, j) * del(m, q)) +
                             del(l, q) * (4 * r2 * del(m, j) + 8 * d[m] * d[j]) +
                             d[l] * (8 * d[q] * del(m, j) + 8 * (del(m, q) * d[j] + d[m] * del(j, q)))) /
                            192;
        g[m][j][q] = del(m, j) * lap - c * dphi;
      }
    }
  }
  std::array<std::array<double, 2>, 2> t{};
  for (std::size_t m = 0; m < 2; ++m) {
    const double volume = lambda * (g[m][0][0] + g[m][1][1]);
    for (std::size_t j = 0; j < 2; ++j) {
      t[m][j] = volume * normal[j];
      for (std::size_t q = 0; q < 2; ++q) t[m][j] += (g[m][j][q] + g[m][q][j]) * normal[q];
    }
  }
  return {{u[0][0], u[0][1], u[1][0], u[1][1]}, {t[0][0], t[0][1], t[1][0], t[1][1]}};
}

void put(MatrixXd& a, std::size_t row, std::size_t column, Mat2 m) {
  a(ix(row), ix(column)) += m.xx;
  a(ix(row), ix(column + 1)) += m.xy;
  a(ix(row + 1), ix(column)) += m.yx;
  a(ix(row + 1), ix(column + 1)) += m.yy;
}
Mat2 transposed(Mat2 m) { return {m.xx, m.yx, m.xy, m.yy}; }

struct BoundaryMatrices {
  MatrixXd h, g;
};
/// H of displacements and G of element-wise tractions, for the nodes and the points inside.
BoundaryMatrices boundary_matrices(const Mesh& mesh, const std::vector<Vec2>& points, double nu) {
  const std::size_t nb = mesh.nodes.size(), n = points.size(), per = mesh.per_element();
  const Integrator integrator{mesh, {{1, nu}}, 1e-12};
  MatrixXd hm = MatrixXd::Zero(ix(2 * n), ix(2 * n));
  MatrixXd gm = MatrixXd::Zero(ix(2 * n), ix(2 * per * mesh.elements.size()));
  for (std::size_t i = 0; i < n; ++i) {
    Mat2 total;
    ElementIntegrals part;
    for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
      std::optional<double> own;
      if (i < nb) {
        for (const Use& use : mesh.nodes[i].uses) {
          if (use.element == e) own = local_nodes(mesh.order)[use.local];
        }
      }
      integrator.integrate(e, points[i], own, part);
      for (std::size_t a = 0; a < per; ++a) {
        put(gm, 2 * i, 2 * (e * per + a), part.g[a]);
        put(hm, 2 * i, 2 * mesh.elements[e].node[a], part.h[a]);
        if (!own) total += part.h[a];
      }
    }
    put(hm, 2 * i, 2 * i, i < nb ? -1.0 * total : Mat2{1, 0, 0, 1});
  }
  return {std::move(hm), std::move(gm)};
}

/// Particular solutions at nodes and, with each element's own normal, at element nodes.
struct Spread {
  MatrixXd displacement, traction;
  MatrixXd spread;  ///< functions of accelerations at the points
};
/// `h`: the length that points are scaled by, m.
Spread particular_solutions(const Mesh& mesh, const std::vector<Vec2>& points, double nu, double h, Basis basis) {
  const std::size_t n = points.size(), per = mesh.per_element(), nt = per * mesh.elements.size();
  const bool linear = basis == Basis::r_plus_linear;
  const std::size_t functions = n + (linear ? 3 : 0);
  MatrixXd uh = MatrixXd::Zero(ix(2 * n), ix(2 * functions));
  MatrixXd th = MatrixXd::Zero(ix(2 * nt), ix(2 * functions));
  MatrixXd f = MatrixXd::Zero(ix(functions), ix(functions));
  const auto pair = [&](std::size_t q, Vec2 x, Vec2 normal) {
    if (q >= n) return q == n ? of_power(x, normal, nu, 0) : of_linear(x, normal, nu, q - n - 1);
    const Vec2 d = x - points[q];
    ParticularPair p = of_power(d, normal, nu, 1);
    if (basis == Basis::one_plus_r) {
      // The 1 of 1 + r is a metre, as in Fu (2014); r is scaled here.
      const ParticularPair one = of_power(d, normal, nu, 0);
      p.u = p.u + (1 / h) * one.u;
      p.t = p.t + (1 / h) * one.t;
    }
    return p;
  };
  for (std::size_t q = 0; q < functions; ++q) {
    for (std::size_t i = 0; i < n; ++i) put(uh, 2 * i, 2 * q, transposed(pair(q, points[i], {}).u));
    for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
      for (std::size_t a = 0; a < per; ++a) {
        const double s = local_nodes(mesh.order)[a];
        const Element& element = mesh.elements[e];
        put(th, 2 * (e * per + a), 2 * q, transposed(pair(q, element.at(s), element.normal(s)).t));
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      const Vec2 x = points[i];
      double value = 0;
      if (q < n) {
        value = norm(x - points[q]) + (basis == Basis::one_plus_r ? 1 / h : 0.0);
      } else {
        value = q == n ? 1 : (q == n + 1 ? x.x : x.y);
        f(ix(q), ix(i)) = value;
      }
      f(ix(i), ix(q)) = value;
    }
  }
  const MatrixXd inverse = f.partialPivLu().inverse().leftCols(ix(n));
  MatrixXd spread = MatrixXd::Zero(ix(2 * functions), ix(2 * n));
  for (std::size_t q = 0; q < functions; ++q) {
    for (std::size_t i = 0; i < n; ++i) {
      spread(ix(2 * q), ix(2 * i)) = spread(ix(2 * q + 1), ix(2 * i + 1)) = inverse(ix(q), ix(i));
    }
  }
  return {std::move(uh), std::move(th), std::move(spread)};
}

/// What clamped sides take, and the tractions given on the others.
struct HeldSides {
  std::map<std::uint32_t, std::size_t> nodes;                  ///< clamped, numbered
  std::vector<std::pair<std::size_t, std::size_t>> reactions;  ///< element place, clamped node
  Eigen::VectorXd tractions;
};
HeldSides held_sides(const Region& region, const std::vector<Loop>& loops, const Mesh& mesh, Vec2 origin, double h) {
  const std::size_t per = mesh.per_element();
  const double mu = region.material.mu();
  HeldSides out;
  Eigen::VectorXd& t = out.tractions = Eigen::VectorXd::Zero(ix(2 * per * mesh.elements.size()));
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const Element& element = mesh.elements[e];
    const Condition& c = region.conditions[loops[element.loop][element.side].condition];
    const bool held = c.component[0].given == Given::displacement;
    for (std::size_t a = 0; a < per; ++a) {
      if (held) {
        const auto [it, fresh] = out.nodes.try_emplace(element.node[a], out.nodes.size());
        out.reactions.emplace_back(e * per + a, it->second);
        continue;
      }
      const double s = local_nodes(mesh.order)[a];
      const Vec2 normal = element.normal(s);
      const std::array<Vec2, 2> axes = c.axes == Axes::normal
                                           ? std::array{rotated(normal, c.turn), rotated(turned_left(normal), c.turn)}
                                           : std::array{rotated({1, 0}, c.turn), rotated({0, 1}, c.turn)};
      Vec2 v;
      for (std::size_t k = 0; k < 2; ++k) {
        if (c.component[k].value) v += c.component[k].value(origin + h * element.at(s), normal) * axes[k];
      }
      t(ix(2 * (e * per + a))) = v.x / mu;
      t(ix(2 * (e * per + a) + 1)) = v.y / mu;
    }
  }
  return out;
}

}  // namespace

std::expected<Drbem, DrbemError> Drbem::make(const Region& region, const MeshSize& size, Basis basis,
                                             const std::vector<Vec2>& inner) {
  auto checked = check_loops(region.loops, false);
  if (!checked) return std::unexpected<DrbemError>{std::in_place, SolveError{BadOutline{0, checked.error()}}};
  const double rho = region.material.density();
  if (!(rho > 0)) return std::unexpected(DrbemError{BlockNeedsDensity{}});
  Drbem out;
  out.origin_ = area_moments(checked->loops).centroid;
  double extent = 0;
  for (const Loop& loop : checked->loops) {
    for (const Side& side : loop) extent = std::max(extent, norm(side.start - out.origin_));
  }
  const double h = out.scale_ = 8 * extent;
  out.mu_ = region.material.mu();
  out.mesh_ = make_mesh(checked->loops, size, out.origin_, h);
  const Mesh& mesh = out.mesh_;
  const double nu = region.material.nu();
  const std::size_t nb = mesh.nodes.size();
  for (const Node& node : mesh.nodes) out.points_.push_back(node.x);
  for (const Vec2 x : inner) out.points_.push_back((x - out.origin_) / h);
  const std::size_t n = out.points_.size();
  const auto [hm, gm] = boundary_matrices(mesh, out.points_, nu);
  const Spread by = particular_solutions(mesh, out.points_, nu, h, basis);
  // Scaled equations: u'/h, t/mu; time unit h sqrt(rho/mu).
  const MatrixXd m = (rho * h * h / out.mu_) * ((gm * by.traction - hm * by.displacement) * by.spread);
  out.mass_ = dense(m);
  out.stiffness_ = dense(hm);
  out.gather_ = dense(gm);

  // Tractions of clamped sides go by rows Z with Z G_b = 0.
  const HeldSides held = held_sides(region, checked->loops, mesh, out.origin_, h);
  MatrixXd gb = MatrixXd::Zero(ix(2 * n), ix(2 * held.nodes.size()));
  for (const auto& [place, node] : held.reactions) {
    for (std::size_t c = 0; c < 2; ++c) gb.col(ix(2 * node + c)) += gm.col(ix(2 * place + c));
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (i < nb && held.nodes.contains(static_cast<std::uint32_t>(i))) continue;
    out.free_.push_back(2 * i);
    out.free_.push_back(2 * i + 1);
  }
  MatrixXd z = MatrixXd::Identity(ix(2 * n), ix(2 * n));
  if (!held.nodes.empty()) {
    const Eigen::HouseholderQR<MatrixXd> qr{gb};
    const MatrixXd q = qr.householderQ();
    z = q.rightCols(ix(2 * n) - gb.cols()).transpose();
  }
  MatrixXd mr(z.rows(), ix(out.free_.size())), kr(z.rows(), ix(out.free_.size()));
  for (std::size_t k = 0; k < out.free_.size(); ++k) {
    mr.col(ix(k)) = z * m.col(ix(out.free_[k]));
    kr.col(ix(k)) = z * hm.col(ix(out.free_[k]));
  }
  out.reduced_mass_ = dense(mr);
  out.reduced_stiffness_ = dense(kr);
  const Eigen::VectorXd load = z * (gm * held.tractions);
  out.load_.assign(load.begin(), load.end());
  const Eigen::VectorXcd l = mr.partialPivLu().solve(kr).eigenvalues();
  out.eigenvalues_.assign(l.begin(), l.end());
  std::ranges::sort(out.eigenvalues_, {}, [](const std::complex<double>& c) { return std::abs(c); });
  if (held.nodes.empty() && out.eigenvalues_.size() > 3) {
    // The rigid motions, zero to rounding.
    out.eigenvalues_.erase(out.eigenvalues_.begin(), out.eigenvalues_.begin() + 3);
  }
  return out;
}

double Drbem::radius(const Scheme& scheme, double step) const {
  double worst = 0;
  for (const std::complex<double> l : eigenvalues_) worst = std::max(worst, spectral_radius(scheme, l * step * step));
  return worst;
}

double Drbem::smallest_stable_step() const {
  double worst = 0;
  for (const std::complex<double> l : eigenvalues_) {
    const double angle = std::abs(std::arg(l));
    if (angle > std::numbers::pi - 1e-9) return INFINITY;
    if (angle > 1e-9) worst = std::max(worst, 4 * std::sin(angle / 2) / std::sqrt(std::abs(l)));
  }
  return worst;
}

std::expected<Drbem::History, DrbemError> Drbem::run(const Scheme& scheme, double step, std::size_t steps,
                                                     const std::function<double(double)>& factor, Vec2 watch,
                                                     bool forced) const {
  History out;
  out.radius = radius(scheme, step);
  if (!forced && out.radius > 1 + 1e-9) {
    return std::unexpected(DrbemError{UnstableStep{step, out.radius, smallest_stable_step()}});
  }
  const auto m = view(reduced_mass_);
  const auto k = view(reduced_stiffness_);
  const Eigen::Map<const Eigen::VectorXd> load{load_.data(), ix(load_.size())};
  const auto n = m.cols();
  std::size_t seen = 0;
  for (std::size_t i = 0; i < free_.size(); i += 2) {
    const auto far = [&](std::size_t f) { return norm(points_[free_[f] / 2] - (watch - origin_) / scale_); };
    if (far(i) < far(seen)) seen = i;
  }
  const double h = step;
  Eigen::VectorXd u = Eigen::VectorXd::Zero(n), v = u, before = u, before2 = u;
  Eigen::VectorXd a = m.partialPivLu().solve(load * factor(0));
  const AlphaNumbers g = numbers_of(scheme);
  const bool houbolt = std::holds_alternative<Houbolt>(scheme);
  const Eigen::PartialPivLU<MatrixXd> newmark{m * (1 - g.am) + k * (g.beta * h * h * (1 - g.af))};
  const Eigen::PartialPivLU<MatrixXd> past{houbolt ? MatrixXd{m * (2 / (h * h)) + k} : MatrixXd::Identity(1, 1)};
  for (std::size_t s = 0; s <= steps; ++s) {
    out.time.push_back(static_cast<double>(s) * h);
    out.displacement.push_back(scale_ * Vec2{u(ix(seen)), u(ix(seen + 1))});
    const double f0 = factor(static_cast<double>(s) * h);
    const double f1 = factor(static_cast<double>(s + 1) * h);
    Eigen::VectorXd next;
    if (houbolt && s >= 2) {
      next = past.solve(load * f1 + m * ((5 * u - 4 * before + before2) / (h * h)));
    } else {
      const Eigen::VectorXd up = u + h * v + h * h * (0.5 - g.beta) * a;
      const Eigen::VectorXd an =
          newmark.solve(load * ((1 - g.af) * f1 + g.af * f0) - k * ((1 - g.af) * up + g.af * u) - g.am * (m * a));
      next = up + g.beta * h * h * an;
      v += h * ((1 - g.gamma) * a + g.gamma * an);
      a = an;
    }
    before2 = before;
    before = u;
    u = next;
  }
  return out;
}

std::vector<double> Drbem::mass_times(const std::vector<double>& acceleration) const {
  const Eigen::Map<const Eigen::VectorXd> a{acceleration.data(), ix(acceleration.size())};
  const Eigen::VectorXd out = view(mass_) * a;
  return {out.begin(), out.end()};
}

std::vector<double> Drbem::stiffness_times(const std::vector<double>& displacement) const {
  const Eigen::Map<const Eigen::VectorXd> u{displacement.data(), ix(displacement.size())};
  const Eigen::VectorXd out = view(stiffness_) * u;
  return {out.begin(), out.end()};
}

std::vector<double> Drbem::load_of(const std::vector<std::array<Vec2, 3>>& tractions) const {
  Eigen::VectorXd t(ix(gather_.columns));
  for (std::size_t e = 0; e < tractions.size(); ++e) {
    for (std::size_t a = 0; a < mesh_.per_element(); ++a) {
      // In scaled equations a traction of 1 Pa moves by scale / mu.
      t(ix(2 * (e * mesh_.per_element() + a))) = tractions[e][a].x * scale_ / mu_;
      t(ix(2 * (e * mesh_.per_element() + a) + 1)) = tractions[e][a].y * scale_ / mu_;
    }
  }
  const Eigen::VectorXd out = view(gather_) * t;
  return {out.begin(), out.end()};
}

}  // namespace cleave::bem
