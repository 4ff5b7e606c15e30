#include "reference.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <Eigen/SparseLU>
#include <cstdlib>
#include <optional>
#include <utility>

#include "cleave/bem/block.hpp"
#include "cleave/dbem/world.hpp"

namespace cleave::contact_suite {
namespace {

using bem::Vec2;

constexpr double young = 1e9, density = 2600, step = 1e-3, theta = 0.5, compliance = 1e-10;

std::vector<Vec2> square() { return {{0, 0}, {1, 0}, {1, 1}, {0, 1}}; }

bem::BlockOperator build(std::size_t per_side) {
  bem::BlockOptions options;
  options.bubbles = 0;
  const auto stuff = bem::Material::make(pascals(young), 0.25, kilograms_per_cubic_metre(density));
  return bem::BlockOperator::make({bem::polygon(square(), 0, per_side)}, stuff.value(), options).value();
}

Eigen::MatrixXd dense(const bem::DenseMatrix& m) {
  Eigen::MatrixXd out(static_cast<Eigen::Index>(m.rows), static_cast<Eigen::Index>(m.columns));
  for (std::size_t c = 0; c < m.columns; ++c) {
    for (std::size_t r = 0; r < m.rows; ++r) out(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = m(r, c);
  }
  return out;
}

/// A row of the contacts' Jacobian on the nodal freedoms.
using Row = std::vector<std::pair<Eigen::Index, double>>;

}  // namespace

struct PassProblem::Parts {
  std::size_t per_side;
  bem::BlockOperator block;
  std::vector<std::size_t> nodes;  // of the corners of the outline
  std::optional<dbem::World> world;
  std::size_t blocks = 0;
  std::vector<Row> rows;         // two a contact
  std::vector<double> constant;  // gap / (step theta), 0
};

PassProblem::PassProblem(std::size_t side, std::size_t per_side, bool every_node)
    : parts_{std::make_unique<Parts>(Parts{per_side, build(per_side), {}, std::nullopt, side * side, {}, {}})} {
  Parts& p = *parts_;
  dbem::Body body;
  body.density = density;
  const bem::Modes modes = bem::free_modes(p.block);
  dbem::ModalBasis basis;
  for (const double value : modes.eigenvalues) basis.omega.push_back(std::sqrt(value));
  const bem::Mesh& mesh = p.block.mesh();
  for (const bem::Element& element : mesh.elements) {
    for (std::size_t k = 0; k + 1 < mesh.per_element(); ++k) {
      const std::size_t node = element.node[k];
      if (!every_node && !mesh.nodes[node].corner) continue;
      p.nodes.push_back(node);
      body.outline.push_back(mesh.nodes[node].x);
      for (const std::size_t row : {2 * node, 2 * node + 1}) {
        for (std::size_t m = 0; m < basis.omega.size(); ++m) basis.shapes.push_back(modes.shapes(row, m));
      }
    }
  }
  body.modes = std::move(basis);
  body.mass = p.block.mass();
  body.inertia = p.block.inertia();
  dbem::Body floor{
      .name = "floor",
      .outline = {{-1, -1}, {static_cast<double>(side) + 1, -1}, {static_cast<double>(side) + 1, 0}, {-1, 0}}};
  floor.held = {true, true, true};
  std::vector<dbem::Body> bodies{floor};
  for (std::size_t r = 0; r < side; ++r) {
    for (std::size_t c = 0; c < side; ++c) {
      bodies.push_back(body);
      // Neighbours in a row do not touch: the pass is over stacks side by side, then tied by shifting every other row.
      const double shift = r % 2 == 1 ? 0.45 : 0.0;
      bodies.back().origin = p.block.centroid() + Vec2{shift + 1.001 * static_cast<double>(c), static_cast<double>(r)};
    }
  }
  dbem::Laws laws;
  laws.otherwise = {.friction = 1, .cohesion = 1e15, .tension = 1e15, .compliance = compliance};
  auto world = dbem::World::make(std::move(bodies), laws, {.step = step, .regularisation = 0});
  if (!world) {
    fmt::print(stderr, "reference: {}\n", dbem::describe(world.error()));
    std::abort();
  }
  dbem::World moved = *world;
  if (!moved.step(step)) std::abort();
  p.world = *std::move(world);
  const auto n = static_cast<Eigen::Index>(p.block.freedoms());
  for (const dbem::Contact& c : moved.contacts()) {
    const Vec2 t = turned_left(c.normal);
    for (const Vec2 d : {c.normal, t}) {
      Row row;
      const auto add = [&](std::uint32_t body_of, std::size_t corner, double weight) {
        if (body_of == 0 || weight == 0) return;
        const Eigen::Index first =
            n * (static_cast<Eigen::Index>(body_of) - 1) + 2 * static_cast<Eigen::Index>(p.nodes[corner]);
        row.emplace_back(first, weight * d.x);
        row.emplace_back(first + 1, weight * d.y);
      };
      add(c.vertex_body, c.vertex, 1);
      const std::vector<Vec2> edge_of = p.world->outline(c.edge_body);
      const Vec2 a = edge_of[c.edge];
      const Vec2 along = edge_of[(c.edge + 1) % edge_of.size()] - a;
      const double share =
          std::clamp(dot(p.world->outline(c.vertex_body)[c.vertex] - a, along) / dot(along, along), 0.0, 1.0);
      add(c.edge_body, c.edge, -(1 - share));
      add(c.edge_body, (c.edge + 1) % edge_of.size(), -share);
      p.rows.push_back(std::move(row));
    }
    p.constant.push_back(c.gap / (step * theta));
    p.constant.push_back(0);
  }
}

PassProblem::~PassProblem() = default;

Pass PassProblem::size() const { return {parts_->blocks, parts_->block.freedoms(), parts_->rows.size() / 2}; }

std::vector<dbem::Vec2> PassProblem::condensed() const {
  std::vector<dbem::Vec2> all;
  for (const dbem::ContactProblem& problem : parts_->world->problems(step)) {
    const dbem::ContactSolution solution = dbem::solve(problem, {});
    all.insert(all.end(), solution.impulse.begin(), solution.impulse.end());
  }
  return all;
}

namespace {

/// p = -(c + J v) / softness of (A + J^T J / softness) v = A v_f - J^T c / softness, v_f = free fall.
std::vector<dbem::Vec2> impulses(const std::vector<Row>& rows, const std::vector<double>& constant, double softness,
                                 const Eigen::VectorXd& v) {
  std::vector<dbem::Vec2> out(rows.size() / 2);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    double y = constant[r];
    for (const auto& [at, weight] : rows[r]) y += weight * v[at];
    (r % 2 == 0 ? out[r / 2].x : out[r / 2].y) = -y / softness;
  }
  return out;
}

Eigen::VectorXd right_side(const std::vector<Row>& rows, const std::vector<double>& constant, double softness,
                           const Eigen::MatrixXd& a, std::size_t blocks) {
  Eigen::VectorXd fall = Eigen::VectorXd::Zero(a.rows());
  for (Eigen::Index k = 1; k < a.rows(); k += 2) fall[k] = -9.81 * step;
  const Eigen::VectorXd pulled = a * fall;
  Eigen::VectorXd right = pulled.replicate(static_cast<Eigen::Index>(blocks), 1);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (const auto& [at, weight] : rows[r]) right[at] -= weight * constant[r] / softness;
  }
  return right;
}

constexpr double softness_of_joints = compliance / (step * step * theta);

Eigen::MatrixXd step_matrix(const bem::BlockOperator& block) {
  return dense(block.mass_matrix()) + theta * theta * step * step * dense(block.stiffness());
}

}  // namespace

