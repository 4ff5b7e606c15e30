#pragma once

#include "cleave/scene/table_reader.hpp"
#include "cleave/scene2d/bodies.hpp"

/// Tables of [elastic].
namespace cleave::scene {

/// `time`: end, step, scheme, damping.
void parse_elastic_time(const TableReader& elastic, BodiesScene& scene);
/// `points`; after the bodies, in which they must lie.
void parse_elastic_points(const TableReader& elastic, BodiesScene& scene);
/// Bodies must not lie in each other; bonded ones touch along sides.
void check_overlaps(const std::vector<BodySpec>& bodies, Problems& problems);
/// Bodies at rest that stand alone must be held; what bonded ones and a mesh leave free is found as they are solved.
void check_supports(const std::vector<BodySpec>& bodies, Problems& problems);

}  // namespace cleave::scene
