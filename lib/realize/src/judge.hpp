#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "cleave/realize/run.hpp"
#include "cleave/stability/analyse.hpp"

namespace cleave::scene {

/// How much is judged.
enum class Detail : std::uint8_t {
  shown,   ///< all that a result shows
  counted  ///< what ensembles count: nothing that is only flagged, no key groups but those that decide, no designs
};

/// What the analysis needs, from a scene and its drawn joints. Everything was checked when the scene was parsed.
[[nodiscard]] stability::Settings settings_of(const Scene& scene, const SampledScene& drawn, const LoadSet& loads);
/// Those of the base case.
[[nodiscard]] stability::Settings settings_of(const Scene& scene, const SampledScene& drawn);
/// For these blocks: micro-blocks stay out of everything that is judged, where the scene asks for it.
[[nodiscard]] stability::Settings settings_on(const topology::BlockComplex& complex, const Scene& scene,
                                              const SampledScene& drawn, const LoadSet& loads);

/// The stages of [sequence], which the scene has.
[[nodiscard]] SequenceResult judge_stages(const Scene& scene, const topology::SequentialCut& cut,
                                          const topology::StageBlocks& final_state, const Judge& judge);

/// Loads of the base case and of the named ones that lie on no free face of the complex.
[[nodiscard]] std::vector<Problem> misplaced_loads(const Scene& scene, const SampledScene& drawn,
                                                   const topology::BlockComplex& complex);

/// m, the longest bolt that the support has or may try: how far behind free faces rock matters to it.
[[nodiscard]] Length longest_bolt(const Scene& scene);

/// So many blocks are judged together: fewer where groups are only noted.
[[nodiscard]] stability::Together together(const Scene& scene, unsigned threads);

/// m of rock that all tunnels go through; empty without a tunnel.
[[nodiscard]] std::optional<Length> tunnel_length(const std::vector<ExcavationInfo>& excavations);

/// The rock after each stage under each [[load]].
void judge_cases_in_stages(const Scene& scene, Realization& made);
/// [support] in the rock after each stage of the sequence: without and with the bolts of the stage.
void judge_support_in_stages(const Scene& scene, Realization& made, bool with_groups, unsigned threads);

// What is judged beside the base case goes into the realization; blocks cut by a window that it depends on into
// `Realization::undecided`.
void forget_cases_and_support(Realization& made);
void judge_cases(const Scene& scene, const topology::AuditedComplex& complex, Realization& made);
/// After `judge_cases`: the support is checked under each named case too. Shown: with factors, and its designs are
/// searched for, if the scene asks for them; then what `search_designs` gives.
std::vector<stability::KeyGroups> judge_support(const Scene& scene, const topology::AuditedComplex& complex,
                                                const stability::Analysis& analysis, Realization& made, Detail detail,
                                                unsigned threads);
/// The widest spacings for each length of bolt that the scene's design tries, into `Realization::designs`. Gives the
/// groups that miss their targets without support, of the base case and each load case, where groups are judged.
std::vector<stability::KeyGroups> search_designs(const Scene& scene, const topology::AuditedComplex& complex,
                                                 const stability::Analysis& analysis, Realization& made,
                                                 unsigned threads);
/// The plan with the targets of a load case.
[[nodiscard]] stability::SupportPlan plan_under(const LoadCase& load, stability::SupportPlan plan);
void judge_maximum_blocks(const Scene& scene, Realization& made);

/// Of the blocks of all batches: equal whether all the rock was cut or only that near free faces.
[[nodiscard]] std::string hash_of_key_blocks(const topology::BlockComplex& complex,
                                             const stability::Analysis& analysis);

}  // namespace cleave::scene
