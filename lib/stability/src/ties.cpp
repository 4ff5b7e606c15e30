#include "ties.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "bolt_grips.hpp"
#include "free_faces.hpp"

namespace cleave::stability {
namespace {

using geometry::dot;
using geometry::norm;
using geometry::Vec3;
using topology::BlockId;

/// A block falls where nothing carries it: its rate is that of its load, to this share.
constexpr double free_fall = 1e-6;

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
      movement_(complex.blocks().size(), Vec3{}),
      target_(complex.blocks().size(), plan.target_sliding) {
  const Model model{complex, settings};
  for (const KeyGroup& group : unsupported.groups) {
    for (std::size_t k = 0; k < group.blocks.size(); ++k) {
      movement_[group.blocks[k]] = group.rates[k].velocity;
      if (falls(model, group.blocks[k], group.batch, group.rates[k].velocity))
        target_[group.blocks[k]] = plan.target_falling;
    }
  }
  for (const BoltResult& bolt : bolts) add_bar(bolt);
  if (!plan.shotcrete) return;
  const double per_metre = held_per_metre(*plan.shotcrete);
  const std::function<bool(BlockId)> gone = [&](BlockId id) { return !model.present(id, 1); };
  for (const BlockId id : complex.blocks().ids()) {
    if (!complex.blocks()[id].fixed && !gone(id)) add_seams(id, per_metre, gone);
  }
}

void Ties::add_bar(const BoltResult& result) {
  const Bolt& bolt = result.bolt;
  Bar bar{.collar = bolt.collar, .axis = bolt.direction, .type = bolt.type, .pieces = {}};
  for (const Pierced& p : result.pierced) {
    const double grip = gripped_length(bolt.type, bolt.length.si(), p.from, p.to);
    const bool plate = &p == &result.pierced.front() && bolt.type.plate > newtons(0);
    bar.pieces.push_back({.block = p.block,
                          .to = p.to,
                          .grip = grip,
                          .capacity = bond_of(bolt.type) * grip + (plate ? bolt.type.plate.si() : 0),
                          .plate = plate});
  }
  if (bar.pieces.size() > 1) bars_.push_back(std::move(bar));
}

void Ties::add_seams(BlockId block, double per_metre, const std::function<bool(BlockId)>& gone) {
  for (const KeyedEdge& edge : keyed_edges(*complex_, block, gone)) {
    // Where several blocks lie beyond, the edge may run along any of them.
    std::optional<BlockId> beyond;
    bool one = true;
    for (const topology::Patch& patch : complex_->patches(complex_->faces()[edge.beyond])) {
      if (!patch.neighbour) continue;
      one = one && (!beyond || *beyond == *patch.neighbour);
      beyond = patch.neighbour;
    }
    if (!beyond || !one) continue;
    const Vec3 a = complex_->position(edge.from), b = complex_->position(edge.to);
    seams_.push_back({block, *beyond, 0.5 * (a + b), complex_->faces()[edge.open].outward, per_metre * norm(b - a)});
  }
}

double Ties::target(BlockId block, BlockId other) const { return std::max(target_[block], target_[other]); }

double Ties::efficiency(const Bar& bar, BlockId block, BlockId behind) const {
  if (bar.type.angle == AngleLaw::full) return 1;
  const Vec3 apart = movement_[block] - movement_[behind];
  const double along = -dot(apart, bar.axis);
  const double across = norm(apart + along * bar.axis);
  if (!(along > 0)) return 1;
  if (bar.type.angle == AngleLaw::cosine) return along / std::hypot(along, across);
  return 1 - std::atan2(across, along) * (2 * std::numbers::inv_pi);
}

/// Each piece pulls what it can, the outermost first and first at what lies deepest: forces that bond, plate, anchor
/// and tendon carry all at once, whichever of the pieces move.
void Ties::add_pulls(const Bar& bar, std::vector<Held> held, std::vector<assembly::Contact>& out) const {
  if (held.size() < 2) return;
  std::vector<double> tendon(held.size() - 1, bar.type.tendon.si());  // behind each piece
  double before = 0;
  for (std::size_t i = 0; i + 1 < held.size(); ++i) {
    Piece& near = held[i].piece;
    before += near.grip;
    double behind = 0;
    for (std::size_t j = held.size(); --j > i && near.capacity > 0;) {
      Piece& deep = held[j].piece;
      behind += deep.grip;
      const bool anchored = (near.plate || anchors(bar.type, before)) && anchors(bar.type, behind);
      if (!anchored || held[i].body == held[j].body) continue;
      const auto crossed = std::span{tendon}.subspan(i, j - i);
      const double force = std::min({near.capacity, deep.capacity, std::ranges::min(crossed)});
      if (!(force > 0)) continue;
      near.capacity -= force;
      deep.capacity -= force;
      for (double& left : crossed) left -= force;
      const double counts = force * efficiency(bar, near.block, deep.block) / target(near.block, deep.block);
      if (!(counts > 0)) continue;
      const Vec3 at = bar.collar + near.to * bar.axis;
      out.push_back(held[i].body ? pull_between(*held[i].body, held[j].body, -bar.axis, at, counts)
                                 : pull_between(*held[j].body, std::nullopt, bar.axis, at, counts));
    }
  }
}

std::vector<BlockId> Ties::with_tied(std::vector<BlockId> blocks) const {
  std::ranges::sort(blocks);
  const std::vector<BlockId> given = blocks;
  const auto asked = [&](BlockId id) { return std::ranges::binary_search(given, id); };
  for (const Bar& bar : bars_) {
    if (std::ranges::none_of(bar.pieces, asked, &Piece::block)) continue;
    for (const Piece& piece : bar.pieces) blocks.push_back(piece.block);
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
  for (const Bar& bar : bars_) {
    std::vector<Held> held;
    for (const Piece& piece : bar.pieces) {
      if (!model.present(piece.block, batch)) continue;
      const auto body = number(piece.block);
      if (held.empty() || held.back().body != body) {
        held.push_back({body, piece});
        continue;
      }
      Piece& own = held.back().piece;
      own.grip += piece.grip;
      own.capacity += piece.capacity;
      own.to = piece.to;
    }
    add_pulls(bar, std::move(held), out);
  }
  for (const Seam& seam : seams_) {
    const auto body = number(seam.block);
    if (!body || !model.present(seam.beyond, batch)) continue;
    const double force = seam.force / target(seam.block, seam.beyond);
    if (force > 0) out.push_back(pull_between(*body, number(seam.beyond), seam.outward, seam.at, force));
  }
  return out;
}

}  // namespace cleave::stability
