#include "cleave/bem/antiplane.hpp"

#include <Eigen/Dense>
#include <numbers>

namespace cleave::bem {
namespace {

using Complex = std::complex<double>;

Complex at(Vec2 x) { return {x.x, x.y}; }

/// tau_xz - i tau_yz of a unit source density on the segment.
Complex of_segment(Complex from, Complex to, Complex z) {
  const Complex along = (to - from) / std::abs(to - from);
  return std::log((z - from) / (z - to)) / (2 * std::numbers::pi * along);
}

Complex mirrored(Complex z, double surface) { return {z.real(), 2 * surface - z.imag()}; }

}  // namespace

Complex Antiplane::of_unit(const Panel& panel, Complex z, const std::optional<double>& surface) {
  Complex field = of_segment(panel.from, panel.to, z);
  // The image has the same sign: no flux through the line of symmetry.
  if (surface) field += of_segment(mirrored(panel.from, *surface), mirrored(panel.to, *surface), z);
  return field;
}

std::expected<Antiplane, SolveError> Antiplane::make(const std::vector<Loop>& openings, std::optional<double> surface,
                                                     const MeshSize& size, Vec2 far) {
  auto checked = check_loops(openings, true);
  if (!checked) return std::unexpected(BadOutline{0, checked.error()});
  const Mesh mesh = make_mesh(checked->loops, size);
  Antiplane out;
  out.surface_ = surface;
  out.far_ = far;
  for (const Element& e : mesh.elements) out.panels_.push_back({at(e.at(-1)), at(e.at(1))});
  const auto n = static_cast<Eigen::Index>(out.panels_.size());
  Eigen::MatrixXd flux(n, n);
  Eigen::VectorXd given(n);
  const auto panel = [&](Eigen::Index i) -> const Panel& { return out.panels_[static_cast<std::size_t>(i)]; };
  const auto length = [&](Eigen::Index i) { return std::abs(panel(i).to - panel(i).from); };
  for (Eigen::Index i = 0; i < n; ++i) {
    const Complex middle = 0.5 * (panel(i).from + panel(i).to);
    const Complex normal = (panel(i).to - panel(i).from) / length(i) * Complex{0, -1};  // out of the rock on the left
    for (Eigen::Index j = 0; j < n; ++j) {
      flux(i, j) = i == j ? 0 : (of_segment(panel(j).from, panel(j).to, middle) * normal).real();
    }
    given(i) = -(far.x * normal.real() + far.y * normal.imag());
  }
  // What a panel sends through its own place: all it emits leaves the opening's outline (half of it on a straight one).
  for (Eigen::Index j = 0; j < n; ++j) {
    double others = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto loop = [&](Eigen::Index k) { return mesh.elements[static_cast<std::size_t>(k)].loop; };
      if (loop(i) == loop(j)) others += flux(i, j) * length(i);
    }
    flux(j, j) = -1 - others / length(j);
  }
  if (surface) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const Complex middle = 0.5 * (panel(i).from + panel(i).to);
      const Complex normal = (panel(i).to - panel(i).from) / length(i) * Complex{0, -1};
      for (Eigen::Index j = 0; j < n; ++j) {
        flux(i, j) +=
            (of_segment(mirrored(panel(j).from, *surface), mirrored(panel(j).to, *surface), middle) * normal).real();
      }
    }
  }
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu{flux};
  if (!(lu.rcond() > 1e-14)) return std::unexpected(SingularSystem{1 / lu.rcond()});
  const Eigen::VectorXd source = lu.solve(given);
  for (Eigen::Index i = 0; i < n; ++i) out.panels_[static_cast<std::size_t>(i)].source = source(i);
  return out;
}

Vec2 Antiplane::shear(Vec2 x) const {
  Complex field = 0;
  for (const Panel& panel : panels_) field += panel.source * of_unit(panel, at(x), surface_);
  return far_ + Vec2{field.real(), -field.imag()};
}

}  // namespace cleave::bem
