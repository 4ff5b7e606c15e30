#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "arm.hpp"
#include "newton.hpp"

namespace cleave::assembly {

/// The Coulomb problem from rest contact by contact (nonlinear Gauss-Seidel of contact dynamics, Jean 1999; conjugate
/// directions by Silcowitz, Niebe and Erleben 2010): cheap sweeps and memory by contact. It starts from free fall, so
/// that no self-stress enters. Bodies that have come to rest
/// are left alone until a neighbour pushes them.
class Sweeps final {
 public:
  /// Bodies slower than `asleep` of their own free fall are left alone. `order`: of contacts, as of `settle`.
  Sweeps(const Elements& elements, double divisor, double asleep, unsigned order);
  Sweeps(const Elements&&, double, double, unsigned) = delete;

  /// Up to so many sweeps; ends when all is at rest or nothing changes any more.
  void run(int most);
  /// Goes on with other strengths.
  void strength_over(double divisor);
  /// Goes on with the bonds of other elements of the same contacts.
  void bonds_of(const Elements& elements);
  void bonds_of(const Elements&&) = delete;
  [[nodiscard]] const State& state() const noexcept { return state_; }
  /// Goes on from another state of the forces; rates follow from them.
  void take(const std::vector<Eigen::Vector3d>& forces);
  /// Bodies faster than `still` of their own free fall.
  [[nodiscard]] std::vector<std::uint8_t> moving(double still) const;

 private:
  /// What a sweep needs of one element.
  template <class A>
  struct Link {
    std::uint32_t body, other;  ///< first rows of either; of fixed rock those behind the last body, which stay 0
    double stop;                ///< force that stops a unit rate at most
    double friction;
    bool bond;
    std::uint32_t contact;
    A arm;
  };
  template <class A>
  using Links = std::vector<Link<A>>;
  /// What a bond carries at the present strengths; nothing of a point.
  struct Bonded {
    double cohesion, tension;
  };
  using AnyLinks = std::variant<Links<Arm<2>>, Links<Arm<3>>, Links<StraightArm>, Links<Arm<6>>>;

  /// Of a body.
  template <class A>
  [[nodiscard]] std::span<double, A::rows> rows_of(std::uint32_t first) {
    return std::span{rates_}.subspan(first).template first<A::rows>();
  }
  template <class A>
  static Links<A> links_of(const Elements& elements);
  static AnyLinks any_links_of(const Elements& elements);
  template <class A>
  void run(const Links<A>& links, int most);
  template <class A>
  void sweep(const Links<A>& links, std::uint32_t element);
  template <class A>
  void extrapolate(const Links<A>& links, double share);
  /// Force of an element, that its bodies move past at a rate, after a step.
  template <class A>
  [[nodiscard]] Eigen::Vector3d next(const Link<A>& link, std::uint32_t element, const Eigen::Vector3d& rate) const;
  [[nodiscard]] Eigen::Vector3d carried_by_bond(const Bonded& bond, bool presses, Eigen::Vector3d x) const;
  template <class A>
  void set_force(const Link<A>& link, Eigen::Vector3d& x, const Eigen::Vector3d& to);
  void count_pressing();
  void choose();
  void tell_rates();
  [[nodiscard]] double speed_over_own(std::size_t body) const;

  const Elements* elements_;
  double divisor_, strength_, asleep_;
  State state_;
  AnyLinks links_;
  std::vector<Bonded> bonded_;                   ///< by element
  std::vector<std::uint32_t> pressing_;          ///< by contact: points that press
  std::vector<std::uint32_t> order_;             ///< elements as they are swept
  std::vector<double> rates_;                    ///< rows of all bodies, and of one more that stays 0
  std::vector<Eigen::Matrix3d> stiff_;           ///< by element where bodies turn: force that stops a unit rate
  std::vector<double> own_;                      ///< by body: rate of free fall
  std::vector<std::uint32_t> active_;            ///< elements beside a body that is not at rest
  std::vector<Eigen::Vector3d> before_, along_;  ///< by element; of what is at rest the force and zero
};

}  // namespace cleave::assembly
