#include "balance.hpp"

#include <algorithm>
#include <cmath>

#include "interval.hpp"

namespace cleave::assembly {
namespace {

using geometry::Vec3;

/// Unit normals, corners and centroids are exact to this share of their size; forces to that of theirs.
constexpr double own_rounding = 0x1p-50, rounding_of_forces = 1e-9;

/// By how much a force is beyond what is carried; 0: not at all.
double beyond(Vec3 force, Vec3 normal, double least, double friction, double cohesion) {
  const double n = dot(force, normal), shear = norm(force - n * normal);
  const double slack = rounding_of_forces * norm(force);
  return std::max({0.0, least - n - slack, shear - (friction * std::max(0.0, n) + cohesion) - slack});
}

/// What one body is left with.
struct Left {
  Interval3 force, moment;
  double reach = 0;
};

class Sum final {
 public:
  explicit Sum(const Assembly& assembly) : assembly_{assembly} {
    for (const Body& body : assembly.bodies()) {
      left_.push_back({Interval3::of(body.force), Interval3::of(body.moment)});
    }
  }
  void add(const Contact& contact, Vec3 force, Vec3 at) {
    push(contact.body, force, at);
    if (contact.other) push(*contact.other, -force, at);
  }
  [[nodiscard]] std::vector<double> lack() const {
    std::vector<double> out;
    const double least = 1e-9 * assembly_.load();
    for (std::size_t b = 0; b < left_.size(); ++b) {
      const Body& body = assembly_.bodies()[b];
      const double reach = left_[b].reach > 0 ? left_[b].reach : 1;
      const bool moments = turns(assembly_.freedom());
      double lack = shown(left_[b].force, false), own = norm(body.force);
      if (moments) {
        lack = Interval::up(lack + Interval::up(shown(left_[b].moment, true) / reach));
        own = std::max(own, norm(body.moment) / reach);
      }
      own = std::max(own, least);
      out.push_back(own > 0 ? Interval::up(lack / own) : 0);
    }
    return out;
  }

 private:
  [[nodiscard]] double shown(const Interval3& a, bool moment) const {
    if (!flat(assembly_.freedom())) return longest(a);
    return moment ? a.y.size() : longest({a.x, {}, a.z});
  }
  void push(std::uint32_t body, Vec3 force, Vec3 at) {
    Left& left = left_[body];
    const Vec3 c = assembly_.bodies()[body].centroid;
    const double scale = std::max(norm(at), norm(c));
    const Interval3 arm = Interval3::about(at, scale, own_rounding) - Interval3::about(c, scale, own_rounding);
    left.force = left.force + Interval3::of(force);
    left.moment = left.moment + cross(arm, Interval3::of(force));
    left.reach = std::max(left.reach, norm(at - c));
  }
  const Assembly& assembly_;
  std::vector<Left> left_;
};

}  // namespace

std::expected<BalanceCertificate, Refused> check_balance(const Assembly& assembly, double factor,
                                                         const ContactForces& forces) {
  const std::vector<Contact>& contacts = assembly.contacts();
  if (forces.at_points.size() != contacts.size() || forces.at_bonds.size() != contacts.size() || !(factor > 0)) {
    return std::unexpected(Refused{});
  }
  Sum sum{assembly};
  const double counts = rounding_of_forces * assembly.load();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const Contact& contact = contacts[c];
    if (forces.at_points[c].size() != contact.points.size() || forces.at_bonds[c].size() != contact.bonds.size()) {
      return std::unexpected(Refused{});
    }
    bool presses = false;
    for (std::size_t p = 0; p < contact.points.size(); ++p) {
      const Vec3 force = forces.at_points[c][p];
      if (!is_finite(force)) return std::unexpected(Refused{});
      const double over = beyond(force, contact.normal, 0, contact.friction / factor, 0);
      if (over > counts) return std::unexpected(Refused{counts, over});
      presses = presses || dot(force, contact.normal) > 0;
      sum.add(contact, force, contact.points[p]);
    }
    for (std::size_t k = 0; k < contact.bonds.size(); ++k) {
      const Bond& bond = contact.bonds[k];
      const Vec3 force = forces.at_bonds[c][k];
      if (!is_finite(force)) return std::unexpected(Refused{});
      const double cohesion = presses ? bond.cohesion / factor : 0;
      const double over = beyond(force, contact.normal, -bond.tension / factor, 0, cohesion);
      if (over > counts || dot(force, contact.normal) > counts) return std::unexpected(Refused{counts, over});
      sum.add(contact, force, (1.0 / 3) * (bond.corners[0] + bond.corners[1] + bond.corners[2]));
    }
  }
  return BalanceCertificate{factor, sum.lack()};
}

}  // namespace cleave::assembly
