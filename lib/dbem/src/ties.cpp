#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "trial.hpp"
#include "world_impl.hpp"

/// Bolts between bodies: bars that pull and do not push. A bar is one more contact of its two bodies, along the line
/// between its ends, with a spring: the law of contact (no push, force by shortening) is that of a bar that is
/// lengthened. At its capacity it pulls with that for the whole step, and lengthens for good.
namespace cleave::dbem {

std::optional<WorldError> check_tie(const std::vector<Body>& bodies, const Tie& tie) {
  const auto bad = [&](std::string reason) { return BadTie{tie.name, std::move(reason)}; };
  const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
  if (tie.first >= bodies.size() || tie.second >= bodies.size()) return bad("names a body that is not there");
  if (tie.first == tie.second) return bad("both ends are in one body");
  for (const Vec2 at : {tie.at_first, tie.at_second}) {
    if (!std::isfinite(at.x) || !std::isfinite(at.y)) return bad("its ends must be finite");
  }
  if (!positive(tie.stiffness.si())) return bad("its stiffness must be above 0 and finite");
  if (!(tie.capacity.si() > 0)) return bad("its capacity must be above 0");
  if (!(tie.ductility.si() >= 0)) return bad("its ductility must not be negative");
  if (!(tie.pretension.si() >= 0 && tie.pretension.si() <= tie.capacity.si() && std::isfinite(tie.pretension.si()))) {
    return bad("its pretension must be from 0 to its capacity");
  }
  if (!(tie.installed.si() >= 0)) return bad("the time of its installation must not be negative");
  return std::nullopt;
}

std::optional<WorldError> World::Impl::make_ties() {
  for (const Tie& tie : ties) {
    if (auto bad = check_tie(bodies, tie)) return bad;
    std::array<BoundaryPoint, 2> ends{};
    for (const auto& [end, body, at] : {std::tuple{0U, tie.first, tie.at_first}, {1U, tie.second, tie.at_second}}) {
      ends.at(end) = nearest_on(shapes[body].corners, at - shapes[body].local_centroid);
    }
    tie_places.push_back(ends);
    bars.emplace_back();
    const auto [p, q] = tie_ends(bars.size() - 1, state);
    const double size = std::max(shapes[tie.first].radius, shapes[tie.second].radius);
    if (!(norm(q - p) > 1e-9 * size)) return BadTie{tie.name, "its ends are at one place"};
  }
  install_ties();
  energy.work = 0;  // what it took to tighten those that are there from the start
  return std::nullopt;
}

std::pair<Vec2, Vec2> JointState::tie_ends(std::size_t tie, const State& at) const {
  const auto end = [&](std::size_t body, Vec2 local, const BoundaryPoint& place) {
    const Shape& shape = shapes[body];
    Vec2 p = local - shape.local_centroid;
    if (shape.modes > 0) {
      const std::vector<double>& table = bodies[body].modes->shapes;
      const std::size_t next = place.edge + 1 == shape.corners.size() ? 0 : place.edge + 1;
      for (std::size_t m = 0; m < shape.modes; ++m) {
        const auto row = [&](std::size_t corner, std::size_t axis) {
          return table[(2 * corner + axis) * shape.modes + m];
        };
        p += at.e[first_mode[body] + m] * ((1 - place.share) * Vec2{row(place.edge, 0), row(place.edge, 1)} +
                                           place.share * Vec2{row(next, 0), row(next, 1)});
      }
    }
    return at.x[body] + rotated(p, at.angle[body]);
  };
  const Tie& of = ties[tie];
  return {end(of.first, of.at_first, tie_places[tie][0]), end(of.second, of.at_second, tie_places[tie][1])};
}

ContactCandidate JointState::touch_of_tie(std::size_t tie, const State& at) const {
  const auto [p, q] = tie_ends(tie, at);
  const double length = norm(q - p);
  return {.i = static_cast<std::uint32_t>(ties[tie].first),
          .vertex = static_cast<std::uint32_t>(tie_places[tie][0].edge),
          .j = static_cast<std::uint32_t>(ties[tie].second),
          .edge = static_cast<std::uint32_t>(tie_places[tie][1].edge),
          .gap = bars[tie].rest - length,
          .ratio = tie_places[tie][1].share,
          .normal = length > 0 ? (q - p) / length : Vec2{},
          .point = p,
          .tie = static_cast<std::uint32_t>(tie)};
}

std::vector<ContactCandidate> JointState::bars_at(const State& at) const {
  std::vector<ContactCandidate> out;
  for (std::size_t k = 0; k < bars.size(); ++k) {
    if (!bars[k].installed || bars[k].broken || (idle(ties[k].first) && idle(ties[k].second))) continue;
    ContactCandidate bar = touch_of_tie(k, at);
    if (bar.normal != Vec2{}) out.push_back(bar);
  }
  return out;
}

void World::Impl::install_ties() {
  for (std::size_t k = 0; k < ties.size(); ++k) {
    if (bars[k].installed || time < ties[k].installed.si() * (1 - 1e-12)) continue;
    const auto [p, q] = tie_ends(k, state);
    const double force = ties[k].pretension.si(), stored = 0.5 * force * force / ties[k].stiffness.si();
    bars[k].installed = true;
    bars[k].force = force;
    bars[k].rest = norm(q - p) - force / ties[k].stiffness.si();
    energy.work += stored;
    energy.elastic += stored;
    for (const std::size_t body : {ties[k].first, ties[k].second}) {
      if (asleep[body] == 0) continue;
      const std::uint32_t group = sleep_group[body];
      for (std::size_t b = 0; b < size(); ++b) {
        if (asleep[b] == 0 || sleep_group[b] != group) continue;
        asleep[b] = 0;
        calm[b] = 0;
      }
      fat.clear();
      look(next_step);
    }
  }
}

double JointState::until_next_tie() const {
  double soonest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < ties.size(); ++k) {
    if (!bars[k].installed) soonest = std::min(soonest, ties[k].installed.si() - time);
  }
  return soonest;
}

