/// Study "bem_assembly": what filling the dense matrices costs. All integrals of U N and T N (quadratic elements,
/// default error target) from every node of a square; `error` is how far the integral of T over all other elements is
/// from its exact value -1/2 at the middle nodes. `condition` holds the ratio to the bound: the time in which this
/// machine does the same floating point operations in Eigen's matrix product (same build). Count: 105 operations a
/// point (4 distance, 1 division, 20 logarithm, 38 kernels, 42 = 3 shape functions x 7 sums x 2), points counted one by
/// one. Rows with two threads hold the ratio of wall times to one thread instead, beside that of arithmetic without
/// memory measured in the same minute: what the machine had to give.

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "cleave/bem/problem.hpp"
#include "cleave/core/parallel.hpp"
#include "element_rows.hpp"
#include "study.hpp"

namespace cleave {
namespace {

using namespace bem;

constexpr double operations_a_point = 105;

double product_rate(const study::Study& study) {
  const Eigen::Index n = study.quick() ? 100 : 500;
  const Eigen::MatrixXd a = Eigen::MatrixXd::Random(n, n), b = Eigen::MatrixXd::Random(n, n);
  Eigen::MatrixXd c(n, n);
  const auto cost = study.measure([&] { c.noalias() = a * b; }, 0.3);
  return 2 * std::pow(static_cast<double>(n), 3) / cost.cpu_s;
}

/// A fixed amount of arithmetic, shared by the threads.
void arithmetic(unsigned threads, std::size_t operations) {
  constexpr std::size_t shares = 64;
  std::vector<double> results(shares);
  parallel_for(shares, ThreadLimit{threads}, [&](std::size_t k) {
    double a = 1 + static_cast<double>(k), b = 0.5;
    for (std::size_t i = 0; i < operations / shares; ++i) {
      a = 0.999999 * a + b;
      b = 0.5 * b + 1e-9 * a;
    }
    results[k] = a;
  });
  if (results[0] == 0) fmt::print("\n");
}

void study_assembly(study::Study& study) {
  study::Plot plot{
      .title = "filling the matrices", .x_label = "elements", .y_label = "processor time (s)", .series = {}};
  study::Series filled{.name = "integrals", .points = {}, .line = true, .fit = true};
  study::Series bound{.name = "bound by operations", .points = {}, .line = true, .fit = true};
  for (const std::size_t elements :
       study.quick() ? std::vector<std::size_t>{40} : std::vector<std::size_t>{500, 1000, 2000}) {
    const Loop square = polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0, elements / 4);
    const Mesh mesh = make_mesh({square}, {}, {0.5, 0.5}, 4);
    const Integrator integrator{mesh, Medium{{1, 0.3}, {}}, 1e-10};
    std::vector<double> wrong(mesh.nodes.size(), 0.0);
    const auto own_of = [&](std::size_t n, std::size_t e) -> std::optional<double> {
      for (const Use& use : mesh.nodes[n].uses) {
        if (use.element == e) return local_nodes(mesh.order)[use.local];
      }
      return std::nullopt;
    };
    const auto judge = [&](std::size_t n, Mat2 total) {
      if (mesh.nodes[n].uses.size() != 1) return;
      wrong[n] = std::max({std::abs(total.xx + 0.5), std::abs(total.yy + 0.5), std::abs(total.xy), std::abs(total.yx)});
    };
    /// Four rows side by side, as the solver does.
    const auto four = [&](std::size_t parcel) {
      constexpr std::size_t lanes = Integrator::lanes;
      std::array<Vec2, lanes> y;
      std::array<std::optional<double>, lanes> own;
      std::array<ElementIntegrals, lanes> part;
      std::array<Mat2, lanes> total{};
      for (std::size_t l = 0; l < lanes; ++l) y[l] = mesh.nodes[lanes * parcel + l].x;
      for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
        for (std::size_t l = 0; l < lanes; ++l) own[l] = own_of(lanes * parcel + l, e);
        integrator.integrate(e, y, own, part);
        for (std::size_t l = 0; l < lanes; ++l) {
          for (std::size_t k = 0; k < mesh.per_element() && !own[l]; ++k) total[l] += part[l].h[k];
        }
      }
      for (std::size_t l = 0; l < lanes; ++l) judge(lanes * parcel + l, total[l]);
    };
    const auto single = [&](std::size_t n) {
      ElementIntegrals part;
      Mat2 total;
      for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
        const auto own = own_of(n, e);
        integrator.integrate(e, mesh.nodes[n].x, own, part);
        for (std::size_t k = 0; k < mesh.per_element() && !own; ++k) total += part.h[k];
      }
      judge(n, total);
    };
    double points = 0;
    const std::size_t stride = std::max<std::size_t>(1, mesh.nodes.size() / 50);
    for (std::size_t n = 0; n < mesh.nodes.size(); n += stride) {
      for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
        const auto& uses = mesh.nodes[n].uses;
        if (std::ranges::any_of(uses, [&](const Use& use) { return use.element == e; })) continue;
        points += static_cast<double>(integrator.points_of(e, mesh.nodes[n].x) * stride);
      }
    }
    const auto one_by_one = study.measure([&] { parallel_for(mesh.nodes.size(), ThreadLimit{1}, single); }, 0.2, 3);
    // Close in time to what it is compared with: the machine may be shared.
    const double before = product_rate(study);
    const auto least = operations_a_point * points / before;
    study.add({.problem = "square",
               .method = "one_row_at_a_time",
               .setting = fmt::format("elements={} threads=1 points={:.3g}", elements, points),
               .error = *std::ranges::max_element(wrong),
               .cost = one_by_one,
               .condition = one_by_one.cpu_s / least,
               .status = study::Status::converged});
    double one_wall = 0, arithmetic_wall = 0;
    for (const unsigned threads : {1U, 2U}) {
      const auto cost = study.measure(
          [&] { parallel_for(mesh.nodes.size() / Integrator::lanes, ThreadLimit{threads}, four); }, 0.2, 5);
      // What the machine gives two threads now: arithmetic that touches no memory, in the same minute.
      const auto pure = study.measure([&] { arithmetic(threads, study.quick() ? 2'000'000 : 200'000'000); }, 0.2, 5);
      if (threads == 1) {
        one_wall = cost.wall_s;
        arithmetic_wall = pure.wall_s;
      }
      study.add({.problem = "square",
                 .method = threads == 1 ? "time_over_bound" : "wall_of_one_over_two_threads",
                 .setting = fmt::format("elements={} threads={} points={:.3g}", elements, threads, points),
                 .error = *std::ranges::max_element(wrong),
                 .cost = cost,
                 .condition = threads == 1 ? cost.cpu_s / least : one_wall / cost.wall_s,
                 .status = study::Status::converged});
      if (threads == 1) {
        filled.points.emplace_back(static_cast<double>(elements), cost.cpu_s);
        bound.points.emplace_back(static_cast<double>(elements), least);
      } else {
        study.add({.problem = "arithmetic",
                   .method = "wall_of_one_over_two_threads",
                   .setting = "no memory",
                   .error = 0,
                   .cost = pure,
                   .condition = arithmetic_wall / pure.wall_s,
                   .status = study::Status::converged});
      }
    }
  }
  plot.series = {std::move(filled), std::move(bound)};
  study.plot("time", plot);
}

}  // namespace
}  // namespace cleave

int main(int argc, char** argv) { return cleave::study::run("bem_assembly", argc, argv, cleave::study_assembly); }
