#include "cut_problem.hpp"

#include <fmt/format.h>

#include "cleave/core/overloaded.hpp"

namespace cleave::scene {

Problem problem_of(const topology::CutError& error, const Scene& scene, const SampledScene& drawn) {
  const std::string what = describe(error);
  const auto whole = [&] { return Problem{scene.shown, 1, "scene", what, ""}; };
  // What the lattice alone would keep may be lost to the snap.
  const std::string coarse =
      scene.snap > metres(0)
          ? fmt::format("snap = {:g} joins corners nearer than that: try a smaller one", scene.snap.si())
          : std::string{};
  return std::visit(
      overloaded{
          [&](const topology::JointCollapsed& e) {
            if (e.joint.index() < scene.joints.size()) {
              const MeasuredJoint& joint = scene.joints[e.joint.index()];
              return Problem{joint.file, joint.line, "joint", what, coarse};
            }
            const JointInfo& info = drawn.joints[e.joint];
            return Problem{scene.shown, 1, fmt::format("joint_set {}", info.source), what, coarse};
          },
          [&](const topology::SolidCollapsed& e) {
            if (!e.excavation) return Problem{scene.shown, 1, "domain", what, coarse};
            return Problem{scene.shown, scene.excavations[*e.excavation].line,
                           fmt::format("excavation[{}]", *e.excavation + 1), what, coarse};
          },
          [&](const topology::TerminationUndecided& e) {
            const MeasuredJoint& joint = scene.joints[e.joint.index()];
            return Problem{joint.file, joint.line, "joint.terminates_at", what, ""};
          },
          [&](const topology::DomainSwallowed&) {
            const std::uint32_t line = scene.excavations.empty() ? 1 : scene.excavations.front().line;
            return Problem{scene.shown, line, "excavation", what, ""};
          },
          [&](const topology::WindowOutside&) { return whole(); }, [&](const topology::TooLarge&) { return whole(); },
          [&](const topology::NotFinite&) { return whole(); }, [&](const topology::SnapNegative&) { return whole(); },
          [&](const topology::UnknownTag&) { return whole(); }, [&](const topology::UnknownJoint&) { return whole(); }},
      error);
}

}  // namespace cleave::scene
