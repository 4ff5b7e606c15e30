#include <fmt/format.h>

#include "cleave/bem/statics.hpp"
#include "cleave/core/overloaded.hpp"

namespace cleave::bem {

std::string describe(const SolveError& error) {
  return std::visit(
      overloaded{
          [](const BadOutline& e) { return fmt::format("region {}: {}", e.region + 1, describe(e.why)); },
          [](const UnknownCondition& e) {
            return fmt::format("region {}, loop {}, side {} names a condition that does not exist", e.region + 1,
                               e.loop + 1, e.side + 1);
          },
          [](const FreeMotions& e) {
            std::string list;
            for (const std::string& motion : e.motions) list += (list.empty() ? "" : ", ") + motion;
            if (e.finer_holds) {
              return fmt::format(
                  "constant elements are held in their middles, which leaves {} free; use two or more elements on the "
                  "sides that are held, or order = \"quadratic\"",
                  list);
            }
            return fmt::format("the supports do not hold the body against {}; support it, or let it be restrained",
                               list);
          },
          [](const UnbondedSide& e) {
            return fmt::format(
                "region {}, loop {}, side {} is bonded, but no bonded side of another region runs along it the other "
                "way with the same elements",
                e.region + 1, e.loop + 1, e.side + 1);
          },
          [](const TornCorner& e) {
            return fmt::format(
                "region {}: the sides that meet at ({:.9g}, {:.9g}) give it displacements {:.3g} m apart", e.region + 1,
                e.at.x, e.at.y, e.gap);
          },
          [](const ForceOffBoundary& e) {
            return fmt::format("point force {} acts {:.3g} m away from the boundary; move it onto a side", e.force + 1,
                               e.distance);
          },
          [](const ForceOnSupport& e) {
            return fmt::format("point force {} acts on a side whose displacement is given", e.force + 1);
          },
          [](const NotInBalance& e) {
            return fmt::format(
                "the in-situ stress of an infinite region does not carry the weight: ({:.3g}, {:.3g}) N/m3 are left "
                "over; its gradient must be the unit weight",
                e.missing.x, e.missing.y);
          },
          [](const AboveSurface& e) {
            return fmt::format("region {}, loop {} reaches the surface of the half plane or lies above it",
                               e.region + 1, e.loop + 1);
          },
          [](const NoRegion&) { return std::string{"the problem has no region"}; },
          [](const BadNumber& e) { return fmt::format("{} is {}", e.what, e.value); },
          [](const TooManyUnknowns& e) {
            return fmt::format("{} unknowns need {:.0f} MB; use fewer elements or allow more memory", e.unknowns,
                               e.needed_mb);
          },
          [](const SingularSystem& e) {
            return fmt::format("the equations are singular to rounding (condition number {:.1e})", e.condition);
          }},
      error);
}

}  // namespace cleave::bem
