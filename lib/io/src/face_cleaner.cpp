#include "face_cleaner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <variant>

#include "cleave/geometry/polygon.hpp"

namespace cleave::io {

using geometry::Vec3;

void FaceCleaner::add(std::span<const Vec3> corners, std::uint32_t group, std::uint32_t line) {
  std::vector<Vec3> ring;
  for (const Vec3& p : corners) {
    if (ring.empty() || ring.back() != p) ring.push_back(p);
  }
  while (ring.size() > 1 && ring.back() == ring.front()) ring.pop_back();
  const auto polygon = geometry::Polygon::make(ring);
  if (polygon) return add_simple(ring, group, line);
  const bool bent = std::holds_alternative<geometry::NotPlanar>(polygon.error());
  const bool crossing = std::holds_alternative<geometry::SelfCrossing>(polygon.error());
  if (!bent && !crossing) {
    ++flat_;
    return;
  }
  if (crossing) return add_simple(ring, group, line);  // for the user of the mesh to refuse
  ++cut_;
  add_simple(std::array{ring[0], ring[1], ring[2]}, group, line);
  add_simple(std::array{ring[0], ring[2], ring[3]}, group, line);
}

void FaceCleaner::add_simple(std::span<const Vec3> corners, std::uint32_t group, std::uint32_t line) {
  std::vector<Place> key;
  for (const Vec3& p : corners) key.emplace_back(p.x + 0.0, p.y + 0.0, p.z + 0.0);
  std::ranges::sort(key);
  if (!known_.insert(std::move(key)).second) {
    ++repeated_;
    return;
  }
  builder_.add_face(corners, group, line);
}

void FaceCleaner::describe(std::vector<std::string>& notes) const {
  if (cut_ > 0) notes.push_back(fmt::format("{} faces of four corners are not planar: cut along corners 1-3", cut_));
  if (flat_ > 0) notes.push_back(fmt::format("{} faces without area left out", flat_));
  if (repeated_ > 0) notes.push_back(fmt::format("{} faces given more than once left out", repeated_));
}

}  // namespace cleave::io
