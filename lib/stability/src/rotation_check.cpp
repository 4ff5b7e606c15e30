#include "rotation_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "assembly_of.hpp"
#include "cleave/assembly/groups.hpp"
#include "cleave/stability/analyse.hpp"
#include "flat.hpp"
#include "nonnegative.hpp"

namespace cleave::stability {
namespace {

using geometry::cross;
using geometry::dot;
using geometry::norm;
using geometry::Vec3;
using topology::BlockComplex;
using topology::BlockId;
using topology::Face;

/// Sides of the pyramid that stands for the friction cone. It is drawn around the cone, so that a block is said to turn
/// only when it does.
constexpr int sides = 16;

/// A face's contact with blocks that are there. `corners` span at least its convex hull, which is where the resultant
/// of any pressure on it can act.
struct Spot {
  Vec3 inward;
  double tangent = 0;
  std::vector<Vec3> corners;
  double cohesion = 0;  ///< N
  Vec3 centroid;        ///< of the cohesive part
};

std::vector<Spot> spots_of(Model& model, BlockId id, std::uint32_t batch, const Contacts& contacts,
                           const Verdict& verdict) {
  std::vector<Spot> spots;
  const BlockComplex& complex = model.complex();
  for (const topology::FaceId face_id : complex.blocks()[id].faces) {
    const Face& face = complex.faces()[face_id];
    if (face.role != topology::Role::joint) continue;
    Spot spot;
    double all = 0;
    bool whole = true;
    std::vector<BlockId> neighbours;
    for (const topology::Patch& patch : complex.patches(face)) {
      if (!patch.neighbour || !model.present(*patch.neighbour, batch)) {
        whole = false;
        continue;
      }
      neighbours.push_back(*patch.neighbour);
      const double cohesion = model.settings().strengths.of(patch.joint).cohesion().si() * patch.area.si() /
                              model.settings().partial.cohesion();
      spot.cohesion += cohesion;
      spot.centroid += cohesion * patch.centroid;
      all += patch.area.si();
    }
    if (neighbours.empty() || !(all > 0)) continue;
    if (spot.cohesion > 0) spot.centroid = spot.centroid / spot.cohesion;
    if (whole) {
      for (const auto& loop : complex.loops(face)) {
        for (const topology::VertexId v : loop) spot.corners.push_back(complex.position(v));
      }
    } else {
      std::ranges::sort(neighbours);
      neighbours.erase(std::ranges::unique(neighbours).begin(), neighbours.end());
      for (const BlockId neighbour : neighbours) {
        const std::vector<Vec3> corners = shared_corners(complex, face, neighbour);
        spot.corners.insert(spot.corners.end(), corners.begin(), corners.end());
      }
    }
    const Direction inward = model.inward(face);
    spot.inward = inward.unit();
    const auto groups = contacts.cone.groups();
    const auto group = static_cast<std::uint32_t>(std::ranges::find(groups, inward) - groups.begin());
    if (group >= contacts.groups.size()) continue;
    double reaction = 0;
    for (const auto& [pressing, n] : verdict.resistance.pressing) {
      if (pressing == group) reaction = n;
    }
    spot.tangent = contacts.groups[group].tan_at(reaction);
    spots.push_back(std::move(spot));
  }
  return spots;
}

/// Unit vectors in the plane to the corners of the pyramid; the middle of its first side looks against the motion,
/// where friction acts at the limit of sliding: there pyramid and cone are one.
std::vector<Vec3> around(Vec3 n, Vec3 motion) {
  Vec3 first = dot(motion, n) * n - motion;
  if (!(norm(first) > 1e-6)) first = std::abs(n.z) < 0.9 ? cross(n, {0, 0, 1}) : cross(n, {1, 0, 0});
  first = geometry::normalized(first);
  const Vec3 second = cross(n, first);
  std::vector<Vec3> out;
  for (int k = 0; k < sides; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.5) / sides;
    out.push_back(std::cos(angle) * first + std::sin(angle) * second);
  }
  return out;
}

}  // namespace

