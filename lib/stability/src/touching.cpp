#include "touching.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "assembly_of.hpp"

namespace cleave::stability {
namespace {

using geometry::cross;
using geometry::dot;
using geometry::norm;
using geometry::Vec3;
using topology::BlockComplex;
using topology::BlockId;
using topology::Face;
using topology::FaceId;

std::vector<topology::VertexId> vertices_of(const BlockComplex& complex, const Face& face) {
  std::vector<topology::VertexId> out;
  for (const auto& loop : complex.loops(face)) out.insert(out.end(), loop.begin(), loop.end());
  std::ranges::sort(out);
  return out;
}

class Touching final {
 public:
  Touching(Model& model, std::span<const BlockId> movers, std::span<const BlockId> blocks)
      : model_{&model}, complex_{&model.complex()}, movers_{movers}, blocks_{blocks} {}

  std::vector<assembly::Contact> run(std::span<const assembly::Rate> rates) {
    for (std::size_t k = 0; k < movers_.size(); ++k) {
      const auto body = number(movers_[k]);
      if (!body) continue;
      for (const FaceId id : complex_->blocks()[movers_[k]].faces) {
        const Face& face = complex_->faces()[id];
        if (face.role == topology::Role::joint) look(rates[k], *body, face);
      }
    }
    return std::move(out_);
  }

 private:
  [[nodiscard]] std::optional<std::uint32_t> number(BlockId id) const {
    const auto it = std::ranges::lower_bound(blocks_, id);
    if (it == blocks_.end() || *it != id) return std::nullopt;
    return static_cast<std::uint32_t>(it - blocks_.begin());
  }
  [[nodiscard]] bool moves(BlockId id) const { return std::ranges::binary_search(movers_, id); }

  /// Blocks at rest beside those that touch the face from the other side.
  void look(const assembly::Rate& rate, std::uint32_t body, const Face& face) {
    std::set<BlockId> under, beside;
    for (const topology::Patch& patch : complex_->patches(face)) {
      if (patch.neighbour) under.insert(*patch.neighbour);
    }
    for (const BlockId id : under) {
      for (const FaceId other : complex_->blocks()[id].faces) {
        for (const topology::Patch& patch : complex_->patches(complex_->faces()[other])) {
          if (patch.neighbour && *patch.neighbour != face.block) beside.insert(*patch.neighbour);
        }
      }
    }
    for (const BlockId id : beside) {
      const auto other = number(id);
      if (!other || moves(id) || under.contains(id)) continue;
      for (const FaceId opposite : complex_->blocks()[id].faces) touch(rate, body, face, *other, opposite);
    }
  }

  void touch(const assembly::Rate& rate, std::uint32_t body, const Face& face, std::uint32_t other, FaceId opposite) {
    const Face& ground = complex_->faces()[opposite];
    if (ground.role != topology::Role::joint || ground.plane != face.plane ||
        ground.block_on_positive_side == face.block_on_positive_side) {
      return;
    }
    std::vector<topology::VertexId> shared;
    std::ranges::set_intersection(vertices_of(*complex_, face), vertices_of(*complex_, ground),
                                  std::back_inserter(shared));
    assembly::Contact contact{.body = body, .other = other, .normal = model_->inward(face).unit(), .points = {}};
    const Vec3 centre = complex_->blocks()[face.block].centroid;
    for (const topology::VertexId v : shared) {
      const Vec3 at = complex_->position(v);
      const Vec3 velocity = rate.velocity + cross(rate.spin, at - centre);
      if (dot(velocity, contact.normal) < -1e-3 * norm(velocity)) contact.points.push_back(at);
    }
    if (contact.points.empty()) return;
    for (const Face* side : {&face, &ground}) {
      for (const topology::Patch& patch : complex_->patches(*side)) {
        const double tangent = model_->settings().strengths.of(patch.joint).tan_friction();
        contact.friction = std::max(contact.friction, tangent / model_->settings().partial.friction());
      }
    }
    contact.most = most_pressure * face.area.si();
    out_.push_back(std::move(contact));
  }

  Model* model_;
  const BlockComplex* complex_;
  std::span<const BlockId> movers_, blocks_;
  std::vector<assembly::Contact> out_;
};

}  // namespace

std::vector<assembly::Contact> touching_contacts(Model& model, std::span<const BlockId> movers,
                                                 std::span<const assembly::Rate> rates,
                                                 std::span<const BlockId> blocks) {
  return Touching{model, movers, blocks}.run(rates);
}

}  // namespace cleave::stability
