#include <optional>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/scene/run.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/stability/near_field.hpp"
#include "cleave/topology/cut.hpp"
#include "cleave/topology/sequence.hpp"
#include "cut_problem.hpp"
#include "judge.hpp"

namespace cleave::scene {
namespace {

/// Ensembles count nothing that is only flagged.
stability::Settings unflagged(stability::Settings settings) {
  if (settings.rotation == stability::RotationCheck::flag) settings.rotation = stability::RotationCheck::off;
  return settings;
}

/// Judges what was cut for other strengths of the same joints.
void judge_realized(const Scene& scene, const std::optional<topology::SequentialCut>& in_stages,
                    const std::optional<topology::StageBlocks>& final_state, Realized& realized) {
  if (!realized.complex || !scene.stability) return;
  const Judge judge = [&](const topology::AuditedComplex& complex) {
    return stability::analyse(complex,
                              unflagged(settings_on(complex.complex(), scene, realized.drawn, scene.stability->loads)));
  };
  if (in_stages && final_state) realized.sequence = judge_stages(scene, *in_stages, *final_state, judge);
  realized.analysis = judge(*realized.complex);
  if (scene.support) {
    realized.support = judge_plan(scene, realized.drawn, *realized.complex, *realized.analysis, false);
  }
}

std::expected<Realized, std::vector<Problem>> realize_near(const Scene& scene, Drawn drawn) {
  StageTimer timer;
  JudgedMore more;
  const auto cases_and_support = [&](const topology::AuditedComplex& complex, const stability::Analysis& analysis) {
    more = {};
    if (!scene.stability->cases.empty()) judge_cases(scene, drawn, complex, more);
    if (scene.support && more.undecided.empty()) judge_support(scene, drawn, complex, analysis, more, false);
    return more.undecided;
  };
  auto near = stability::analyse_near_field(drawn.input, unflagged(settings_of(scene, drawn)), {.threads = 1}, timer,
                                            {.depth = longest_bolt(scene), .undecided = cases_and_support});
  if (near) {
    return Realized{std::move(drawn), std::move(near->complex), std::move(near->analysis), {}, std::move(more.support)};
  }
  if (auto* error = std::get_if<topology::CutError>(&near.error())) {
    return std::unexpected(std::vector{problem_of(*error, scene, drawn)});
  }
  return Realized{
      std::move(drawn), std::unexpected(std::get<topology::Certificate>(std::move(near).error())), {}, {}, {}};
}

}  // namespace

void realize(const Scene& scene, std::uint64_t first, std::uint64_t count,
             const std::function<void(std::uint64_t, const std::expected<Realized, std::vector<Problem>>&)>& use) {
  using Result = std::expected<Realized, std::vector<Problem>>;
  const auto fail = [&](std::vector<Problem> problems) {
    const Result failed = std::unexpected(std::move(problems));
    for (std::uint64_t k = first; k < first + count; ++k) use(k, failed);
  };
  auto drawn = draw(scene, first);
  if (!drawn) return fail(std::move(drawn).error());
  const auto next_strengths = [&](std::uint64_t k) {
    auto again = draw(scene, k);
    CLEAVE_ASSERT(again.has_value());  // the same joints as before
    return *std::move(again);
  };
  if (scene.output.only_key_blocks && scene.stability && !scene.sequence) {
    // How far the rock must be cut depends on the strengths.
    use(first, realize_near(scene, *std::move(drawn)));
    for (std::uint64_t k = first + 1; k < first + count; ++k) use(k, realize_near(scene, next_strengths(k)));
    return;
  }
  std::optional<topology::SequentialCut> in_stages;
  std::optional<topology::StageBlocks> final_state;
  auto cut = [&]() -> std::expected<topology::BlockComplex, topology::CutError> {
    if (!scene.sequence) return topology::cut(drawn->input, {.threads = 1});
    CLEAVE_TRY(in_stages, topology::SequentialCut::make(drawn->input, {.threads = 1}));
    CLEAVE_TRY(final_state,
               in_stages->blocks({.excavated = std::vector<std::uint8_t>(scene.excavations.size(), 1), .fallen = {}}));
    return final_state->complex;
  }();
  if (!cut) return fail(std::vector{problem_of(cut.error(), scene, *drawn)});
  Result result = Realized{*std::move(drawn), topology::audit(*std::move(cut)), {}, {}, {}};
  for (std::uint64_t k = first; k < first + count; ++k) {
    if (k > first) result->drawn = next_strengths(k);
    judge_realized(scene, in_stages, final_state, *result);
    use(k, result);
  }
}

}  // namespace cleave::scene
