#include "cut_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "cleave/core/overloaded.hpp"
#include "cleave/core/rng.hpp"
#include "cleave/scene3d/bounds.hpp"

namespace cleave::scene {
namespace {

using geometry::Vec3;

/// The part of a joint's face that lies in the domain.
struct Plate {
  Vec3 normal;  // unit
  double area;  // m2
  std::uint32_t joint;
};

struct Plates {
  std::vector<Plate> all;
  double area = 0;
  std::vector<double> area_up_to;  // and with each plate
  double inner = 0;                // joints that do not reach the border of the domain
  double through = 0;              // joints without end
  double joints = 0;

  /// A plate drawn by its area; `u` in [0, 1).
  [[nodiscard]] const Plate& at(double u) const {
    const auto found = std::ranges::upper_bound(area_up_to, u * area);
    return all[static_cast<std::size_t>(std::min(found - area_up_to.begin(), std::ssize(all) - 1))];
  }
};

/// A square of the plane that holds its section with the box.
std::vector<Vec3> square(const topology::PersistentJoint& plane, Vec3 normal, const Box& box) {
  const Vec3 middle = 0.5 * (box.min + box.max);
  const double reach = norm(box.max - box.min);
  const Vec3 axis = std::abs(normal.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 along = reach * geometry::normalized(cross(normal, axis)), across = cross(normal, along);
  const Vec3 foot = middle - dot(middle - plane.through, normal) * normal;
  return {foot - along - across, foot + along - across, foot + along + across, foot - along + across};
}

/// `share`: of the box that is domain.
Plates plates_of(const SampledScene& drawn, const Box& box, double share) {
  Plates plates;
  const auto add = [&](Vec3 inside) {
    const double area = share * norm(inside);
    if (!(area > 0)) return false;
    plates.area += area;
    plates.all.push_back(
        {.normal = (1 / norm(inside)) * inside, .area = area, .joint = static_cast<std::uint32_t>(plates.joints)});
    plates.area_up_to.push_back(plates.area);
    return true;
  };
  const auto finite = [&](const topology::Joint& shape) {
    constexpr double rounding = 1e-9;
    bool met = false, within = true;
    for (const geometry::Polygon& polygon : shape.polygons) {
      const auto corners = polygon.corners();
      const Vec3 inside = area_within({corners.begin(), corners.end()}, box);
      within = within && norm(inside) >= (1 - rounding) * norm(area_vector(polygon)) / 2;
      met = add(inside) || met;
    }
    if (met && within) plates.inner += 1;
    return met;
  };
  const auto endless = [&](const topology::PersistentJoint& plane) {
    const bool met = add(area_within(square(plane, geometry::normalized(plane.normal), box), box));
    if (met) plates.through += 1;
    return met;
  };
  for (const auto& joint : drawn.input.joints) {
    if (std::visit(overloaded{finite, endless}, joint)) plates.joints += 1;
  }
  return plates;
}

/// Means over plates that are drawn by area: of the sine of the angle of two, of the determinant of three, and of the
/// chance that two of their size meet, over the product of their areas.
struct Means {
  double sine = 0, determinant = 0, meeting = 0;
};

Means means_of(const Plates& plates, double volume) {
  constexpr std::uint32_t draws = 4096;
  Means mean;
  for (std::uint32_t i = 0; i < draws; ++i) {
    Rng rng{{.seed = 0, .realization = 0, .purpose = 0, .index = i}};
    const Plate &a = plates.at(rng.uniform()), &b = plates.at(rng.uniform()), &c = plates.at(rng.uniform());
    if (a.joint == b.joint) continue;
    const Vec3 both = cross(a.normal, b.normal);
    mean.sine += norm(both) / draws;
    // Discs of these areas: the volume of the places where one meets the other (Minkowski's sum of the two).
    const double radius_a = std::sqrt(a.area / std::numbers::pi), radius_b = std::sqrt(b.area / std::numbers::pi);
    const double chance = 2 * (a.area * radius_b + b.area * radius_a) * norm(both) / volume;
    mean.meeting += std::min(1.0, chance) / (a.area * b.area) / draws;
    if (c.joint != a.joint && c.joint != b.joint) mean.determinant += std::abs(dot(both, c.normal)) / draws;
  }
  return mean;
}

}  // namespace

// Measured on grids, persistent planes, rectangles and discs of 1,000 to 120,000 blocks.
std::optional<Problem> too_large_for(double memory_mb, const Scene& scene, const SampledScene& drawn) {
  constexpr std::size_t least_joints = 100;  // fewer never fill a machine, and an estimate takes longer than their cut
  if (drawn.input.joints.size() < least_joints) return std::nullopt;
  const CutEstimate expected = estimate_cut(drawn);
  if (expected.memory_mb() <= memory_mb) return std::nullopt;
  return Problem{scene.shown, 1, "domain",
                 fmt::format("about {:.2g} blocks are expected, which take about {:.0f} GB; this machine has {:.0f} GB",
                             expected.blocks, expected.memory_mb() / 1000, memory_mb / 1000),
                 "make the domain smaller, take joints that matter less out, cut only what key blocks need "
                 "(output.blocks = \"key\"), or say with --memory what the run may take"};
}

double CutEstimate::memory_mb() const noexcept { return 3.4e-3 * joints + 2.2e-3 * pairs + 3e-3 * blocks; }
double CutEstimate::cut_s() const noexcept { return 6e-5 * faces + 1e-5 * joints + 6e-6 * pairs + 6e-6 * blocks; }
double CutEstimate::audit_s() const noexcept { return 2.4e-6 * blocks; }

/// The joints and the border of the domain are a surface; by Euler's formula, and where all hangs together without
/// tunnels, it divides the rock into 1 + (joints that border the rock all round) + (ends of lines of two joints at the
/// border) + (points of three joints) - (lines of two joints) + (joints inside) blocks. Of each, what plates of these
/// areas and attitudes have on average when they lie anywhere (Santalo 1976). Where each joint meets few others, most
/// of it hangs loosely and separates nothing.
CutEstimate estimate_cut(const SampledScene& drawn) {
  const Box box = box_of(drawn.input.domain);
  const Vec3 side = box.max - box.min;
  const double box_volume = side.x * side.y * side.z;
  const double share = std::min(1.0, drawn.input.domain.volume().si() / box_volume);
  const double volume = share * box_volume;
  const double border = 2 * (side.x * side.y + side.y * side.z + side.z * side.x) * std::cbrt(share * share);
  const Plates plates = plates_of(drawn, box, share);
  CutEstimate estimate{.faces = static_cast<double>(drawn.input.domain.faces().size()), .joints = plates.joints};
  for (const geometry::Solid& opening : drawn.input.excavations) {
    estimate.faces += static_cast<double>(opening.faces().size());
  }
  if (plates.all.empty()) return estimate;
  const Means mean = means_of(plates, volume);
  const double s = plates.area;
  estimate.pairs = s * s / 2 * mean.meeting;
  const double length = s * s / 2 * mean.sine / volume;  // of all lines of two joints
  const double ends = length / volume * border / 2;
  const double points = s * s * s / 6 * mean.determinant / (volume * volume);
  const double inner = std::max(0.0, points - estimate.pairs + plates.inner);
  // Met by two on average a network begins to close; by twenty nearly all of it does.
  const double met = 2 * estimate.pairs / plates.joints;
  const double endless_share = plates.through / plates.joints;
  const double closed = std::max(endless_share, 1 - std::exp(-met * met / 81));
  estimate.blocks = 1 + plates.through + closed * (ends + inner);
  estimate.blocks_low = std::max(1.0, 0.4 * estimate.blocks - 10);
  estimate.blocks_high = 2 * (1 + plates.joints + ends + inner);
  return estimate;
}

}  // namespace cleave::scene
