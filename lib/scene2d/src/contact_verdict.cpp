#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "cleave/scene2d/contact.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;

constexpr double moves_from = 0.01;  // of a body's size
constexpr double topples_from = 5;   // degrees

/// Between the two corners farthest apart.
double size_of(const ContactBodyResult& body) {
  double size = 0;
  for (std::size_t i = 0; i < body.outline.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) size = std::max(size, norm(body.outline[i] - body.outline[k]));
  }
  return size;
}

/// How far a body, taken as rigid, is from its place at the start: its centroid, and its corners by their turn.
double moved_by(const ContactBodyResult& body, const ContactPlacement& place, double size) {
  return norm(place.centroid - body.start) + std::abs(place.rotation) * size / 2;
}

BodyMotion motion_of(const ContactResult& result, std::size_t frame, std::uint32_t body) {
  const ContactFrame& first = result.frames[frame];
  const bool touched =
      std::ranges::any_of(first.contacts, [&](const ContactMark& c) { return c.first == body || c.second == body; });
  double turned = 0;
  for (const ContactFrame& f : result.frames) turned = std::max(turned, std::abs(f.places[body].rotation));
  if (turned > topples_from * std::numbers::pi / 180) return BodyMotion::topples;
  return touched ? BodyMotion::slides : BodyMotion::falls;
}

}  // namespace

std::string counts_of(const ContactVerdict& verdict) {
  std::string out;
  for (const auto& [count, did] :
       {std::pair{verdict.bodies[0], " slid"}, {verdict.bodies[1], " toppled"}, {verdict.bodies[2], " fell"}}) {
    if (count > 0) out += (out.empty() ? "" : ", ") + std::to_string(count) + did;
  }
  return out;
}

ContactVerdict verdict_of(const ContactResult& result) {
  ContactVerdict verdict;
  double farthest = 0;
  for (std::uint32_t b = 0; b < result.bodies.size(); ++b) {
    const ContactBodyResult& body = result.bodies[b];
    const double size = size_of(body);
    if (body.fixed || !(size > 0)) continue;
    for (std::size_t f = 0; f < result.frames.size(); ++f) {
      const ContactFrame& frame = result.frames[f];
      if (moved_by(body, frame.places[b], size) <= moves_from * size) continue;
      const BodyMotion motion = motion_of(result, f, b);
      ++verdict.bodies[static_cast<std::size_t>(motion)];
      const double far = moved_by(body, result.frames.back().places[b], size) / size;
      const bool first = !verdict.since || frame.time < verdict.since->si();
      if (first || (frame.time == verdict.since->si() && far > farthest)) {
        verdict.since = Time::from_si(frame.time);
        verdict.first = b;
        verdict.motion = motion;
        farthest = far;
      }
      break;
    }
  }
  verdict.known = result.converged || verdict.motion.has_value();
  return verdict;
}

}  // namespace cleave::scene
