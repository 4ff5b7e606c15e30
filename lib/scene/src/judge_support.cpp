#include <algorithm>
#include <cmath>

#include "cleave/core/overloaded.hpp"
#include "judge.hpp"

namespace cleave::scene {
namespace {

using stability::Bolt;

/// All bolts with the spacings times `scale`, another length, and the offsets moved by a share of a spacing.
std::vector<Bolt> bolts_with(const SupportSettings& support, double scale, double length, double phase) {
  std::vector<Bolt> bolts = support.single;
  for (const auto& pattern : support.patterns) {
    const auto more =
        std::visit(overloaded{[&](stability::RingPattern ring) {
                                ring.along *= scale;
                                ring.around *= scale;
                                ring.offset_along = std::fmod(ring.offset_along + phase * ring.along, ring.along);
                                ring.offset_around = std::fmod(ring.offset_around + phase * ring.around, ring.around);
                                ring.length = length;
                                return bolts_of(ring);
                              },
                              [&](stability::GridPattern grid) {
                                grid.spacing_across *= scale;
                                grid.spacing_down *= scale;
                                grid.offset_across += phase * grid.spacing_across;
                                grid.offset_down += phase * grid.spacing_down;
                                grid.length = length;
                                return bolts_of(grid);
                              }},
                   pattern);
    bolts.insert(bolts.end(), more.begin(), more.end());
  }
  return bolts;
}

void note(const std::vector<topology::BlockId>& undecided, JudgedMore& more) {
  more.undecided.insert(more.undecided.end(), undecided.begin(), undecided.end());
}

}  // namespace

double longest_bolt(const Scene& scene) {
  double longest = 0;
  if (!scene.support) return longest;
  for (const Bolt& bolt : scene.support->plan.bolts) longest = std::max(longest, bolt.length);
  if (scene.support->plan.spot) longest = std::max(longest, scene.support->plan.spot->length);
  if (scene.support->design) {
    for (const double length : scene.support->design->lengths) longest = std::max(longest, length);
  }
  return longest;
}

double tunnel_length(const Scene& scene) {
  double length = 0;
  for (const Excavation& excavation : scene.excavations) {
    if (!excavation.tunnel) continue;
    const auto& axis = excavation.tunnel->axis;
    for (std::size_t i = 0; i + 1 < axis.size(); ++i) length += geometry::norm(axis[i + 1] - axis[i]);
  }
  return length;
}

void judge_cases(const Scene& scene, const Drawn& drawn, const topology::AuditedComplex& complex, JudgedMore& more) {
  for (const LoadCase& load : scene.stability->cases) {
    more.cases.push_back(
        {load.name, stability::analyse(complex, settings_on(complex.complex(), scene, drawn, load.loads))});
    note(more.cases.back().analysis.undecided, more);
  }
}

stability::SupportResult judge_plan(const Scene& scene, const Drawn& drawn, const topology::AuditedComplex& complex,
                                    const stability::Analysis& analysis) {
  return check_support(complex, settings_on(complex.complex(), scene, drawn, scene.stability->loads), analysis,
                       scene.support->plan);
}

void judge_support(const Scene& scene, const Drawn& drawn, const topology::AuditedComplex& complex,
                   const stability::Analysis& analysis, JudgedMore& more, bool designs) {
  const stability::Settings settings = settings_on(complex.complex(), scene, drawn, scene.stability->loads);
  const SupportSettings& support = *scene.support;
  more.support = judge_plan(scene, drawn, complex, analysis);
  note(more.support->undecided, more);
  for (std::size_t k = 0; k < more.cases.size(); ++k) {
    const LoadCase& load = scene.stability->cases[k];
    more.support_cases.push_back(
        {load.name, check_support(complex, settings_on(complex.complex(), scene, drawn, load.loads),
                                  more.cases[k].analysis, support.plan)});
    note(more.support_cases.back().support.undecided, more);
  }
  if (!support.design || !designs || !more.undecided.empty()) return;
  const DesignSettings& design = *support.design;
  for (const double length : design.lengths) {
    // Spot bolts would hide what the pattern lacks.
    stability::SupportPlan plan = support.plan;
    plan.spot.reset();
    // A pattern is as good as its worst place: every phase must pass.
    const auto passes = [&](double scale) {
      for (std::uint32_t k = 0; k < design.phases; ++k) {
        plan.bolts = bolts_with(support, scale, length, static_cast<double>(k) / design.phases);
        const stability::SupportResult result = check_support(complex, settings, analysis, plan);
        note(result.undecided, more);
        if (!result.passes()) return false;
      }
      return true;
    };
    DesignResult row{.length = length};
    double low = design.tightest, high = design.widest;
    if (passes(low)) {
      row.found = true;
      if (passes(high)) {
        low = high;
      } else {
        for (int i = 0; i < 7; ++i) {
          const double middle = std::sqrt(low * high);
          (passes(middle) ? low : high) = middle;
        }
      }
      row.scale = low;
      row.bolts = bolts_with(support, low, length, 0).size();
      row.cost = static_cast<double>(row.bolts) * (design.cost_per_bolt + design.cost_per_metre * length);
    }
    more.designs.push_back(row);
  }
}

void judge_sensitivity(const Scene& scene, const Drawn& drawn, const topology::AuditedComplex& complex,
                       const stability::Analysis& analysis, JudgedMore& more) {
  more.sensitivity =
      stability::sensitivity(complex, settings_on(complex.complex(), scene, drawn, scene.stability->loads), analysis);
}

}  // namespace cleave::scene
