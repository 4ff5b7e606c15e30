#include "cleave/bem/block.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "block_build.hpp"
#include "cleave/core/overloaded.hpp"
#include "domain_rule.hpp"
#include "gauss.hpp"
#include "with_eigen.hpp"

namespace cleave::bem {

std::string describe(const BlockError& error) {
  return std::visit(
      overloaded{[](const OutlineError& e) { return describe(e); },
                 [](const BlockFailed& e) {
                   return fmt::format(
                       "the elastic operator of the body failed its check of {} ({:.2e}); use more "
                       "elements or a less extreme shape",
                       e.check, e.value);
                 },
                 [](const BlockNeedsDensity&) { return std::string{"a moving body needs a density above 0"}; }},
      error);
}

namespace {

using Eigen::MatrixXd;

MatrixXd rigid_motions(const Mesh& mesh, Eigen::Index freedoms) {
  MatrixXd rigid = MatrixXd::Zero(freedoms, 3);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const Vec2 x = mesh.nodes[i].x;
    rigid(ix(2 * i), 0) = rigid(ix(2 * i + 1), 1) = 1;
    rigid(ix(2 * i), 2) = -x.y;
    rigid(ix(2 * i + 1), 2) = x.x;
  }
  return rigid;
}

}  // namespace

Eigen::Map<const MatrixXd> view(const DenseMatrix& m) { return {m.values.data(), ix(m.rows), ix(m.columns)}; }

std::expected<BlockOperator, BlockError> BlockOperator::make(const std::vector<Loop>& loops, const Material& material,
                                                             const BlockOptions& options) {
  auto checked = check_loops(loops, false);
  if (!checked) return std::unexpected(BlockError{checked.error()});
  if (options.mass && !(material.density() > 0)) return std::unexpected(BlockError{BlockNeedsDensity{}});
  const AreaMoments area = area_moments(checked->loops);
  BlockOperator block{material};
  block.centroid_ = area.centroid;
  block.mesh_ = make_mesh(checked->loops, options.mesh, area.centroid, 1);
  // Curved elements are quadratic: mass and inertia are those of what they enclose.
  const AreaMoments meshed = area_moments(block.mesh_);
  block.area_ = meshed.area;
  block.mass_ = material.density() * meshed.area;
  block.inertia_ = material.density() * meshed.polar;
  GalerkinStiffness k = galerkin_stiffness(block.mesh_, {material.mu(), material.nu()}, options);
  if (!(k.check <= 1e-9)) return std::unexpected(BlockError{BlockFailed{"exact fields", k.check}});
  const auto n = k.stiffness.rows();
  if (!options.mass) {
    block.stiffness_ = dense(k.stiffness);
    block.traction_of_ = dense(k.traction_of);
    return block;
  }
  BlockMass m = block_mass(block.mesh_, material, k.traction_of, options);
  const auto all = m.mass.rows();
  MatrixXd stiffness = MatrixXd::Zero(all, all);
  stiffness.topLeftCorner(n, n) = k.stiffness;
  stiffness.bottomRightCorner(all - n, all - n) = m.bubble_stiffness;
  // Mass and inertia of the operator are those of the outline.
  const MatrixXd rigid = rigid_motions(block.mesh_, all);
  const Eigen::Matrix3d r = rigid.transpose() * m.mass * rigid;
  const double off = std::max({std::abs(r(0, 0) / block.mass_ - 1), std::abs(r(1, 1) / block.mass_ - 1),
                               std::abs(r(2, 2) / block.inertia_ - 1)});
  if (!(off < 1e-5)) return std::unexpected(BlockError{BlockFailed{"mass and inertia", off}});
  block.stiffness_ = dense(stiffness);
  block.mass_matrix_ = dense(m.mass);
  block.bubbles_ = m.bubbles;
  block.set_tractions(dense(k.traction_of));
  return block;
}

