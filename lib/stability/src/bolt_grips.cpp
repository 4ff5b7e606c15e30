#include "bolt_grips.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "cleave/core/disjoint_sets.hpp"

namespace cleave::stability {

using topology::BlockId;

namespace {

double grip_in(const Bolt& bolt, const Pierced& p) { return gripped_length(bolt.type, bolt.length.si(), p.from, p.to); }

}  // namespace

Grip grip_of(const BoltResult& bolt, BlockId block) {
  return grip_of(bolt, block, [](BlockId) { return true; });
}

Grip grip_of(const BoltResult& bolt, BlockId block, const std::function<bool(BlockId)>& stays) {
  Grip grip;
  bool found = false;
  for (const Pierced& p : bolt.pierced) {
    if (p.block == block) {
      if (!found) grip.first = p.from;
      found = true;
      grip.gripped += grip_in(bolt.bolt, p);
      grip.last = p.to;
      grip.behind = 0;
    } else if (found && stays(p.block)) {
      grip.behind += grip_in(bolt.bolt, p);
    }
  }
  grip.collar = !bolt.pierced.empty() && bolt.pierced.front().block == block;
  return grip;
}

bool gripped(const Grip& grip, const BoltType& type) {
  if (grip.collar && type.plate > newtons(0)) return true;
  return anchors(type, grip.gripped);
}

BodyGrip grip_of(const BoltResult& bolt, std::span<const BlockId> members, const std::function<bool(BlockId)>& stays) {
  BodyGrip grip;
  bool entered = false;
  for (const Pierced& p : bolt.pierced) {
    if (std::ranges::binary_search(members, p.block)) {
      entered = true;
      grip.inside += grip_in(bolt.bolt, p);
      grip.anchored = 0;
      grip.gripped = grip.gripped || gripped(grip_of(bolt, p.block), bolt.bolt.type);
    } else if (entered && stays(p.block)) {
      grip.anchored += grip_in(bolt.bolt, p);
    }
  }
  grip.collar = !bolt.pierced.empty() && std::ranges::binary_search(members, bolt.pierced.front().block);
  return grip;
}

std::vector<std::vector<BlockId>> stitched(const topology::BlockComplex& complex, const std::vector<BoltResult>& bolts,
                                           const std::function<bool(BlockId)>& count) {
  DisjointSets<std::uint32_t> bodies_of{complex.blocks().size()};
  for (const BoltResult& bolt : bolts) {
    std::optional<std::uint32_t> first;
    std::vector<BlockId> seen;
    for (const Pierced& p : bolt.pierced) {
      if (std::ranges::find(seen, p.block) != seen.end()) continue;
      seen.push_back(p.block);
      if (!count(p.block) || !gripped(grip_of(bolt, p.block), bolt.bolt.type)) continue;
      if (!first) first = p.block.value();
      bodies_of.join(*first, p.block.value());
    }
  }
  std::map<std::uint32_t, std::vector<BlockId>> groups;
  for (const BlockId id : complex.blocks().ids()) groups[bodies_of.find(id.value())].push_back(id);
  std::vector<std::vector<BlockId>> bodies;
  for (auto& [lowest, members] : groups) {
    if (members.size() > 1) bodies.push_back(std::move(members));
  }
  return bodies;
}

}  // namespace cleave::stability
