#include "detail/input_check.hpp"

#include <algorithm>
#include <cmath>

namespace cleave::topology::detail {
namespace {

using geometry::Vec3;

using geometry::is_finite;

std::optional<std::string> fault_of(const PersistentJoint& joint) {
  if (!is_finite(joint.through)) return "the point that the plane goes through";
  // Its square, too, must be a number that can be divided by.
  const double length = geometry::norm(joint.normal);
  if (!is_finite(joint.normal) || !std::isnormal(length) || !std::isfinite(length)) return "the plane's normal";
  return std::nullopt;
}

}  // namespace

std::expected<void, CutError> check_input(const CutInput& input) {
  for (std::size_t j = 0; j < input.joints.size(); ++j) {
    const auto* plane = std::get_if<PersistentJoint>(&input.joints[j]);
    if (plane == nullptr) continue;
    if (const auto fault = fault_of(*plane)) return std::unexpected(CutError{NotFinite{*fault, JointId{j}}});
  }
  if (std::isnan(input.snap.si()) || std::isinf(input.snap.si())) {
    return std::unexpected(CutError{NotFinite{"snap", std::nullopt}});
  }
  if (input.snap.si() < 0) return std::unexpected(CutError{SnapNegative{input.snap}});
  if (input.window && (!is_finite(input.window->min) || !is_finite(input.window->max))) {
    return std::unexpected(CutError{NotFinite{"a corner of the window", std::nullopt}});
  }
  for (const std::uint32_t tag : input.free_domain_tags) {
    const auto faces = input.domain.faces();
    if (std::ranges::find(faces, tag, &geometry::SolidFace::tag) == faces.end()) {
      return std::unexpected(CutError{UnknownTag{tag}});
    }
  }
  for (const auto& [joint, at] : input.terminations) {
    for (const JointId j : {joint, at}) {
      if (j.index() >= input.joints.size()) return std::unexpected(CutError{UnknownJoint{j}});
    }
  }
  return {};
}

}  // namespace cleave::topology::detail