std::expected<BlockOperator, BlockError> BlockOperator::deformed(const std::vector<double>& freedoms,
                                                                 const BlockOptions& options) const {
  BlockOperator out = *this;
  for (std::size_t i = 0; i < mesh_.nodes.size(); ++i)
    out.mesh_.nodes[i].x += Vec2{freedoms[2 * i], freedoms[2 * i + 1]};
  for (Element& e : out.mesh_.elements) {
    const Vec2 start = out.mesh_.nodes[e.node[0]].x, end = out.mesh_.nodes[e.node[mesh_.per_element() - 1]].x;
    const Vec2 middle = mesh_.order == Order::quadratic ? out.mesh_.nodes[e.node[1]].x : 0.5 * (start + end);
    e.c0 = middle;
    e.c1 = 0.5 * (end - start);
    e.c2 = 0.5 * (start + end) - middle;
    // What bends by less than rounding is straight, for the closed forms.
    e.curved = norm(e.c2) > 1e-12 * norm(e.c1);
    if (!e.curved) {
      e.c0 = 0.5 * (start + end);
      e.c2 = {};
    }
  }
  out.area_ = area_moments(out.mesh_).area;
  if (!(out.area_ > 0)) return std::unexpected(BlockError{BlockFailed{"area", out.area_}});
  const GalerkinStiffness k = galerkin_stiffness(out.mesh_, {material_.mu(), material_.nu()}, options);
  if (!(k.check <= 1e-9)) return std::unexpected(BlockError{BlockFailed{"exact fields", k.check}});
  MatrixXd stiffness = view(stiffness_);
  stiffness.topLeftCorner(k.stiffness.rows(), k.stiffness.rows()) = k.stiffness;
  out.stiffness_ = dense(stiffness);
  out.set_tractions(dense(k.traction_of));
  if (!mass_matrix_.values.empty()) {
    const Eigen::VectorXd turn = rigid_motions(out.mesh_, ix(mass_matrix_.rows)).col(2);
    out.inertia_ = turn.dot(view(mass_matrix_) * turn);
  }
  return out;
}

/// Of boundary freedoms, and of inner motions: their own less those of the static extension of their boundary values.
void BlockOperator::set_tractions(const DenseMatrix& of_boundary) {
  const MatrixXd t = view(of_boundary);
  const auto nb = ix(bubbles_.count());
  if (nb == 0) {
    traction_of_ = of_boundary;
    return;
  }
  MatrixXd boundary(t.cols(), nb), own(t.rows(), nb);
  std::vector<Bubbles::Value> at;
  for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) {
    bubbles_.evaluate(mesh_.nodes[i].x, material_, at);
    for (std::size_t k = 0; k < at.size(); ++k) {
      boundary(ix(2 * i), ix(k)) = at[k].displacement.x;
      boundary(ix(2 * i + 1), ix(k)) = at[k].displacement.y;
    }
  }
  const auto local = local_nodes(mesh_.order);
  for (std::size_t e = 0; e < mesh_.elements.size(); ++e) {
    for (std::size_t a = 0; a < local.size(); ++a) {
      bubbles_.evaluate(mesh_.elements[e].at(local[a]), material_, at);
      const Vec2 n = mesh_.elements[e].normal(local[a]);
      const auto row = ix(2 * (e * local.size() + a));
      for (std::size_t k = 0; k < at.size(); ++k) {
        const Vec2 traction = at[k].stress * n;
        own(row, ix(k)) = traction.x;
        own(row + 1, ix(k)) = traction.y;
      }
    }
  }
  MatrixXd all(t.rows(), t.cols() + nb);
  all << t, own - t * boundary;
  bubbles_.on_nodes = dense(boundary);
  bubbles_.on_elements = dense(own);
  traction_of_ = dense(all);
}

