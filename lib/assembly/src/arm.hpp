#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "elements.hpp"

namespace cleave::assembly {

/// How the force of one element and the rates of its two bodies act on one another, laid out for sweeps: memory bounds
/// them. `of_body`, `of_other`: the rows of either body; of fixed rock they are not used up or changed.
template <std::size_t width>
class Arm final {
 public:
  static constexpr std::size_t rows = width;
  using Rates = std::span<const double, rows>;
  static constexpr bool turns = true;  ///< a force may move the point across itself
  explicit Arm(const Element& e) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t row = 0; row < width; ++row) {
        const auto i = static_cast<Eigen::Index>(row), k = static_cast<Eigen::Index>(axis);
        body_[axis][row] = e.on_body(i, k);
        other_[axis][row] = e.other ? e.on_other(i, k) : 0;
      }
    }
  }
  [[nodiscard]] double opening(Rates of_body, Rates of_other) const { return along(0, of_body, of_other); }
  /// Opening and two slips.
  [[nodiscard]] Eigen::Vector3d rate(Rates of_body, Rates of_other) const {
    return {along(0, of_body, of_other), along(1, of_body, of_other), along(2, of_body, of_other)};
  }
  void push(const Eigen::Vector3d& x, std::span<double, rows> of_body, std::span<double, rows> of_other) const {
    for (std::size_t row = 0; row < width; ++row) {
      of_body[row] += body_[0][row] * x[0] + body_[1][row] * x[1] + body_[2][row] * x[2];
      of_other[row] += other_[0][row] * x[0] + other_[1][row] * x[1] + other_[2][row] * x[2];
    }
  }

 private:
  /// In sums of every second row: a sweep waits for each.
  [[nodiscard]] double along(std::size_t axis, Rates of_body, Rates of_other) const {
    std::array<double, 2> body{}, other{};
    for (std::size_t row = 0; row < width; ++row) {
      body[row % 2] += body_[axis][row] * of_body[row];
      other[row % 2] += other_[axis][row] * of_other[row];
    }
    return (body[0] + body[1]) + (other[0] + other[1]);
  }
  std::array<std::array<double, width>, 3> body_, other_;
};

/// Of blocks in space that do not turn: both share the frame of their contact.
class StraightArm final {
 public:
  static constexpr std::size_t rows = 3;
  using Rates = std::span<const double, rows>;
  static constexpr bool turns = false;
  explicit StraightArm(const Element& e) {
    body_ = e.on_body.col(0).norm();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t row = 0; row < 3; ++row) {
        axes_[axis][row] = e.on_body(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(axis)) / body_;
      }
    }
    if (!e.other) return;
    for (std::size_t row = 0; row < 3; ++row) other_ += e.on_other(static_cast<Eigen::Index>(row), 0) * axes_[0][row];
  }
  [[nodiscard]] double opening(Rates of_body, Rates of_other) const { return along(0, between(of_body, of_other)); }
  [[nodiscard]] Eigen::Vector3d rate(Rates of_body, Rates of_other) const {
    const std::array<double, 3> u = between(of_body, of_other);
    return {along(0, u), along(1, u), along(2, u)};
  }
  void push(const Eigen::Vector3d& x, std::span<double, rows> of_body, std::span<double, rows> of_other) const {
    for (std::size_t row = 0; row < 3; ++row) {
      const double force = axes_[0][row] * x[0] + axes_[1][row] * x[1] + axes_[2][row] * x[2];
      of_body[row] += body_ * force;
      of_other[row] += other_ * force;
    }
  }

 private:
  [[nodiscard]] std::array<double, 3> between(Rates of_body, Rates of_other) const {
    return {body_ * of_body[0] + other_ * of_other[0], body_ * of_body[1] + other_ * of_other[1],
            body_ * of_body[2] + other_ * of_other[2]};
  }
  [[nodiscard]] double along(std::size_t axis, const std::array<double, 3>& u) const {
    return axes_[axis][0] * u[0] + axes_[axis][1] * u[1] + axes_[axis][2] * u[2];
  }
  std::array<std::array<double, 3>, 3> axes_;
  double body_ = 0, other_ = 0;  ///< roots of the inverse masses
};

}  // namespace cleave::assembly
