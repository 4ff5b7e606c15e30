#include "block_build.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "cleave/core/parallel.hpp"
#include "domain_rule.hpp"
#include "element_rows.hpp"
#include "gauss.hpp"
#include "with_eigen.hpp"

namespace cleave::bem {
namespace {

using Eigen::MatrixXd;
using Rows2 = Eigen::Matrix<double, 2, Eigen::Dynamic>;

/// A polynomial field that is in equilibrium without body force.
struct Field {
  std::array<Vec2, 2> linear{};     // u = sum of x_k linear[k] + ...
  std::array<Vec2, 3> quadratic{};  // xx, xy, yy

  [[nodiscard]] Vec2 displacement(Vec2 x) const {
    return x.x * linear[0] + x.y * linear[1] + (x.x * x.x) * quadratic[0] + (x.x * x.y) * quadratic[1] +
           (x.y * x.y) * quadratic[2];
  }
  [[nodiscard]] Sym2 stress(Vec2 x, Elastic e) const {
    const Vec2 dx = linear[0] + (2 * x.x) * quadratic[0] + x.y * quadratic[1];
    const Vec2 dy = linear[1] + x.x * quadratic[1] + (2 * x.y) * quadratic[2];
    const double v = 2 * e.mu * e.nu / (1 - 2 * e.nu) * (dx.x + dy.y);
    return {v + 2 * e.mu * dx.x, e.mu * (dx.y + dy.x), v + 2 * e.mu * dy.y};
  }
};

std::vector<Field> equilibrium_fields(double nu, Order order) {
  std::vector<Field> fields(3);
  fields[0].linear[0] = {1, 0};
  fields[1].linear[1] = {0, 1};
  fields[2].linear[0] = {0, 0.5};
  fields[2].linear[1] = {0.5, 0};
  if (order != Order::quadratic) return fields;
  // u = a x^2 + b xy + d y^2 with Navier's equations: (lambda + 2 mu) 2 a1 + (lambda + mu) b2 + 2 mu d1 = 0 and its
  // mirror image. mu = 1.
  const double l = 2 * nu / (1 - 2 * nu);
  const auto push = [&](double a1, double a2, double b1, double b2, double d1, double d2) {
    Field f;
    f.quadratic = {Vec2{a1, a2}, Vec2{b1, b2}, Vec2{d1, d2}};
    fields.push_back(f);
  };
  // Free: b1, b2 by turns, and the harmonic-like pairs.
  push(-(l + 1) / (2 * (l + 2)), 0, 0, 1, 0, 0);
  push(0, 0, 1, 0, 0, -(l + 1) / (2 * (l + 2)));
  push(-1 / (l + 2), 0, 0, 0, 1, 0);
  push(0, 1, 0, 0, 0, -1 / (l + 2));
  return fields;
}

}  // namespace

MatrixXd boundary_gram(const Mesh& mesh) {
  const std::size_t per = mesh.per_element();
  MatrixXd l = MatrixXd::Zero(ix(2 * mesh.nodes.size()), ix(2 * per * mesh.elements.size()));
  const GaussRule& rule = gauss(8);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const Element& element = mesh.elements[e];
    for (std::size_t g = 0; g < rule.s.size(); ++g) {
      const auto n = shape(mesh.order, rule.s[g]);
      const double w = rule.w[g] * norm(element.derivative(rule.s[g]));
      for (std::size_t a = 0; a < per; ++a) {
        for (std::size_t b = 0; b < per; ++b) {
          for (std::size_t c = 0; c < 2; ++c)
            l(ix(2 * element.node[a] + c), ix(2 * (e * per + b) + c)) += w * n[a] * n[b];
        }
      }
    }
  }
  return l;
}

