#pragma once

#include <vector>

#include "cleave/scene/run.hpp"
#include "cleave/stability/analyse.hpp"

namespace cleave::scene {

/// What the analysis needs, from a scene and its drawn joints. Everything was checked when the scene was parsed.
[[nodiscard]] stability::Settings settings_of(const Scene& scene, const Drawn& drawn, const StabilitySettings& wanted,
                                              const LoadSet& loads);
/// Those of the base case.
[[nodiscard]] stability::Settings settings_of(const Scene& scene, const Drawn& drawn);
/// For these blocks: micro-blocks stay out of everything that is judged, where the scene asks for it.
[[nodiscard]] stability::Settings settings_on(const topology::BlockComplex& complex, const Scene& scene,
                                              const Drawn& drawn, const LoadSet& loads);

/// The stages of [sequence], which the scene has.
[[nodiscard]] SequenceResult judge_stages(const Scene& scene, const topology::SequentialCut& cut,
                                          const topology::StageBlocks& final_state, const Judge& judge);

/// Point and line forces of the base case and of the named ones that lie on no free face of the complex.
[[nodiscard]] std::vector<Problem> misplaced_loads(const Scene& scene, const Drawn& drawn,
                                                   const StabilitySettings& wanted,
                                                   const topology::BlockComplex& complex);

/// m, the longest bolt that the support has or may try: how far behind free faces rock matters to it.
[[nodiscard]] double longest_bolt(const Scene& scene);

/// m, of all tunnels.
[[nodiscard]] double tunnel_length(const Scene& scene);

/// What is judged beside the base case.
struct JudgedMore {
  std::vector<CaseResult> cases;
  std::optional<stability::SupportResult> support;
  std::vector<CaseSupport> support_cases;
  std::vector<DesignResult> designs;
  std::vector<stability::Sensitivity> sensitivity;
  std::vector<MaximumRow> maximum_blocks;
  /// Blocks cut by a window that cases or support depend on: then none of it holds, and a larger window is needed.
  std::vector<topology::BlockId> undecided;
};
void judge_cases(const Scene& scene, const Drawn& drawn, const topology::AuditedComplex& complex, JudgedMore& more);
/// After `judge_cases`: the support is checked under each named case too. `designs`: its designs are searched for, if
/// the scene asks for them.
void judge_support(const Scene& scene, const Drawn& drawn, const topology::AuditedComplex& complex,
                   const stability::Analysis& analysis, JudgedMore& more, bool designs = true);
/// The support plan as it stands, under the base case; no design is searched for. Without `factors` the verdicts alone.
[[nodiscard]] stability::SupportResult judge_plan(const Scene& scene, const Drawn& drawn,
                                                  const topology::AuditedComplex& complex,
                                                  const stability::Analysis& analysis, bool factors);
void judge_sensitivity(const Scene& scene, const Drawn& drawn, const topology::AuditedComplex& complex,
                       const stability::Analysis& analysis, JudgedMore& more);
void judge_maximum_blocks(const Scene& scene, const Drawn& drawn, JudgedMore& more);

}  // namespace cleave::scene
