#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <span>
#include <utility>

#include "cleave/core/overloaded.hpp"
#include "cleave/core/rng.hpp"
#include "cleave/core/special.hpp"
#include "cleave/dfn/sample.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/realize/run.hpp"
#include "cleave/scene3d/bounds.hpp"
#include "cleave/scene3d/drawing_order.hpp"
#include "cut_notes.hpp"

namespace cleave::scene {
namespace {

/// Streams of measured joints lie beyond those of any number of [[joint_set]]s, so that joints drawn and joints
/// measured under one name do not share their friction.
constexpr std::size_t measured_streams = std::size_t{1} << 23U;

/// Streams of the whole scene, not of a joint set: their purposes lie beyond those of core's Draw.
constexpr auto seismic_stream = static_cast<Draw>(64);
constexpr auto water_stream = static_cast<Draw>(65);

using DrawnStrength = std::expected<stability::JointStrength, stability::StrengthError>;

/// One value a joint of each property; what the joint states itself goes before. Friction and cohesion may hang
/// together by a Gaussian copula: the marginal laws stay what the scene says.
DrawnStrength draw_strength(const Scene& scene, std::uint64_t realization, SetId set, std::size_t stream,
                            std::uint32_t index, const OwnStrength& own = {}) {
  const auto uniform = [&](Draw what) {
    return Rng{
        {.seed = scene.seed, .realization = realization, .purpose = stream_purpose(stream, what), .index = index}}
        .uniform();
  };
  const JointProperties& properties = scene.sets[set].properties;
  const double friction = uniform(Draw::friction);
  double cohesion = uniform(Draw::cohesion);
  if (const double r = properties.friction_cohesion; r != 0) {
    const double score = r * normal_quantile(friction) + std::sqrt(1 - r * r) * normal_quantile(cohesion);
    cohesion = std::clamp(special::normal_cdf(score), 0x1p-53, 1 - 0x1p-53);
  }
  return joint_strength(own.friction.value_or(properties.friction.quantile(friction)),
                        own.cohesion.value_or(properties.cohesion.quantile(cohesion)),
                        own.tension.value_or(properties.tension.quantile(uniform(Draw::tension))),
                        own.cohesion ? std::nullopt : properties.roughness);  // a straight law of its own
}

/// m, one value a joint.
std::optional<Length> draw_aperture(const Scene& scene, std::uint64_t realization, SetId set, std::size_t stream,
                                    std::uint32_t index) {
  const auto& law = scene.sets[set].properties.aperture;
  if (!law) return std::nullopt;
  const StreamKey key{.seed = scene.seed,
                      .realization = realization,
                      .purpose = stream_purpose(stream, Draw::aperture),
                      .index = index};
  return metres(law->quantile(Rng{key}.uniform()));
}

Problem no_strength(const Scene& scene, SetId set, std::uint32_t line, const stability::StrengthError& why) {
  return {scene.shown, line, "joints." + scene.sets[set].name, describe(why), ""};
}

JointInfo describe_joint(SetId set, JointOrigin origin, std::string source, stability::JointStrength strength,
                         geometry::Vec3 normal) {
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

void add_measured(const Scene& scene, std::uint64_t realization, SampledScene& drawn, std::vector<Problem>& problems) {
  IdVector<SetId, std::uint32_t> next{scene.sets.size(), 0U};
  for (const MeasuredJoint& joint : scene.joints) {
    const std::uint32_t index = next[joint.set]++;
    const auto strength =
        draw_strength(scene, realization, joint.set, measured_streams + joint.set.index(), index, joint.own);
    if (!strength) {
      problems.push_back(no_strength(scene, joint.set, joint.line, strength.error()));
      continue;
    }
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
    JointInfo info = describe_joint(joint.set, JointOrigin::measured, fmt::format("{}:{}", joint.file, joint.line),
                                    *strength, normal);
    info.aperture = draw_aperture(scene, realization, joint.set, measured_streams + joint.set.index(), index);
    drawn.joints.push_back(std::move(info));
    ++drawn.sets[joint.set].joints;
  }
}

using SampledSets = std::vector<std::vector<dfn::SampledJoint>>;

/// Joints drawn for what has been mapped have numbers from here on.
constexpr std::uint32_t first_seen = std::uint32_t{1} << 31U;

/// Of each set the joints drawn for what has been mapped of it; how well they do so is written into `result`.
std::expected<SampledSets, Problem> honour_mapped(const Scene& scene, std::uint64_t geometry, MappedResult& result) {
  const MappedSettings& mapped = *scene.mapped;
  std::vector<const dfn::JointSet*> laws;
  for (std::size_t i = 0; i < scene.joint_sets.size(); ++i) {
    laws.push_back(mapped.sets[i] != 0 ? &scene.joint_sets[i].law : nullptr);
  }
  result = {.faces = mapped.faces.size(), .holes = mapped.holes.size()};
  auto honoured = dfn::honour(laws, mapped.seen, scene.seed, geometry);
  if (!honoured) return std::unexpected(Problem{scene.shown, mapped.line, "mapped", describe(honoured.error()), ""});
  SampledSets seen(scene.joint_sets.size());
  for (dfn::HonouredJoint& found : *honoured) {
    const dfn::MappedJoint& asked = mapped.seen.joints[found.mapped];
    const MappedSettings::Source& source = mapped.sources[found.mapped];
    const geometry::Attitude attitude = geometry::attitude_of(found.joint.normal);
    MappedJointResult& row =
        result.joints.emplace_back(MappedJointResult{.source = source.name,
                                                     .set = scene.sets[scene.joint_sets[found.set].set].name,
                                                     .set_known = asked.set.has_value(),
                                                     .traces = asked.traces.size(),
                                                     .picks = asked.picks.size(),
                                                     .misfit = found.misfit,
                                                     .honours = found.honours,
                                                     .dip = attitude.dip,
                                                     .dip_direction = attitude.direction,
                                                     .centre = found.joint.centre});
    for (const MappedRow& at : source.rows) row.rows.push_back(fmt::format("{}:{}", at.file, at.line));
    seen[found.set].push_back(std::move(found.joint));
  }
  return seen;
}

/// The joints of all sets, each drawn after those it ends at. Of mapped sets those that would have been seen are left
/// out, and those drawn for what has been seen follow.
std::expected<SampledSets, std::vector<Problem>> sample_sets(const Scene& scene, std::uint64_t realization,
                                                             const Box& box, std::optional<MappedResult>& mapped) {
  const std::size_t count = scene.joint_sets.size();
  SampledSets sampled(count), given(scene.sets.size());
  // Where several draws of strengths share a geometry, the joints go by the number of the geometry.
  const std::uint64_t geometry = realization / (scene.monte_carlo ? scene.monte_carlo->strengths_per_geometry : 1);
  std::vector<Problem> problems;
  SampledSets seen(count);
  if (scene.mapped) {
    auto honoured = honour_mapped(scene, geometry, mapped.emplace());
    if (!honoured) return std::unexpected(std::vector{std::move(honoured).error()});
    seen = *std::move(honoured);
  }
  for (const std::size_t number : drawing_order(scene.joint_sets)) {
    const RandomSet& set = scene.joint_sets[number];
    std::vector<std::span<const dfn::SampledJoint>> older;
    for (const std::size_t other : dfn::terminates_at(set.law)) {
      if (other < count) {
        older.emplace_back(sampled[other]);
      } else {
        auto& joints = given[other - count];
        if (joints.empty()) joints = given_joints(scene.joints, SetId{other - count});
        older.emplace_back(joints);
      }
    }
    auto joints = dfn::sample(set.law, number, {box.min, box.max}, scene.seed, geometry, older);
    if (joints && scene.mapped && scene.mapped->sets[number] != 0) {
      const std::size_t drawn = joints->size();
      *joints = dfn::unseen(*std::move(joints), scene.mapped->seen);
      mapped->taken_out += drawn - joints->size();
      std::ranges::move(seen[number], std::back_inserter(*joints));
    }
    if (joints) {
      sampled[number] = with_polygons(*std::move(joints));
    } else {
      problems.push_back(
          {scene.shown, set.line, fmt::format("joint_set[{}]", number + 1), describe(joints.error()), ""});
    }
  }
  if (!problems.empty()) return std::unexpected(std::move(problems));
  return sampled;
}

void add_random(const Scene& scene, std::uint64_t realization, std::size_t number,
                std::vector<dfn::SampledJoint> sampled, SampledScene& drawn, std::vector<Problem>& problems) {
  const RandomSet& set = scene.joint_sets[number];
  const NamedSet& named = scene.sets[set.set];
  for (dfn::SampledJoint& joint : sampled) {
    const auto strength = draw_strength(scene, realization, set.set, number, joint.index);
    if (!strength) {
      problems.push_back(no_strength(scene, set.set, set.line, strength.error()));
      continue;
    }
    const geometry::Vec3 normal = joint.normal;
    const std::uint32_t index = joint.index;
    drawn.input.joints.push_back(dfn::joint_of(std::move(joint)));
    std::string source = fmt::format("{} #{}", named.name, index + 1);
    if (index >= first_seen) {
      MappedJointResult& row = drawn.mapped->joints[index - first_seen];
      row.joint = topology::JointId{drawn.joints.size()};
      source = fmt::format("{} seen {}", named.name, row.source);
    }
    JointInfo info = describe_joint(set.set, JointOrigin::drawn, std::move(source), *strength, normal);
    info.aperture = draw_aperture(scene, realization, set.set, number, index);
    drawn.joints.push_back(std::move(info));
    ++drawn.sets[set.set].joints;
  }
}

/// For `topology::CutInput::precedence`; empty where all joints are as strong.
std::vector<std::uint32_t> weakest_first(const IdVector<topology::JointId, JointInfo>& joints) {
  const auto same = [&](const JointInfo& j) { return j.strength == joints[topology::JointId{0U}].strength; };
  if (std::ranges::all_of(joints, same)) return {};
  using Bears = std::pair<double, double>;
  std::vector<Bears> bears;
  for (const JointInfo& joint : joints) {
    bears.emplace_back(joint.strength.shear(normal_stress_on_overlaps).si(), joint.strength.tension().si());
  }
  std::vector<Bears> sorted = bears;
  std::ranges::sort(sorted);
  std::vector<std::uint32_t> order;
  for (const Bears& own : bears) {
    order.push_back(static_cast<std::uint32_t>(std::ranges::lower_bound(sorted, own) - sorted.begin()));
  }
  return order;
}

}  // namespace

std::expected<SampledScene, std::vector<Problem>> sample(const Scene& scene, std::uint64_t realization) {
  SampledScene drawn{.input = {.domain = scene.domain,
                               .joints = {},
                               .excavations = {},
                               .free_domain_tags = scene.free_domain_tags,
                               .snap = scene.snap,
                               .terminations = scene.terminations,
                               .keep_dangling = scene.keep_dangling},
                     .sets = {},
                     .joints = {}};
  const auto once = [&](Draw what) {
    return Rng{{.seed = scene.seed, .realization = realization, .purpose = stream_purpose(0, what), .index = 0}}
        .uniform();
  };
  if (scene.monte_carlo) drawn.seismic_factor = scene.monte_carlo->seismic_factor.quantile(once(seismic_stream));
  drawn.water_quantile = once(water_stream);
  for (const NamedSet& set : scene.sets) drawn.sets.push_back({set.name, 0});
  for (const Excavation& excavation : scene.excavations) drawn.input.excavations.push_back(excavation.solid);
  std::vector<Problem> problems;
  add_measured(scene, realization, drawn, problems);
  auto sampled = sample_sets(scene, realization, box_of(scene.domain), drawn.mapped);
  if (!sampled) return std::unexpected(std::move(sampled).error());
  for (std::size_t number = 0; number < sampled->size(); ++number) {
    add_random(scene, realization, number, std::move((*sampled)[number]), drawn, problems);
  }
  if (!problems.empty()) return std::unexpected(std::move(problems));
  drawn.input.precedence = weakest_first(drawn.joints);
  return drawn;
}

}  // namespace cleave::scene