namespace {

void add_at(Rows2& rows, Eigen::Index column, Mat2 value) {
  rows(0, column) += value.xx;
  rows(0, column + 1) += value.xy;
  rows(1, column) += value.yx;
  rows(1, column + 1) += value.yy;
}

/// Exactness where it matters: K <- F (U^T F)^-1 F^T + P^T K P takes the quadrature error out of rigid motions,
/// constant strain and pure bending.
void make_exact(const Mesh& mesh, Elastic elastic, const MatrixXd& k, GalerkinStiffness& out) {
  const std::size_t per = mesh.per_element();
  const auto nu2 = ix(2 * mesh.nodes.size());
  const std::vector<Field> fields = equilibrium_fields(elastic.nu, mesh.order);
  const MatrixXd gram = boundary_gram(mesh);
  MatrixXd u(nu2, ix(fields.size())), f(nu2, ix(fields.size()));
  for (std::size_t q = 0; q < fields.size(); ++q) {
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
      const Vec2 x = fields[q].displacement(mesh.nodes[i].x);
      u(ix(2 * i), ix(q)) = x.x;
      u(ix(2 * i + 1), ix(q)) = x.y;
    }
    Eigen::VectorXd t(ix(2 * per * mesh.elements.size()));
    for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
      const auto local = local_nodes(mesh.order);
      for (std::size_t a = 0; a < per; ++a) {
        const Vec2 x =
            fields[q].stress(mesh.elements[e].at(local[a]), {1, elastic.nu}) * mesh.elements[e].normal(local[a]);
        t(ix(2 * (e * per + a))) = x.x;
        t(ix(2 * (e * per + a) + 1)) = x.y;
      }
    }
    f.col(ix(q)) = gram * t;
  }
  MatrixXd r = MatrixXd::Zero(nu2, 3);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    r(ix(2 * i), 0) = r(ix(2 * i + 1), 1) = 1;
    r(ix(2 * i), 2) = -mesh.nodes[i].x.y;
    r(ix(2 * i + 1), 2) = mesh.nodes[i].x.x;
  }
  const Eigen::LDLT<MatrixXd> rr{r.transpose() * r};
  const bool curved = std::ranges::any_of(mesh.elements, &Element::curved);
  if (curved) {
    // On curved sides polynomial tractions are no polynomials of the element, so only the rigid motions are made exact
    // (there the quadrature is not the error that counts).
    MatrixXd p = MatrixXd::Identity(nu2, nu2) - r * rr.solve(r.transpose());
    out.stiffness = p.transpose() * k * p;
  } else {
    MatrixXd uf = u.transpose() * f;
    uf = (0.5 * (uf + uf.transpose())).eval();
    const Eigen::LDLT<MatrixXd> solver{uf};
    MatrixXd p = MatrixXd::Identity(nu2, nu2) - u * solver.solve(f.transpose());
    p -= r * rr.solve(r.transpose() * p);
    out.stiffness = f * solver.solve(f.transpose()) + p.transpose() * k * p;
    out.check = (out.stiffness * u - f).cwiseAbs().maxCoeff() / f.cwiseAbs().maxCoeff();
  }
  out.stiffness = (0.5 * elastic.mu * (out.stiffness + out.stiffness.transpose())).eval();
  out.check = std::max(out.check, (out.stiffness * r).cwiseAbs().maxCoeff() / out.stiffness.cwiseAbs().maxCoeff());
}

}  // namespace

