#pragma once

#include <array>
#include <expected>
#include <functional>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "cleave/core/cost.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"

namespace cleave::stability {

/// The part of a scene in which key blocks are looked for: a box around all free faces, made larger as long as blocks
/// that it cuts through might move.
///
/// A block that the window cuts through stays for certain when its known faces leave it no direction of movement, or
/// when friction on them holds it whatever else belongs to it; only the others ask for a larger window.
class NearField final {
 public:
  /// Empty when there is no free face, or when the window would hold more than half of the domain: cut all of it then.
  /// The box goes `depth` m beyond the free faces at least.
  [[nodiscard]] static std::optional<NearField> around_free_faces(const topology::CutInput& input, double depth = 0);

  [[nodiscard]] topology::Window window() const noexcept;
  /// Moves the sides that the undecided blocks reach. False when nearly all of the domain would be cut: cut all of it.
  [[nodiscard]] bool grow(const topology::BlockComplex& complex, std::span<const topology::BlockId> undecided);

 private:
  NearField() = default;
  [[nodiscard]] bool worth_while() const noexcept;
  std::array<double, 3> free_min_{}, free_max_{};      ///< box of the free faces within the domain's
  std::array<double, 3> domain_min_{}, domain_max_{};  ///< box of the domain
  std::array<double, 6> margin_{};                     ///< x-, x+, y-, y+, z-, z+; m
};

/// Key blocks without cutting more than their neighbourhood.
struct NearKeyBlocks {
  topology::AuditedComplex complex;        ///< of the window; blocks at its edge are marked truncated
  Analysis analysis;                       ///< that of the whole scene
  std::optional<topology::Window> window;  ///< empty when all was cut after all
  unsigned rounds = 1;                     ///< how many windows were cut
};
using NearError = std::variant<topology::CutError, topology::Certificate>;

/// What is asked of the same window beside the analysis.
struct NearMore {
  Length depth;  ///< how far behind free faces the first window goes at least (the longest bolt)
  /// Looks at a window in which the analysis is decided; returns the truncated blocks that its own answer depends on,
  /// none when it stands.
  std::function<std::vector<topology::BlockId>(const topology::AuditedComplex&, const Analysis&)> undecided = {};
};

/// Batches, key blocks and what moves them are those of `analyse` on the whole scene (block numbers are not), under all
/// loads: cost goes with the free surface, not with the volume. Of the blocks that would move but for friction those
/// below `Settings::least_factor` are listed, and others that lie in the window as a whole. With pressures stated joint
/// by joint a block that the window cuts through is decided only when nothing lets it move at all. Books its work under
/// "cut", "audit" and "stability".
[[nodiscard]] std::expected<NearKeyBlocks, NearError> analyse_near_field(const topology::CutInput& input,
                                                                         const Settings& settings,
                                                                         const topology::CutOptions& options,
                                                                         StageTimer& timer, const NearMore& more = {});

}  // namespace cleave::stability
