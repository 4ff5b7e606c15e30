#include "ties.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include "free_faces.hpp"

namespace cleave::stability {
namespace {

using geometry::cross;
using geometry::dot;
using geometry::norm;
using geometry::Vec3;
using topology::BlockId;

/// A block falls where nothing carries it: its rate is that of its load, to this share.
constexpr double free_fall = 1e-6;
/// Of the rates of two blocks, and of directions: a smaller difference is none.
constexpr double together = 1e-6;

bool falls(const Model& model, BlockId id, std::uint32_t batch, Vec3 velocity) {
  const double mass = model.settings().rock.density().si() * model.complex().blocks()[id].volume.si();
  const Vec3 own = model.applied_forces(id, batch).newtons() / mass;
  return norm(own) > 0 && norm(velocity - own) <= free_fall * norm(own);
}

assembly::Contact pull_between(std::uint32_t body, std::optional<std::uint32_t> other, Vec3 normal, Vec3 at,
                               double force) {
  assembly::Contact out;
  out.body = body;
  out.other = other;
  out.normal = normal;
  out.bonds.push_back({.corners = {at, at, at}, .cohesion = 0, .tension = force});
  return out;
}

}  // namespace

Ties::Ties(const topology::BlockComplex& complex, const Settings& settings, const SupportPlan& plan,
           std::span<const BoltResult> bolts, const KeyGroups& unsupported)
    : complex_{&complex},
      movement_(complex.blocks().size(), assembly::Rate{}),
      target_(complex.blocks().size(), plan.target_sliding) {
  const Model model{complex, settings};
  for (const KeyGroup& group : unsupported.groups) {
    for (std::size_t k = 0; k < group.blocks.size(); ++k) {
      movement_[group.blocks[k]] = group.rates[k];
      if (falls(model, group.blocks[k], group.batch, group.rates[k].velocity))
        target_[group.blocks[k]] = plan.target_falling;
    }
  }
  std::ranges::copy_if(bolts, std::back_inserter(bolts_), [](const BoltResult& b) { return b.pierced.size() > 1; });
  if (!plan.shotcrete) return;
  add_seams(*plan.shotcrete, [&](BlockId id) { return !model.present(id, 1); });
}

void Ties::add_seams(const Shotcrete& layer, const std::function<bool(BlockId)>& gone) {
  const double per_metre = held_per_metre(layer);
  const Sprayed sprayed{*complex_, layer, gone};
  std::map<std::array<std::uint32_t, 4>, std::size_t> at_edge;
  for (const BlockId id : complex_->blocks().ids()) {
    if (complex_->blocks()[id].fixed || gone(id)) continue;
    for (const KeyedEdge& edge : keyed_edges(*complex_, id, gone)) {
      if (!sprayed(complex_->faces()[edge.open])) continue;
      const Vec3 outward = complex_->faces()[edge.open].outward;
      for (const EdgePart& part : parts_along(*complex_, edge)) {
        const auto [from, to] = std::minmax({edge.from.value(), edge.to.value()});
        const auto [one, other] = std::minmax({id.value(), part.beyond.value()});
        const auto [twin, fresh] = at_edge.try_emplace({from, to, one, other}, seams_.size());
        Seam seam{id, part.beyond, part.middle, outward, per_metre * part.length};
        if (!fresh) {
          seam.outward_beyond = seams_[twin->second].outward;
          seams_[twin->second].outward_beyond = outward;
        }
        seams_.push_back(seam);
      }
    }
  }
}

Vec3 Ties::movement_at(BlockId block, Vec3 at) const {
  const assembly::Rate& rate = movement_[block];
  return rate.velocity + cross(rate.spin, at - complex_->blocks()[block].centroid);
}

/// A block by itself has its layer straight against its motion, out of the face at whatever angle: so it is here.
Ties::Pull Ties::pull_of(const Seam& seam) const {
  if (straight_out_) return {seam.outward, seam.force};
  const Vec3 own = movement_at(seam.block, seam.at), beyond = movement_at(seam.beyond, seam.at), apart = own - beyond;
  if (!(norm(apart) > together * (norm(own) + norm(beyond)))) return {seam.outward, seam.force};
  const Vec3 way = geometry::normalized(apart);
  if (!(dot(way, seam.outward) > along_face)) return {seam.outward, 0};
  if (norm(way - seam.outward) < together) return {seam.outward, seam.force};
  const bool both = seam.outward_beyond && dot(-way, *seam.outward_beyond) > along_face;
  return {way, both ? 0.5 * seam.force : seam.force};
}

Ties Ties::straight_out() const {
  Ties out = *this;
  out.straight_out_ = true;
  return out;
}

bool Ties::slants() const {
  return std::ranges::any_of(seams_, [&](const Seam& seam) {
    const Pull pull = pull_of(seam);
    return pull.force > 0 && pull.against != seam.outward;
  });
}

double Ties::target(BlockId block, BlockId other) const { return std::max(target_[block], target_[other]); }

std::vector<BlockId> Ties::with_tied(std::vector<BlockId> blocks) const {
  std::ranges::sort(blocks);
  const std::vector<BlockId> given = blocks;
  const auto asked = [&](BlockId id) { return std::ranges::binary_search(given, id); };
  for (const BoltResult& bolt : bolts_) {
    if (std::ranges::none_of(bolt.pierced, asked, &Pierced::block)) continue;
    for (const Pierced& piece : bolt.pierced) blocks.push_back(piece.block);
  }
  for (const Seam& seam : seams_) {
    if (asked(seam.block)) blocks.push_back(seam.beyond);
    if (asked(seam.beyond)) blocks.push_back(seam.block);
  }
  std::ranges::sort(blocks);
  blocks.erase(std::ranges::unique(blocks).begin(), blocks.end());
  return blocks;
}

std::vector<assembly::Contact> Ties::among(const Model& model, std::span<const BlockId> blocks,
                                           std::uint32_t batch) const {
  std::vector<assembly::Contact> out;
  const auto number = [&](BlockId id) -> std::optional<std::uint32_t> {
    const auto it = std::ranges::lower_bound(blocks, id);
    if (it == blocks.end() || *it != id) return std::nullopt;
    return static_cast<std::uint32_t>(it - blocks.begin());
  };
  const OwnerOf owner = [&](BlockId id) -> std::optional<std::optional<std::uint32_t>> {
    if (!model.present(id, batch)) return std::nullopt;
    return number(id);
  };
  for (const BoltResult& bolt : bolts_) {
    const Vec3 axis = bolt.bolt.direction;
    for (const BoltPull& pull : pulls_of(bolt, owner)) {
      const Vec3 apart = movement_[pull.block].velocity - movement_[pull.behind].velocity;
      const double counts =
          pull.force.si() * share_at_angle(bolt.bolt, apart).value_or(1) / target(pull.block, pull.behind);
      if (!(counts > 0)) continue;
      const Vec3 at = bolt.bolt.collar + pull.leaves * axis;
      out.push_back(pull.body ? pull_between(*pull.body, pull.other, -axis, at, counts)
                              : pull_between(*pull.other, std::nullopt, axis, at, counts));
    }
  }
  for (const Seam& seam : seams_) {
    const auto body = number(seam.block);
    if (!body || !model.present(seam.beyond, batch)) continue;
    const Pull pull = pull_of(seam);
    const double force = pull.force / target(seam.block, seam.beyond);
    if (force > 0) out.push_back(pull_between(*body, number(seam.beyond), pull.against, seam.at, force));
  }
  return out;
}

}  // namespace cleave::stability
