#pragma once

#include <cstdint>
#include <expected>
#include <functional>
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
  double seismic_factor = 1;    ///< of this realization
  double water_quantile = 0.5;  ///< of this realization: u of the laws of water tables
};

/// Draws the random joints, the strength of each joint and what is random of the loads. A pure function of the scene
/// (with its seed) and the number of the realization; in a nested design the joints are those of the geometry that the
/// realization belongs to.
[[nodiscard]] std::expected<Drawn, std::vector<Problem>> draw(const Scene& scene, std::uint64_t realization = 0);

/// What one realization of a scene came to.
struct Realized {
  Drawn drawn;
  std::expected<topology::AuditedComplex, topology::Certificate> complex;
  std::optional<stability::Analysis> analysis;      ///< when the scene has a stability stage and the certificate passed
  std::optional<SequenceResult> sequence;           ///< when it has [sequence]
  std::optional<stability::SupportResult> support;  ///< when it has [support]
};
/// Realizations `first` .. `first + count - 1` on one thread: the same joints, blocks and judgements as `run` finds for
/// each. Precondition: they belong to one geometry; it is cut once.
void realize(const Scene& scene, std::uint64_t first, std::uint64_t count,
             const std::function<void(std::uint64_t, const std::expected<Realized, std::vector<Problem>>&)>& use);

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
