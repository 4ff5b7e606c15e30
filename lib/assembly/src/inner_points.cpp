#include "inner_points.hpp"

#include "cleave/linear/interior.hpp"

namespace cleave::assembly {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

/// The elements as interior points take them. Tension is left out: what comes near is judged with it.
struct ConeElements {
  struct OneElement {
    const Element& own;
    std::uint32_t body;
    std::optional<std::uint32_t> other;
    const Rows& on_body;
    const Rows& on_other;
    double mu, cohesion, tension;
    bool shear;
  };
  const Elements& whole;
  std::vector<OneElement> elements = {};
  std::vector<std::size_t> from = {};  ///< of all elements, by own
  std::size_t bodies = 0;

  ConeElements(const Elements& of, double divisor, const std::vector<std::uint8_t>& pressing)
      : whole{of}, bodies{of.bodies()} {
    for (std::size_t k = 0; k < of.all().size(); ++k) {
      const Element& e = of.all()[k];
      const double cohesion = e.bond && pressing[k] != 0 ? e.cohesion / divisor : 0;
      if (e.bond && !(cohesion > 0)) continue;
      elements.push_back({e, e.body, e.other, e.on_body, e.on_other, e.friction / divisor, cohesion, 0, e.bond});
      from.push_back(k);
    }
  }
  [[nodiscard]] Eigen::Index width() const { return whole.width(); }
  [[nodiscard]] const VectorXd& start() const { return whole.load(); }
  [[nodiscard]] Vector3d change(const OneElement& e, const VectorXd& v) const { return whole.relative(e.own, v); }
  [[nodiscard]] Vector3d relative(const OneElement& e, const VectorXd& v) const { return whole.relative(e.own, v); }
  void add(const OneElement& e, const Vector3d& x, VectorXd& v) const { whole.add_force(e.own, x, v); }
};

}  // namespace

Near by_inner_points(const Elements& elements, double divisor, const std::vector<std::uint8_t>& pressing, Path path) {
  const ConeElements cones{elements, divisor, pressing};
  linear::Interior<ConeElements> interior{cones};
  std::vector<Vector3d> x(cones.elements.size(), Vector3d::Zero());
  Near out;
  if (!x.empty()) out.left = interior.solve(x, {.weight = path.weight, .coupled = path.coupled});
  out.state.x.assign(elements.all().size(), Vector3d::Zero());
  out.state.v = elements.load();
  for (std::size_t k = 0; k < x.size(); ++k) {
    out.state.x[cones.from[k]] = x[k];
    cones.add(cones.elements[k], x[k], out.state.v);
  }
  return out;
}

}  // namespace cleave::assembly