Rotation rotation_of(Model& model, BlockId id, std::uint32_t batch, const Contacts& contacts, const Verdict& verdict) {
  Rotation result;
  const Resultant resultant = model.applied_forces(id, batch);
  const double load = resultant.scale();
  if (!(load > 0)) return result;
  const Vec3 centre = model.complex().blocks()[id].centroid;
  const auto spots = spots_of(model, id, batch, contacts, verdict);
  double arm = 0;
  for (const Spot& spot : spots) {
    for (const Vec3 corner : spot.corners) arm = std::max(arm, norm(corner - centre));
  }
  const auto cohesive =
      static_cast<std::size_t>(std::ranges::count_if(spots, [](const Spot& spot) { return spot.cohesion > 0; }));
  const std::size_t rows = 6 + cohesive;
  Columns columns;
  const auto add = [&](Vec3 force, Vec3 at) -> std::vector<double>& {
    const Vec3 moment = arm > 0 ? cross(at - centre, force) / arm : Vec3{};
    std::vector<double> column(rows, 0);
    column[0] = force.x;
    column[1] = force.y;
    column[2] = force.z;
    column[3] = moment.x;
    column[4] = moment.y;
    column[5] = moment.z;
    columns.push_back(std::move(column));
    return columns.back();
  };
  const double widen = 1 / std::cos(std::numbers::pi / sides);
  std::size_t row = 6;
  for (const Spot& spot : spots) {
    const auto directions = around(spot.inward, verdict.direction);
    for (const Vec3 corner : spot.corners) {
      if (!(spot.tangent > 0)) {
        add(spot.inward, corner);
        continue;
      }
      for (const Vec3 t : directions) add(spot.inward + widen * spot.tangent * t, corner);
    }
    if (!(spot.cohesion > 0)) continue;
    // Shear up to c A, evenly spread: shares of it add up to one with what is not used.
    for (const Vec3 t : directions) add((widen * spot.cohesion / load) * t, spot.centroid)[row] = 1;
    columns.emplace_back(rows, 0);
    columns.back()[row++] = 1;
  }
  const Vec3 force = resultant.newtons() / load;
  const Vec3 moment = arm > 0 ? model.other_forces(id, batch).moment / (load * arm) : Vec3{};
  std::vector<double> wanted(rows, 1);
  wanted[0] = -force.x;
  wanted[1] = -force.y;
  wanted[2] = -force.z;
  wanted[3] = -moment.x;
  wanted[4] = -moment.y;
  wanted[5] = -moment.z;
  const NonNegative found = nonnegative_least_squares(columns, wanted);
  const Vec3 left_force{found.residual[0], found.residual[1], found.residual[2]};
  const Vec3 left_moment{found.residual[3], found.residual[4], found.residual[5]};
  result.lack = std::hypot(norm(left_force), norm(left_moment));
  result.turns = result.lack > 1e-6;
  if (!result.turns) {
    result.lack = 0;
  } else if (norm(left_moment) > 0) {
    result.axis = -left_moment / norm(left_moment);
  }
  return result;
}

Rotation rotation_from_rest(Model& model, BlockId id, std::uint32_t batch, const Contacts& contacts,
                            const Verdict& verdict) {
  Rotation result = rotation_of(model, id, batch, contacts, verdict);
  if (result.turns) return result;
  const assembly::Start start = assembly::start_from_rest(assembly_of(model, std::array{id}, batch), 1);
  if (start.found != assembly::FromRest::moves) return result;
  const assembly::Rate& rate = start.motion.at(0);
  double arm = 0;
  const BlockComplex& complex = model.complex();
  for (const topology::FaceId face : complex.blocks()[id].faces) {
    for (const auto& loop : complex.loops(complex.faces()[face])) {
      for (const topology::VertexId v : loop)
        arm = std::max(arm, norm(complex.position(v) - complex.blocks()[id].centroid));
    }
  }
  // What slides is judged by its factor of safety.
  if (!(arm * norm(rate.spin) > 1e-3 * norm(rate.velocity))) return result;
  result.turns = result.from_rest = true;
  result.axis = geometry::normalized(rate.spin);
  return result;
}

}  // namespace cleave::stability
