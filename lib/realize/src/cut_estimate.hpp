#pragma once

#include <optional>

#include "cleave/realize/run.hpp"

namespace cleave::scene {

/// What cutting some joints is expected to make and to take, from their areas and attitudes alone. For people and for
/// the machine's memory; nothing of a result depends on it.
struct CutEstimate {
  double faces = 0;        ///< of the domain and the openings
  double joints = 0;       ///< that reach the domain
  double pairs = 0;        ///< of them that meet
  double blocks = 1;       ///< expected
  double blocks_low = 1;   ///< a bracket: those that the joints form if they hang together loosely,
  double blocks_high = 1;  ///< and if they hang together as planes do, twice over

  [[nodiscard]] double memory_mb() const noexcept;  ///< of cutting and auditing, without the program itself
  [[nodiscard]] double cut_s() const noexcept;      ///< seconds of CPU
  [[nodiscard]] double audit_s() const noexcept;
};

/// The refusal of a cut that takes more than `memory_mb`; empty where it fits, or has too few joints to fill a machine.
[[nodiscard]] std::optional<Problem> too_large_for(double memory_mb, const Scene& scene, const SampledScene& drawn);

/// Time linear in the joints. The same joints always give the same figures.
[[nodiscard]] CutEstimate estimate_cut(const SampledScene& drawn);

}  // namespace cleave::scene
