#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "bounds.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/core/rng.hpp"
#include "cleave/dfn/sample.hpp"
#include "cleave/scene/run.hpp"

namespace cleave::scene {
namespace {

/// Streams of measured joints lie beyond those of any number of [[joint_set]]s, so that joints drawn and joints
/// measured under one name do not share their friction.
constexpr std::size_t measured_streams = std::size_t{1} << 23U;
constexpr std::uint64_t single_realization = 0;

FrictionAngle draw_friction(const Scene& scene, SetId set, std::size_t stream, std::uint32_t index) {
  Rng rng{{.seed = scene.seed,
           .realization = single_realization,
           .purpose = stream_purpose(stream, Draw::friction),
           .index = index}};
  return scene.sets[set].properties.friction.quantile(rng.uniform());
}

geometry::Vec3 upward(geometry::Vec3 n) {
  const bool down = n.z < 0 || (n.z == 0 && (n.y < 0 || (n.y == 0 && n.x < 0)));
  return down ? -n : n;
}

/// Area vector of a polygon (Newell), relative to its first corner.
geometry::Vec3 area_vector(const geometry::Polygon& polygon) {
  const auto corners = polygon.corners();
  geometry::Vec3 sum;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    sum += geometry::cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
  }
  return sum;
}

JointInfo describe_joint(SetId set, JointOrigin origin, std::string source, Strength strength, geometry::Vec3 normal) {
  constexpr double degrees = 180.0 / std::numbers::pi;
  const geometry::Vec3 n = upward(normal);
  const double dip = std::atan2(std::hypot(n.x, n.y), n.z) * degrees;
  const double direction = n.x == 0 && n.y == 0 ? 0.0 : std::atan2(n.x, n.y) * degrees;
  return {.set = set,
          .origin = origin,
          .source = std::move(source),
          .strength = strength,
          .normal = n,
          .dip = Dip::degrees(dip),
          .dip_direction = DipDirection::degrees(direction < 0 ? direction + 360 : direction)};
}

void add_measured(const Scene& scene, Drawn& drawn) {
  IdVector<SetId, std::uint32_t> next{scene.sets.size(), 0U};
  for (const MeasuredJoint& joint : scene.joints) {
    const JointProperties& properties = scene.sets[joint.set].properties;
    const std::uint32_t index = next[joint.set]++;
    const FrictionAngle friction = joint.own.friction
                                       ? *joint.own.friction
                                       : draw_friction(scene, joint.set, measured_streams + joint.set.index(), index);
    const Strength strength{friction, joint.own.cohesion.value_or(properties.cohesion), properties.tension};
    geometry::Vec3 normal;
    std::visit(overloaded{[&](const topology::Joint& polygons) {
                            normal = geometry::normalized(area_vector(polygons.polygons.front()));
                            drawn.input.joints.emplace_back(polygons);
                          },
                          [&](const topology::PersistentJoint& plane) {
                            normal = plane.normal;
                            drawn.input.joints.emplace_back(plane);
                          }},
               joint.geometry);
    drawn.joints.push_back(describe_joint(joint.set, JointOrigin::measured,
                                          fmt::format("{}:{}", joint.file, joint.line), strength, normal));
    ++drawn.sets[joint.set].joints;
  }
}

std::expected<void, Problem> add_random(const Scene& scene, std::size_t number, const Box& box, Drawn& drawn) {
  const RandomSet& set = scene.joint_sets[number];
  auto sampled = dfn::sample(set.law, number, {box.min, box.max}, scene.seed, single_realization);
  if (!sampled) {
    return std::unexpected(
        Problem{scene.shown, set.line, fmt::format("joint_set[{}]", number + 1), describe(sampled.error()), ""});
  }
  const NamedSet& named = scene.sets[set.set];
  for (dfn::SampledJoint& joint : *sampled) {
    const Strength strength{draw_friction(scene, set.set, number, joint.index), named.properties.cohesion,
                            named.properties.tension};
    std::visit(overloaded{[&](geometry::Polygon& polygon) {
                            topology::Joint shape;
                            shape.polygons.push_back(std::move(polygon));
                            drawn.input.joints.emplace_back(std::move(shape));
                          },
                          [&](const dfn::InfinitePlane& plane) {
                            drawn.input.joints.emplace_back(topology::PersistentJoint{plane.through, plane.normal});
                          }},
               joint.shape);
    drawn.joints.push_back(describe_joint(set.set, JointOrigin::drawn,
                                          fmt::format("{} #{}", named.name, joint.index + 1), strength, joint.normal));
    ++drawn.sets[set.set].joints;
  }
  return {};
}

}  // namespace

std::expected<Drawn, std::vector<Problem>> draw(const Scene& scene) {
  Drawn drawn{.input = {.domain = scene.domain,
                        .joints = {},
                        .excavations = {},
                        .free_domain_tags = scene.free_domain_tags,
                        .snap = scene.snap,
                        .terminations = scene.terminations,
                        .keep_dangling = scene.keep_dangling},
              .sets = {},
              .joints = {}};
  for (const NamedSet& set : scene.sets) drawn.sets.push_back({set.name, 0});
  for (const Excavation& excavation : scene.excavations) drawn.input.excavations.push_back(excavation.solid);
  add_measured(scene, drawn);
  std::vector<Problem> problems;
  const Box box = box_of(scene.domain);
  for (std::size_t number = 0; number < scene.joint_sets.size(); ++number) {
    if (auto added = add_random(scene, number, box, drawn); !added) problems.push_back(std::move(added).error());
  }
  if (!problems.empty()) return std::unexpected(std::move(problems));
  return drawn;
}

}  // namespace cleave::scene
