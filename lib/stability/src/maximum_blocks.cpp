#include "cleave/stability/block_theory.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "contacts.hpp"
#include "supported_body.hpp"
#include "verdict.hpp"

namespace cleave::stability {
namespace {

using geometry::cross;
using geometry::dot;
using geometry::norm;
using geometry::Vec3;

/// Areas of the three joint faces: the face vectors of a closed body add up to zero.
std::array<double, 3> joint_areas(const std::array<Vec3, 3>& inward, Vec3 wall) {
  std::array<double, 3> areas{};
  const double det = dot(inward[0], cross(inward[1], inward[2]));
  for (std::size_t i = 0; i < 3; ++i) {
    areas[i] = std::max(0.0, -dot(wall, cross(inward[(i + 1) % 3], inward[(i + 2) % 3])) / det);
  }
  return areas;
}

struct Loaded {
  Contacts contacts;
  Resultant resultant;
};

/// Least pressure on the wall that reaches the target, Pa. More pressure never helps once it drives the block itself,
/// so the range is scanned before it is halved.
double required_pressure(const Loaded& loaded, const Settings& settings, const Verdict& bare, double target,
                         Vec3 wall) {
  const auto lack = [&](double pressure) {
    Resultant r = loaded.resultant;
    // Strength and support alike are divided by the target.
    r.add((pressure / target) * wall, pressure / target * norm(wall));
    const Verdict v = judge(loaded.contacts, r, settings);
    return v.driving - v.resistance.least / target;
  };
  const double enough = 1e-12 * bare.driving;
  if (!(bare.driving - bare.resistance.least / target > enough)) return 0;
  const double against = -dot(wall, bare.direction);
  const double limit = 4 * target * bare.driving / std::max(std::abs(against), 1e-3 * norm(wall));
  double below = 0;
  constexpr int steps = 64;
  for (int i = 1; i <= steps; ++i) {
    double above = limit * i / steps;
    if (lack(above) > enough) {
      below = above;
      continue;
    }
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (below + above);
      (lack(middle) > enough ? below : above) = middle;
    }
    return above;
  }
  return std::numeric_limits<double>::infinity();
}

double most(const std::vector<double>& lengths) { return lengths.empty() ? 0 : std::ranges::max(lengths); }

/// What brings the lengths of a block's joints down to those allowed.
double scale_of(const MaximumBlock& block, const Persistence& persistence) {
  const double trace = most(block.traces), size = most(block.extents);
  double scale = 1;
  if (trace > persistence.trace) scale = persistence.trace / trace;
  if (size > persistence.size) scale = std::min(scale, persistence.size / size);
  return scale;
}

}  // namespace

double MaximumKeyBlock::longest_trace() const noexcept { return most(block.traces); }
double MaximumKeyBlock::largest_extent() const noexcept { return most(block.extents); }

bool is_convex(std::span<const std::array<double, 2>> outline) {
  const std::size_t n = outline.size();
  double size = 0;
  for (const auto& c : outline) size = std::max({size, std::abs(c[0]), std::abs(c[1])});
  for (std::size_t i = 0; i < n; ++i) {
    const auto& a = outline[i];
    const auto& b = outline[(i + 1) % n];
    const auto& c = outline[(i + 2) % n];
    const double turn = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
    if (turn < -1e-12 * size * size) return false;
  }
  return n >= 3;
}

std::vector<MaximumKeyBlock> maximum_key_blocks(std::span<const TheoryPlane> planes, const ConvexTunnel& tunnel,
                                                const TheoryLoads& loads, const Persistence& persistence,
                                                double least) {
  std::vector<MaximumKeyBlock> found;
  if (planes.size() < 3) return found;
  const Settings settings{.rock = loads.rock, .strengths = StrengthTable{planes[0].strength}, .loads = loads.body};
  const Vec3 gravity = loads.body.gravity(), seismic = loads.body.seismic();
  const double weight_per_volume = loads.rock.density().si() * norm(gravity) * loads.partial.weight();
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t j = i + 1; j < planes.size(); ++j) {
      for (std::size_t k = j + 1; k < planes.size(); ++k) {
        const std::array<std::size_t, 3> chosen{i, j, k};
        std::vector<Direction> upward;
        for (const std::size_t p : chosen) upward.push_back(planes[p].upward);
        for (std::uint32_t code = 0; code < 8; ++code) {
          auto block = maximum_block(upward, code, tunnel);
          if (!block || !(block->volume > least)) continue;
          const double scale = scale_of(*block, persistence);
          block->scale(scale);
          MaximumKeyBlock row{.planes = chosen, .block = *block, .scale = scale};
          std::vector<Direction> rows;
          std::array<Vec3, 3> inward;
          for (std::size_t p = 0; p < 3; ++p) {
            rows.push_back(((code >> p) & 1U) != 0 ? upward[p].opposite() : upward[p]);
            inward[p] = rows.back().unit();
            row.upward[p] = upward[p].unit();
          }
          row.areas = joint_areas(inward, block->face_vector);
          Loaded loaded{.contacts = {.cone = Cone{rows}, .groups = {}, .exposed = true}, .resultant = {}};
          for (std::size_t p = 0; p < 3; ++p) {
            const JointStrength& strength = planes[chosen[p]].strength;
            Contact contact{.face = topology::FaceId{static_cast<std::uint32_t>(p)}};
            contact.area = row.areas[p];
            contact.divisor = loads.partial.friction();
            if (strength.curved()) {
              contact.curved.push_back({row.areas[p], strength});
            } else {
              contact.straight_area = row.areas[p];
              contact.tan_friction = strength.tan_friction() / loads.partial.friction();
            }
            contact.cohesion = strength.cohesion().si() * row.areas[p] / loads.partial.cohesion();
            contact.tension = strength.tension().si() * row.areas[p] / loads.partial.cohesion();
            loaded.contacts.groups.push_back(std::move(contact));
          }
          const double weight = weight_per_volume * block->volume;
          loaded.resultant = Resultant::along(gravity, newtons(weight));
          loaded.resultant.add(weight * seismic, weight * norm(seismic));
          const Verdict v = judge(loaded.contacts, loaded.resultant, settings);
          row.weight = newtons(weight);
          row.mode = v.mode;
          row.direction = v.direction;
          row.driving = newtons(v.driving);
          row.resistance = newtons(v.resistance.least);
          row.net = newtons(v.net);
          row.factor_of_safety = v.factor_of_safety;
          row.target = v.mode == Mode::falling || v.mode == Mode::lifting ? loads.target_falling : loads.target_sliding;
          if (moves(v.mode)) {
            keep_cohesion_of(v, loaded.resultant, settings.parallel_contact, loaded.contacts);
            row.required_pressure = required_pressure(loaded, settings, v, row.target, block->face_vector);
          }
          found.push_back(std::move(row));
        }
      }
    }
  }
  return found;
}

}  // namespace cleave::stability
