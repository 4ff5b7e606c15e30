#include "carriers.hpp"

#include <algorithm>
#include <numeric>

#include "cleave/core/disjoint_sets.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;

/// Bodies closer than this lie on one another, of the size of the smaller one.
constexpr double lies_within = 1e-3;

bool has_corner_at(const std::vector<Vec2>& of, const std::vector<Vec2>& sides, double near) {
  return std::ranges::any_of(of, [&](Vec2 p) {
    for (std::size_t k = 0; k < sides.size(); ++k) {
      const Vec2 a = sides[k], along = sides[k + 1 == sides.size() ? 0 : k + 1] - a;
      const double share = std::clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0);
      if (norm(p - a - share * along) <= near) return true;
    }
    return false;
  });
}

bool lie_together(const ContactBodyResult& a, const ContactBodyResult& b) {
  const double near = lies_within * std::min(a.size, b.size).si();
  return has_corner_at(a.outline, b.outline, near) || has_corner_at(b.outline, a.outline, near);
}

/// Pairs of bodies whose boxes come within reach, by a sweep from left to right.
template <class Visit>
void for_each_near_pair(const std::vector<ContactBodyResult>& bodies, const Visit& visit) {
  std::vector<Box2> boxes;
  for (const ContactBodyResult& body : bodies) {
    Box2 box = box_of(body.outline);
    const Vec2 wide = 0.5 * lies_within * body.size.si() * Vec2{1, 1};
    boxes.push_back({box.low - wide, box.high + wide});
  }
  std::vector<std::uint32_t> order(bodies.size()), open;
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t b) { return boxes[b].low.x; });
  for (const std::uint32_t b : order) {
    std::erase_if(open, [&](std::uint32_t a) { return boxes[a].high.x < boxes[b].low.x; });
    for (const std::uint32_t a : open) {
      if (boxes[a].low.y <= boxes[b].high.y && boxes[b].low.y <= boxes[a].high.y) visit(a, b);
    }
    open.push_back(b);
  }
}

}  // namespace

std::vector<std::vector<std::uint32_t>> carriers_of(const ContactScene& scene,
                                                    const std::vector<ContactBodyResult>& bodies) {
  std::vector<std::vector<std::uint32_t>> carriers(bodies.size());
  const auto moves = [&](std::uint32_t b) { return scene.bodies[b].motion.has_value(); };
  if (std::ranges::none_of(scene.bodies, [](const ContactBody& b) { return b.motion.has_value(); })) return carriers;
  DisjointSets<std::uint32_t> together{bodies.size()};
  std::vector<std::pair<std::uint32_t, std::uint32_t>> lies_on;  // a body, and a support
  for_each_near_pair(bodies, [&](std::uint32_t a, std::uint32_t b) {
    if ((bodies[a].fixed && bodies[b].fixed) || !lie_together(bodies[a], bodies[b])) return;
    if (bodies[a].fixed) {
      lies_on.emplace_back(b, a);
    } else if (bodies[b].fixed) {
      lies_on.emplace_back(a, b);
    } else {
      together.join(a, b);
    }
  });
  std::vector<std::vector<std::uint32_t>> of_group(bodies.size());
  for (const auto& [body, support] : lies_on) of_group[together.find(body)].push_back(support);
  for (std::vector<std::uint32_t>& group : of_group) {
    std::ranges::sort(group);
    group.erase(std::ranges::unique(group).begin(), group.end());
  }
  for (std::uint32_t b = 0; b < bodies.size(); ++b) {
    const std::vector<std::uint32_t>& group = of_group[together.find(b)];
    if (!bodies[b].fixed && std::ranges::any_of(group, moves)) carriers[b] = group;
  }
  return carriers;
}

Vec2 carried_by(const std::vector<std::uint32_t>& carriers, std::uint32_t body,
                const std::vector<ContactPlacement>& places, const std::vector<ContactBodyResult>& bodies) {
  Vec2 carried{};
  double farthest = -1;
  for (const std::uint32_t support : carriers) {
    const Vec2 way = places[support].centroid - bodies[support].start;
    const double far = norm(places[body].centroid - bodies[body].start - way);
    if (far <= farthest) continue;
    farthest = far;
    carried = way;
  }
  return carried;
}

}  // namespace cleave::scene
