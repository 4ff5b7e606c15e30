#include <algorithm>
#include <array>
#include <optional>

#include "world_impl.hpp"

namespace cleave::dbem {

/// Where a corner meets a corner, or an edge that goes on straight, the pair may be named anew from step to step: the
/// other body's corner, or the edge before or behind. What it carried is found under those names too, when the line is
/// the same.
std::optional<std::size_t> JointState::remembered(const ContactCandidate& t,
                                                  const std::vector<std::uint8_t>& taken) const {
  const auto find_key = [&](const ContactKey& key) {
    const auto at = std::ranges::lower_bound(memory, key, {}, &CachedContact::key);
    return at != memory.end() && at->key == key ? static_cast<std::size_t>(at - memory.begin()) : memory.size();
  };
  if (const std::size_t at = find_key(key_of(t)); at < memory.size()) return at;
  const auto next = [&](std::uint32_t corner, std::uint32_t body) {
    return corner + 1 == corner_count(body) ? 0U : corner + 1;
  };
  const auto before = [&](std::uint32_t corner, std::uint32_t body) {
    return corner == 0 ? static_cast<std::uint32_t>(corner_count(body)) - 1 : corner - 1;
  };
  const std::uint32_t corner = t.ratio < 0.5 ? t.edge : next(t.edge, t.j);
  const std::uint32_t other_edge = t.ratio < 0.5 ? before(t.edge, t.j) : next(t.edge, t.j);
  const std::array<ContactKey, 3> names{ContactKey{t.i, t.vertex, t.j, other_edge},
                                        ContactKey{t.j, corner, t.i, t.vertex},
                                        ContactKey{t.j, corner, t.i, before(t.vertex, t.i)}};
  for (const ContactKey& name : names) {
    const std::size_t at = find_key(name);
    if (at == memory.size() || (!taken.empty() && taken[at] != 0)) continue;
    const double along = dot(memory[at].normal, t.normal) * (name.i == t.i ? 1 : -1);
    const double feature = std::min(shapes[t.i].feature, shapes[t.j].feature);
    if (along >= 0.99 && norm(memory[at].point - t.point) <= 0.1 * feature) return at;
  }
  return std::nullopt;
}

std::vector<Vec2> ContactSolve::warm_start(const std::vector<ContactCandidate>& list, const Island& island) const {
  const std::size_t m = island.touches.size();
  std::vector<Vec2> force(m);
  std::vector<std::uint8_t> used(memory.size()), known(m);
  // Of springs that have got softer: they are as long as before.
  const auto take = [&](std::size_t k, std::size_t at) {
    const Vec2 soft = compliance_of(list[island.touches[k]]), was = memory[at].compliance;
    const double left = was.y > 0 && soft.y > was.y ? was.y / soft.y : 1.0;
    force[k] = {memory[at].force.x, left * memory[at].force.y};
    used[at] = known[k] = 1;
  };
  for (std::size_t k = 0; k < m; ++k) {
    const ContactCandidate& t = list[island.touches[k]];
    if (t.tie != no_tie) {
      force[k] = {bars[t.tie].force, 0};
      known[k] = 1;
      continue;
    }
    const auto at = std::ranges::lower_bound(memory, key_of(t), {}, &CachedContact::key);
    if (at != memory.end() && at->key == key_of(t)) take(k, static_cast<std::size_t>(at - memory.begin()));
  }
  for (std::size_t k = 0; k < m; ++k) {
    if (known[k] != 0) continue;
    // What it carried is that of (n, t) turned round together on the other body: the same.
    if (const auto at = remembered(list[island.touches[k]], used)) take(k, *at);
  }
  return force;
}

}  // namespace cleave::dbem
