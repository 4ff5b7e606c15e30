#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "context.hpp"

/// What the parts of the parser of [mapped] share.
namespace cleave::scene {

/// How far a point lies from the outline of a face, in its plane.
[[nodiscard]] Length distance_to_border(const dfn::MappedFace& face, geometry::Vec3 p);
/// Whether a point in the face's plane lies within its outline.
[[nodiscard]] bool holds(const dfn::MappedFace& face, geometry::Vec3 p);
/// Unit.
[[nodiscard]] geometry::Vec3 normal_of(const dfn::MappedFace& face);

/// The traces and picks of the files that `table` names, as joints of `settings`, which has its faces, holes and sets;
/// all that is wrong is reported. `names`: of the sets that are mapped and of those that are not.
void parse_mapped_rows(Context& context, const TableReader& table, const std::vector<RandomSet>& joint_sets,
                       MappedSettings& settings);

/// Notes what may be meant otherwise: faces outside of the domain, traces on different faces that may be of one joint.
void note_mapped(Context& context, const std::vector<RandomSet>& joint_sets,
                 const std::optional<geometry::Solid>& domain, const MappedSettings& settings);

/// "did you mean "A"?", or which there are.
[[nodiscard]] std::string nearest_of(const std::string& name, std::span<const std::string_view> names,
                                     std::string_view kind);

}  // namespace cleave::scene
