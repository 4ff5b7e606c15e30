#include "trial.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cleave::dbem {
namespace {

/// Largest energy that contacts may bring in with a step, over the energy of the group.
constexpr double most_energy_gain = 1e-7;
/// Rounds of a try with contacts that came up in it.
constexpr std::size_t most_rounds = 8;
/// Steps for which what rattles is thought to go on rattling.
constexpr std::uint8_t rattles_for = 8;

constexpr auto no_group = static_cast<std::uint32_t>(-1);

}  // namespace

Trial::Trial(World::Impl& world, double step, std::size_t cut, Work& work, const SlipEnds& slip_ends, Attempt& out)
    : w_{world},
      step_{step},
      cut_{cut},
      work_{work},
      slip_ends_{slip_ends},
      out_{out},
      list_{world.touches},
      implicit_(world.size()) {
  w_.hint.resize(w_.size());
  for (std::size_t b = 0; b < w_.size(); ++b) implicit_[b] = w_.hint[b] > 0 ? 1 : 0;
  w_.torn_now.assign(w_.sections.size(), 0);
  w_.lost_now.assign(w_.bonds.size(), Loss::none);
  out_.bars = w_.bars;
  if (!w_.ties.empty()) pull_ties();
}

std::optional<World::Impl::Failure> Trial::run() {
  for (;;) {
    divide();
    if (auto failed = solve()) return failed;
    if (ties_gave_way()) continue;
    if (w_.tear_sections(list_, out_, solutions_, step_)) {
      solutions_.clear();  // other questions
      continue;
    }
    if (bonds_gave_way()) continue;
    if (const double share = until_slip_ends(); share != 1) return Failure{0, "", share, false, true};
    if (mean_rule_gained()) {
      ++out_.report.retries;
      continue;
    }
    if (auto failed = move()) return failed;
    if (ties_hold_again()) continue;
    if (auto failed = look()) return failed;
    if (out_.report.retries >= most_rounds || !contacts_came_up()) break;
    if (w_.wake(list_, std::numeric_limits<double>::infinity())) return Failure{0, "", 1};
    ++out_.report.retries;
  }
  note_contacts();
  note_yielding();
  note_loads();
  part();
  return judge_overlaps();
}

void Trial::divide() {
  groups_before_ = std::exchange(out_.islands, w_.islands_of(list_));
  solutions_before_ = std::exchange(solutions_, {});
  group_of_.assign(list_.size(), no_group);
  for (std::size_t s = 0; s < solutions_before_.size(); ++s) {
    group_of_[groups_before_[s].touches[0]] = static_cast<std::uint32_t>(s);
  }
  impulse_before_.clear();
  if (!solutions_before_.empty()) impulse_before_.resize(list_.size());
  for (std::size_t s = 0; s < solutions_before_.size(); ++s) {
    const std::vector<std::uint32_t>& touches = groups_before_[s].touches;
    for (std::size_t k = 0; k < touches.size(); ++k) impulse_before_[touches[k]] = solutions_before_[s].impulse[k];
  }
  w_.mark_impacts(list_, out_.islands, step_, implicit_, rows_);
  theta_.assign(w_.size(), w_.options.quasi_static ? 1.0 : 0.5);
  for (const Island& island : out_.islands) {
    for (const std::uint32_t b : island.bodies) theta_[b] = island.theta;
  }
  // Where impulses act: on the geometry at the share 1 - theta of the step. With arms about the centroids there,
  // angular momentum is kept exactly.
  State mid = w_.state;
  std::vector<Vec2> mid_corners = w_.corners;
  for (std::size_t b = 0; b < w_.size(); ++b) {
    if (w_.asleep[b] != 0 || theta_[b] >= 1) continue;
    w_.predict(w_.state, (1 - theta_[b]) * step_, b, mid);
    if (!w_.shapes[b].fixed || w_.state.v[b] != Vec2{} || w_.state.spin[b] != 0) w_.place(mid, b, mid_corners);
  }
  moved_ = list_;
  for (std::size_t s = 0; s < out_.islands.size(); ++s) {
    const Island& island = out_.islands[s];
    if (island.theta >= 1) continue;
    for (const std::uint32_t k : island.touches) {
      ContactCandidate& touch = moved_[k];
      const double gap = touch.gap;
      if (touch.tie != no_tie) {
        touch = w_.touch_of_tie(touch.tie, mid);
        touch.gap = gap;
        continue;
      }
      update_candidate(touch, w_.corners_of(mid_corners, touch.i), w_.corners_of(mid_corners, touch.j));
      w_.ride(touch, mid);
      touch.gap = gap;
    }
    rows_[s] = w_.rows_of(moved_, island, mid);
  }
  free_ = w_.state;
  w_.free_motion(w_.state, theta_, step_, free_);
  pull_with_capacity(mid);
}

