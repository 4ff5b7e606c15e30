#include <algorithm>
#include <limits>
#include <utility>

#include "branch.hpp"
#include "cleave/assembly/groups.hpp"
#include "cleave/core/assert.hpp"
#include "cleave/core/parallel.hpp"

namespace cleave::assembly {
namespace {

/// Groups among a few bodies that move from rest, all others fixed.
std::vector<Group> moving_among(const Assembly& assembly, const std::vector<std::uint32_t>& bodies, Ask ask) {
  const Assembly part = assembly.part(bodies, Assembly::Others::fixed);
  if (!(project(part, std::numeric_limits<double>::infinity()).largest > slow)) return {};
  if (start_from_rest(part, 1).found != FromRest::moves) return {};
  std::vector<Group> out = find_groups(part, ask).groups;
  std::erase_if(out, [](const Group& group) { return group.verdict == Verdict::in_doubt; });
  for (Group& group : out) {
    for (std::uint32_t& b : group.bodies) b = bodies[b];
  }
  return out;
}

class SmallSearch final {
 public:
  SmallSearch(const Assembly& assembly, std::span<const std::uint8_t> open, std::span<const std::uint8_t> taken,
              Ask ask, ThreadLimit threads)
      : assembly_{assembly}, open_{open}, taken_{taken.begin(), taken.end()}, ask_{ask}, threads_{threads} {}

  std::vector<Group> run() {
    std::vector<std::vector<std::uint32_t>> sets;
    for (std::uint32_t b = 0; b < assembly_.bodies().size(); ++b) {
      if (open_[b] != 0 && taken_[b] == 0) sets.push_back({b});
    }
    look_at(sets);
    look_at(pairs());
    std::ranges::sort(groups_, {}, [](const Group& g) { return g.bodies.front(); });
    return std::move(groups_);
  }

 private:
  /// Neighbours of which one is open, in an order that does not hang on numbers.
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> pairs() const {
    std::vector<std::vector<std::uint32_t>> out;
    for (const Contact& contact : assembly_.contacts()) {
      if (!contact.other || contact.is_tie()) continue;
      const auto [a, b] = std::minmax(contact.body, *contact.other);
      if (taken_[a] != 0 || taken_[b] != 0 || (open_[a] == 0 && open_[b] == 0)) continue;
      out.push_back({a, b});
    }
    std::ranges::sort(out);
    out.erase(std::ranges::unique(out).begin(), out.end());
    std::ranges::stable_sort(out, {}, [&](const std::vector<std::uint32_t>& pair) {
      const double a = place_of(pair[0]), b = place_of(pair[1]);
      return std::pair{std::min(a, b), std::max(a, b)};
    });
    return out;
  }
  [[nodiscard]] double place_of(std::uint32_t body) const {
    return geometry::along_generic(assembly_.bodies()[body].centroid);
  }

  /// What is found first is taken; a set of which some was taken is left to the next state.
  void look_at(const std::vector<std::vector<std::uint32_t>>& sets) {
    auto found =
        parallel_map(sets.size(), threads_, [&](std::size_t k) { return moving_among(assembly_, sets[k], ask_); });
    for (std::vector<Group>& groups : found) {
      for (Group& group : groups) {
        if (std::ranges::any_of(group.bodies, [&](std::uint32_t b) { return taken_[b] != 0; })) continue;
        for (const std::uint32_t b : group.bodies) taken_[b] = 1;
        groups_.push_back(std::move(group));
      }
    }
  }

  const Assembly& assembly_;
  std::span<const std::uint8_t> open_;
  std::vector<std::uint8_t> taken_;
  Ask ask_;
  ThreadLimit threads_;
  std::vector<Group> groups_;
};

}  // namespace

std::vector<Group> find_small_groups(const Assembly& assembly, std::span<const std::uint8_t> open,
                                     std::span<const std::uint8_t> taken, Ask ask, unsigned threads) {
  CLEAVE_ASSERT(open.size() == assembly.bodies().size() && taken.size() == open.size());
  return SmallSearch{assembly, open, taken, ask, ThreadLimit{threads}}.run();
}

}  // namespace cleave::assembly
