#include <algorithm>
#include <utility>

#include "world_impl.hpp"

namespace cleave::dbem {

bool ContactSearch::wake(const std::vector<ContactCandidate>& list, double closer) {
  if (std::ranges::none_of(asleep, [](std::uint8_t a) { return a != 0; })) return false;
  std::vector<std::uint8_t> rouse(groups, 0);
  bool any = false;
  for (const ContactCandidate& t : list) {
    if (t.gap > closer * std::min(shapes[t.i].feature, shapes[t.j].feature)) continue;
    for (const auto& [a, b] : {std::pair{t.i, t.j}, std::pair{t.j, t.i}}) {
      if (asleep[a] != 0 && !idle(b)) rouse[sleep_group[a]] = 1;
      if (asleep[a] != 0 && shapes[b].fixed && !still(b)) rouse[sleep_group[a]] = 1;
    }
  }
  for (std::size_t b = 0; b < size(); ++b) {
    if (asleep[b] != 0 && rouse[sleep_group[b]] != 0) {
      asleep[b] = 0;
      calm[b] = 0;
      any = true;
    }
  }
  if (any) fat.clear();
  return any;
}

void World::Impl::fall_asleep() {
  if (!options.sleep || options.ground || options.quasi_static) return;
  std::vector<ContactCandidate> joined = touches;
  for (const ContactCandidate& bar : bars_at(state)) joined.push_back(bar);
  const std::vector<Island> islands = islands_of(joined);
  const std::uint32_t before = groups;
  for (const Island& island : islands) {
    const auto moves = [&](std::uint32_t k) { return bodies[joined[k].i].moves || bodies[joined[k].j].moves; };
    bool quiet = std::ranges::none_of(island.touches, moves);
    for (const std::uint32_t b : island.bodies) {
      const bool now = !shapes[b].timed && speed_bound(state, b) < options.sleep_speed;
      calm[b] = static_cast<std::uint16_t>(now ? std::min<int>(calm[b] + 1, 1000) : 0);
      quiet = quiet && calm[b] >= 10;
    }
    if (!quiet) continue;
    for (const std::uint32_t b : island.bodies) {
      asleep[b] = 1;
      sleep_group[b] = groups;
      state.v[b] = {};
      state.spin[b] = 0;
      for (std::size_t m = first_mode[b]; m < first_mode[b + 1]; ++m) state.de[m] = 0;
    }
    ++groups;
  }
  if (groups == before) return;
  fat.clear();  // the list of pairs leaves sleeping ones out
  std::erase_if(touches, [&](const ContactCandidate& t) { return asleep[t.i] != 0 || asleep[t.j] != 0; });
}

}  // namespace cleave::dbem