std::optional<World::Impl::Failure> Trial::solve() {
  StepReport& report = out_.report;
  out_.state = free_;
  report.residual = 0;
  report.iterations = report.stick = report.slip = report.opened = 0;
  report.solved_by.fill(0);
  report.solves_by.fill(0);
  report.impact = false;
  for (std::size_t s = 0; s < out_.islands.size(); ++s) {
    if (auto failed = solve_group(s)) return failed;
  }
  return std::nullopt;
}

const ContactSolution* Trial::found_before(std::size_t group) const {
  const Island& island = out_.islands[group];
  const std::uint32_t s = group_of_[island.touches[0]];
  if (s == no_group) return nullptr;
  const Island& before = groups_before_[s];
  const bool same = before.theta == island.theta && before.impact == island.impact && before.touches == island.touches;
  return same ? &solutions_before_[s] : nullptr;
}

std::vector<Vec2> Trial::impulses_before(const Island& island) const {
  std::vector<Vec2> out;
  if (impulse_before_.empty()) return out;
  for (const std::uint32_t k : island.touches) {
    out.push_back(k < impulse_before_.size() ? impulse_before_[k] : Vec2{});
  }
  if (std::ranges::all_of(out, [](Vec2 p) { return p == Vec2{}; })) out.clear();
  return out;
}

std::optional<World::Impl::Failure> Trial::solve_group(std::size_t group) {
  Island& island = out_.islands[group];
  const Rows& rows = rows_[group];
  if (const ContactSolution* known = found_before(group)) {
    island.rebound = groups_before_[group_of_[island.touches[0]]].rebound;
    solutions_.push_back(*known);
  } else {
    solutions_.push_back(w_.solve_island(moved_, island, rows, free_, step_, cut_, impulses_before(island), work_));
  }
  const ContactSolution& found = solutions_.back();
  if (found.report.status == ContactReport::Status::not_converged) {
    return Failure{found.report.residual, work_.over()
                                              ? "the contact law was not met with the work that a step may take"
                                              : "the contact law was not met"};
  }
  if (const double share = w_.until_first_bounce(moved_, island, rows, found, step_); share < 1) {
    return Failure{0, "", share};
  }
  StepReport& report = out_.report;
  report.residual = std::max(report.residual, found.report.residual);
  report.iterations += found.report.iterations;
  report.stick += found.report.stick;
  report.slip += found.report.slip;
  report.opened += found.report.opened;
  ++report.solved_by[static_cast<std::size_t>(found.report.method)];
  report.solves_by[static_cast<std::size_t>(found.report.method)] += found.report.iterations;
  report.impact = report.impact || island.impact;
  for (std::size_t k = 0; k < island.touches.size(); ++k) {
    const Vec2 p = found.impulse[k];
    if (p != Vec2{}) w_.add_impulse(rows, k, p, island.theta, step_, out_.state);
  }
  const double gain = w_.energy_brought_in(moved_, island, rows, found, out_.state);
  if (gain > most_energy_gain) return Failure{gain, "its contacts bring in energy"};
  return std::nullopt;
}

