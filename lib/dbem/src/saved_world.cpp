#include <algorithm>
#include <cmath>
#include <utility>

#include "cleave/core/archive.hpp"
#include "cleave/core/expected.hpp"
#include "world_impl.hpp"

/// A world as bytes, and back: what it carries from step to step. What follows from the bodies is made again.
namespace cleave::dbem {

template <class A>
void archive(A& a, Archived<State> auto& s) {
  a(s.x, s.angle, s.v, s.spin, s.e, s.de);
}
template <class A>
void archive(A& a, Archived<BodyPair> auto& p) {
  a(p.a, p.b);
}
template <class A>
void archive(A& a, Archived<ContactCandidate> auto& t) {
  a(t.i, t.vertex, t.j, t.edge, t.gap, t.ratio, t.normal, t.point, t.tilt, t.met);
}
template <class A>
void archive(A& a, Archived<Bar> auto& b) {
  a(b.rest, b.force, b.plastic, b.installed, b.broken, b.yielding);
}
template <class A>
void archive(A& a, Archived<CornerChoice> auto& c) {
  a(c.first, c.last);
}
template <class A>
void archive(A& a, Archived<ContactKey> auto& k) {
  a(k.i, k.vertex, k.j, k.edge);
}
template <class A>
void archive(A& a, Archived<CachedContact> auto& m) {
  a(m.key, m.force, m.compliance, m.point, m.normal);
}
template <class A>
void archive(A& a, Archived<Contact> auto& c) {
  a(c.vertex_body, c.vertex, c.edge_body, c.edge, c.point, c.normal, c.gap, c.normal_force, c.tangential_force,
    c.slip_velocity, c.bonded);
  a.word(c.state, ContactState::slip);
}
template <class A>
void archive(A& a, Archived<Energy> auto& e) {
  a(e.kinetic, e.potential, e.elastic, e.work, e.friction, e.projected, e.lost, e.yielded);
}

// What stays: for the name of a world.
template <class A>
void archive(A& a, const JointLaw& l) {
  const bool wet = l.water_table.has_value();
  a(l.friction, l.cohesion, l.tension, l.residual_cohesion, l.residual_friction, l.dilation, l.dilation_slip.si(),
    l.water_pressure.si(), wet, wet ? l.water_table->si() : 0.0, l.compliance, l.normal_stiffness.value_or(0),
    l.shear_stiffness.value_or(0), l.restitution);
}
template <class A>
void archive(A& a, const PairLaw& p) {
  a(p.a, p.b, p.law);
}
template <class A>
void archive(A& a, const ModalBasis& m) {
  a(m.omega, m.shapes, m.damping);
}
template <class A>
void archive(A& a, const PointForce& f) {
  a(f.at, f.force, f.follows);
}
template <class A>
void archive(A& a, const Tie& t) {
  a(t.name, t.first, t.second, t.at_first, t.at_second, t.stiffness.si(), t.capacity.si(), t.ductility.si(),
    t.pretension.si(), t.installed.si());
}
template <class A>
void archive(A& a, const Body& b) {
  a(b.name, b.outline, b.origin, b.density, b.mass, b.inertia, b.held.x, b.held.y, b.held.spin, b.velocity, b.spin,
    b.property, b.properties, b.modes, b.forces, static_cast<bool>(b.moves));
}

namespace {

constexpr std::string_view world_kind = "cleave-world";
constexpr std::uint32_t version_of_saved = 3;

std::string identity_of(const World::Impl& w) {
  ArchiveWriter a;
  a(w.bodies, w.laws.otherwise, w.laws.pairs, w.options.gravity, w.options.quasi_static, w.options.sleep,
    static_cast<bool>(w.options.ground), w.ties);
  return sha256_hex(a.bytes());
}

/// What changes, but for what is written in another form.
template <class A>
void archive_motion(A& a, Archived<World::Impl> auto& w) {
  a(w.time, w.next_step, w.calm_steps, w.seen_step, w.limit, w.state, w.fat, w.pairs, w.touches, w.choices, w.memory,
    w.asleep, w.calm, w.contacts, w.energy, w.start_energy, w.last_change, w.hint, w.slip_ends_in_a_row, w.bars);
}

/// Bonds that broke, and groups that sleep numbered as they come: what of them changes.
struct Marks {
  double step = 0;  // that was asked for
  std::vector<std::uint8_t> broken, opened;
  std::vector<std::uint32_t> sleep_group;
  std::uint32_t groups = 0;
  friend bool operator==(const Marks&, const Marks&) = default;
};
template <class A>
void archive(A& a, Archived<Marks> auto& m) {
  a(m.step, m.broken, m.opened, m.sleep_group, m.groups);
}

Marks marks_of(const World::Impl& w) {
  Marks out;
  out.step = w.options.step;
  out.sleep_group.assign(w.size(), 0);
  for (const Bond& bond : w.bonds) {
    out.broken.push_back(bond.broken ? 1 : 0);
    out.opened.push_back(bond.opened ? 1 : 0);
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> known;  // number before, number now
  for (std::size_t b = 0; b < w.size(); ++b) {
    if (w.asleep[b] == 0) continue;
    const std::uint32_t before = w.sleep_group[b];
    auto at = std::ranges::lower_bound(known, std::pair{before, 0U});
    if (at == known.end() || at->first != before) at = known.insert(at, {before, out.groups++});
    out.sleep_group[b] = at->second;
  }
  return out;
}

bool finite(double x) { return std::isfinite(x); }
bool finite(Vec2 v) { return std::isfinite(v.x) && std::isfinite(v.y); }
template <class List>
bool all_finite(const List& list, std::size_t size) {
  return list.size() == size && std::ranges::all_of(list, [](const auto& x) { return finite(x); });
}

bool is_pair(const World::Impl& w, std::uint32_t a, std::uint32_t vertex, std::uint32_t b, std::uint32_t edge) {
  return a < w.size() && b < w.size() && a != b && vertex < w.corner_count(a) && edge < w.corner_count(b);
}
bool is_touch(const World::Impl& w, const ContactCandidate& t) {
  return is_pair(w, t.i, t.vertex, t.j, t.edge) && finite(t.gap) && finite(t.ratio) && finite(t.normal) &&
         finite(t.point) && finite(t.tilt);
}

bool motion_is_sound(const World::Impl& w) {
  const std::size_t n = w.size();
  const State& s = w.state;
  return finite(w.time) && w.time >= 0 && finite(w.next_step) && w.next_step > 0 && finite(w.seen_step) &&
         w.seen_step >= 0 && w.limit >= 0 && all_finite(s.x, n) && all_finite(s.angle, n) && all_finite(s.v, n) &&
         all_finite(s.spin, n) && all_finite(s.e, w.first_mode.back()) && all_finite(s.de, w.first_mode.back()) &&
         all_finite(w.last_change, n) && w.asleep.size() == n && w.calm.size() == n &&
         (w.hint.empty() || w.hint.size() == n) && finite(w.energy.total()) && finite(w.energy.work) &&
         finite(w.energy.friction) && finite(w.energy.projected) && finite(w.energy.lost) && finite(w.start_energy);
}

bool bars_are_sound(const World::Impl& w) {
  return w.bars.size() == w.ties.size() && std::ranges::all_of(w.bars, [](const Bar& b) {
           return finite(b.rest) && finite(b.force) && b.force >= 0 && finite(b.plastic);
         });
}

bool contacts_are_sound(const World::Impl& w) {
  const std::size_t n = w.size();
  const auto boxes = [&](const Box2& box) { return finite(box.low) && finite(box.high); };
  const auto pair = [&](const BodyPair& p) { return p.a < p.b && p.b < n; };
  const auto touch = [&](const ContactCandidate& t) { return is_touch(w, t); };
  const auto choice = [&](const CornerChoice& c) { return is_touch(w, c.first) && is_touch(w, c.last); };
  const auto remembered = [&](const CachedContact& m) {
    return is_pair(w, m.key.i, m.key.vertex, m.key.j, m.key.edge) && finite(m.force) && finite(m.compliance) &&
           finite(m.point) && finite(m.normal);
  };
  const auto contact = [&](const Contact& c) {
    return is_pair(w, c.vertex_body, c.vertex, c.edge_body, c.edge) && finite(c.point) && finite(c.normal);
  };
  return (w.fat.empty() || w.fat.size() == n) && std::ranges::all_of(w.fat, boxes) &&
         std::ranges::all_of(w.pairs, pair) && std::ranges::all_of(w.touches, touch) &&
         std::ranges::all_of(w.choices, choice) && std::ranges::all_of(w.memory, remembered) &&
         std::ranges::is_sorted(w.memory, {}, &CachedContact::key) && std::ranges::all_of(w.contacts, contact);
}

bool marks_are_sound(const World::Impl& w, const Marks& marks) {
  bool sound = finite(marks.step) && marks.step > 0 && marks.broken.size() == w.bonds.size() &&
               marks.opened.size() == w.bonds.size() && marks.sleep_group.size() == w.size() &&
               marks.groups <= w.size();
  for (std::size_t b = 0; sound && b < w.size(); ++b) sound = w.asleep[b] == 0 || marks.sleep_group[b] < marks.groups;
  return sound;
}

}  // namespace

std::string World::saved() const {
  ArchiveWriter a;
  a(identity_of(*impl_));
  archive_motion(a, std::as_const(*impl_));
  a(marks_of(*impl_));
  return sealed(world_kind, version_of_saved, a.bytes());
}

std::expected<void, SavedFault> World::restore(std::string_view saved) {
  CLEAVE_TRY(ArchiveReader a, unsealed_of(identity_of(*impl_), world_kind, version_of_saved, saved));
  Impl w = *impl_;
  Marks marks;
  archive_motion(a, w);
  a(marks);
  if (!a.complete() || !motion_is_sound(w) || !contacts_are_sound(w) || !bars_are_sound(w) ||
      !marks_are_sound(w, marks)) {
    return std::unexpected(SavedFault::damaged);
  }
  for (std::size_t k = 0; k < w.bonds.size(); ++k) {
    w.bonds[k].broken = marks.broken[k] != 0;
    w.bonds[k].opened = marks.opened[k] != 0;
  }
  w.sleep_group = marks.sleep_group;
  w.groups = marks.groups;
  const bool other_step = marks.step != w.options.step;
  marks.step = w.options.step;
  if (marks != marks_of(w)) return std::unexpected(SavedFault::damaged);
  w.torn_now.clear();
  w.lost_now.clear();
  w.place_all(w.state, w.corners, w.boxes);
  if (other_step) w.next_step = w.options.step;
  *impl_ = std::move(w);
  return {};
}

}  // namespace cleave::dbem
