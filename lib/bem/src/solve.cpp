#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "cleave/core/cost.hpp"
#include "cleave/core/parallel.hpp"
#include "field_values.hpp"
#include "gauss.hpp"
#include "system.hpp"
#include "with_eigen.hpp"

namespace cleave::bem {

/// Fills the private parts of a solution.
struct SolutionMaker {
  static Solution make(const Problem& problem, const Options& options, System&& system, const Eigen::VectorXd& x);
  static Diagnostics& diagnostics(Solution& s) { return s.diagnostics_; }
};

namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class Rows {
 public:
  Rows(const System& system, Matrix& a, Eigen::VectorXd& b) : system_{system}, a_{a}, b_{b} {}

  /// Equations of one region, several at a time.
  void add(std::span<const EquationGroup> groups, const Integrator& integrator) const {
    std::vector<const Equation*> equations;
    for (const EquationGroup& group : groups) {
      for (const Equation& q : group.equations) equations.push_back(&q);
    }
    std::size_t k = 0;
    for (; k + Integrator::lanes <= equations.size(); k += Integrator::lanes) {
      add_lanes(std::span{equations}.subspan(k, Integrator::lanes), groups.front().region, integrator);
    }
    for (; k < equations.size(); ++k) add_one(*equations[k], groups.front().region, integrator);
  }

 private:
  void put(const Equation& q, std::uint32_t column, Vec2 value) const {
    for (const Equation::Row& row : q.rows) a_(ix(row.row), ix(column)) += dot(row.direction, value);
  }
  void put_constant(const Equation& q, Vec2 value) const {
    for (const Equation::Row& row : q.rows) b_(ix(row.row)) -= dot(row.direction, value);
  }
  void put_displacement(const Equation& q, const ScaledRegion& region, std::uint32_t node, Mat2 m) const {
    const Affine& u = system_.displacement[region.global[node]];
    put_constant(q, m * (u.constant - region.u_particular[node]));
    for (std::uint32_t k = 0; k < u.count; ++k) put(q, u.terms[k].column, m * u.terms[k].direction);
  }

  static std::optional<double> own_of(const Equation& q, std::size_t element) {
    for (const Equation::Own& o : q.own) {
      if (o.element == element) return o.s;
    }
    return std::nullopt;
  }

  void put_element(const Equation& q, const ScaledRegion& region, std::size_t e, const ElementIntegrals& part) const {
    for (std::size_t k = 0; k < region.mesh.per_element(); ++k) {
      const double sign = region.slot_sign[e][k];
      const Affine& t = system_.traction[region.slot[e][k]];
      put_constant(q, (-1.0 * part.g[k]) * (sign * t.constant - region.t_particular[e][k]));
      for (std::uint32_t i = 0; i < t.count; ++i) {
        put(q, t.terms[i].column, (-sign * part.g[k]) * t.terms[i].direction);
      }
      put_displacement(q, region, region.mesh.elements[e].node[k], part.h[k]);
    }
  }

  /// u(x) - u(y) in place of u(x): free term, principal value and rigid motions in one identity.
  void put_point(const Equation& q, const ScaledRegion& region, std::size_t number, Mat2 total) const {
    Mat2 at = -1.0 * total;
    if (system_.extent != Extent::bounded && number == 0) {
      at.xx += 1;
      at.yy += 1;
    }
    for (const auto& [node, value] : q.at_point) put_displacement(q, region, node, value * at);
  }

  void add_one(const Equation& q, std::size_t number, const Integrator& integrator) const {
    const ScaledRegion& region = system_.regions[number];
    Mat2 total;
    ElementIntegrals part;
    for (std::size_t e = 0; e < region.mesh.elements.size(); ++e) {
      const auto own = own_of(q, e);
      integrator.integrate(e, q.y, own, part);
      for (std::size_t k = 0; k < region.mesh.per_element() && !own; ++k) total += part.h[k];
      put_element(q, region, e, part);
    }
    put_point(q, region, number, total);
  }

  void add_lanes(std::span<const Equation* const> q, std::size_t number, const Integrator& integrator) const {
    const ScaledRegion& region = system_.regions[number];
    std::array<Mat2, Integrator::lanes> total{};
    std::array<Vec2, Integrator::lanes> y;
    std::array<std::optional<double>, Integrator::lanes> own;
    std::array<ElementIntegrals, Integrator::lanes> part;
    for (std::size_t l = 0; l < q.size(); ++l) y[l] = q[l]->y;
    for (std::size_t e = 0; e < region.mesh.elements.size(); ++e) {
      for (std::size_t l = 0; l < q.size(); ++l) own[l] = own_of(*q[l], e);
      integrator.integrate(e, y, own, part);
      for (std::size_t l = 0; l < q.size(); ++l) {
        for (std::size_t k = 0; k < region.mesh.per_element() && !own[l]; ++k) total[l] += part[l].h[k];
        put_element(*q[l], region, e, part[l]);
      }
    }
    for (std::size_t l = 0; l < q.size(); ++l) put_point(*q[l], region, number, total[l]);
  }

  const System& system_;
  Matrix& a_;
  Eigen::VectorXd& b_;
};

/// Three more rows and columns: no mean translation and rotation, and a slack along the rigid motions for what the
/// discrete loads lack to balance.
void hold(const System& system, Matrix& a) {
  const auto n = ix(system.columns);
  const auto m = ix(system.rows);
  const ScaledRegion& region = system.regions.front();
  for (std::size_t k = 0; k < region.mesh.nodes.size(); ++k) {
    const Vec2 x = 4 * region.mesh.nodes[k].x;
    const Affine& u = system.displacement[region.global[k]];
    for (std::uint32_t i = 0; i < u.count; ++i) {
      const Vec2 d = u.terms[i].direction;
      const auto c = ix(u.terms[i].column);
      a(m, c) += d.x;
      a(m + 1, c) += d.y;
      a(m + 2, c) += cross(x, d);
    }
  }
  for (const EquationGroup& group : system.groups) {
    for (const Equation& q : group.equations) {
      for (const Equation::Row& row : q.rows) {
        a(ix(row.row), n) += row.direction.x;
        a(ix(row.row), n + 1) += row.direction.y;
        a(ix(row.row), n + 2) += cross(4 * q.y, row.direction);
      }
    }
  }
}

double residual_of(const Matrix& a, const Eigen::VectorXd& x, const Eigen::VectorXd& b) {
  double worst = 0;
  const Eigen::VectorXd magnitude = x.cwiseAbs();
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    const double scale = a.row(i).cwiseAbs().dot(magnitude) + std::abs(b(i));
    if (scale > 0) worst = std::max(worst, std::abs(a.row(i).dot(x) - b(i)) / scale);
  }
  return worst;
}

}  // namespace

