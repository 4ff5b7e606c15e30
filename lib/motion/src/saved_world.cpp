#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "cleave/core/expected.hpp"
#include "cleave/motion/archive.hpp"
#include "world_impl.hpp"

/// A world as bytes, and back: what it carries from step to step. What follows from the bodies is made again.
namespace cleave::motion {

template <class A>
void archive(A& a, Archived<State> auto& s) {
  a(s.shift, s.turn, s.v, s.momentum);
}
template <class A>
void archive(A& a, Archived<Touch> auto& t) {
  a(t.body, t.other, t.cell, t.other_cell, t.point, t.normal, t.gap, t.surface, t.other_surface, t.size, t.impulse);
}
template <class A>
void archive(A& a, Archived<Contact> auto& c) {
  a(c.body, c.other, c.point, c.normal, c.gap, c.force, c.slip, c.bonded);
}
template <class A>
void archive(A& a, Archived<Energy> auto& e) {
  a(e.start, e.kinetic, e.potential, e.friction, e.lost, e.projected, e.carried, e.ground, e.loads, e.closing_error,
    e.largest_gain);
}

// What stays: for the name of a world.
template <class A>
void archive(A& a, const Symmetric& s) {
  a(s.xx, s.yy, s.zz, s.xy, s.yz, s.zx);
}
template <class A>
void archive(A& a, const Shape& s) {
  a(s.centroid, s.mass, s.volume, s.inertia, s.radius, s.size, s.thickness, s.first_cell, s.last_cell);
}
template <class A>
void archive(A& a, const Side& s) {
  a(s.corners, s.normal, s.surface, s.outer);
}
template <class A>
void archive(A& a, const Cell& c) {
  a(c.vertices, c.sides);
}
template <class A>
void archive(A& a, const Surface& s) {
  a(s.friction, s.restitution);
}
template <class A>
void archive(A& a, const Bond::Share& s) {
  a(s.point, s.area);
}
template <class A>
void archive(A& a, const BondState& b) {
  a(b.bond.body, b.bond.other, b.bond.normal, b.bond.shares, b.bond.cohesion, b.bond.tension, b.bond.friction,
    b.bond.patch);
}
template <class A>
void archive(A& a, const Tie& t) {
  a(t.body, t.other, t.end, t.other_end, t.capacity.si(), t.ductility.si());
}
template <class A>
void archive(A& a, const Load& l) {
  a(l.body, l.other.has_value(), l.other.value_or(0), l.at, l.force, l.opens.si(), l.slides.si());
}
template <class A>
void archive(A& a, Archived<TieRecord> auto& t) {
  a(t.force, t.lengthened, t.broken);
}

namespace {

constexpr std::string_view world_kind = "cleave-motion-world";
constexpr std::uint32_t version_of_saved = 6;

std::string identity_of(const World::Impl& w) {
  ArchiveWriter a;
  for (const TieRecord& tie : w.ties) a(tie.tie);
  for (const LoadRecord& load : w.loads) a(load.load);
  if (w.water) a(w.water->level.si(), w.water->up, w.water->unit_weight.si());
  a(w.shapes, *w.cells, w.surfaces, w.bonds, w.extent, w.options.gravity, w.options.quasi_static, w.options.sleep);
  if (const GroundMotion& g = w.options.ground; g.mean) {
    const double end = g.end.si();
    a(g.peak.si(), end);
    // A function has no bytes: what it is over parts of the motion.
    constexpr int parts = 64;
    const double part = (std::isfinite(end) && end > 0 ? end : 10.0) / parts;
    for (int k = 0; k < parts; ++k) a(g.mean(k * part, (k + 1) * part));
  }
  return sha256_hex(a.bytes());
}

/// What changes, but for the bonds.
template <class A>
void archive_motion(A& a, Archived<World::Impl> auto& w) {
  a(w.now, w.last_step, w.state, w.touches, w.contacts, w.held, w.asleep, w.quiet, w.implicit, w.locked, w.energy,
    w.expected, w.largest_momentum, w.momentum_off);
}

std::vector<std::uint8_t> broken_of(const World::Impl& w) {
  std::vector<std::uint8_t> out;
  for (const BondState& bond : w.bonds) out.push_back(bond.broken ? 1 : 0);
  return out;
}
std::vector<std::uint8_t> gone_of(const World::Impl& w) {
  std::vector<std::uint8_t> out;
  for (const LoadRecord& load : w.loads) out.push_back(load.gone ? 1 : 0);
  return out;
}

bool finite(double x) { return std::isfinite(x); }
bool finite(Vec3 v) { return geometry::is_finite(v); }

bool is_sound(const State& s) {
  const Turn& t = s.turn;
  return finite(s.shift) && finite(s.v) && finite(s.momentum) &&
         std::abs(t.w * t.w + t.x * t.x + t.y * t.y + t.z * t.z - 1) < 1e-9;
}

bool bodies_are_sound(const World::Impl& w) {
  const std::size_t n = w.shapes.size();
  const Energy& e = w.energy;
  const std::array books{e.carried,   e.start,  e.kinetic,       e.potential,    e.friction,         e.lost,
                         e.projected, e.ground, e.closing_error, e.largest_gain, w.largest_momentum, w.momentum_off,
                         e.loads};
  const auto flag = [](std::uint8_t f) { return f <= 1; };
  return w.now >= 0 && finite(w.now) && w.last_step >= 0 && finite(w.last_step) && w.state.size() == n &&
         std::ranges::all_of(w.state, is_sound) && w.held.size() == n && std::ranges::all_of(w.held, flag) &&
         w.asleep.size() == n && std::ranges::all_of(w.asleep, flag) && w.quiet.size() == n && w.implicit.size() == n &&
         w.locked.size() == n && std::ranges::all_of(w.locked, flag) &&
         std::ranges::all_of(books, [](double x) { return finite(x); }) && finite(w.expected);
}

bool contacts_are_sound(const World::Impl& w) {
  const std::size_t n = w.shapes.size();
  const auto of_body = [&](std::uint32_t cell, std::uint32_t body) {
    return cell < w.cell_body.size() && w.cell_body[cell] == body;
  };
  const auto pair = [&](std::uint32_t a, std::uint32_t b) { return a < n && b < n && a != b; };
  const auto touch = [&](const Touch& t) {
    return pair(t.body, t.other) && of_body(t.cell, t.body) && of_body(t.other_cell, t.other) &&
           t.surface < w.surfaces.size() && t.other_surface < w.surfaces.size() && finite(t.point) &&
           finite(t.normal) && finite(t.gap) && finite(t.size) && finite(t.impulse);
  };
  const auto contact = [&](const Contact& c) {
    return pair(c.body, c.other) && finite(c.point) && finite(c.normal) && finite(c.gap) && finite(c.force) &&
           finite(c.slip);
  };
  return std::ranges::all_of(w.touches, touch) && std::ranges::all_of(w.contacts, contact);
}

bool bond_is_sound(const BondState& bond) {
  return std::ranges::all_of(bond.impulse, [](Vec3 v) { return finite(v); });
}
bool tie_is_sound(const TieRecord& tie) {
  return tie.force >= 0 && finite(tie.force) && tie.lengthened >= 0 && finite(tie.lengthened);
}

}  // namespace

std::string World::saved() const {
  ArchiveWriter a;
  a(identity_of(*impl_));
  archive_motion(a, std::as_const(*impl_));
  for (const BondState& bond : impl_->bonds) a(bond.impulse);
  a(broken_of(*impl_), impl_->torn, gone_of(*impl_));
  for (const TieRecord& tie : impl_->ties) a(tie);
  return sealed(world_kind, version_of_saved, a.bytes());
}

std::expected<void, SavedFault> World::restore(std::string_view saved) {
  CLEAVE_TRY(ArchiveReader a, unsealed_of(identity_of(*impl_), world_kind, version_of_saved, saved));
  Impl w = *impl_;
  std::vector<std::uint8_t> broken, gone;
  archive_motion(a, w);
  for (BondState& bond : w.bonds) a(bond.impulse);
  a(broken, w.torn, gone);
  for (TieRecord& tie : w.ties) a(tie);
  const auto flags = [](const std::vector<std::uint8_t>& of, std::size_t count) {
    return of.size() == count && std::ranges::all_of(of, [](std::uint8_t b) { return b <= 1; });
  };
  if (!a.complete() || !bodies_are_sound(w) || !contacts_are_sound(w) || !flags(broken, w.bonds.size()) ||
      !flags(w.torn, w.bonds.size()) || !flags(gone, w.loads.size()) || !std::ranges::all_of(w.bonds, bond_is_sound) ||
      !std::ranges::all_of(w.ties, tie_is_sound)) {
    return std::unexpected(SavedFault::damaged);
  }
  for (std::size_t k = 0; k < w.bonds.size(); ++k) w.bonds[k].broken = broken[k] != 0;
  for (std::size_t k = 0; k < w.loads.size(); ++k) w.loads[k].gone = gone[k] != 0;
  w.place_all(w.state, true);
  *impl_ = std::move(w);
  return {};
}

}  // namespace cleave::motion
