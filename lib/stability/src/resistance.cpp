#include "resistance.hpp"

#include <algorithm>
#include <utility>

namespace cleave::stability {
namespace {

using Pressings = std::vector<std::pair<std::uint32_t, double>>;

Pressings of_motion(const Motion& motion) {
  switch (motion.kind) {
    case MotionKind::none:
    case MotionKind::free:
    case MotionKind::held: return {};
    case MotionKind::one_plane: return {{motion.groups[0], motion.reactions[0]}};
    case MotionKind::two_planes:
      return {{motion.groups[0], motion.reactions[0]}, {motion.groups[1], motion.reactions[1]}};
  }
  std::unreachable();
}

/// What cohesion is worth at a face to which something stands at this small angle (sine): nothing at none, all from one
/// degree on. So nothing jumps where a wall stands exactly along the resultant, or the motion exactly along a wall.
double ramp(double sine) {
  constexpr double full = 0.01745240643728351;  // sin 1 degree
  return std::clamp(sine / full, 0.0, 1.0);
}

/// Which shares of a group's cohesion count, and of that of faces that do not open.
struct Shares {
  double counted = 0, touches = 0;
};
/// The resultant presses on some; `parallel_contact`: what does not open counts, too.
Shares shares_of(const Contacts& contacts, const Resultant& resultant, const Motion& motion, const Pressings& pressing,
                 bool parallel_contact, std::uint32_t group) {
  const double load = geometry::norm(resultant.newtons()), driving = geometry::norm(motion.s);
  double pressed = 0;
  for (const auto& [presses, reaction] : pressing) {
    if (presses == group && load > 0) pressed = ramp(reaction / load);
  }
  const double opens = geometry::dot(contacts.cone.groups()[group].unit(), motion.s) / driving;
  const double touches = std::ranges::binary_search(motion.touching, group) ? 1 : 1 - ramp(opens);
  return {parallel_contact ? std::max(pressed, touches) : pressed, touches};
}

struct Cohesion {
  double counted = 0;
  double left_out = 0;  ///< of faces that do not open
};
Cohesion cohesion_of(const Contacts& contacts, const Resultant& resultant, const Motion& motion,
                     const Pressings& pressing, bool parallel_contact) {
  Cohesion sum;
  for (std::uint32_t group = 0; group < contacts.groups.size(); ++group) {
    const double cohesion = contacts.groups[group].cohesion;
    if (!(cohesion > 0)) continue;
    const Shares share = shares_of(contacts, resultant, motion, pressing, parallel_contact, group);
    sum.counted += share.counted * cohesion;
    sum.left_out += std::max(0.0, share.touches - share.counted) * cohesion;
  }
  return sum;
}

double strength_of(const Contacts& contacts, const Resultant& resultant, const Motion& motion,
                   const Pressings& pressing, bool parallel_contact) {
  double sum = cohesion_of(contacts, resultant, motion, pressing, parallel_contact).counted;
  for (const auto& [group, reaction] : pressing) sum += reaction * contacts.groups[group].tan_at(reaction);
  return sum;
}

/// Tensile strength of the faces that open.
double tension(const Contacts& contacts, const Motion& motion) {
  const geometry::Vec3 along = geometry::normalized(motion.s);
  double sum = 0;
  for (std::uint32_t group = 0; group < contacts.groups.size(); ++group) {
    if (!(contacts.groups[group].tension > 0)) continue;
    sum += contacts.groups[group].tension * std::max(0.0, geometry::dot(contacts.cone.groups()[group].unit(), along));
  }
  return sum;
}

}  // namespace

Resistance resistance(const Contacts& contacts, const Resultant& resultant, const Motion& motion,
                      bool parallel_contact) {
  Resistance result;
  if (motion.kind == MotionKind::none || motion.kind == MotionKind::held) return result;
  result.pressing = of_motion(motion);
  result.least = strength_of(contacts, resultant, motion, result.pressing, parallel_contact);
  result.greatest = result.least;
  if (motion.kind != MotionKind::free && motion.touching.size() > result.pressing.size()) {
    const auto& touching = motion.touching;
    for (std::size_t a = 0; a < touching.size(); ++a) {
      for (std::size_t b = a + 1; b < touching.size(); ++b) {
        const auto pair = reactions(contacts.cone, resultant, touching[a], touching[b]);
        if (!pair) continue;
        Pressings pressing{{touching[a], pair->first}, {touching[b], pair->second}};
        const double sum = strength_of(contacts, resultant, motion, pressing, parallel_contact);
        result.greatest = std::max(result.greatest, sum);
        if (sum < result.least) {
          result.least = sum;
          result.pressing = std::move(pressing);
        }
      }
    }
  }
  result.cohesion_left_out = cohesion_of(contacts, resultant, motion, result.pressing, parallel_contact).left_out;
  for (const auto& [group, reaction] : result.pressing) {
    const Contact& contact = contacts.groups[group];
    const Shares share = shares_of(contacts, resultant, motion, result.pressing, parallel_contact, group);
    result.strength.push_back(reaction * contact.tan_at(reaction) + share.counted * contact.cohesion);
  }
  const double opening = tension(contacts, motion);
  result.least += opening;
  result.greatest += opening;
  return result;
}

}  // namespace cleave::stability