Solution SolutionMaker::make(const Problem& problem, const Options& options, System&& system,
                             const Eigen::VectorXd& x) {
  Solution out;
  out.extent_ = system.extent;
  out.surface_ = system.surface;
  out.origin_ = system.origin;
  out.scale_ = system.scale;
  out.mu_ = system.mu;
  const auto value = [&](const Affine& a) {
    Vec2 v = a.constant;
    for (std::uint32_t k = 0; k < a.count; ++k) v += x(ix(a.terms[k].column)) * a.terms[k].direction;
    return v;
  };
  Vec2 force;
  double magnitude = 0;
  double energy = 0;
  for (std::size_t r = 0; r < system.regions.size(); ++r) {
    ScaledRegion& region = system.regions[r];
    std::vector<Vec2> u, u_part;
    for (std::size_t n = 0; n < region.mesh.nodes.size(); ++n) {
      const Vec2 v = value(system.displacement[region.global[n]]);
      u.push_back(system.scale * v);
      u_part.push_back(v - region.u_particular[n]);
    }
    std::vector<std::array<Vec2, 3>> t, t_part;
    for (std::size_t e = 0; e < region.mesh.elements.size(); ++e) {
      const Element& element = region.mesh.elements[e];
      std::array<Vec2, 3> whole{}, part{};
      for (std::size_t k = 0; k < region.mesh.per_element(); ++k) {
        const Vec2 v = region.slot_sign[e][k] * value(system.traction[region.slot[e][k]]);
        part[k] = v - region.t_particular[e][k];
        whole[k] = system.mu * (v + region.t_forces[e][k]);
      }
      const GaussRule& rule = gauss(8);
      for (std::size_t k = 0; k < rule.s.size(); ++k) {
        const auto n = shape(region.mesh.order, rule.s[k]);
        Vec2 traction, displacement;
        for (std::size_t a = 0; a < region.mesh.per_element(); ++a) {
          traction += n[a] * whole[a];
          displacement += n[a] * u[element.node[a]];
        }
        const Vec2 f = (rule.w[k] * norm(element.derivative(rule.s[k])) * system.scale) * traction;
        force += f;
        magnitude += norm(f);
        energy += 0.5 * dot(f, displacement);
      }
      t.push_back(whole);
      t_part.push_back(part);
    }
    for (const PointField& f : region.particular.points) {
      force += (system.mu * system.scale) * f.force;
      magnitude += norm((system.mu * system.scale) * f.force);
    }
    const Region& given = problem.regions[r];
    const AreaMoments area = area_moments(given.loops);
    if (system.extent == Extent::bounded) {
      const double density = system.mu / system.scale;
      const Particular& p = region.particular;
      const double a = std::abs(area.area);
      const Vec2 c = (area.centroid - system.origin) / system.scale;
      const Vec2 f = (a * density) *
                     (p.body + p.spin * c - p.twist * turned_left(c) - Vec2{p.initial_slope.xy, p.initial_slope.yy});
      force += f;
      magnitude += norm(f);
    }
    std::vector<Loop> loops = check_loops(given.loops, system.extent != Extent::bounded && r == 0)->loops;
    out.diagnostics_.elements += region.mesh.elements.size();
    const Medium medium{{region.particular.mu, region.particular.nu},
                        system.surface ? std::optional{HalfPlane{*system.surface}} : std::nullopt};
    out.inside_.push_back(std::make_shared<const InsideRules>(region.mesh, medium, options.integration));
    out.regions_.push_back({given.material, std::move(loops), std::move(region.mesh), region.particular, std::move(u),
                            std::move(t), std::move(u_part), std::move(t_part)});
  }
  out.diagnostics_.imbalance = magnitude > 0 && system.extent == Extent::bounded ? norm(force) / magnitude : 0;
  out.diagnostics_.energy = energy;
  return out;
}

