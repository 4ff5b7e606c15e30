#include "holds_at_border.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "held_notes.hpp"

namespace cleave::scene {
namespace {

using topology::Block;
using topology::BlockComplex;
using topology::BlockId;

class BorderHolds final {
 public:
  explicit BorderHolds(std::vector<std::string>& notes) : notes_{&notes} {}

  void tell(const BlockComplex& complex, const HoldsAtBorder& held, const std::string& where) {
    tell_of(bolted_, complex, held.bolts, where, "bolts go through", "what is bolted to them alone");
    tell_of(sprayed_, complex, held.shotcrete, where, "shotcrete at the edges of blocks is held at",
            "what hangs on that layer");
  }

 private:
  void tell_of(std::vector<Block>& known, const BlockComplex& complex, std::vector<BlockId> blocks,
               const std::string& where, std::string_view how, std::string_view what) {
    std::erase_if(blocks, [&](BlockId id) {
      return std::ranges::any_of(known, [&](const Block& other) { return same_block(complex.blocks()[id], other); });
    });
    if (blocks.empty()) return;
    for (const BlockId id : blocks) known.push_back(complex.blocks()[id]);
    notes_->push_back(
        fmt::format("{}{} {} {} that only a side of the domain holds ({}{}): they count as rock that stays, so that {} "
                    "may move with them; enlarge the domain",
                    where, how, blocks.size(), blocks.size() == 1 ? "block" : "blocks", blocks.front().value(),
                    blocks.size() > 1 ? ", ..." : "", what));
  }

  std::vector<std::string>* notes_;
  std::vector<Block> bolted_, sprayed_;
};

}  // namespace

void add_holds_at_border_notes(const Realization& made, std::vector<std::string>& notes) {
  BorderHolds holds{notes};
  const auto of = [](const stability::SupportResult& support) {
    return HoldsAtBorder{support.held_by_border, support.sprayed_at_border};
  };
  const BlockComplex& complex = made.complex->complex();
  holds.tell(complex, of(*made.support), "");
  for (const CaseSupport& load : made.support_cases) {
    holds.tell(complex, of(load.support), fmt::format("load case {}: ", load.name));
  }
  if (!made.sequence) return;
  for (const StageResult& row : made.sequence->stages) {
    if (!row.complex || !*row.complex || !row.support) continue;
    const BlockComplex& stage = (*row.complex)->complex();
    holds.tell(stage, row.support->at_border, fmt::format("after stage {}: ", row.stage));
    for (const StageCase& under : row.cases) {
      holds.tell(stage, under.at_border, fmt::format("after stage {}, load case {}: ", row.stage, under.name));
    }
  }
}

}  // namespace cleave::scene
