#include <algorithm>
#include <cmath>
#include <limits>

#include "world_impl.hpp"

namespace cleave::motion {

/// One rotation of all about their common centroid, added to their motion, that has this angular momentum. Returns the
/// kinetic energy that it brings in.
double World::Impl::turn_all(const Island& island, Vec3 angular, std::vector<State>& s) const {
  double mass = 0;
  Vec3 middle;
  for (const std::uint32_t b : island.bodies) {
    mass += shapes[b].mass;
    middle += shapes[b].mass * centroid(s[b], b);
  }
  middle = (1 / mass) * middle;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (const std::uint32_t b : island.bodies) {
    const Vec3 away = centroid(s[b], b) - middle;
    const Eigen::Vector3d r{away.x, away.y, away.z};
    inertia += mass_matrix(shapes[b], s[b].turn).bottomRightCorner<3, 3>() +
               shapes[b].mass * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
  }
  const Eigen::Vector3d rate = inertia.ldlt().solve(Eigen::Vector3d{angular.x, angular.y, angular.z});
  const Vec3 turning{rate[0], rate[1], rate[2]};
  double gained = 0;
  for (const std::uint32_t b : island.bodies) {
    const Vec3 more = cross(turning, centroid(s[b], b) - middle);
    const Vec3 spun = s[b].momentum + shapes[b].inertia * s[b].turn.back(turning);
    gained += shapes[b].mass * (dot(s[b].v, more) + 0.5 * dot(more, more)) -
              0.5 * dot(s[b].momentum, solve(shapes[b].inertia, s[b].momentum)) +
              0.5 * dot(spun, solve(shapes[b].inertia, spun));
    s[b].v += more;
    s[b].momentum = spun;
  }
  return gained;
}

double World::Impl::move_apart(const Island& island, const Solution& moved, std::vector<State>& s) const {
  double lift = 0;
  Vec3 gained;  // angular momentum
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    const std::uint32_t b = island.bodies[k];
    const Vector6& d = moved.velocity[k];
    const Vec3 by{d[0], d[1], d[2]};
    // The angular momentum in space stays; the energy of turning is counted with the lift.
    const Vec3 momentum = s[b].turn * s[b].momentum;
    lift -= shapes[b].mass * dot(pull, by) + 0.5 * dot(momentum, spin(s[b], b));
    s[b].shift += by;
    gained += shapes[b].mass * cross(by, s[b].v);
    s[b].turn = normalized(cayley({d[3], d[4], d[5]}) * s[b].turn);
    s[b].momentum = s[b].turn.back(momentum);
    lift += 0.5 * dot(momentum, spin(s[b], b));
  }
  // Bodies that lean on no wall keep their angular momentum.
  return island.leans ? lift : lift + turn_all(island, -gained, s);
}

double World::Impl::part(std::vector<State>& s, const std::vector<TieRecord>& tied, Look& seen, double& deepest) {
  // Again: parted bodies may touch what they did not touch before.
  constexpr int rounds = 8;
  constexpr double soft = 1e-5;
  // Overlaps of a block between two walls cannot all be parted: what is left is judged below.
  SolverOptions how = options.solver;
  how.patience = std::min<std::size_t>(how.patience, 100);
  double lift = 0;
  deepest = 0;
  for (int round = 0; round < rounds; ++round) {
    double deep = 0, wrong = 0;
    for (const Touch& t : seen.touches) {
      deep = std::max(deep, -t.gap);
      wrong = std::max(wrong, -t.gap / t.size);
    }
    std::vector<double> slack;
    for (const TieRecord& t : tied) {
      const bool counts = !t.broken && (moves(t.tie.body) || moves(t.tie.other));
      slack.push_back(counts ? slack_of(t, s) : 0);
      deep = std::max(deep, -slack.back());
      wrong = std::max(wrong, -slack.back() / t.length);
    }
    if (round == 0) deepest = deep;
    if (wrong <= 5e-3 * options.overlap) return lift;
    // What wedges between walls is left as it is: the look at all overlaps after the step decides.
    if (round + 1 == rounds) return lift;
    std::vector<double> travel(shapes.size(), 0);
    for (std::uint32_t b = 0; b < shapes.size(); ++b) travel[b] = moves(b) ? 4 * deep : 0;
    const std::vector<Touch> list = touches_of(near_pairs(travel), travel, false);
    for (const Island& island : islands_of(list)) {
      Island only = island;
      only.bonds.clear();
      bool overlapping = false;
      for (const std::uint32_t k : only.touches) overlapping = overlapping || list[k].gap < -1e-10 * list[k].size;
      for (const std::uint32_t k : only.ties) overlapping = overlapping || slack[k] < -1e-10 * tied[k].length;
      if (!overlapping) continue;
      std::erase_if(only.ties, [&](std::uint32_t k) { return tied[k].broken; });
      Group group = group_of(only, list, s, 1, 0);
      for (std::size_t k = 0; k < only.ties.size(); ++k) {
        Point& p = group.points[only.touches.size() + k];
        p.most = std::numeric_limits<double>::infinity();
        p.b = {slack[only.ties[k]], 0, 0};
        p.start.setZero();
      }
      for (std::size_t k = 0; k < only.touches.size(); ++k) {
        group.points[k].b = {list[only.touches[k]].gap, 0, 0};
        group.points[k].mu = 0;
        group.points[k].start.setZero();
      }
      for (Vector6& free : group.free) free.setZero();
      Solution moved = motion::solve(group, how);
      if (moved.report.status == SolveReport::Status::not_converged) moved = solve_softly(group, soft);
      lift += move_apart(only, moved, s);
    }
    place_all(s, false);
    seen = look();
  }
  return lift;
}

}  // namespace cleave::motion
