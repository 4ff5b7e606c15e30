#include <fmt/format.h>

#include <optional>

#include "cleave/core/overloaded.hpp"
#include "cleave/facets/cut_input.hpp"

namespace cleave::topology {

std::string describe(const CutError& error) {
  return std::visit(
      overloaded{
          [](const JointCollapsed& e) {
            return fmt::format(
                "joint {} is too small for this scene: its corners fall on one line of the lattice of {} m; leave "
                "it out or cut a smaller domain",
                e.joint.value(), e.pitch.si());
          },
          [](const SolidCollapsed& e) {
            const std::string what =
                e.excavation ? fmt::format("excavation {}", *e.excavation) : std::string{"the domain"};
            return fmt::format(
                "face {} of {} is too small or too bent for the lattice of {} m; merge its corners or give it as "
                "triangles",
                e.face, what, e.pitch.si());
          },
          [](const TerminationUndecided& e) {
            return fmt::format(
                "joint {} ends on joint {}, but which part of it is meant is not clear: its middle lies on that "
                "joint's "
                "plane, or that joint is not flat; end it on another joint or move its middle",
                e.joint.value(), e.at.value());
          },
          [](const DomainSwallowed&) {
            return std::string{
                "the excavations leave no rock of the domain; make the domain larger or an excavation smaller"};
          },
          [](const WindowOutside&) {
            return std::string{"the window misses the domain; give one that has a part of the domain in it"};
          },
          [](const TooLarge& e) {
            return fmt::format("the scene has more than 2^31 {}; split it or use fewer joints", e.what);
          },
          [](const NotFinite& e) {
            return fmt::format("{}{} is not a finite number; give one",
                               e.joint ? fmt::format("joint {}: ", e.joint->value()) : std::string{}, e.what);
          },
          [](const SnapNegative& e) { return fmt::format("snap is {} m; give 0 or more", e.snap.si()); },
          [](const UnknownTag& e) {
            return fmt::format("side {} is to be free, but the domain has no such side; give one that it has", e.tag);
          },
          [](const UnknownJoint& e) {
            return fmt::format("a termination names joint {}, but there is no such joint", e.joint.value());
          },
      },
      error);
}

}  // namespace cleave::topology
