#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <vector>

#include "cleave/realize/run.hpp"
#include "cleave/topology/sequence.hpp"
#include "held_notes.hpp"
#include "judge.hpp"

namespace cleave::scene {

/// Makes one realization of a scene by executing the steps of its plan: of a single run, an ensemble, a shard and a
/// replay. Each step is booked and shown under its name.
class Realizer final {
 public:
  using Done = std::expected<void, std::vector<Problem>>;
  Realizer(const Scene& scene, const RunOptions& options, Detail detail, StageTimer& timer, Progress& progress);

  /// Does those steps of the plan that make a realization, in its order.
  [[nodiscard]] Done execute(const Plan& plan);
  /// Goes on with another realization of the same geometry; what was cut stays.
  [[nodiscard]] Done next(const Plan& plan, std::uint64_t realization);

  [[nodiscard]] const Realization& now() const noexcept { return made_; }
  /// On load cases, earlier stages and the support.
  [[nodiscard]] const std::vector<std::string>& notes() const noexcept { return notes_; }
  [[nodiscard]] Realization take() && { return std::move(made_); }

 private:
  [[nodiscard]] Done step(Step which);
  [[nodiscard]] Done draw_joints();
  /// Refuses what is expected to be too large for the machine.
  [[nodiscard]] Done fits_memory() const;
  [[nodiscard]] Done cut();
  [[nodiscard]] Done cut_near_free_faces();
  void audit();
  [[nodiscard]] Done judge();
  /// Each [[load]], with its groups where they are judged.
  void judge_load_cases();
  void support();
  [[nodiscard]] Done clamp();
  [[nodiscard]] Done move();
  [[nodiscard]] Done send_water();
  [[nodiscard]] stability::Settings settings(const topology::BlockComplex& complex) const;
  [[nodiscard]] stability::Analysis analyse(const topology::AuditedComplex& complex) const;
  [[nodiscard]] stability::Analysis analyse_stage(const topology::AuditedComplex& complex) const;

  // Blocks judged together (realizer_groups.cpp).
  [[nodiscard]] bool judges_groups() const;
  void find_groups(const topology::AuditedComplex& complex);
  void judge_groups();
  void judge_groups_of_cases();
  void judge_groups_of_stages();
  void judge_groups_below_target();
  [[nodiscard]] std::optional<stability::KeyGroups> groups_below(const topology::AuditedComplex& complex,
                                                                 const stability::Settings& settings,
                                                                 const std::optional<stability::KeyGroups>& groups,
                                                                 const std::optional<Targets>& target) const;
  void support_of_groups();
  /// Of the base case, `number` 0, or a load case; empty, and noted, where more blocks than are judged together are
  /// near free faces.
  [[nodiscard]] std::optional<stability::GroupSupport> groups_with_support(const stability::Settings& settings,
                                                                           const stability::SupportPlan& plan,
                                                                           stability::SupportResult& support,
                                                                           std::string_view where, std::size_t number);
  /// Nothing is asked of ensembles that is only flagged.
  [[nodiscard]] bool asks_what_turns() const;

  // What stays by something that may not be there (realizer_held.cpp).
  /// Blocks that stay for a reason that may not hold: a side of the domain, a slight taper.
  void hold_by_next_to_nothing(const stability::Settings& settings);
  /// What reaches its target so; empty without one.
  [[nodiscard]] std::optional<HeldAtTarget> at_target(const stability::Settings& settings,
                                                      const stability::Analysis& analysis,
                                                      const std::optional<stability::KeyGroups>& groups,
                                                      const LoadCase* load);
  [[nodiscard]] const stability::DomainHeld* border_at(std::size_t number) const;
  void taper_of_stages();
  /// In all states, what a reader should not be left to find out.
  void look_for_held();
  void look_for_held_in_stages(HeldNotes& held);
  /// Asked of blocks under a load case; of the base case without one.
  [[nodiscard]] std::optional<Targets> target_of(const LoadCase* load) const;
  /// What micro-blocks hold, in the base case, under each load and after each stage.
  void held_by_micro_blocks();
  void supported_by_micro_blocks();
  void left_out_and_moving();
  /// What the border holds of single blocks, and of groups.
  [[nodiscard]] stability::DomainHeld with_groups(stability::DomainHeld held, const stability::Settings& settings,
                                                  const stability::Analysis& analysis,
                                                  const std::optional<stability::KeyGroups>& groups,
                                                  std::string_view where);

  template <class Work>
  decltype(auto) booked(Step which, Work&& work) {
    progress_->begin(name_of(which));
    return timer_->run(name_of(which), std::forward<Work>(work));
  }

  const Scene* scene_;
  RunOptions options_;
  Detail detail_;
  StageTimer* timer_;
  Progress* progress_;
  /// Only the rock near free faces is cut, as far as judging it asks for: those steps are then one.
  bool near_;
  bool drawn_ = false;
  std::optional<topology::BlockComplex> unchecked_;  ///< between cut and audit
  std::optional<topology::SequentialCut> in_stages_;
  std::optional<topology::StageBlocks> final_state_;
  Realization made_;
  std::vector<std::string> notes_;
  /// What misses its target without support, where a search for designs has found it: base case, then load cases.
  std::vector<stability::KeyGroups> below_target_;
  /// What sides of the domain hold at strengths over the target: base case, then load cases.
  std::vector<stability::DomainHeld> border_at_target_;
};

}  // namespace cleave::scene
