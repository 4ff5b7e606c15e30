#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>
#include <string>
#include <vector>

#include "cleave/bem/statics.hpp"
#include "parse_elastic.hpp"

namespace cleave::scene {

using bem::Vec2;

void check_overlaps(const std::vector<BodySpec>& bodies, Problems& problems) {
  const auto bounded = [](const BodySpec& b) { return b.extent == bem::Extent::bounded; };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      if (!bounded(bodies[i]) || !bounded(bodies[j])) continue;
      const auto pokes = [](const BodySpec& a, const BodySpec& b) -> std::optional<Vec2> {
        // Points of a's boundary, moved a little inwards, that lie inside b.
        for (const bem::Loop& loop : a.region.loops) {
          for (std::size_t s = 0; s < loop.size(); ++s) {
            for (int k = 0; k < 16; ++k) {
              const bem::SidePoint p = bem::point_on(loop, s, (k + 0.5) / 16);
              const Vec2 inward = turned_left(p.derivative) * 1e-6;
              if (bem::inside(b.region.loops, p.x + inward)) return p.x;
            }
          }
        }
        return std::nullopt;
      };
      auto at = pokes(bodies[i], bodies[j]);
      if (!at) at = pokes(bodies[j], bodies[i]);
      if (at) {
        problems.error(bodies[j].line, fmt::format("body[{}].outline", j + 1),
                       fmt::format("overlaps \"{}\" at ({:.6g}, {:.6g})", bodies[i].name, at->x, at->y),
                       "move one of them; bodies may touch along bonded sides");
      }
    }
  }
}

void check_supports(const std::vector<BodySpec>& bodies, Problems& problems) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const BodySpec& body = bodies[i];
    if (body.bonded || body.extent != bem::Extent::bounded) continue;
    const std::vector<std::string> motions = bem::unheld_motions(body.region);
    if (motions.empty()) continue;
    problems.error(body.line, fmt::format("body[{}]", i + 1),
                   fmt::format("the supports do not hold the body against {}", fmt::join(motions, ", ")),
                   "hold more of its sides by `support`; see docs/bem.md");
  }
}

}  // namespace cleave::scene
