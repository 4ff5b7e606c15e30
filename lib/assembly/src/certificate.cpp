#include "cleave/assembly/groups.hpp"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "interval.hpp"

namespace cleave::assembly {
namespace {

using geometry::Vec3;

/// Unit normals, corners and centroids are exact to this share of their size.
constexpr double own_rounding = 0x1p-50;

Interval3 velocity_at(const Body& body, const Rate& rate, Vec3 point, Freedom freedom) {
  Interval3 v = Interval3::of(rate.velocity);
  if (!turns(freedom)) return v;
  const double scale = std::max(norm(point), norm(body.centroid));
  const Interval3 arm =
      Interval3::about(point, scale, own_rounding) - Interval3::about(body.centroid, scale, own_rounding);
  return v + cross(Interval3::of(rate.spin), arm);
}

/// Opening and at most the slip at a point.
struct Opening {
  Interval open;
  double slip;
};
Opening opening(const Assembly& assembly, const Contact& contact, const Motion& motion, Vec3 point) {
  Interval3 u = velocity_at(assembly.bodies()[contact.body], motion[contact.body], point, assembly.freedom());
  if (contact.other) {
    u = u - velocity_at(assembly.bodies()[*contact.other], motion[*contact.other], point, assembly.freedom());
  }
  const Interval3 n = Interval3::about(contact.normal, 1, own_rounding);
  const Interval open = dot(n, u);
  // Less the normal part: the length does not grow by taking another number of the interval for it.
  Interval3 slip = u - open * n;
  if (flat(assembly.freedom())) slip.y = {};
  return {open, longest(slip)};
}

bool still(const Rate& rate) { return norm(rate.velocity) == 0 && norm(rate.spin) == 0; }

/// At most what a contact takes up at these rates.
double charge_of(const Assembly& assembly, const Contact& contact, double factor, const Motion& motion, double most) {
  if (still(motion[contact.body]) && (!contact.other || still(motion[*contact.other]))) return 0;
  const double force = std::min(most, contact.most);
  const Interval friction = Interval::of(Interval::up(contact.friction / factor));
  double least = 0;  // of [mu |u_t| - u_n]_+ the largest: what presses does so at one of the points
  for (const Vec3 point : contact.points) {
    const Opening at = opening(assembly, contact, motion, point);
    least = std::max(least, (friction * Interval::of(at.slip) - at.open).high);
  }
  Interval charge = Interval::of(least) * Interval::of(least > 0 ? force : 0);
  for (const Bond& bond : contact.bonds) {
    // Slip is affine over a triangle: its mean length is at most that of the corners.
    Interval slip{}, open{};
    for (const Vec3 corner : bond.corners) {
      const Opening at = opening(assembly, contact, motion, corner);
      slip = slip + Interval::of(at.slip);
      open = open + Interval::of(std::max(0.0, at.open.high));
    }
    const Interval third = {Interval::down(1.0 / 3), Interval::up(1.0 / 3)};
    charge = charge + third * slip * Interval::of(Interval::up(bond.cohesion / factor));
    charge = charge + third * open * Interval::of(Interval::up(bond.tension / factor));
  }
  return charge.high;
}

}  // namespace

std::expected<MotionCertificate, Refused> check_motion(const Assembly& assembly, double factor, const Motion& motion,
                                                       double most) {
  if (motion.size() != assembly.bodies().size() || !(factor > 0)) return std::unexpected(Refused{});
  const double cap = most * assembly.load();
  Interval driving{};
  for (std::size_t b = 0; b < motion.size(); ++b) {
    const Body& body = assembly.bodies()[b];
    if (!is_finite(motion[b].velocity) || !is_finite(motion[b].spin)) return std::unexpected(Refused{});
    driving = driving + dot(Interval3::of(body.force), Interval3::of(motion[b].velocity));
    if (turns(assembly.freedom())) driving = driving + dot(Interval3::of(body.moment), Interval3::of(motion[b].spin));
  }
  Interval charge{};
  for (const Contact& contact : assembly.contacts()) {
    charge = charge + Interval::of(charge_of(assembly, contact, factor, motion, cap));
  }
  if (!(driving.low > charge.high)) return std::unexpected(Refused{driving.low, charge.high});
  return MotionCertificate{factor, motion, driving.low, charge.high, cap};
}

namespace {

/// Six rows a body, moments over `arm`, so that all are forces.
struct Column {
  std::uint32_t body;
  std::optional<std::uint32_t> other;
  Vec3 direction, at;
};

class Balance final {
 public:
  explicit Balance(const Assembly& assembly) : assembly_{assembly} {
    for (const Contact& contact : assembly.contacts()) {
      for (const Vec3 p : contact.points) {
        arm_ = std::max(arm_, norm(p - assembly.bodies()[contact.body].centroid));
      }
    }
    if (!(arm_ > 0)) arm_ = 1;
    lack_.resize(assembly.bodies().size());
    for (std::size_t b = 0; b < lack_.size(); ++b) {
      lack_[b] = {Interval3::of(assembly.bodies()[b].force), Interval3::of(assembly.bodies()[b].moment)};
    }
  }

  void add(const Contact& contact, Vec3 force, Vec3 at) {
    push(contact.body, Interval3::of(force), at);
    if (contact.other) push(*contact.other, Interval3::of(-force), at);
  }
  void span(const Contact& contact, Vec3 direction, Vec3 at) {
    columns_.push_back({contact.body, contact.other, direction, at});
  }