std::vector<dbem::Vec2> PassProblem::sparse_full() const {
  const Parts& p = *parts_;
  const Eigen::MatrixXd a = step_matrix(p.block);
  const Eigen::Index n = a.rows();
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t b = 0; b < p.blocks; ++b) {
    const Eigen::Index first = n * static_cast<Eigen::Index>(b);
    for (Eigen::Index c = 0; c < n; ++c) {
      for (Eigen::Index r = 0; r < n; ++r)
        entries.emplace_back(static_cast<int>(first + r), static_cast<int>(first + c), a(r, c));
    }
  }
  for (const Row& row : p.rows) {
    for (const auto& [i, wi] : row) {
      for (const auto& [j, wj] : row)
        entries.emplace_back(static_cast<int>(i), static_cast<int>(j), wi * wj / softness_of_joints);
    }
  }
  const Eigen::Index total = n * static_cast<Eigen::Index>(p.blocks);
  Eigen::SparseMatrix<double> k(total, total);
  k.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseLU<Eigen::SparseMatrix<double>> lu{k};
  const Eigen::VectorXd v = lu.solve(right_side(p.rows, p.constant, softness_of_joints, a, p.blocks));
  return impulses(p.rows, p.constant, softness_of_joints, v);
}

std::vector<dbem::Vec2> PassProblem::dense_full(bool rebuild) const {
  const Parts& p = *parts_;
  Eigen::MatrixXd a = step_matrix(p.block);
  const Eigen::Index n = a.rows();
  const Eigen::Index total = n * static_cast<Eigen::Index>(p.blocks);
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(total, total);
  for (std::size_t b = 0; b < p.blocks; ++b) {
    if (rebuild) a = step_matrix(build(p.per_side));
    k.block(n * static_cast<Eigen::Index>(b), n * static_cast<Eigen::Index>(b), n, n) = a;
  }
  for (const Row& row : p.rows) {
    for (const auto& [i, wi] : row) {
      for (const auto& [j, wj] : row) k(i, j) += wi * wj / softness_of_joints;
    }
  }
  const Eigen::VectorXd right = right_side(p.rows, p.constant, softness_of_joints, a, p.blocks);
  const Eigen::VectorXd v = k.partialPivLu().solve(right);
  return impulses(p.rows, p.constant, softness_of_joints, v);
}

}  // namespace cleave::contact_suite
