#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <vector>

#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/scene/problem.hpp"
#include "cleave/scene/run_result.hpp"
#include "cleave/scene/scene.hpp"

namespace cleave::scene {

struct RunOptions {
  unsigned threads = 1;           ///< at least 1; changes nothing but the time
  std::uint64_t realization = 0;  ///< number of the random realization
};

/// Everything that goes into the cutter, and what each joint is.
struct Drawn {
  topology::CutInput input;
  IdVector<SetId, SetInfo> sets;
  IdVector<topology::JointId, JointInfo> joints;
};

/// Draws the random joints and the strength of each joint. A pure function of the scene (with its seed) and the number
/// of the realization.
[[nodiscard]] std::expected<Drawn, std::vector<Problem>> draw(const Scene& scene, std::uint64_t realization = 0);

/// What one realization of a scene came to.
struct Realized {
  Drawn drawn;
  std::expected<topology::AuditedComplex, topology::Certificate> complex;
  std::optional<stability::Analysis> analysis;  ///< when the scene has a stability stage and the certificate passed
};
/// One realization on one thread: the same joints, blocks and judgements as `run` finds for it.
[[nodiscard]] std::expected<Realized, std::vector<Problem>> realize(const Scene& scene, std::uint64_t realization);

/// Draws, cuts, audits and judges. `timer` books the stages (the caller has booked `read`); `progress` shows them.
///
/// Errors are what only these stages can see in a scene: a joint too small for the lattice, excavations that leave no
/// rock, more joints than can be drawn. A certificate that does not pass is a result, not an error.
[[nodiscard]] std::expected<RunResult, std::vector<Problem>> run(const Scene& scene, const RunOptions& options,
                                                                 StageTimer& timer, Progress& progress);

/// The blocks that [micro_blocks] is about, in order.
[[nodiscard]] std::vector<topology::BlockId> micro_blocks(const topology::BlockComplex& complex,
                                                          const MicroBlocks& limits);

/// The timer's bookings as they stand in a result.
[[nodiscard]] RunCost cost_of(const StageTimer& timer, unsigned threads);

}  // namespace cleave::scene
