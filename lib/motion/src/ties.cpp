#include <algorithm>
#include <cmath>
#include <utility>

#include "world_impl.hpp"

/// Ties: where they pull, how far they come, and when they are gone.
namespace cleave::motion {

std::pair<Vec3, Vec3> World::Impl::ends_of(const TieRecord& tie, const std::vector<State>& s) const {
  const auto at = [&](std::uint32_t b, Vec3 end) { return centroid(s[b], b) + s[b].turn * (end - shapes[b].centroid); };
  return {at(tie.tie.body, tie.tie.end), at(tie.tie.other, tie.tie.other_end)};
}

double World::Impl::slack_of(const TieRecord& tie, const std::vector<State>& s) const {
  const auto [end, other] = ends_of(tie, s);
  return tie.length + tie.lengthened - norm(end - other);
}

void World::Impl::set_tie(const TieRecord& tie, double slack, double step, Point& p) {
  p.axial = true;
  for (Rows* rows : {&p.on_body, &p.on_other}) rows->rightCols<2>().setZero();
  p.most = tie.tie.capacity.si() * step;
  p.b = {std::max(slack, 0.0) / step, 0, 0};
  p.start = {tie.force * step, 0, 0};
}

void World::Impl::note_tie(std::uint32_t number, const Group& group, const Point& p, double impulse, double room,
                           double step, Attempt& out) const {
  TieRecord& tie = out.ties[number];
  tie.force = impulse / step;
  // Of a step that misses the law by its residual this is rounding.
  if (room >= -1e-6 * step * strongest()) return;
  // As the law is judged: an answer that is near enough may have a little less than the capacity where it gives.
  double mobility = p.on_body.col(0).dot(group.mass[p.body].llt().solve(p.on_body.col(0)));
  if (p.other) mobility += p.on_other.col(0).dot(group.mass[*p.other].llt().solve(p.on_other.col(0)));
  tie.gives = impulse - room / mobility >= p.most;
}

void World::Impl::lengthen_ties(Attempt& out) const {
  for (TieRecord& tie : out.ties) {
    if (!std::exchange(tie.gives, false)) continue;
    tie.lengthened += std::max(0.0, -slack_of(tie, out.state));
    tie.broken = tie.lengthened >= tie.tie.ductility.si();
    if (tie.broken) out.freed.insert(out.freed.end(), {tie.tie.body, tie.tie.other});
  }
}

bool World::Impl::wake_tied() {
  bool any = false;
  for (const TieRecord& tie : ties) {
    if (tie.broken || moves(tie.tie.body) == moves(tie.tie.other)) continue;
    for (const std::uint32_t b : {tie.tie.body, tie.tie.other}) {
      if (asleep[b] == 0) continue;
      asleep[b] = quiet[b] = 0;
      any = true;
    }
  }
  return any;
}

}  // namespace cleave::motion
