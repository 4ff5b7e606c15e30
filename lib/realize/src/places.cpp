#include "cleave/realize/places.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "cleave/stochastic/measure.hpp"

namespace cleave::scene {
namespace {

using geometry::Vec3;

void sort_and_drop_repeated(auto& values) {
  std::ranges::sort(values);
  const auto repeated = std::ranges::unique(values);
  values.erase(repeated.begin(), repeated.end());
}

/// Direction of the part of a polyline that holds this chainage.
Vec3 direction_at(const std::vector<Vec3>& axis, double chainage) {
  std::size_t i = 0;
  for (double left = chainage; i + 2 < axis.size(); ++i) {
    left -= geometry::norm(axis[i + 1] - axis[i]);
    if (left <= 0) break;
  }
  return geometry::normalized(axis[i + 1] - axis[i]);
}

}  // namespace

std::string_view location_of(double right, double up) {
  const double angle = std::atan2(right, up) * 180 / std::numbers::pi;  // from up to the right
  if (std::abs(angle) <= 45) return "roof";
  if (std::abs(angle) >= 135) return "floor";
  return angle > 0 ? "right wall" : "left wall";
}

std::vector<topology::JointId> joints_of(const topology::BlockComplex& complex, topology::BlockId block) {
  std::vector<topology::JointId> joints;
  for (const topology::FaceId id : complex.blocks()[block].faces) {
    const topology::Face& face = complex.faces()[id];
    if (face.joint) joints.push_back(*face.joint);
    for (const topology::Patch& patch : complex.patches(face)) {
      if (patch.joint) joints.push_back(*patch.joint);
    }
  }
  sort_and_drop_repeated(joints);
  return joints;
}

BlockPlace place_of(const RunResult& result, const topology::BlockComplex& complex, topology::BlockId block,
                    const std::vector<topology::JointId>& joints) {
  BlockPlace place{.centroid = complex.blocks()[block].centroid};
  for (const topology::JointId joint : joints) {
    if (joint.index() < result.joints.size()) place.sets.push_back(result.joints[joint].set);
  }
  sort_and_drop_repeated(place.sets);

  struct Opening {
    double area = 0;
    Vec3 towards;  ///< sum of outward area vectors
  };
  std::map<std::uint32_t, Opening> openings;  // by excavation
  for (const topology::FaceId id : complex.blocks()[block].faces) {
    const topology::Face& face = complex.faces()[id];
    if (face.role != topology::Role::free) continue;
    place.free_area += face.area;
    place.location = "face";
    if (!face.excavation || *face.excavation >= result.excavations.size()) continue;
    Opening& opening = openings[*face.excavation];
    opening.area += face.area.si();
    opening.towards += face.area.si() * face.outward;
  }
  const auto widest = std::ranges::max_element(openings, {}, [](const auto& entry) { return entry.second.area; });
  if (widest == openings.end()) return place;
  const auto& tunnel = result.excavations[widest->first].tunnel;
  if (!tunnel || tunnel->axis.size() < 2) return place;
  place.chainage = stochastic::chainage_of(tunnel->axis, place.centroid);
  const Vec3 axis = direction_at(tunnel->axis, *place.chainage);
  const Vec3 right = geometry::normalized(cross(axis, tunnel->up)), up = cross(right, axis);
  const Vec3 away = -widest->second.towards;
  const double across = std::hypot(dot(away, right), dot(away, up));
  if (across > std::abs(dot(away, axis))) place.location = location_of(dot(away, right), dot(away, up));
  return place;
}

}  // namespace cleave::scene
