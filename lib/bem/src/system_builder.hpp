#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <optional>
#include <utility>
#include <vector>

#include "system.hpp"

namespace cleave::bem {

/// The elements of one region that share a condition at a node.
struct SideGroup {
  std::uint32_t region;
  std::uint32_t node;  ///< of the region
  std::array<Use, 2> uses;
  std::size_t count = 0;
  const Condition* condition = nullptr;
  Vec2 normal;

  [[nodiscard]] std::array<Vec2, 2> axes() const {
    if (condition->axes == Axes::normal)
      return {rotated(normal, condition->turn), rotated(turned_left(normal), condition->turn)};
    return {rotated({1, 0}, condition->turn), rotated({0, 1}, condition->turn)};
  }
};

/// Sets up a system step by step: scaled meshes, bonds, supports, loads, unknowns, equations. Each step has its file.
class SystemBuilder {
 public:
  SystemBuilder(const Problem& problem, const Options& options) : problem_{problem}, options_{options} {}

  [[nodiscard]] std::expected<System, SolveError> build();

 private:
  [[nodiscard]] std::optional<SolveError> check_numbers() const;
  std::optional<SolveError> scale();
  const Condition& condition_of(std::size_t region, const Element& e) const;
  std::optional<SolveError> bond();
  void find_groups();
  Vec2 position(const SideGroup& g) const;
  /// Rigid motions that no support feels, by the Gram matrix of what supports see of them.
  std::optional<SolveError> check_supports();
  /// Inertia relief: the body accelerates as its loads ask, and this acceleration is a load that balances them.
  void balance();
  /// Traction known at a node of an element, scaled (0 where it is not known).
  Vec2 given_traction(std::size_t region, std::uint32_t element, std::uint32_t local) const;
  std::optional<SolveError> constrain();
  void add_tractions();
  std::optional<SolveError> add_forces();
  /// Directions in which the traction of a group is unknown.
  static std::vector<Vec2> unknown_directions(const SideGroup& g);
  void plan_equations();

  const Problem& problem_;
  const Options& options_;
  System system_;
  std::vector<std::vector<std::vector<std::size_t>>> side_condition_;
  std::vector<std::vector<std::optional<std::pair<std::uint32_t, std::uint32_t>>>> partner_;
  std::vector<SideGroup> groups_;
  std::vector<std::vector<std::uint32_t>> groups_of_;
};

}  // namespace cleave::bem
