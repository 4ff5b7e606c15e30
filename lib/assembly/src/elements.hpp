#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "cleave/assembly/assembly.hpp"

namespace cleave::assembly {

/// Rows of one body that one force gives: at most 6 x 3 (normal, two tangents).
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 6, 3>;

/// One force: at a corner (friction with its normal) or spread over a bond (cohesion, tension).
struct Element {
  std::uint32_t contact = 0;
  std::uint32_t body = 0;
  std::optional<std::uint32_t> other = {};
  Rows on_body, on_other;  ///< scaled
  double scale = 1;        ///< force in units of the load = scale * unknown
  bool bond = false;
  double friction = 0;  ///< of a corner
  double cohesion = 0;  ///< of a bond, in units of its unknown
  double tension = 0;
};

/// The equations of an assembly without units: velocities such that the matrix of masses is 1, loads such that the
/// largest is 1, unknown forces such that each alone moves its blocks by about 1.
class Elements final {
 public:
  explicit Elements(const Assembly& assembly);
  /// Of some bodies (ascending), all others fixed, in the same units; `from` becomes the number that each element of
  /// the part has in the whole.
  [[nodiscard]] Elements part(std::span<const std::uint32_t> members, std::vector<std::uint32_t>& from) const;

  [[nodiscard]] const std::vector<Element>& all() const noexcept { return elements_; }
  [[nodiscard]] std::size_t bodies() const noexcept { return bodies_; }
  [[nodiscard]] Freedom freedom() const noexcept { return freedom_; }
  [[nodiscard]] Eigen::Index width() const noexcept { return width_; }
  [[nodiscard]] const Eigen::VectorXd& load() const noexcept { return load_; }
  /// Elements of one contact, first and one past the last.
  [[nodiscard]] std::pair<std::size_t, std::size_t> of_contact(std::size_t contact) const {
    return {starts_[contact], starts_[contact + 1]};
  }

  /// Relative velocity at an element: opening, then slip.
  [[nodiscard]] Eigen::Vector3d relative(const Element& e, const Eigen::VectorXd& v) const;
  /// y += G x.
  void add_force(const Element& e, const Eigen::Vector3d& x, Eigen::VectorXd& y) const;

  /// m/s2 and 1/s2 of a scaled velocity, and back.
  [[nodiscard]] Motion motion_of(const Eigen::VectorXd& v) const;
  [[nodiscard]] Eigen::VectorXd scaled(const Motion& motion) const;
  /// N of an unknown: normal and two tangents in the frame of the contact.
  [[nodiscard]] double newtons(const Element& e) const { return e.scale * unit_; }

 private:
  Elements(const Elements& whole, std::size_t bodies)
      : bodies_{bodies}, width_{whole.width_}, freedom_{whole.freedom_}, unit_{whole.unit_}, starts_{0} {}
  std::size_t bodies_;
  Eigen::Index width_;
  Freedom freedom_;
  double unit_ = 1;                      ///< scaled load 1 as a root of energy
  std::vector<Eigen::MatrixXd> mass_l_;  ///< lower Cholesky factors of the masses, rows of the freedom
  Eigen::VectorXd load_;
  std::vector<Element> elements_;
  std::vector<std::size_t> starts_;
};

/// Two unit vectors that make a right-handed frame with the normal.
[[nodiscard]] std::pair<geometry::Vec3, geometry::Vec3> tangents(geometry::Vec3 normal);

}  // namespace cleave::assembly
