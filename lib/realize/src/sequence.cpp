#include "cleave/realize/sequence.hpp"

#include <algorithm>
#include <tuple>

namespace cleave::scene {
namespace {

using topology::CellId;

/// What happens when one stage is taken out.
struct AfterStage {
  std::optional<std::expected<topology::AuditedComplex, topology::Certificate>> complex;
  std::optional<stability::Analysis> analysis;
  std::vector<std::pair<Volume, std::vector<CellId>>> left;  ///< each block that leaves: its volume and cells
};

class Sequencer {
 public:
  Sequencer(const topology::SequentialCut& cut, const SequenceSettings& settings,
            const std::vector<std::uint32_t>& stage_of_excavation, const Judge& judge)
      : cut_{cut}, settings_{settings}, stage_of_excavation_{stage_of_excavation}, judge_{judge} {}

  [[nodiscard]] AfterStage step(const topology::WorkState& state) const {
    AfterStage result;
    auto blocks = cut_.blocks(state);
    if (!blocks) return result;  // no rock left
    result.complex = topology::audit(std::move(blocks->complex));
    if (!*result.complex) return result;
    const topology::AuditedComplex& complex = **result.complex;
    result.analysis = judge_(complex);
    std::vector<std::vector<CellId>> cells_of(complex.complex().blocks().size());
    for (std::size_t c = 0; c < blocks->block_of_cell.size(); ++c) {
      if (const auto block = blocks->block_of_cell[c]) cells_of[block->index()].emplace_back(c);
    }
    for (const stability::Batch& batch : result.analysis->batches) {
      for (const topology::BlockId block : batch.blocks) {
        result.left.emplace_back(complex.complex().blocks()[block].volume, cells_of[block.index()]);
      }
    }
    return result;
  }

  /// Walks through one order; `look` sees each step.
  template <class Look>
  OrderResult walk(const std::vector<std::uint32_t>& order, Look&& look) {
    OrderResult result{.stages = order, .new_key_blocks = {}, .new_key_volume = {}, .key_blocks = 0, .key_volume = {}};
    topology::WorkState state{.excavated = std::vector<std::uint8_t>(stage_of_excavation_.size(), 0), .fallen = {}};
    std::vector<std::uint8_t> has_left(cut_.cells(), 0);
    for (const std::uint32_t stage : order) {
      for (std::size_t e = 0; e < stage_of_excavation_.size(); ++e) {
        if (stage_of_excavation_[e] == stage) state.excavated[e] = 1;
      }
      look(stage, state, [&](const std::vector<std::pair<Volume, std::vector<CellId>>>& left) {
        std::uint64_t count = 0;
        Volume volume;
        std::vector<CellId> out;
        for (const auto& [size, cells] : left) {
          const bool known = std::ranges::any_of(cells, [&](CellId c) { return has_left[c.index()] != 0; });
          if (!known) {
            ++count;
            volume += size;
          }
          out.insert(out.end(), cells.begin(), cells.end());
        }
        for (const CellId c : out) has_left[c.index()] = 1;
        if (settings_.fallen == Fallen::stay_out) {
          state.fallen.insert(state.fallen.end(), out.begin(), out.end());
          std::ranges::sort(state.fallen);
        }
        result.new_key_blocks.push_back(count);
        result.new_key_volume.push_back(volume);
        result.key_blocks += count;
        result.key_volume += volume;
      });
    }
    return result;
  }

 private:
  const topology::SequentialCut& cut_;
  const SequenceSettings& settings_;
  const std::vector<std::uint32_t>& stage_of_excavation_;
  const Judge& judge_;
};

}  // namespace

SequenceResult run_sequence(const topology::SequentialCut& cut, const topology::StageBlocks& final_state,
                            const SequenceSettings& settings, const std::vector<std::uint32_t>& stage_of_excavation,
                            const std::vector<std::string>& names, const Judge& judge) {
  SequenceResult result{
      .fallen = settings.fallen,
      .stages = {},
      .orders = {},
      .best = 0,
      .stage_of_block = std::vector<std::optional<std::uint32_t>>(final_state.complex.blocks().size())};
  Sequencer sequencer{cut, settings, stage_of_excavation, judge};

  result.orders.push_back(
      sequencer.walk(settings.stages, [&](std::uint32_t stage, const topology::WorkState& state, const auto& account) {
        AfterStage step = sequencer.step(state);
        StageResult row{.stage = stage,
                        .excavations = {},
                        .complex = std::move(step.complex),
                        .block_hash = {},
                        .analysis = std::move(step.analysis),
                        .new_key_blocks = 0,
                        .new_key_volume = {}};
        for (std::size_t e = 0; e < names.size(); ++e) {
          if (stage_of_excavation[e] == stage) row.excavations.push_back(names[e]);
        }
        if (row.complex && *row.complex) {
          row.block_hash = topology::canonical_hash((*row.complex)->complex());
          row.blocks = count_blocks((*row.complex)->complex(), row.block_hash);
        }
        if (row.analysis) row.key_blocks = count_key_blocks(*row.analysis);
        for (const auto& [volume, cells] : step.left) {
          for (const CellId cell : cells) {
            const auto block = final_state.block_of_cell[cell.index()];
            if (!block) continue;
            auto& first = result.stage_of_block[block->index()];
            if (!first) first = stage;
          }
        }
        result.stages.push_back(std::move(row));
        account(step.left);
      }));
  for (std::size_t s = 0; s < result.stages.size(); ++s) {
    result.stages[s].new_key_blocks = result.orders[0].new_key_blocks[s];
    result.stages[s].new_key_volume = result.orders[0].new_key_volume[s];
  }

  // States that several orders pass through are judged once.
  using Left = std::vector<std::pair<Volume, std::vector<CellId>>>;
  std::map<std::pair<std::vector<std::uint8_t>, std::vector<CellId>>, Left> known;
  for (const auto& order : settings.orders) {
    if (order == settings.stages) continue;
    result.orders.push_back(
        sequencer.walk(order, [&](std::uint32_t, const topology::WorkState& state, const auto& account) {
          const auto [entry, fresh] = known.try_emplace(std::pair{state.excavated, state.fallen});
          if (fresh) entry->second = sequencer.step(state).left;
          account(entry->second);
        }));
  }
  for (std::size_t i = 1; i < result.orders.size(); ++i) {
    if (result.orders[i].key_volume < result.orders[result.best].key_volume) result.best = i;
  }
  return result;
}

}  // namespace cleave::scene