double JointState::elastic_of_ties() const {
  double sum = 0;
  for (std::size_t k = 0; k < ties.size(); ++k) sum += 0.5 * bars[k].force * bars[k].force / ties[k].stiffness.si();
  return sum;
}

// ---- in a step

void Trial::pull_ties() {
  // What yields is expected to go on; it is looked at again when it is known where it leads.
  for (const ContactCandidate& bar : w_.bars_at(w_.state)) {
    if (out_.bars[bar.tie].yielding) {
      pulling_.push_back(bar.tie);
    } else {
      list_.push_back(bar);
    }
  }
  settled_.assign(w_.ties.size(), 0);
}

void Trial::pull_with_capacity(const State& mid) {
  for (const std::uint32_t tie : pulling_) {
    const std::vector<ContactCandidate> one{w_.touch_of_tie(tie, mid)};
    Island island;
    island.touches = {0};
    const Rows rows = w_.rows_of(one, island, mid);
    w_.add_impulse(rows, 0, {step_ * w_.ties[tie].capacity.si(), 0}, {theta_[one[0].i], theta_[one[0].j]}, step_,
                   free_);
  }
}

bool Trial::ties_gave_way() {
  bool any = false;
  for (std::size_t s = 0; s < out_.islands.size(); ++s) {
    for (std::size_t k = 0; k < out_.islands[s].touches.size(); ++k) {
      const std::uint32_t tie = list_[out_.islands[s].touches[k]].tie;
      if (tie == no_tie) continue;
      const Tie& of = w_.ties[tie];
      if (solutions_[s].impulse[k].x <= step_ * of.capacity.si() * (1 + 1e-9)) continue;
      any = true;
      settled_[tie] = 1;
      if (of.ductility > Length{}) {
        pulling_.push_back(tie);
        out_.bars[tie].yielding = true;
      } else {
        break_bar(tie);
      }
    }
  }
  if (!any) return false;
  std::erase_if(list_, [&](const ContactCandidate& t) {
    return t.tie != no_tie && (out_.bars[t.tie].yielding || out_.bars[t.tie].broken);
  });
  solutions_.clear();  // other questions
  return true;
}

bool Trial::ties_hold_again() {
  bool any = false;
  for (std::size_t q = 0; q < pulling_.size();) {
    const std::uint32_t tie = pulling_[q];
    const auto [a, b] = w_.tie_ends(tie, out_.state);
    const double force = w_.ties[tie].stiffness.si() * (norm(b - a) - out_.bars[tie].rest);
    if (settled_[tie] != 0 || force >= w_.ties[tie].capacity.si() * (1 - 1e-9)) {
      ++q;
      continue;
    }
    settled_[tie] = 0;
    out_.bars[tie].yielding = false;
    list_.push_back(w_.touch_of_tie(tie, w_.state));
    pulling_.erase(pulling_.begin() + static_cast<std::ptrdiff_t>(q));
    any = true;
  }
  if (any) solutions_.clear();
  return any;
}

void Trial::break_bar(std::uint32_t tie) {
  Bar& bar = out_.bars[tie];
  out_.yielded += 0.5 * bar.force * bar.force / w_.ties[tie].stiffness.si();
  bar.broken = true;
  bar.yielding = false;
  bar.force = 0;
}

void Trial::note_tie(std::size_t group, std::size_t contact) {
  const ContactCandidate& t = list_[out_.islands[group].touches[contact]];
  out_.bars[t.tie].force = solutions_[group].impulse[contact].x / step_;
}

void Trial::note_yielding() {
  for (const std::uint32_t tie : pulling_) {
    const Tie& of = w_.ties[tie];
    Bar& bar = out_.bars[tie];
    const auto [a, b] = w_.tie_ends(tie, out_.state);
    const double longer = std::max(0.0, norm(b - a) - bar.rest - of.capacity.si() / of.stiffness.si());
    bar.rest += longer;
    bar.plastic += longer;
    bar.force = of.capacity.si();
    out_.yielded += of.capacity.si() * longer;
    if (bar.plastic >= of.ductility.si()) break_bar(tie);
  }
}

}  // namespace cleave::dbem