std::vector<double> BlockOperator::forces_of(const std::vector<std::array<Vec2, 3>>& tractions) const {
  std::vector<double> f(freedoms(), 0.0);
  const GaussRule& rule = gauss(8);
  for (std::size_t e = 0; e < mesh_.elements.size(); ++e) {
    const Element& element = mesh_.elements[e];
    for (std::size_t g = 0; g < rule.s.size(); ++g) {
      const auto n = shape(mesh_.order, rule.s[g]);
      Vec2 t;
      for (std::size_t a = 0; a < mesh_.per_element(); ++a) t += n[a] * tractions[e][a];
      const double w = rule.w[g] * norm(element.derivative(rule.s[g]));
      for (std::size_t a = 0; a < mesh_.per_element(); ++a) {
        f[2 * element.node[a]] += w * n[a] * t.x;
        f[2 * element.node[a] + 1] += w * n[a] * t.y;
      }
    }
  }
  return f;
}

std::vector<double> BlockOperator::forces_of_acceleration(Vec2 a) const {
  Eigen::VectorXd r = Eigen::VectorXd::Zero(ix(freedoms()));
  for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) {
    r(ix(2 * i)) = a.x;
    r(ix(2 * i + 1)) = a.y;
  }
  const Eigen::VectorXd f = view(mass_matrix_) * r;
  return {f.begin(), f.end()};
}

BoundaryPlace BlockOperator::place(Vec2 x) const { return nearest_place(mesh_, x); }

void BlockOperator::add_point_force(BoundaryPlace at, Vec2 force, std::vector<double>& forces) const {
  const auto n = shape(mesh_.order, at.s);
  for (std::size_t a = 0; a < mesh_.per_element(); ++a) {
    forces[2 * mesh_.elements[at.element].node[a]] += n[a] * force.x;
    forces[2 * mesh_.elements[at.element].node[a] + 1] += n[a] * force.y;
  }
}

Vec2 BlockOperator::displacement_at(BoundaryPlace at, const std::vector<double>& u) const {
  const auto n = shape(mesh_.order, at.s);
  Vec2 out;
  for (std::size_t a = 0; a < mesh_.per_element(); ++a) {
    const std::size_t i = mesh_.elements[at.element].node[a];
    out += n[a] * Vec2{u[2 * i], u[2 * i + 1]};
  }
  return out;
}

namespace {

/// Orthonormal basis of the freedoms that are left, as columns.
MatrixXd left_free(const BlockOperator& block, const std::vector<HeldFreedom>& held) {
  std::vector<std::vector<Vec2>> directions(block.mesh().nodes.size());
  for (const HeldFreedom& h : held) {
    Vec2 d = h.direction;
    for (const Vec2 e : directions[h.node]) d -= dot(d, e) * e;
    if (norm(d) > 1e-6) directions[h.node].push_back(d / norm(d));
  }
  std::vector<std::pair<std::size_t, Vec2>> columns;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    if (directions[i].empty()) {
      columns.emplace_back(i, Vec2{1, 0});
      columns.emplace_back(i, Vec2{0, 1});
    } else if (directions[i].size() == 1) {
      columns.emplace_back(i, turned_left(directions[i].front()));
    }
  }
  const std::size_t inner = block.freedoms() - block.boundary_freedoms();
  MatrixXd z = MatrixXd::Zero(ix(block.freedoms()), ix(columns.size() + inner));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    z(ix(2 * columns[k].first), ix(k)) = columns[k].second.x;
    z(ix(2 * columns[k].first + 1), ix(k)) = columns[k].second.y;
  }
  for (std::size_t k = 0; k < inner; ++k) z(ix(block.boundary_freedoms() + k), ix(columns.size() + k)) = 1;
  return z;
}

MatrixXd sprung(const BlockOperator& block, const std::vector<NodeSpring>& springs) {
  MatrixXd k = view(block.stiffness());
  for (const NodeSpring& s : springs) {
    const auto i = ix(2 * s.node);
    k(i, i) += s.stiffness * s.direction.x * s.direction.x;
    k(i + 1, i) += s.stiffness * s.direction.x * s.direction.y;
    k(i, i + 1) += s.stiffness * s.direction.x * s.direction.y;
    k(i + 1, i + 1) += s.stiffness * s.direction.y * s.direction.y;
  }
  return k;
}

}  // namespace