GalerkinStiffness galerkin_stiffness(const Mesh& given, Elastic elastic, const BlockOptions& options, bool project) {
  // Lengths below a quarter keep V positive definite; mu = 1.
  Box2 box;
  for (const Node& node : given.nodes) box.add(node.x);
  const double h = 4 * std::max(box.high.x - box.low.x, box.high.y - box.low.y);
  const Vec2 centre = 0.5 * (box.low + box.high);
  Mesh mesh = given;
  for (Element& e : mesh.elements) {
    e.c0 = (e.c0 - centre) / h;
    e.c1 = e.c1 / h;
    e.c2 = e.c2 / h;
  }
  for (Node& node : mesh.nodes) node.x = (node.x - centre) / h;
  const double nu = elastic.nu;
  const std::size_t per = mesh.per_element();
  const std::size_t elements = mesh.elements.size();
  const auto nt = ix(2 * per * elements);
  const auto nu2 = ix(2 * mesh.nodes.size());
  const Integrator integrator{mesh, {{1, nu}}, options.integration};
  MatrixXd v = MatrixXd::Zero(nt, nt);
  MatrixXd b = MatrixXd::Zero(nt, nu2);
  std::vector<Rows2> slopes(elements * 3, Rows2::Zero(2, nu2));
  const GaussRule& outer = gauss(options.outer_points);
  parallel_for(elements, ThreadLimit{std::max(1U, options.threads)}, [&](std::size_t e) {
    const Element& element = mesh.elements[e];
    Rows2 g(2, nt), hh(2, nu2), d(2, nu2);
    ElementIntegrals part;
    std::array<Mat2, 3> logs;
    for (std::size_t q = 0; q < outer.s.size(); ++q) {
      // A quintic map flattens the logarithms at the ends of the outer integral.
      const double t = outer.s[q];
      const double s = t * (15 - t * t * (10 - 3 * t * t)) / 8;
      const double w = outer.w[q] * 15.0 / 8 * (1 - t * t) * (1 - t * t);
      const Vec2 y = element.at(s);
      const auto n = shape(mesh.order, s);
      const auto slope = shape_slope(mesh.order, s);
      g.setZero();
      hh.setZero();
      d.setZero();
      Mat2 total;
      for (std::size_t f = 0; f < elements; ++f) {
        const std::optional<double> own = f == e ? std::optional{s} : std::nullopt;
        integrator.integrate(f, y, own, part);
        integrator.log_slopes(f, y, own, logs);
        for (std::size_t a = 0; a < per; ++a) {
          const auto c = ix(2 * (f * per + a));
          const auto u = ix(2 * mesh.elements[f].node[a]);
          add_at(g, c, part.g[a]);
          add_at(hh, u, part.h[a]);
          add_at(d, u, logs[a]);
          if (!own) total += part.h[a];
        }
      }
      for (std::size_t a = 0; a < per; ++a) {
        const auto u = ix(2 * element.node[a]);
        add_at(hh, u, -n[a] * total);
      }
      const double wj = w * norm(element.derivative(s));
      for (std::size_t a = 0; a < per; ++a) {
        v.middleRows(ix(2 * (e * per + a)), 2) += (wj * n[a]) * g;
        b.middleRows(ix(2 * (e * per + a)), 2) += (wj * n[a]) * hh;
        slopes[e * 3 + a] += (w * slope[a]) * d;
      }
    }
  });
  MatrixXd d = MatrixXd::Zero(nu2, nu2);
  for (std::size_t e = 0; e < elements; ++e) {
    for (std::size_t a = 0; a < per; ++a) d.middleRows(ix(2 * mesh.elements[e].node[a]), 2) += slopes[e * 3 + a];
  }
  v = (0.5 * (v + v.transpose())).eval();
  d = (0.5 / (2 * std::numbers::pi * (1 - nu)) * (d + d.transpose())).eval();
  GalerkinStiffness out;
  out.traction_of = v.ldlt().solve(b);
  MatrixXd k = d + b.transpose() * out.traction_of;
  k = (0.5 * (k + k.transpose())).eval();
  out.traction_of *= elastic.mu / h;
  if (!project) {
    out.stiffness = elastic.mu * k;
    return out;
  }
  make_exact(mesh, elastic, k, out);
  return out;
}

namespace {

/// Static extension of the boundary values to every point: Phi = G T - H, taken against rigid motions like the rows of
/// the boundary so that points close to it lose nothing.
MatrixXd static_extension(const Mesh& mesh, const std::vector<DomainPoint>& points, const Material& material,
                          const MatrixXd& traction_of, unsigned threads) {
  const std::size_t per = mesh.per_element();
  const Integrator integrator{mesh, {{material.mu(), material.nu()}}, 1e-9};
  MatrixXd g = MatrixXd::Zero(ix(2 * points.size()), ix(2 * per * mesh.elements.size()));
  MatrixXd phi = MatrixXd::Zero(ix(2 * points.size()), ix(2 * mesh.nodes.size()));
  parallel_for(points.size(), ThreadLimit{std::max(1U, threads)}, [&](std::size_t q) {
    const Vec2 y = points[q].x;
    const auto row = ix(2 * q);
    ElementIntegrals part;
    for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
      integrator.integrate(e, y, std::nullopt, part);
      for (std::size_t a = 0; a < per; ++a) {
        const auto c = ix(2 * (e * per + a));
        const auto u = ix(2 * mesh.elements[e].node[a]);
        g(row, c) += part.g[a].xx;
        g(row, c + 1) += part.g[a].xy;
        g(row + 1, c) += part.g[a].yx;
        g(row + 1, c + 1) += part.g[a].yy;
        phi(row, u) -= part.h[a].xx;
        phi(row, u + 1) -= part.h[a].xy;
        phi(row + 1, u) -= part.h[a].yx;
        phi(row + 1, u + 1) -= part.h[a].yy;
      }
    }
  });
  phi.noalias() += g * traction_of;
  return phi;
}

