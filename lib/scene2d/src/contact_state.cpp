#include "contact_state.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>
#include <variant>

#include "cleave/core/archive.hpp"
#include "cleave/core/sha256.hpp"
#include "cleave/scene/saved_run.hpp"

namespace cleave::scene {

template <class A>
void archive(A& a, Archived<MotionTrail::Span> auto& s) {
  a(s.at, s.reach);
}
template <class A>
void archive(A& a, Archived<MotionTrail> auto& t) {
  a(t.length, t.spans);
}
template <class A>
void archive(A& a, Archived<ContactTally> auto& t) {
  a(t.shares, t.solves, t.lowest, t.scale, t.expected, t.largest, t.broken_at, t.trail, t.hit);
}
template <class A>
void archive(A& a, Archived<ContactPlace> auto& p) {
  a(p.step, p.next, p.unbalanced, p.last_time, p.last_step, p.last_residual, p.last_iterations);
}
template <class A>
void archive(A& a, Archived<ContactPlacement> auto& p) {
  a(p.centroid, p.rotation);
}
template <class A>
void archive(A& a, Archived<NodeStress> auto& n) {
  a(n.stress.xx, n.stress.xy, n.stress.yy, n.out_of_plane, n.von_mises, n.safety);
}
template <class A>
void archive(A& a, Archived<ContactMark> auto& m) {
  a(m.at, m.force, m.first, m.second);
  a.word(m.state, ContactMarkState::slip);
}
template <class A>
void archive(A& a, Archived<ContactFrame> auto& f) {
  a(f.time, f.places, f.corners, f.stress, f.contacts, f.points);
}
template <class A>
void archive(A& a, Archived<ContactHistory> auto& h) {
  a(h.time, h.step, h.kinetic, h.elastic, h.gravity, h.work, h.friction, h.lost, h.bolts, h.residual, h.contacts,
    h.sticking, h.slipping, h.iterations, h.points);
}
template <class A>
void archive(A& a, Archived<ContactBodyResult> auto& b) {
  std::optional<double> moved_at;
  if (b.moved_at) moved_at = b.moved_at->si();
  a(b.centroid, b.rotation, b.largest, moved_at, b.touched, b.turned);
  if constexpr (!std::is_const_v<std::remove_reference_t<decltype(b)>>) {
    b.moved_at = moved_at ? std::optional{Time::from_si(*moved_at)} : std::nullopt;
  }
}
template <class A>
void archive(A& a, Archived<ContactResult> auto& r) {
  a(r.steps, r.residual, r.largest_displacement, r.cut_steps, r.end_time, r.largest_penetration, r.drift_momentum,
    r.drift_angular, r.energy_gain, r.bodies, r.frames, r.history, r.iterations, r.work);
}

// What stays, beside what the world itself is known by.
template <class A>
void archive(A& a, const ContactLoad& l) {
  a(l.time);
}
template <class A>
void archive(A& a, const PointSpec& p) {
  a(p.name, p.at, p.body);
}
template <class A>
void archive(A& a, const SupportMotion& m) {
  a(m.course, m.is_velocity);
}
template <class A>
void archive(A& a, const RockStrength& s) {
  a(s.cohesion, s.friction, s.tension);
}

namespace {

constexpr std::string_view state_kind = "cleave-contact-state";
constexpr std::uint32_t version_of_state = 3;

/// Of what a state must agree with but the world does not know.
std::string identity_of(const ContactScene& scene) {
  ArchiveWriter a;
  for (const ContactBody& body : scene.bodies) a(body.loads, body.motion);
  const ContactSettings& s = scene.settings;
  a(scene.points, s.ground, s.strength, s.to_rest, scene.output.vtu || scene.output.csv);
  return sha256_hex(a.bytes());
}

/// Frames and rows have what each body and point asks for.
bool is_sound(const ContactResult& result, std::size_t bodies, std::size_t points) {
  const auto frame = [&](const ContactFrame& f) {
    bool sound = f.places.size() == bodies && f.corners.size() == bodies && f.stress.size() == bodies &&
                 f.points.size() == points;
    for (std::size_t b = 0; sound && b < bodies; ++b) {
      const std::size_t corners = f.corners[b].size(), stress = f.stress[b].size();
      sound = (corners == 0 || corners == result.bodies[b].outline.size()) && (stress == 0 || stress == corners);
    }
    return sound &&
           std::ranges::all_of(f.contacts, [&](const ContactMark& m) { return m.first < bodies && m.second < bodies; });
  };
  return result.bodies.size() == bodies && !result.frames.empty() && !result.history.empty() &&
         std::ranges::all_of(result.frames, frame) &&
         std::ranges::all_of(result.history, [&](const ContactHistory& h) { return h.points.size() == points; });
}

bool is_sound(const MotionTrail& trail, std::size_t bodies) {
  const auto span = [&](const MotionTrail::Span& s) { return s.reach.size() == MotionTrail::parts * bodies; };
  return trail.spans.empty() ||
         (trail.length > 0 && std::isfinite(trail.length) && std::ranges::all_of(trail.spans, span) &&
          std::ranges::is_sorted(trail.spans, std::ranges::less{}, &MotionTrail::Span::at));
}

constexpr StateKind kind_of_state{
    .run = "a run in contact", .file = contact_state_name, .ties = "its bodies, joints, loads or points"};

}  // namespace

std::string state_of(const ContactScene& scene, const dbem::World& world, const ContactTally& tally,
                     const ContactPlace& place, const ContactResult& result) {
  ArchiveWriter a;
  a(identity_of(scene), world.saved(), tally, place, result);
  return sealed(state_kind, version_of_state, a.bytes());
}

std::optional<Problem> go_on_from(const SavedRun& saved, const ContactScene& scene, dbem::World& world,
                                  Recorder& recorder, ContactPlace& place, ContactResult& result) {
  const auto because = [&](SavedFault fault) { return refused(saved, kind_of_state, fault); };
  auto opened = unsealed_of(identity_of(scene), state_kind, version_of_state, saved.bytes);
  if (!opened) return because(opened.error());
  ArchiveReader& a = *opened;
  std::string world_bytes;
  ContactTally tally;
  ContactPlace was;
  ContactResult read = result;
  a(world_bytes, tally, was, read);
  if (!a.complete() || read.bodies.size() != result.bodies.size()) return because(SavedFault::damaged);
  std::vector<ContactBodyResult> bodies = result.bodies;  // their motion alone was read
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    bodies[b].centroid = read.bodies[b].centroid;
    bodies[b].rotation = read.bodies[b].rotation;
    bodies[b].largest = read.bodies[b].largest;
    bodies[b].moved_at = read.bodies[b].moved_at;
    bodies[b].touched = read.bodies[b].touched;
    bodies[b].turned = read.bodies[b].turned;
  }
  read.bodies = std::move(bodies);
  if (!is_sound(read, scene.bodies.size(), scene.points.size()) || !(was.next > 0) ||
      !is_sound(tally.trail, scene.bodies.size()) || tally.largest.size() != world.ties().size() ||
      tally.broken_at.size() != world.ties().size()) {
    return because(SavedFault::damaged);
  }
  if (const auto restored = world.restore(world_bytes); !restored) {
    return because(restored.error() == SavedFault::foreign ? SavedFault::damaged : restored.error());
  }
  result = std::move(read);
  recorder.go_on(tally);
  if (was.step != place.step) {
    was.step = place.step;
    was.next = place.next;
  }
  place = was;
  return std::nullopt;
}

}  // namespace cleave::scene
