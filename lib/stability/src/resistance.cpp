#include "resistance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "cleave/assembly/groups.hpp"

namespace cleave::stability {
namespace {

using geometry::Vec3;
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

/// A face that the motion is known to touch opens by nothing, whatever rounding says.
CohesionShares shares_of(const Contacts& contacts, const Resultant& resultant, const Motion& motion,
                         const Pressings& pressing, bool parallel_contact, std::uint32_t group) {
  const bool touches = std::ranges::binary_search(motion.touching, group);
  const double opens = geometry::dot(contacts.cone.groups()[group].unit(), motion.s) / geometry::norm(motion.s);
  return cohesion_shares(pressing, group, geometry::norm(resultant.newtons()), touches ? 0 : opens, parallel_contact);
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
    const CohesionShares share = shares_of(contacts, resultant, motion, pressing, parallel_contact, group);
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

/// What the tension of opening faces does against a unit motion. A face that a motion opens in a slant pulls aside,
/// too, and that must be balanced: by the tension and the cohesion of other opening faces, and by what presses. So it
/// is the most for which there is a balance, and by duality the least, over all velocities u with the same part along
/// the motion, of the work that tension, cohesion and friction do against u; nothing that touches is pushed in.
class OpeningTension final {
 public:
  OpeningTension(const Contacts& contacts, const Motion& motion, const Pressings& pressing, Vec3 along)
      : along_{along} {
    across_[0] = geometry::normalized(cross(along, std::abs(along.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
    across_[1] = cross(along, across_[0]);
    for (std::uint32_t group = 0; group < contacts.groups.size(); ++group) {
      const Contact& contact = contacts.groups[group];
      const Vec3 normal = contacts.cone.groups()[group].unit();
      if (std::ranges::find(motion.touching, group) != motion.touching.end()) {
        const auto presses = std::ranges::find(pressing, group, &Pressings::value_type::first);
        const double reaction = presses == pressing.end() ? 0 : presses->second;
        touching_.push_back({normal, reaction, reaction > 0 ? contact.tan_at(reaction) : 0});
        continue;
      }
      const double opens = dot(normal, along);
      if (!(opens > 0)) continue;
      straight_ += contact.tension * opens;
      opening_.push_back({normal, contact.tension, assembly::cohesion_share(opens) * contact.cohesion});
    }
  }

  /// N; a lower bound of that least, by the method of ellipsoids.
  [[nodiscard]] double least() const {
    if (!(straight_ > 0)) return 0;
    constexpr int most_rounds = 1000;
    constexpr double widest = 1e3;  // what is nearer to upright than one in this many is upright
    std::array<double, 2> at{0, 0};
    std::array<std::array<double, 2>, 2> axes{{{widest, 0}, {0, widest}}};  // of the ellipse that holds the least
    double best = straight_, bound = 0;
    for (int round = 0; round < most_rounds; ++round) {
      const auto [value, slope] = look(at);
      const std::array<double, 2> seen{axes[0][0] * slope[0] + axes[0][1] * slope[1],
                                       axes[1][0] * slope[0] + axes[1][1] * slope[1]};
      const double reach = std::hypot(seen[0], seen[1]);
      if (value) {
        best = std::min(best, *value);
        bound = std::max(bound, *value - reach);
        if (best - bound <= 1e-12 * straight_) break;
      }
      if (!(reach > 0)) break;
      const std::array<double, 2> turn{seen[0] / reach, seen[1] / reach};
      const std::array<double, 2> step{axes[0][0] * turn[0] + axes[1][0] * turn[1],
                                       axes[0][1] * turn[0] + axes[1][1] * turn[1]};
      for (std::size_t k = 0; k < 2; ++k) {
        at[k] -= step[k] / 3;
        for (std::size_t i = 0; i < 2; ++i) {
          axes[i][k] = 2 / std::numbers::sqrt3 * (axes[i][k] - (1 - std::numbers::inv_sqrt3) * turn[i] * step[k]);
        }
      }
    }
    return std::min(bound, straight_);
  }

 private:
  struct Opening {
    Vec3 normal;
    double tension, cohesion;  ///< N
  };
  struct Touching {
    Vec3 normal;
    double reaction, tan_friction;  ///< N
  };
  struct Seen {
    std::optional<double> value;  ///< none: the velocity is not allowed
    std::array<double, 2> slope;  ///< of the value, or of what forbids it
  };
  [[nodiscard]] Seen look(std::array<double, 2> v) const {
    const Vec3 u = along_ + v[0] * across_[0] + v[1] * across_[1];
    const auto parts = [&](Vec3 g) { return std::array{dot(g, across_[0]), dot(g, across_[1])}; };
    double value = 0;
    Vec3 slope{};
    for (const Touching& t : touching_) {
      constexpr double rounding = 1e-8;
      const double opens = dot(t.normal, u) - dot(t.normal, along_);  // along_ is on it but for rounding
      if (opens < -rounding) return {std::nullopt, parts(-t.normal)};
      if (opens <= t.tan_friction) continue;
      value += t.reaction * (opens - t.tan_friction);
      slope += t.reaction * t.normal;
    }
    for (const Opening& o : opening_) {
      const double opens = dot(o.normal, u);
      const Vec3 slips = u - opens * o.normal;
      if (opens > 0) {
        value += o.tension * opens;
        slope += o.tension * o.normal;
      }
      if (const double way = geometry::norm(slips); way > 0) {
        value += o.cohesion * way;
        slope += o.cohesion / way * slips;
      }
    }
    return {value, parts(slope)};
  }

  Vec3 along_;
  std::array<Vec3, 2> across_;
  std::vector<Opening> opening_;
  std::vector<Touching> touching_;
  double straight_ = 0;  ///< N, were nothing pulled aside
};

}  // namespace

CohesionShares cohesion_shares(std::span<const std::pair<std::uint32_t, double>> pressing, std::uint32_t group,
                               double load, double opens, bool parallel_contact) {
  double pressed = 0;
  for (const auto& [presses, reaction] : pressing) {
    if (presses == group && load > 0) pressed = assembly::cohesion_share(reaction / load);
  }
  const double touches = 1 - assembly::cohesion_share(opens);
  return {parallel_contact ? std::max(pressed, touches) : pressed, touches};
}

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
    const CohesionShares share = shares_of(contacts, resultant, motion, result.pressing, parallel_contact, group);
    result.strength.push_back(reaction * contact.tan_at(reaction) + share.counted * contact.cohesion);
  }
  const double opening = OpeningTension{contacts, motion, result.pressing, geometry::normalized(motion.s)}.least();
  result.least += opening;
  result.greatest += opening;
  return result;
}

}  // namespace cleave::stability
