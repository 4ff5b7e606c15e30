#include "group_factors.hpp"

#include <algorithm>
#include <limits>

#include "branch.hpp"

namespace cleave::assembly {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
/// Larger groups get no factors; factors of more than few blocks are coarse, and what is in doubt has none then.
constexpr std::size_t most_for_factors = 16, few_for_fine_factors = 4;
/// Where the factor of a group in doubt beside what moves is looked for, from here down.
constexpr double strongest = 32;

Accuracy accuracy_for(std::size_t bodies) { return bodies > few_for_fine_factors ? Accuracy::coarse : Accuracy::quick; }

/// A group with bodies that move beside it, all others fixed.
class Wide final {
 public:
  /// As many layers of neighbours of neighbours as have factors.
  Wide(const Group& group, const Assembly& island, const std::vector<std::uint8_t>& moves) : bodies_{group.bodies} {
    std::vector<std::uint8_t> in(moves.size(), 0);
    for (const std::uint32_t b : bodies_) in[b] = 1;
    for (;;) {
      std::vector<std::uint32_t> layer;
      for (const Contact& contact : island.contacts()) {
        if (!contact.other || in[contact.body] == in[*contact.other]) continue;
        const std::uint32_t outer = in[contact.body] != 0 ? *contact.other : contact.body;
        if (moves[outer] != 0) layer.push_back(outer);
      }
      std::ranges::sort(layer);
      layer.erase(std::ranges::unique(layer).begin(), layer.end());
      if (layer.empty() || bodies_.size() + layer.size() > most_for_factors) break;
      for (const std::uint32_t b : layer) in[b] = 1;
      bodies_.insert(bodies_.end(), layer.begin(), layer.end());
    }
    std::ranges::sort(bodies_);
    double most = 0;
    for (const std::uint32_t b : group.bodies) most = std::max(most, island.bodies()[b].mass);
    for (const std::uint32_t b : bodies_) {
      const bool own = std::ranges::binary_search(group.bodies, b);
      own_.push_back(own ? 1 : 0);
      heaviest_.push_back(own && island.bodies()[b].mass >= (1 - 1e-9) * most ? 1 : 0);
    }
  }
  [[nodiscard]] const std::vector<std::uint32_t>& bodies() const noexcept { return bodies_; }
  [[nodiscard]] const std::vector<std::uint8_t>& own() const noexcept { return own_; }
  /// Of equal ones all: the first that moves counts.
  [[nodiscard]] const std::vector<std::uint8_t>& heaviest() const noexcept { return heaviest_; }

 private:
  std::vector<std::uint32_t> bodies_;
  std::vector<std::uint8_t> own_, heaviest_;
};

}  // namespace

void give_factors(Group& group, const Assembly& island, const Assembly& counting,
                  const std::vector<std::uint8_t>& moves, Ask ask) {
  const bool moving = group.verdict != Verdict::in_doubt;
  group.factors = ask == Ask::factors && group.bodies.size() <= (moving ? most_for_factors : few_for_fine_factors);
  group.up.factor = group.verdict == Verdict::certain ? 1 : infinite;
  group.moving = {.factor = 1, .settled = false};
  // It moves at strengths as they are.
  const auto capped = [&](double factor) { return moving ? std::min(factor, 1.0) : factor; };
  if (group.factors) {
    const Accuracy accuracy = accuracy_for(group.bodies.size());
    group.up = static_factor(island.part(group.bodies, Assembly::Others::fixed), accuracy);
    const Wide wide{group, island, moves};
    const Assembly alone = counting.part(group.bodies, Assembly::Others::fixed);
    const Assembly beside = counting.part(wide.bodies(), Assembly::Others::fixed);
    const Accuracy accuracy_beside = accuracy_for(wide.bodies().size());
    const FactorRange range{.begin = moving ? 1 : strongest, .fine = accuracy_beside == Accuracy::coarse ? 1e-4 : 1e-6};
    // With what moves beside it fixed the factor may be too large.
    const auto factor_in = [&](Freedom freedom) {
      MovingFactor found = moving_factor(alone.with(freedom), group.up.factor, accuracy);
      if (wide.bodies().size() > group.bodies.size()) {
        found.factor = std::min(found.factor, factor_of(wide.own(), beside.with(freedom), range, accuracy_beside));
      }
      found.factor = capped(found.factor);
      return found;
    };
    const auto lower_heaviest = [&](Freedom freedom, double least) {
      if (!moving || group.bodies.size() == 1) return;
      const double found = factor_of(wide.heaviest(), beside.with(freedom), {.least = least}, accuracy_beside);
      group.heaviest = std::min(group.heaviest.value_or(1), found);
    };
    group.moving = factor_in(island.freedom());
    lower_heaviest(island.freedom(), group.moving.factor);
    if (moving && !turns(island.freedom())) {
      const Freedom turning = flat(island.freedom()) ? Freedom::section : Freedom::rigid;
      group.turning = factor_in(turning);
      // More freedoms never raise what admits balance.
      group.turning->factor = std::min(group.turning->factor, group.moving.factor);
      lower_heaviest(turning, group.turning->factor);
    }
  }
  group.moving.factor = capped(group.moving.factor);
  // The proof caps what contacts press with, the factor does not.
  if (group.verdict == Verdict::certain) group.up.factor = std::min(group.up.factor, 1.0);
}

}  // namespace cleave::assembly
