#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/stability/result.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/sequence.hpp"

namespace cleave::scene {

/// What becomes of the blocks that leave in one stage before the next one is excavated.
enum class Fallen : std::uint8_t {
  stay_out,  ///< they have fallen: their room is void from then on
  put_back,  ///< they were held in place: the next stage finds them where they were
};

/// [sequence]: the excavations are taken out stage by stage.
struct SequenceSettings {
  Fallen fallen = Fallen::stay_out;
  /// Stage numbers of the excavations in ascending order, each once.
  std::vector<std::uint32_t> stages;
  /// Other orders of the same stages to compare with that one.
  std::vector<std::vector<std::uint32_t>> orders;
};

/// The rock after one stage.
struct StageResult {
  std::uint32_t stage = 1;
  std::vector<std::string> excavations;  ///< those of this stage
  /// Empty when all rock has fallen; the certificate where it did not pass.
  std::optional<std::expected<topology::AuditedComplex, topology::Certificate>> complex;
  std::string block_hash;
  std::optional<stability::Analysis> analysis;
  std::uint64_t new_key_blocks = 0;  ///< of the blocks that leave, those without a part that left in an earlier stage
  Volume new_key_volume;
};

struct OrderResult {
  std::vector<std::uint32_t> stages;
  std::vector<std::uint64_t> new_key_blocks;  ///< one a stage, in this order
  std::vector<Volume> new_key_volume;
  std::uint64_t key_blocks = 0;  ///< sums over the stages
  Volume key_volume;
};

struct SequenceResult {
  Fallen fallen = Fallen::stay_out;
  std::vector<StageResult> stages;
  std::vector<OrderResult> orders;  ///< the scene's own first; only that one when no orders are to be compared
  std::size_t best = 0;             ///< the order with the smallest volume of key blocks; the first of equal ones
  /// By block of the final state: the first stage in which a part of it left; -1 for a block that stays.
  std::vector<std::int32_t> stage_of_block;
};

/// Judges an audited complex.
using Judge = std::function<stability::Analysis(const topology::AuditedComplex&)>;

/// Takes the excavations out in the order of their stages and judges the rock after each; then in every order to be
/// compared. `stage_of_excavation` has an entry an excavation of the cut, `final_state` are the blocks when all are
/// out.
[[nodiscard]] SequenceResult run_sequence(const topology::SequentialCut& cut, const topology::StageBlocks& final_state,
                                          const SequenceSettings& settings,
                                          const std::vector<std::uint32_t>& stage_of_excavation,
                                          const std::vector<std::string>& names, const Judge& judge);

}  // namespace cleave::scene