struct InnerMotions {
  MatrixXd value;      // rows x, y of each point
  MatrixXd stiffness;  // empty: not positive, the boundary is too coarse for them
};
InnerMotions inner_motions(const Mesh& mesh, const std::vector<DomainPoint>& points, const Material& material,
                           const MatrixXd& phi, const Bubbles& shapes) {
  const auto nb = ix(shapes.count());
  MatrixXd boundary(phi.cols(), nb), force = MatrixXd::Zero(phi.rows(), nb);
  InnerMotions out;
  out.value.resize(phi.rows(), nb);
  std::vector<Bubbles::Value> at;
  const auto put = [&](MatrixXd& m, std::size_t row, Vec2 x) {
    shapes.evaluate(x, material, at);
    for (std::size_t k = 0; k < at.size(); ++k) {
      m(ix(2 * row), ix(k)) = at[k].displacement.x;
      m(ix(2 * row + 1), ix(k)) = at[k].displacement.y;
    }
  };
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) put(boundary, i, mesh.nodes[i].x);
  const double unit = material.mu() / (shapes.size * shapes.size);
  for (std::size_t q = 0; q < points.size(); ++q) {
    put(out.value, q, points[q].x);
    for (std::size_t k = 0; k < shapes.count(); ++k) {
      force(ix(2 * q + k % 2), ix(k)) = unit * points[q].w * shapes.force(k, points[q].x);
    }
  }
  out.value -= phi * boundary;
  // Work of the stress of one on the strain of another is that of its force on the other.
  const MatrixXd work = out.value.transpose() * force;
  const MatrixXd k = 0.5 * (work + work.transpose());
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver{k, Eigen::EigenvaluesOnly};
  // What is not well above the error of the extension is no motion of the body: then the boundary is too coarse.
  if (solver.eigenvalues().minCoeff() > 0.25 * (work - work.transpose()).norm()) out.stiffness = k;
  return out;
}

/// Four degrees with 8 elements, one more with every eight.
std::size_t degree_of(const Mesh& mesh, std::optional<std::size_t> asked) {
  if (asked) return *asked;
  return std::clamp<std::size_t>(3 + mesh.elements.size() / 8, 3, 8);
}

}  // namespace

BlockMass block_mass(const Mesh& mesh, const Material& material, const MatrixXd& traction_of,
                     const BlockOptions& options) {
  // About a thousand points, whatever the number of strips the outline needs.
  const std::size_t strips = std::max<std::size_t>(1, domain_rule(mesh, 1).size());
  const double wanted = std::sqrt(1000.0 / static_cast<double>(strips));
  // At least two points to an element's length: the mass of what the boundary can follow.
  double around = 0;
  for (const Element& e : mesh.elements) around += 2 * norm(e.c1);
  const double spacing = 0.5 * around / static_cast<double>(mesh.elements.size());
  const std::vector<DomainPoint> points =
      domain_rule(mesh, static_cast<std::size_t>(std::clamp(wanted, 8.0, 20.0)), spacing);
  const MatrixXd phi = static_extension(mesh, points, material, traction_of, options.threads);
  const auto n = phi.cols();
  BlockMass out;
  InnerMotions inner;
  for (std::size_t degree = degree_of(mesh, options.bubbles); degree > 0; --degree) {
    out.bubbles = bubbles_of(mesh, points, material, degree);
    inner = inner_motions(mesh, points, material, phi, out.bubbles);
    if (inner.stiffness.size() > 0) break;
    out.bubbles = {};
    inner = {};
  }
  const auto nb = ix(out.bubbles.count());
  MatrixXd all(phi.rows(), n + nb);
  all.leftCols(n) = phi;
  if (nb > 0) all.rightCols(nb) = inner.value;
  Eigen::VectorXd weight(phi.rows());
  for (std::size_t q = 0; q < points.size(); ++q)
    weight(ix(2 * q)) = weight(ix(2 * q + 1)) = material.density() * points[q].w;
  const MatrixXd weighted = weight.cwiseSqrt().asDiagonal() * all;
  out.mass = MatrixXd::Zero(n + nb, n + nb);
  out.mass.selfadjointView<Eigen::Lower>().rankUpdate(weighted.transpose());
  out.mass.triangularView<Eigen::StrictlyUpper>() = out.mass.transpose();
  out.bubble_stiffness = nb > 0 ? inner.stiffness : MatrixXd::Zero(0, 0);
  return out;
}

}  // namespace cleave::bem
