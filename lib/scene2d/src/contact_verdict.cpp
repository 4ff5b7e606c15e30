#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "cleave/scene2d/contact.hpp"

namespace cleave::scene {
namespace {

using bem::Vec2;

constexpr double moves_from = 0.01;  // of a body's size
constexpr double topples_from = 5;   // degrees
constexpr double turning_share = 0.7;

/// How far a body, taken as rigid, is from its place at the start: its centroid, and its corners by their turn.
double moved_by(const ContactBodyResult& body, const ContactPlacement& place) {
  return norm(place.centroid - body.start) + std::abs(place.rotation) * body.size.si() / 2;
}

BodyMotion motion_of(const ContactBodyResult& body) {
  if (body.turned > topples_from * std::numbers::pi / 180) return BodyMotion::topples;
  if (!body.touched) return BodyMotion::falls;
  // One that turns about its toe goes along by as much as its turn moves its corners, or less.
  const bool turns =
      std::abs(body.rotation) * body.size.si() / 2 > turning_share * norm(body.centroid - body.carried - body.start);
  return turns ? BodyMotion::topples : BodyMotion::slides;
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

std::string note_of_going_on(const ContactResult& result) {
  constexpr std::size_t most_names = 3;
  std::vector<const ContactBodyResult*> bodies;
  for (const ContactBodyResult& body : result.bodies) {
    if (!body.fixed && !body.moved_at && body.goes_on) bodies.push_back(&body);
  }
  if (bodies.empty()) return {};
  std::ranges::stable_sort(bodies, std::ranges::greater{}, [](const auto* body) { return *body->goes_on; });
  std::string out;
  for (std::size_t k = 0; k < std::min(bodies.size(), most_names); ++k) {
    out += fmt::format("{}\"{}\" (at {:.2g} m/s)", k == 0 ? "" : ", ", bodies[k]->name, *bodies[k]->goes_on);
  }
  if (bodies.size() > most_names) out += fmt::format(" and {} more", bodies.size() - most_names);
  return out + fmt::format(
                   " moved by less than 1 % of {} size but went on moving at the end: that is no standing; give a "
                   "longer duration",
                   bodies.size() == 1 ? "its" : "their");
}

Length size_of(const std::vector<Vec2>& outline) {
  double size = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) size = std::max(size, norm(outline[i] - outline[k]));
  }
  return Length::from_si(size);
}

void note_step(ContactBodyResult& body, Time time, const ContactPlacement& place, bool touches) {
  body.turned = std::max(body.turned, std::abs(place.rotation));
  if (body.moved_at || !(moved_by(body, place) > moves_from * body.size.si())) return;
  body.moved_at = time;
  body.touched = touches;
}

ContactVerdict verdict_of(const ContactResult& result) {
  ContactVerdict verdict;
  double farthest = 0;
  for (std::uint32_t b = 0; b < result.bodies.size(); ++b) {
    const ContactBodyResult& body = result.bodies[b];
    if (body.fixed) continue;
    if (!body.moved_at) {
      verdict.going_on += body.goes_on ? 1U : 0U;
      continue;
    }
    const BodyMotion motion = motion_of(body);
    ++verdict.bodies[static_cast<std::size_t>(motion)];
    const double far = moved_by(body, {body.centroid - body.carried, body.rotation}) / body.size.si();
    const bool first = !verdict.since || *body.moved_at < *verdict.since;
    if (first || (*body.moved_at == *verdict.since && far > farthest)) {
      verdict.since = body.moved_at;
      verdict.first = b;
      verdict.motion = motion;
      farthest = far;
    }
  }
  verdict.known = result.converged || verdict.motion.has_value();
  return verdict;
}

}  // namespace cleave::scene