std::expected<Solution, SolveError> solve(const Problem& problem, const Options& options) {
  auto made = make_system(problem, options);
  if (!made) return std::unexpected(std::move(made).error());
  System system = *std::move(made);
  const std::size_t extra = system.free_body ? 3 : 0;
  const std::size_t rows = system.rows + extra;
  const std::size_t columns = system.columns + extra;
  const double needed = 2e-6 * sizeof(double) * static_cast<double>(rows) * static_cast<double>(columns);
  if (needed > options.memory_limit_mb) return std::unexpected(TooManyUnknowns{columns, needed});

  Matrix a = Matrix::Zero(ix(rows), ix(columns));
  Eigen::VectorXd b = Eigen::VectorXd::Zero(ix(rows));
  {
    std::vector<Integrator> integrators;
    for (const ScaledRegion& region : system.regions) {
      integrators.emplace_back(
          region.mesh,
          Medium{region.elastic, system.surface ? std::optional{HalfPlane{*system.surface}} : std::nullopt},
          options.integration);
    }
    const Rows assemble{system, a, b};
    // Groups in parcels of one region, the same ones for any number of threads.
    constexpr std::size_t parcel = 2 * Integrator::lanes;
    std::vector<std::span<const EquationGroup>> parcels;
    for (std::size_t from = 0; from < system.groups.size();) {
      std::size_t to = from + 1;
      while (to < system.groups.size() && to - from < parcel && system.groups[to].region == system.groups[from].region)
        ++to;
      parcels.push_back(std::span{system.groups}.subspan(from, to - from));
      from = to;
    }
    parallel_for(parcels.size(), ThreadLimit{std::max(1U, options.threads)},
                 [&](std::size_t k) { assemble.add(parcels[k], integrators[parcels[k].front().region]); });
  }
  if (system.free_body) hold(system, a);

  Eigen::VectorXd x;
  double condition = 0;
  if (rows == columns) {
    const Eigen::PartialPivLU<Eigen::MatrixXd> lu{a};
    x = lu.solve(b);
    condition = 1 / lu.rcond();
  } else {
    // More equations than unknowns at corners of bonded regions: least squares.
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr{a};
    x = qr.solve(b);
    const auto r = qr.matrixR().diagonal().cwiseAbs();
    condition = r.maxCoeff() / r.minCoeff();
  }
  if (!x.allFinite() || !(condition < 1e15)) return std::unexpected(SingularSystem{condition});
  const double residual = residual_of(a, x, b);
  Solution solution = SolutionMaker::make(problem, options, std::move(system), x);
  Diagnostics& d = SolutionMaker::diagnostics(solution);
  d.unknowns = columns;
  d.condition = condition;
  d.residual = residual;
  return solution;
}

