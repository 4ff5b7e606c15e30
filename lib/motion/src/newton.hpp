#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "cleave/linear/block_system.hpp"
#include "cleave/linear/cone.hpp"
#include "solver.hpp"

namespace cleave::motion {

/// What a point can carry, as a method takes it.
enum class Law : std::uint8_t {
  coulomb,       ///< as it is
  cone,          ///< opening mu |slip| of `slid`: convex, the programme of De Saxce and Feng
  tresca,        ///< |t| <= threshold: convex
  frictionless,  ///< convex
};

/// The group without units: velocities such that the matrix of masses is 1 and what the contacts see of free motion is
/// 1 at the most; forces such that each alone moves its bodies by about 1.
struct Scaled {
  explicit Scaled(const Group& group);

  struct Element {
    std::uint32_t body;
    std::optional<std::uint32_t> other;
    Rows on_body, on_other;
    Eigen::Vector3d y;  ///< of free motion
    double mu, cohesion, tension;
    double scale;  ///< impulse = scale * unknown
    bool shear = false;
    double most = std::numeric_limits<double>::infinity();
  };
  std::vector<Element> elements;
  std::size_t bodies = 0;
  double unit = 0;  ///< velocity 1; 0: nothing approaches or slips

  [[nodiscard]] static Eigen::Index width() { return 6; }
  /// Velocities count from free motion.
  [[nodiscard]] Eigen::VectorXd start() const { return Eigen::VectorXd::Zero(6 * static_cast<Eigen::Index>(bodies)); }
  [[nodiscard]] Eigen::Vector3d relative(const Element& e, const Eigen::VectorXd& v) const;
  [[nodiscard]] static Eigen::Vector3d change(const Element& e, const Eigen::VectorXd& dv);
  void add(const Element& e, const Eigen::Vector3d& x, Eigen::VectorXd& v) const;
};

struct Programme {
  Law law = Law::coulomb;
  std::vector<double> given = {};  ///< by element: threshold (tresca) or slip (cone)
};

/// Solves v = G x with the law between x and y + G^T v by proximal points on the forces (Rockafellar 1976), each by a
/// semismooth Newton iteration in the freedoms of the bodies (Qi and Sun 1993).
class Newton final {
 public:
  explicit Newton(const Scaled& scaled);
  Newton(const Scaled&&) = delete;

  struct Schedule {
    double rough = 1e-1, fine = 1e-6, fall = 0.1;
    int recentrings = 1;    ///< at each weight before the last
    int last = 6;           ///< at the last weight
    double finest = 1e-10;  ///< where `fine` does not do
  };
  /// Goes on from `x`. Returns the largest change of velocity that the last proximal weight still hid; infinity when a
  /// Newton iteration got lost.
  double solve(const Programme& programme, std::vector<Eigen::Vector3d>& x, const Schedule& schedule);
  [[nodiscard]] std::size_t factors() const noexcept { return system_.factors(); }

 private:
  using Local = linear::Projection;
  [[nodiscard]] Local project(const Programme& programme, std::size_t k, const Eigen::Vector3d& w) const;
  /// Residual v - G P(x - y / rho); of the convex laws also the function that it is the gradient of.
  double evaluate(const Programme& programme, const std::vector<Eigen::Vector3d>& centre, double rho,
                  const Eigen::VectorXd& v, Eigen::VectorXd& gradient, std::vector<Local>& locals) const;
  [[nodiscard]] bool factorise(const std::vector<Local>& locals, double rho, bool symmetric);
  [[nodiscard]] bool direction(const std::vector<Local>& locals, double rho, const Eigen::VectorXd& gradient,
                               Eigen::VectorXd& step);
  double inner(const Programme& programme, std::vector<Eigen::Vector3d>& x, double rho, Eigen::VectorXd& v);

  const Scaled* scaled_;
  linear::BlockSystem system_;
};

/// Sweeps over the points, each solved alone by projected steps (Jean 1999): coarse, but never lost.
void sweep(const Scaled& scaled, std::vector<Eigen::Vector3d>& x, int sweeps);

/// First of the six rows of a body.
[[nodiscard]] inline Eigen::Index row(std::uint32_t body) { return 6 * static_cast<Eigen::Index>(body); }

}  // namespace cleave::motion