  /// Length of what balance lacks, at most.
  [[nodiscard]] double lack() const {
    double sum = 0;
    for (const auto& [force, moment] : lack_) {
      for (const double part : {shown(force, false), turns(assembly_.freedom()) ? shown(moment, true) / arm_ : 0.0}) {
        sum = Interval::up(sum + Interval::up(part * part));
      }
    }
    return Interval::up(std::sqrt(sum));
  }

  /// Whether all singular values of the columns are above `least`.
  [[nodiscard]] bool spans(double least) const {
    const auto n = static_cast<Eigen::Index>(6 * assembly_.bodies().size());
    std::vector<Eigen::Triplet<double>> entries;
    double trace = 0;
    for (const Column& c : columns_) {
      std::vector<std::pair<Eigen::Index, double>> own;
      rows(c.body, c.direction, c.at, own);
      if (c.other) rows(*c.other, -c.direction, c.at, own);
      for (const auto& [i, x] : own) {
        trace += x * x;
        for (const auto& [j, y] : own) entries.emplace_back(i, j, x * y);
      }
    }
    const double shift = std::max(least * least, 1e-11 * trace);
    // Rows that the freedom leaves out stand by themselves.
    for (Eigen::Index k = 0; k < n; ++k) entries.emplace_back(k, k, counts(k % 6) ? -shift : 1.0);
    Eigen::SparseMatrix<double> product(n, n);
    product.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor{product};
    return factor.info() == Eigen::Success;
  }

 private:
  [[nodiscard]] bool counts(Eigen::Index row) const {
    if (!turns(assembly_.freedom()) && row >= 3) return false;
    return !flat(assembly_.freedom()) || row == 0 || row == 2 || row == 4;
  }
  [[nodiscard]] double shown(const Interval3& a, bool moment) const {
    if (!flat(assembly_.freedom())) return longest(a);
    return moment ? a.y.size() : longest({a.x, {}, a.z});
  }
  void push(std::uint32_t body, const Interval3& force, Vec3 at) {
    auto& [sum, moment] = lack_[body];
    sum = sum + force;
    const Vec3 c = assembly_.bodies()[body].centroid;
    const double scale = std::max(norm(at), norm(c));
    moment =
        moment + cross(Interval3::about(at, scale, own_rounding) - Interval3::about(c, scale, own_rounding), force);
  }
  void rows(std::uint32_t body, Vec3 d, Vec3 at, std::vector<std::pair<Eigen::Index, double>>& out) const {
    const Vec3 m = cross(at - assembly_.bodies()[body].centroid, d) / arm_;
    const std::array<double, 6> all{d.x, d.y, d.z, m.x, m.y, m.z};
    for (Eigen::Index k = 0; k < 6; ++k) {
      if (counts(k)) out.emplace_back(6 * static_cast<Eigen::Index>(body) + k, all[static_cast<std::size_t>(k)]);
    }
  }

  const Assembly& assembly_;
  double arm_ = 0;
  std::vector<std::pair<Interval3, Interval3>> lack_;
  std::vector<Column> columns_;
};

}  // namespace

std::expected<RestCertificate, Refused> check_rest(const Assembly& assembly, double factor,
                                                   const ContactForces& forces) {
  if (forces.at_points.size() != assembly.contacts().size()) return std::unexpected(Refused{});
  Balance balance{assembly};
  double margin = std::numeric_limits<double>::infinity();
  const double counts = 1e-9 * assembly.load();
  for (std::size_t c = 0; c < assembly.contacts().size(); ++c) {
    const Contact& contact = assembly.contacts()[c];
    if (forces.at_points[c].size() != contact.points.size()) return std::unexpected(Refused{});
    const double mu = contact.friction / factor;  // 0 without strength
    for (std::size_t p = 0; p < contact.points.size(); ++p) {
      const Vec3 force = forces.at_points[c][p];
      const double normal = dot(force, contact.normal);
      const Vec3 shear = force - normal * contact.normal;
      // Only what presses well inside its cone may be changed; what does not press at all is left out.
      if (!(normal > counts)) continue;
      const double inside = mu > 0 ? (mu * normal - norm(shear)) / (1 + mu) : normal;
      if (!(inside > counts)) return std::unexpected(Refused{0, counts});
      const Vec3 used = mu > 0 ? force : normal * contact.normal;
      balance.add(contact, used, contact.points[p]);
      balance.span(contact, contact.normal, contact.points[p]);
      margin = std::min(margin, inside);
      if (!(mu > 0)) continue;
      const Vec3 first = normalized(std::abs(contact.normal.z) < 0.9 ? cross(contact.normal, {0, 0, 1})
                                                                     : cross(contact.normal, {1, 0, 0}));
      balance.span(contact, first, contact.points[p]);
      balance.span(contact, cross(contact.normal, first), contact.points[p]);
    }
  }
  const double lack = balance.lack();
  if (!(margin < std::numeric_limits<double>::infinity())) return std::unexpected(Refused{0, lack});
  // A change of |lack| / least singular value at most makes up for it; half the margin is kept.
  const double least = 2 * lack / margin;
  if (!balance.spans(least)) return std::unexpected(Refused{margin, lack});
  return RestCertificate{factor, margin, 0.5 * margin};
}

}  // namespace cleave::assembly
