#include "bolt_grips.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

namespace cleave::stability {

using topology::BlockId;

Grip grip_of(const std::vector<Pierced>& path, BlockId block) {
  Grip grip;
  bool found = false;
  for (const Pierced& p : path) {
    if (p.block == block) {
      if (!found) grip.first = p.from;
      found = true;
      grip.gripped += p.to - p.from;
      grip.last = p.to;
      grip.behind = 0;
    } else if (found) {
      grip.behind += p.to - p.from;
    }
  }
  grip.collar = !path.empty() && path.front().block == block;
  return grip;
}

bool gripped(const Grip& grip, const BoltType& type) {
  if (grip.collar && type.plate > 0) return true;
  return grip.gripped >= type.anchorage && grip.gripped > 0;
}

BodyGrip grip_of(const std::vector<Pierced>& path, std::span<const BlockId> members, const BoltType& type,
                 const std::function<bool(BlockId)>& stays) {
  BodyGrip grip;
  for (const Pierced& p : path) {
    if (std::ranges::binary_search(members, p.block)) {
      grip.inside += p.to - p.from;
      grip.anchored = 0;
      grip.gripped = grip.gripped || gripped(grip_of(path, p.block), type);
    } else if (grip.inside > 0 && stays(p.block)) {
      grip.anchored += p.to - p.from;
    }
  }
  grip.collar = !path.empty() && std::ranges::binary_search(members, path.front().block);
  return grip;
}

std::vector<std::vector<BlockId>> stitched(const topology::BlockComplex& complex, const std::vector<BoltResult>& bolts,
                                           const std::function<bool(BlockId)>& count) {
  std::vector<std::uint32_t> parent(complex.blocks().size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const BoltResult& bolt : bolts) {
    std::optional<std::uint32_t> first;
    std::vector<BlockId> seen;
    for (const Pierced& p : bolt.pierced) {
      if (std::ranges::find(seen, p.block) != seen.end()) continue;
      seen.push_back(p.block);
      if (!count(p.block) || !gripped(grip_of(bolt.pierced, p.block), bolt.bolt.type)) continue;
      const std::uint32_t here = root(p.block.value());
      if (!first) {
        first = here;
        continue;
      }
      const std::uint32_t there = root(*first);
      parent[std::max(here, there)] = std::min(here, there);
    }
  }
  std::map<std::uint32_t, std::vector<BlockId>> groups;
  for (const BlockId id : complex.blocks().ids()) groups[root(id.value())].push_back(id);
  std::vector<std::vector<BlockId>> bodies;
  for (auto& [lowest, members] : groups) {
    if (members.size() > 1) bodies.push_back(std::move(members));
  }
  return bodies;
}

}  // namespace cleave::stability
