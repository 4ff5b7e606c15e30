#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

#include "flow_run.hpp"

namespace cleave::scene {
namespace {

using geometry::Vec3;
using stability::FlowWater;
using topology::BlockId;

/// Integral of heads of pressure over a contact, and of them times the place.
struct Pressed {
  double total = 0;  ///< m3
  Vec3 first;        ///< m4
};

/// A corner of a triangle and the head of pressure there, m.
struct Corner {
  Vec3 at;
  double head;
};

/// Over the part of a triangle where the head of pressure is above 0; it is linear there, so this is exact.
void add(Pressed& sum, const std::array<Corner, 3>& triangle) {
  std::vector<Corner> wet;
  for (std::size_t i = 0; i < 3; ++i) {
    const Corner &p = triangle.at(i), &q = triangle.at((i + 1) % 3);
    if (p.head > 0) wet.push_back(p);
    if ((p.head > 0) != (q.head > 0)) {
      const double t = p.head / (p.head - q.head);
      wet.push_back({p.at + t * (q.at - p.at), 0});
    }
  }
  for (std::size_t i = 1; i + 1 < wet.size(); ++i) {
    const Corner &a = wet[0], &b = wet[i], &c = wet[i + 1];
    const double area = norm(cross(b.at - a.at, c.at - a.at)) / 2, heads = a.head + b.head + c.head;
    sum.total += area / 3 * heads;
    sum.first += area / 12 * ((a.head + heads) * a.at + (b.head + heads) * b.at + (c.head + heads) * c.at);
  }
}

std::vector<FlowWater::Contact> contacts_of(const topology::BlockComplex& complex, const flow::Flow& flow) {
  const std::vector<topology::JointPiece>& pieces = complex.network()->pieces;
  std::vector<Pressed> pressed(pieces.size());
  for (std::size_t t = 0; t < flow.mesh.triangles.size(); ++t) {
    if (flow.wet[t] == 0) continue;
    std::array<Corner, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 point = flow.mesh.points[flow.mesh.triangles[t].at(i)];
      corners.at(i) = {complex.origin() + point, flow.head[t].at(i).si() - point.z};
    }
    add(pressed[flow.mesh.part[t]], corners);
  }
  std::vector<FlowWater::Contact> contacts;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const auto& [above, below] = pieces[p].blocks;
    if (above == below || !(pressed[p].total > 0)) continue;  // it dangles: both sides are one block's
    const auto [x, y, z] = complex.planes()[pieces[p].plane].unit_normal();
    const Vec3 heads = pressed[p].total * Vec3{x, y, z}, at = pressed[p].first / pressed[p].total;
    contacts.push_back({above, below, heads, at});
    contacts.push_back({below, above, -heads, at});
  }
  std::ranges::stable_sort(contacts, {}, &FlowWater::Contact::block);
  return contacts;
}

}  // namespace

bool acts_on_blocks(const Scene& scene) {
  if (!scene.stability) return false;
  return scene.stability->loads.flow ||
         std::ranges::any_of(scene.stability->cases, [](const LoadCase& load) { return load.loads.flow.has_value(); });
}

FlowWater water_on_blocks(const Scene& scene, const topology::BlockComplex& complex, const FlowResult& result) {
  FlowWater water;
  if (result.flow) water.contacts = contacts_of(complex, *result.flow);
  for (const FlowSide& side : scene.flow->sides) {
    const bool open = std::ranges::find(scene.free_domain_tags, side.tag) != scene.free_domain_tags.end();
    if (open && side.level) water.standing.push_back({side.tag, side.level->si()});
  }
  return water;
}

}  // namespace cleave::scene
