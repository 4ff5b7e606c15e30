#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "cleave/realize/monte_carlo.hpp"
#include "cleave/realize/run.hpp"
#include "held_notes.hpp"

/// What an ensemble of a scene counts.
namespace cleave::scene {

stochastic::Questions questions_of(const Scene& scene) {
  stochastic::Questions questions;
  if (!scene.monte_carlo) return questions;
  questions.groups = scene.stability && scene.stability->decides_by_groups();
  questions.clamped = scene.stability && scene.field_stress;
  questions.whole = !(scene.output.only_key_blocks && scene.stability);
  questions.undisturbed = undisturbed_box(scene);
  questions.volumes_m3 = scene.monte_carlo->volumes;
  for (const Excavation& excavation : scene.excavations) {
    if (excavation.axis.empty()) continue;
    questions.axis = excavation.axis;
    questions.chainage_parts = scene.monte_carlo->chainage_parts;
    break;
  }
  return questions;
}

std::vector<std::vector<std::uint32_t>> orders_of(const Scene& scene) {
  if (!scene.sequence || !scene.stability) return {};
  std::vector<std::vector<std::uint32_t>> orders{scene.sequence->stages};
  for (const auto& order : scene.sequence->orders) {
    if (order != scene.sequence->stages) orders.push_back(order);
  }
  return orders;
}

namespace {

/// What pulls at all rock of the domain at most: nothing but its weight, and an earthquake.
std::optional<Force> pull_of(const Scene& scene, const LoadSet& loads) {
  const stability::ActionSpec& spec = loads.actions.spec();
  if (!loads.dry() || !spec.surcharges.empty() || !spec.points.empty() || !spec.lines.empty()) return std::nullopt;
  const geometry::Vec3 gravity = loads.body.gravity();
  double shakes = 1;
  if (scene.monte_carlo) {
    const NumberLaw& law = scene.monte_carlo->seismic_factor;
    shakes = law.kind == FrictionLaw::Kind::constant ? law.mean : law.max;
  }
  const Force weight = scene.rock.mass.density() * scene.domain.volume() * metres_per_second_squared(norm(gravity)) *
                       scene.stability->partial.weight();
  return (1 + shakes * norm(loads.body.seismic())) * weight;
}
}  // namespace

std::optional<Length> tunnel_in_rock(const Scene& scene) {
  const auto tunnel = std::ranges::find_if(scene.excavations, [](const auto& e) { return !e.axis.empty(); });
  if (tunnel == scene.excavations.end()) return std::nullopt;
  const auto taken = excavated(scene);
  const auto number = static_cast<std::size_t>(tunnel - scene.excavations.begin());
  const double outside = taken ? taken->openings[number].outside_share.value_or(0) : 0;
  return metres(stochastic::length_of(tunnel->axis) * (1 - outside));
}

stochastic::EnsembleOptions ensemble_options_of(const Scene& scene) {
  const stochastic::Questions questions = questions_of(scene);
  stochastic::EnsembleOptions options{.stability = scene.stability.has_value(),
                                      .whole_system = questions.whole,
                                      .confidence = scene.monte_carlo ? scene.monte_carlo->confidence : 0.95,
                                      .volumes_m3 = questions.volumes_m3,
                                      .tunnel_length_m = {},
                                      .rock = scene.domain.volume(),
                                      .chainage_parts = questions.chainage_parts,
                                      .seed = scene.seed,
                                      .support = scene.support.has_value(),
                                      .stages = scene.support && scene.sequence,
                                      .groups = questions.groups,
                                      .clamped = questions.clamped,
                                      .at_parts = scene.stability.has_value() && has_own_opening(scene.excavations),
                                      .openings = !scene.excavations.empty(),
                                      .orders = orders_of(scene).size(),
                                      .lifts = scene.stability && scene.stability->loads.lifts(),
                                      .strengths_per_geometry = strengths_per_geometry(scene)};
  options.at_target = scene.stability && targets_under(scene, nullptr);
  options.turning = scene.stability && scene.stability->rotation != stability::RotationCheck::off;
  if (!questions.axis.empty()) options.tunnel_length_m = stochastic::length_of(questions.axis);
  for (const auto& [name, p] : Percentiles::levels) options.size_levels.push_back(p);
  if (scene.stability) {
    options.pull = pull_of(scene, scene.stability->loads);
    for (const LoadCase& load : scene.stability->cases) {
      options.cases.push_back(load.name);
      options.cases_lift.push_back(load.loads.lifts());
      options.cases_pull.push_back(pull_of(scene, load.loads));
    }
  }
  for (const NamedSet& set : scene.sets) options.sets.push_back(set.name);
  for (const ScanLine& line : scene.lines) options.lines.push_back(line.name);
  if (scene.flow) {
    options.flow = true;
    options.water = scene.flow->flows();
    options.sides.assign(scene.domain.tags().begin(), scene.domain.tags().end());
  }
  options.undisturbed = questions.undisturbed.has_value();
  if (scene.monte_carlo && scene.monte_carlo->stop) options.running_quantity = scene.monte_carlo->stop->quantity;
  if (!options.stability && stochastic::quantity_named(options.running_quantity)->stability) {
    options.running_quantity = "block_count";
  }
  return options;
}

std::uint64_t strengths_per_geometry(const Scene& scene) noexcept {
  return scene.monte_carlo ? scene.monte_carlo->strengths_per_geometry : 1;
}

}  // namespace cleave::scene