bool Trial::mean_rule_gained() {
  bool gained = false;
  for (std::size_t s = 0; s < out_.islands.size(); ++s) {
    const Island& island = out_.islands[s];
    if (island.theta >= 1) continue;
    double gain = 0, size = 0;
    for (std::size_t k = 0; k < island.touches.size(); ++k) {
      const Vec2 p = solutions_[s].impulse[k];
      if (p == Vec2{} || list_[island.touches[k]].tie != no_tie) continue;
      gain += 0.5 * dot(p, w_.velocity_of(rows_[s], k, w_.state) + w_.velocity_of(rows_[s], k, out_.state));
    }
    for (const std::uint32_t b : island.bodies) {
      const Shape& shape = w_.shapes[b];
      size += shape.mass * (dot(w_.state.v[b], w_.state.v[b]) + shape.feature * norm(w_.options.gravity));
    }
    if (gain <= 1e-13 * size || w_.compliance_of(list_[island.touches[0]]) != Vec2{}) continue;
    for (const std::uint32_t b : island.bodies) {
      implicit_[b] = 1;
      w_.hint[b] = rattles_for;
    }
    gained = true;
  }
  return gained;
}

std::optional<World::Impl::Failure> Trial::move() {
  const State& from = w_.state;
  State& to = out_.state;
  double largest_turn = 0;
  double largest_move = 0;
  bool finite = true;
  for (std::size_t b = 0; b < w_.size(); ++b) {
    if (w_.asleep[b] != 0) continue;
    const double th = theta_[b];
    const Vec2 dx = step_ * (th * to.v[b] + (1 - th) * from.v[b]);
    const double turn = step_ * (th * to.spin[b] + (1 - th) * from.spin[b]);
    to.x[b] = from.x[b] + dx;
    to.angle[b] = from.angle[b] + turn;
    for (std::size_t m = w_.first_mode[b]; m < w_.first_mode[b + 1]; ++m) {
      to.e[m] = from.e[m] + step_ * (th * to.de[m] + (1 - th) * from.de[m]);
      finite = finite && std::isfinite(to.e[m]) && std::isfinite(to.de[m]);
    }
    largest_turn = std::max(largest_turn, std::abs(turn));
    const double move = norm(dx) + std::abs(turn) * w_.shapes[b].radius;
    finite = finite && std::isfinite(move);
    largest_move = std::max(largest_move, move);
  }
  out_.report.max_displacement = largest_move;
  if (!finite) return Failure{1, "the motion is not finite"};
  const double over =
      std::max(largest_turn / w_.options.rotation, largest_move / (w_.options.displacement * w_.height));
  if (over > 1) return Failure{0, "the displacement in a step is too large", 0.9 / over};
  return error_of_position();
}

std::optional<World::Impl::Failure> Trial::error_of_position() const {
  if (!w_.options.position_error || out_.report.impact) return std::nullopt;
  const double allowed = *w_.options.position_error;
  double error = 0;
  for (std::size_t b = 0; b < w_.size(); ++b) {
    if (w_.asleep[b] != 0) continue;
    const Vec2 change = (out_.state.v[b] - w_.state.v[b]) / step_ - w_.last_change[b];
    error = std::max(error, step_ * step_ * norm(change) / 12);
  }
  if (error <= allowed || step_ <= w_.options.step * 1e-3) return std::nullopt;
  return Failure{0, "the error of position in a step is too large",
                 std::clamp(0.9 * std::sqrt(allowed / error), 0.2, 0.9)};
}

std::optional<World::Impl::Failure> Trial::look() {
  w_.place_all(out_.state, out_.corners, out_.boxes);
  const double plan = std::max(w_.next_step, step_);
  w_.find(out_.state, out_.corners, out_.boxes, plan, out_.touches, out_.choices, out_.limit);
  // What sleeps does not move: what runs into it wakes it, and the step is redone.
  if (w_.wake(out_.touches, contact_depth)) return Failure{0, "", 1};
  clashes_ = w_.clashes_of(out_);
  return std::nullopt;
}

bool Trial::contacts_came_up() {
  const bool crossed = w_.add_crossed(out_, list_);
  const bool missed = w_.add_missed(out_, clashes_, list_);
  return crossed || missed;
}

}  // namespace cleave::dbem