namespace {

/// How far the places of a mesh move from where they are to where the mesh of twice as many elements has them, over
/// the largest displacement. Infinite where that cannot be said: under a point force the displacement is infinite, so
/// no mesh settles within three elements of one, and what is left hardly moves.
double change_of(const Problem& problem, const Solution& coarse, const Solution& fine) {
  constexpr double enough = 0.25;  // of the largest displacement, among places that are compared
  double difference = 0, seen = 0;
  for (std::size_t r = 0; r < fine.regions().size(); ++r) {
    const auto& before = coarse.regions()[r];
    const auto& after = fine.regions()[r];
    for (std::size_t e = 0; e < before.mesh.elements.size(); ++e) {
      const Vec2 place = coarse.node(r, before.mesh.elements[e].node[0]);
      const double reach =
          3 * norm(coarse.node(r, before.mesh.elements[e].node[before.mesh.per_element() - 1]) - place);
      if (std::ranges::any_of(problem.forces, [&](const PointForce& f) { return norm(f.at - place) <= reach; }))
        continue;
      // Every element was halved (even where elements are graded, its ends remain nodes); compare at its ends.
      const Vec2 was = before.displacement[before.mesh.elements[e].node[0]];
      Vec2 is = after.displacement[after.mesh.elements[2 * e].node[0]];
      if (before.mesh.order == Order::constant)
        is = 0.5 * (is + after.displacement[after.mesh.elements[2 * e + 1].node[0]]);
      difference = std::max(difference, norm(is - was));
      seen = std::max(seen, norm(is));
    }
  }
  const double largest = fine.largest_displacement();
  if (!problem.forces.empty() && seen < enough * largest) return std::numeric_limits<double>::infinity();
  return largest > 0 ? difference / (problem.forces.empty() ? largest : seen) : 0;
}

}  // namespace

std::expected<Refined, SolveError> solve_to(const Problem& problem, Options options, double tolerance,
                                            std::size_t most_meshes) {
  const double start = cpu_seconds();
  auto coarse = solve(problem, options);
  if (!coarse) return std::unexpected(std::move(coarse).error());
  Refined out{.solution = *std::move(coarse), .error = 1, .meshes = 1, .reached = false};
  while (out.meshes < most_meshes) {
    options.mesh.subdivide *= 2;
    auto fine = solve(problem, options);
    if (!fine) {
      if (std::holds_alternative<TooManyUnknowns>(fine.error())) break;
      return std::unexpected(std::move(fine).error());
    }
    out.error = change_of(problem, out.solution, *fine);
    out.solution = *std::move(fine);
    out.series.push_back({out.solution.diagnostics().elements, cpu_seconds() - start, out.error});
    ++out.meshes;
    // Under point forces few places may be all there is to compare, for the first time: that tells too little.
    const bool twice = problem.forces.empty() || (out.series.size() > 1 && std::isfinite(out.series.rbegin()[1].error));
    if (out.error <= tolerance && twice) {
      out.reached = true;
      break;
    }
  }
  return out;
}

}  // namespace cleave::bem