Modes supported_modes(const BlockOperator& block, const std::vector<HeldFreedom>& held,
                      const std::vector<NodeSpring>& springs) {
  const MatrixXd z = left_free(block, held);
  const MatrixXd m = z.transpose() * view(block.mass_matrix()) * z;
  // Waves along the boundary shorter than the points of the mass's quadrature move almost no mass: there the mass
  // matrix is singular up to rounding, and factors of it drown slow modes in the rounding of endless frequencies. So
  // the stiffness is factored, shifted by s (a frequency of the body's size) against rigid motions:
  // M x = (K + s M) x / (lambda + s).
  double extent = 0;
  for (const Node& node : block.mesh().nodes) extent = std::max(extent, norm(node.x));
  const double shift = block.material().mu() / (block.material().density() * extent * extent);
  const MatrixXd k = z.transpose() * sprung(block, springs) * z + shift * m;
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver{m, k};
  // x^T K x is 1, so any mass left to a mode that has none up to rounding keeps its compliance exact.
  const double least = 1e-14 * solver.eigenvalues().maxCoeff();
  const Eigen::VectorXd inverse = solver.eigenvalues().reverse().cwiseMax(least);
  const Eigen::VectorXd l = inverse.cwiseInverse().array() - shift;
  const MatrixXd x = solver.eigenvectors().rowwise().reverse() * inverse.cwiseSqrt().cwiseInverse().asDiagonal();
  Modes out{{l.begin(), l.end()}, dense(z * x)};
  // What is zero up to rounding is zero: a rigid motion.
  for (double& value : out.eigenvalues) {
    if (value < 1e-9 * out.eigenvalues[std::min<std::size_t>(3, out.eigenvalues.size() - 1)]) value = 0;
  }
  return out;
}

Modes free_modes(const BlockOperator& block, std::optional<std::size_t> most) {
  const Modes all = supported_modes(block, {});
  const std::size_t count = all.eigenvalues.size() - 3;
  const std::size_t kept = std::min(most.value_or(count), count);
  const auto first = static_cast<std::ptrdiff_t>(3);
  const auto last = static_cast<std::ptrdiff_t>(3 + kept);
  return {{all.eigenvalues.begin() + first, all.eigenvalues.begin() + last},
          dense(view(all.shapes).middleCols(3, ix(kept)))};
}

std::vector<double> static_displacement(const BlockOperator& block, const std::vector<HeldFreedom>& held,
                                        const std::vector<double>& forces, const std::vector<NodeSpring>& springs) {
  const Eigen::Map<const Eigen::VectorXd> f{forces.data(), ix(forces.size())};
  const MatrixXd z = left_free(block, held);
  MatrixXd k = z.transpose() * sprung(block, springs) * z;
  Eigen::VectorXd b = z.transpose() * f;
  if (held.empty() && springs.empty()) {
    // Bordered by the rigid motions.
    const auto n = k.rows();
    MatrixXd a = MatrixXd::Zero(n + 3, n + 3);
    a.topLeftCorner(n, n) = k;
    const double scale = k.diagonal().cwiseAbs().maxCoeff();
    for (std::size_t i = 0; i < block.mesh().nodes.size(); ++i) {
      const Vec2 x = block.mesh().nodes[i].x;
      a(ix(2 * i), n) = a(ix(2 * i + 1), n + 1) = scale;
      a(ix(2 * i), n + 2) = -scale * x.y;
      a(ix(2 * i + 1), n + 2) = scale * x.x;
    }
    a.bottomLeftCorner(3, n) = a.topRightCorner(n, 3).transpose();
    b.conservativeResize(n + 3);
    b.tail(3).setZero();
    const Eigen::VectorXd u = a.partialPivLu().solve(b).head(n);
    return {u.begin(), u.end()};
  }
  const Eigen::VectorXd u = z * k.ldlt().solve(b);
  return {u.begin(), u.end()};
}

}  // namespace cleave::bem
