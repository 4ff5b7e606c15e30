/// Study "bem_assembly": what filling the dense matrices costs. All integrals of U N and T N (quadratic elements,
/// default error target) from every node of a square; `error` is how far the integral of T over all other elements is
/// from its exact value -1/2 at the middle nodes. `condition` holds the ratio to the bound: the time in which this
/// machine does the same floating point operations in Eigen's matrix product (same build). Count: 105 operations a
/// point (4 distance, 1 division, 20 logarithm, 38 kernels, 42 = 3 shape functions x 7 sums x 2), points counted one by
/// one. Rows with two threads hold the ratio of wall times to one thread instead; it says something on an idle machine
/// only.

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "cleave/bem/outline.hpp"
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

void study_assembly(study::Study& study) {
  const double rate = product_rate(study);
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
    const auto row = [&](std::size_t n) {
      ElementIntegrals part;
      Mat2 total;
      for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
        std::optional<double> own;
        for (const Use& use : mesh.nodes[n].uses) {
          if (use.element == e) own = local_nodes(mesh.order)[use.local];
        }
        integrator.integrate(e, mesh.nodes[n].x, own, part);
        if (!own) {
          for (std::size_t k = 0; k < mesh.per_element(); ++k) total += part.h[k];
        }
      }
      if (mesh.nodes[n].uses.size() == 1) {
        wrong[n] =
            std::max({std::abs(total.xx + 0.5), std::abs(total.yy + 0.5), std::abs(total.xy), std::abs(total.yx)});
      }
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
    double one_wall = 0;
    for (const unsigned threads : {1U, 2U}) {
      const auto cost = study.measure([&] { parallel_for(mesh.nodes.size(), ThreadLimit{threads}, row); }, 0.2, 3);
      if (threads == 1) one_wall = cost.wall_s;
      const double least = operations_a_point * points / rate;
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
      }
    }
  }
  plot.series = {std::move(filled), std::move(bound)};
  study.plot("time", plot);
}

}  // namespace
}  // namespace cleave

int main(int argc, char** argv) { return cleave::study::run("bem_assembly", argc, argv, cleave::study_assembly); }
