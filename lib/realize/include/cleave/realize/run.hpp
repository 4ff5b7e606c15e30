#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/realize/run_result.hpp"
#include "cleave/scene/problem.hpp"
#include "cleave/scene3d/scene.hpp"

namespace cleave::scene {

class TunnelFields;

[[nodiscard]] Plan make_plan(const Scene& scene);
/// Of one realization, which has what ensembles do not: blocks in motion.
[[nodiscard]] Plan plan_of_realization(const Scene& scene);

/// The plan with what it is expected to cost, from the joints of the first realization. Errors: those of `sample`.
[[nodiscard]] std::expected<Plan, std::vector<Problem>> make_costed_plan(const Scene& scene);

struct RunOptions {
  unsigned threads = 1;           ///< at least 1; changes nothing but the time
  std::uint64_t realization = 0;  ///< number of the random realization
  /// Megabytes (10^6 bytes) that the machine has: what is expected to need more is refused before it is cut. No limit
  /// when empty.
  std::optional<double> memory_mb = std::nullopt;
  /// Of [field_stress], where it has been solved already; it is the same in every realization.
  std::shared_ptr<const TunnelFields> fields = nullptr;
  MovingRun motion = {};  ///< of [motion]
};

/// The fields of [field_stress] for all realizations of a scene; null without it, or where it cannot be solved, which
/// every realization then says.
[[nodiscard]] std::shared_ptr<const TunnelFields> shared_fields(const Scene& scene, unsigned threads);

/// Draws the random joints, the strength of each joint and what is random of the loads. A pure function of the scene
/// (with its seed) and the number of the realization; in a nested design the joints are those of the geometry that the
/// realization belongs to.
[[nodiscard]] std::expected<SampledScene, std::vector<Problem>> sample(const Scene& scene,
                                                                       std::uint64_t realization = 0);

/// Of key blocks that water lifts out of free faces. `where`: the load case, before the note.
[[nodiscard]] std::string note_on_lifted(std::string_view where, std::string_view how_many);

/// Realizations `first` .. `first + count - 1` on one thread: the same joints, blocks and judgements as `run` finds for
/// each, but for what ensembles do not count; null for one that cannot be made. The steps of the plan are booked with
/// `timer`. Precondition: the realizations belong to one geometry; it is cut once.
void realize(const Scene& scene, const std::shared_ptr<const TunnelFields>& fields, std::uint64_t first,
             std::uint64_t count, StageTimer& timer, const std::function<void(std::uint64_t, const Realization*)>& use);

/// Does the steps of the scene's plan from draw to elastic. `timer` books them (the caller has booked `read`),
/// `progress` shows them.
///
/// Errors are what only these stages can see in a scene: a joint too small for the lattice, excavations that leave no
/// rock, more joints than can be drawn, a cut that the machine has no memory for. A certificate that does not pass is a
/// result, not an error.
[[nodiscard]] std::expected<RunResult, std::vector<Problem>> run(const Scene& scene, const RunOptions& options,
                                                                 StageTimer& timer, Progress& progress);

/// What `refusals` makes of a cut for which the memory of `options` is not enough.
enum class TooLarge : std::uint8_t { refused, passed_over };

/// What `run` would refuse of a scene that the parser took, as far as it shows without cutting along the joints: joints
/// that cannot be drawn, openings that miss the rock or leave none, forces on no free face, a cut that `options` has
/// not the memory for. Of scenes of which only the rock near free faces is cut, and of ensembles, `run` has no estimate
/// of memory before it begins, and none is a reason here. Where all joints would not fit into the memory of `options`,
/// they are not looked through for those that cannot be cut.
[[nodiscard]] std::vector<Problem> refusals(const Scene& scene, const RunOptions& options = {},
                                            TooLarge too_large = TooLarge::refused);

/// What the openings take of the rock, in order of the scene, and what a user should know of that.
struct Excavated {
  std::vector<ExcavationFigures> openings;
  std::vector<std::string> notes;
};
/// Of an ensemble, in all of whose realizations it is the same: the openings are cut alone. An opening that takes
/// nothing is an error.
[[nodiscard]] std::expected<Excavated, std::vector<Problem>> excavated(const Scene& scene);

/// The blocks that [micro_blocks] is about, in order.
[[nodiscard]] std::vector<topology::BlockId> micro_blocks(const topology::BlockComplex& complex,
                                                          const MicroBlocks& limits);

}  // namespace cleave::scene
