#include <algorithm>
#include <limits>
#include <utility>

#include "branch.hpp"
#include "cleave/assembly/groups.hpp"
#include "cleave/core/assert.hpp"
#include "cleave/core/parallel.hpp"

namespace cleave::assembly {
namespace {

using geometry::Vec3;

/// Whether anything would move without strength.
bool is_free(const Assembly& assembly) {
  return project(assembly, std::numeric_limits<double>::infinity()).largest > slow;
}

Assembly without_ties(const Assembly& assembly) {
  AssemblySpec spec{assembly.freedom(), assembly.bodies(), assembly.contacts()};
  std::erase_if(spec.contacts, [](const Contact& contact) { return contact.is_tie(); });
  auto made = Assembly::make(std::move(spec));
  CLEAVE_ASSERT(made.has_value());
  return *std::move(made);
}

/// All numbers that motion from rest depends on.
std::vector<double> numbers_of(const Assembly& assembly) {
  std::vector<double> out{static_cast<double>(assembly.freedom()), static_cast<double>(assembly.bodies().size())};
  const auto add = [&](Vec3 v) { out.insert(out.end(), {v.x, v.y, v.z}); };
  for (const Body& body : assembly.bodies()) {
    add(body.centroid);
    add(body.force);
    add(body.moment);
    out.push_back(body.mass);
    out.insert(out.end(), body.inertia.begin(), body.inertia.end());
  }
  for (const Contact& contact : assembly.contacts()) {
    out.push_back(contact.body);
    out.push_back(contact.other ? 1.0 + *contact.other : 0.0);
    add(contact.normal);
    out.push_back(contact.friction);
    out.push_back(static_cast<double>(contact.points.size()));
    for (const Vec3 point : contact.points) add(point);
    out.push_back(static_cast<double>(contact.bonds.size()));
    for (const Bond& bond : contact.bonds) {
      for (const Vec3 corner : bond.corners) add(corner);
      out.insert(out.end(), {bond.cohesion, bond.tension});
    }
  }
  return out;
}

/// Groups among a few bodies that move from rest, all others fixed.
std::vector<Group> moving_among(const Assembly& assembly, const std::vector<std::uint32_t>& bodies, Ask ask,
                                UntiedSets& untied) {
  const Assembly part = assembly.part(bodies, Assembly::Others::fixed);
  if (std::ranges::any_of(part.contacts(), &Contact::is_tie) && !untied.may_move(without_ties(part))) return {};
  if (!is_free(part) || start_from_rest(part, 1).found != FromRest::moves) return {};
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
              std::span<const std::uint8_t> among, Ask ask, ThreadLimit threads, UntiedSets& untied)
      : assembly_{assembly},
        open_{open},
        among_{among},
        taken_{taken.begin(), taken.end()},
        ask_{ask},
        threads_{threads},
        untied_{untied} {}

  std::vector<Group> run() {
    std::vector<std::vector<std::uint32_t>> sets;
    for (std::uint32_t b = 0; b < assembly_.bodies().size(); ++b) {
      if (open_[b] != 0 && taken_[b] == 0) sets.push_back({b});
    }
    look_at(std::move(sets));
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
  void look_at(std::vector<std::vector<std::uint32_t>> sets) {
    const auto asked = [&](std::uint32_t b) { return among_[b] != 0; };
    if (!among_.empty()) std::erase_if(sets, [&](const auto& set) { return std::ranges::none_of(set, asked); });
    auto found = parallel_map(sets.size(), threads_,
                              [&](std::size_t k) { return moving_among(assembly_, sets[k], ask_, untied_); });
    for (std::vector<Group>& groups : found) {
      for (Group& group : groups) {
        if (std::ranges::any_of(group.bodies, [&](std::uint32_t b) { return taken_[b] != 0; })) continue;
        for (const std::uint32_t b : group.bodies) taken_[b] = 1;
        groups_.push_back(std::move(group));
      }
    }
  }

  const Assembly& assembly_;
  std::span<const std::uint8_t> open_, among_;
  std::vector<std::uint8_t> taken_;
  Ask ask_;
  ThreadLimit threads_;
  UntiedSets& untied_;
  std::vector<Group> groups_;
};

}  // namespace

bool UntiedSets::may_move(const Assembly& assembly) {
  std::vector<double> key = numbers_of(assembly);
  {
    const std::lock_guard guard{lock_};
    if (const auto known = known_.find(key); known != known_.end()) return known->second;
  }
  const bool moves = is_free(assembly) && start_from_rest(assembly, 1).found != FromRest::rests;
  const std::lock_guard guard{lock_};
  known_.emplace(std::move(key), moves);
  return moves;
}

std::vector<Group> find_small_groups(const Assembly& assembly, std::span<const std::uint8_t> open,
                                     std::span<const std::uint8_t> taken, Ask ask, unsigned threads, UntiedSets* untied,
                                     std::span<const std::uint8_t> among) {
  CLEAVE_ASSERT(open.size() == assembly.bodies().size() && taken.size() == open.size());
  UntiedSets own;
  return SmallSearch{assembly, open, taken, among, ask, ThreadLimit{threads}, untied != nullptr ? *untied : own}.run();
}

}  // namespace cleave::assembly
