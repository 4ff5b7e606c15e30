#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "trial.hpp"

/// What a step that was solved came to, and whether bodies share space after it.
namespace cleave::dbem {
namespace {

/// Speed of slip before it turns round in a step, over its change, that does not count.
constexpr double little_slip = 2e-3;

/// Whether a contact stuck at the end of the step before.
bool stuck_before(const std::vector<Contact>& contacts, const ContactCandidate& t) {
  const auto key = [](const Contact& c) { return ContactKey{c.vertex_body, c.vertex, c.edge_body, c.edge}; };
  const auto at = std::ranges::lower_bound(contacts, key_of(t), {}, key);
  return at != contacts.end() && key(*at) == key_of(t) && at->state == ContactState::stick;
}

}  // namespace

void Trial::note_contacts() {
  start_forces_.clear();
  for (std::size_t s = 0; s < out_.islands.size(); ++s) {
    start_forces_.push_back(w_.warm_start(moved_, out_.islands[s]));
    for (std::size_t k = 0; k < out_.islands[s].touches.size(); ++k) note_contact(s, k);
  }
  for (std::uint32_t b = 0; b < w_.bonds.size(); ++b) {
    if (w_.bonds[b].broken) continue;
    if (w_.torn_now[w_.bonds[b].section] != 0 || w_.lost(b) != Loss::none) out_.broken.push_back(b);
  }
}

void Trial::note_contact(std::size_t group, std::size_t contact) {
  const Rows& rows = rows_[group];
  const ContactCandidate& t = list_[out_.islands[group].touches[contact]];
  const Vec2 p = solutions_[group].impulse[contact];
  note_given_work(rows, contact, p);
  if (t.tie != no_tie) return note_tie(group, contact);
  const Vec2 now = w_.velocity_of(rows, contact, out_.state);
  const Vec2 old = w_.velocity_of(rows, contact, w_.state);
  const Bond* bond = w_.bond_of(t);
  const Vec2 soft = w_.compliance_of(t);
  const ContactCandidate& at = moved_[out_.islands[group].touches[contact]];
  const double bound = w_.friction_of(at, bond) * p.x / step_ + w_.cohesion_of(t);
  ContactState how = ContactState::stick;
  if (p == Vec2{}) {
    how = ContactState::open;
  } else if (std::abs(p.y) / step_ >= bound * (1 - 1e-9)) {
    how = ContactState::slip;
  }
  const bool turned = old.y * now.y < 0 && std::abs(old.y) > little_slip * std::abs(old.y - now.y);
  if (how == ContactState::slip || !stuck_before(w_.contacts, t))
    out_.friction += friction_work(group, contact, old, now);
  out_.report.slip_turned = out_.report.slip_turned || (turned && how == ContactState::slip);
  const double feature = std::min(w_.shapes[t.i].feature, w_.shapes[t.j].feature);
  const auto place = w_.bond_at(t);
  if (place && t.gap + step_ * now.x < 1e-7 * feature) out_.closed.push_back(*place);
  if (p != Vec2{}) out_.memory.push_back({key_of(t), p / step_, soft, t.point, t.normal});
  // In the axes of the edge, whatever slope of it the contact lies on.
  const Vec2 force = rotated(p / step_, at.tilt), passing = rotated(now, at.tilt);
  out_.contacts.push_back({t.i, t.vertex, t.j, t.edge, w_.anchor + at.point, rotated(at.normal, -at.tilt), t.gap,
                           force.x, force.y, passing.y, how, bond != nullptr});
}

/// What friction takes from slip: never less than nothing. Where slip turned round within the step, or the arms of a
/// contact that sticks turned, forces work that is not of slip: that is the scheme's.
double Trial::friction_work(std::size_t group, std::size_t contact, Vec2 old, Vec2 now) const {
  const Island& island = out_.islands[group];
  const double impulse = solutions_[group].impulse[contact].y;
  const double soft = w_.compliance_of(list_[island.touches[contact]]).y;
  if (soft == 0) return std::max(0.0, -impulse * 0.5 * (now.y + old.y));
  // Of a spring only what it does not give way by is slip.
  const double bent = soft * (impulse / step_ - start_forces_[group][contact].y);
  const double slip = step_ * (island.theta * now.y + (1 - island.theta) * old.y) + bent;
  return std::max(0.0, -impulse / step_ * slip);
}

void Trial::note_given_work(const Rows& rows, std::size_t contact, Vec2 p) {
  for (const std::size_t which : {2 * contact, 2 * contact + 1}) {
    const Side& side = rows.sides[which];
    const Shape& shape = w_.shapes[side.body];
    const Vec2 impulse = p.x * side.n + p.y * side.t;
    const Vec2 v = 0.5 * (out_.state.v[side.body] + w_.state.v[side.body]);
    if (shape.inverse_x == 0) out_.work -= impulse.x * v.x;
    if (shape.inverse_y == 0) out_.work -= impulse.y * v.y;
    if (shape.inverse_spin == 0) {
      out_.work -= (p.x * side.turn_n + p.y * side.turn_t) * out_.state.spin[side.body];
    }
  }
}

/// What slips or opens has lost its bond at once: it holds nothing in the step in which it does.
bool Trial::bonds_gave_way() {
  bool any = false;
  for (std::size_t s = 0; s < out_.islands.size(); ++s) {
    const std::vector<std::uint32_t>& touches = out_.islands[s].touches;
    for (std::size_t k = 0; k < touches.size(); ++k) {
      const ContactCandidate& t = list_[touches[k]];
      const Bond* bond = w_.bond_of(t);
      if (bond == nullptr) continue;
      const Vec2 p = solutions_[s].impulse[k], velocity = w_.velocity_of(rows_[s], k, out_.state);
      const double little = 1e-9 * std::min(w_.shapes[t.i].feature, w_.shapes[t.j].feature);
      const double bound = w_.friction_of(moved_[touches[k]], bond) * p.x / step_ + w_.cohesion_of(t);
      const bool torn = p.x / step_ <= -bond->tension && velocity.x * step_ > little;
      const bool slips = p != Vec2{} && std::abs(p.y) / step_ >= bound * (1 - 1e-9);
      if (!torn && !(slips && std::abs(velocity.y) * step_ > little)) continue;
      w_.lost_now[*w_.bond_at(t)] = torn ? Loss::torn : Loss::by_slip;
      any = true;
    }
  }
  if (any) solutions_.clear();  // other questions
  return any;
}

void Trial::note_loads() {
  double most_change = 0, most_pull = 0;
  for (std::size_t b = 0; b < w_.size(); ++b) {
    if (w_.idle(b)) continue;
    const Shape& shape = w_.shapes[b];
    double torque = 0;
    std::vector<double> modal;
    const Vec2 force = w_.force_on(w_.state, b, step_, torque, shape.timed || shape.stretches ? &modal : nullptr);
    const Vec2 other = force - shape.mass * w_.options.gravity;
    out_.work += dot(other, out_.state.x[b] - w_.state.x[b]) + torque * (out_.state.angle[b] - w_.state.angle[b]);
    for (std::size_t m = 0; m < modal.size(); ++m) {
      const std::size_t at = w_.first_mode[b] + m;
      out_.work += modal[m] * (out_.state.e[at] - w_.state.e[at]);
    }
    if (shape.mass > 0) most_pull = std::max(most_pull, norm(force) / shape.mass);
    const Vec2 dv = out_.state.v[b] - w_.state.v[b];
    double change = norm(dv) + std::abs(out_.state.spin[b] - w_.state.spin[b]) * shape.radius;
    const double speed = w_.speed_bound(out_.state, b);
    if (shape.modes > 0) change = std::max(change, speed);
    most_change = std::max(most_change, change / step_);
    out_.report.max_speed = std::max(out_.report.max_speed, speed);
  }
  out_.report.unbalanced = most_pull > 0 ? most_change / most_pull : most_change;
}

void Trial::part() {
  for (int pass = 0; pass < 3 && w_.separate_overlaps(out_, work_); ++pass) {
    double limit_again = 0;
    const double plan = std::max(w_.next_step, step_);
    w_.find(out_.state, out_.corners, out_.boxes, plan, out_.touches, out_.choices, limit_again);
    out_.limit = std::min(out_.limit, limit_again);
    clashes_ = w_.clashes_of(out_);
  }
}

std::optional<World::Impl::Failure> Trial::judge_overlaps() const {
  for (const Clash& clash : clashes_) {
    if (clash.depth <= clash.allowed + w_.shortened_by_springs(out_, clash.pair)) continue;
    return Failure{out_.report.residual,
                   fmt::format("bodies '{}' and '{}' run into one another", w_.bodies[clash.pair.a].name,
                               w_.bodies[clash.pair.b].name),
                   {},
                   true};
  }
  return std::nullopt;
}

}  // namespace cleave::dbem
