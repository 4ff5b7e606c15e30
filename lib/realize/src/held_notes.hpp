#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cleave/realize/run.hpp"
#include "judge.hpp"

namespace cleave::scene {

/// One state of the rock that was judged: under the loads of the base case or of a named one, when all is excavated or
/// after a stage. Outlives nothing it points at.
struct JudgedState {
  const topology::AuditedComplex* complex;
  stability::Settings settings;
  const stability::Analysis* analysis;
  const std::optional<stability::KeyGroups>* groups;
  std::optional<Targets> target = {};  ///< asked of blocks, by the scene or its support
  std::string where = {};              ///< before each note
  enum class Place : std::uint8_t { base, load, stage, stage_under_load };
  Place place = Place::base;
  /// What sides of the domain hold, alone and together.
  const stability::DomainHeld* held = nullptr;
  /// Groups that move at strengths over the target, where nothing else tells of them.
  const std::optional<stability::KeyGroups>* below_target = nullptr;
  /// What these sides hold at strengths over the target, alone and together; null: not looked for yet.
  const stability::DomainHeld* border_at_target = nullptr;
};

/// By what they are: blocks of another state have other numbers.
template <class Block>
[[nodiscard]] bool same_block(const Block& a, const Block& b) {
  return norm(a.centroid - b.centroid) <= 1e-9 * std::cbrt(a.volume.si()) &&
         std::abs((a.volume - b.volume).si()) <= 1e-9 * a.volume.si();
}

/// Looks in every state at what stays, or reaches its target, only by what may not be there, and at what misses its
/// target where no support asks. Each block is told of once.
class HeldNotes final {
 public:
  /// Outlives neither.
  HeldNotes(const Scene& scene, stability::Together most, std::vector<std::string>& notes)
      : scene_{&scene}, most_{most}, notes_{&notes} {}

  void look(const JudgedState& state);
  /// Of all states so far.
  [[nodiscard]] NotAsked not_asked() const;

 private:
  enum class Reason : std::uint8_t { border, taper, taper_together, within, lesser, turns, own };
  struct Row {
    topology::BlockId block;
    geometry::Vec3 centroid = {};
    Volume volume = {};
    double factor_of_safety = 0;  ///< infinite: only together with others
  };
  using Rows = std::vector<Row>;
  struct Known {
    Reason reason;
    bool at_target;
    Row row;
  };

  [[nodiscard]] static Row row_of(const JudgedState& state, topology::BlockId block, double factor);
  [[nodiscard]] static Rows rows_of(const JudgedState& state, const stability::DomainHeld& held, double factor);
  [[nodiscard]] static Rows rows_of(const JudgedState& state, const std::vector<stability::Barred>& rows,
                                    double factor);
  [[nodiscard]] Rows wedged_together(const JudgedState& state, const stability::Settings& with, double factor) const;
  [[nodiscard]] Rows kept_by(Reason reason, const JudgedState& state, const stability::Settings& with,
                             double factor) const;
  [[nodiscard]] static Rows turning(const JudgedState& state);
  /// Those that were not told of for this reason; from now on they were.
  [[nodiscard]] Rows fresh(Reason reason, bool at_target, Rows rows);
  [[nodiscard]] static bool told(Reason reason, JudgedState::Place place);
  [[nodiscard]] static std::string words(Reason reason, const Rows& rows, const JudgedState& state);
  void as_it_is(const JudgedState& state);
  void at_target(const JudgedState& state);
  void below_target(const JudgedState& state);
  void count_not_asked(const Rows& rows);

  const Scene* scene_;
  stability::Together most_;
  std::vector<std::string>* notes_;
  std::vector<Known> known_;
  Rows not_asked_;
};

/// Asked of blocks under a load case, of the base case without one: its own target, else that of the scene, else of its
/// support; empty where it has none.
[[nodiscard]] std::optional<Targets> targets_under(const Scene& scene, const LoadCase* load);
/// What sides of the domain that are not free hold. `groups`: of blocks judged together, where they decide, else null.
[[nodiscard]] stability::DomainHeld held_by_border(const topology::AuditedComplex& complex,
                                                   const stability::Settings& settings,
                                                   const stability::Analysis& analysis,
                                                   const std::optional<stability::KeyGroups>* groups);
/// What reaches a target for sliding only by these (`border`) or a slight taper. `with`: strengths over the target;
/// `analysis`: at strengths as they are.
[[nodiscard]] HeldAtTarget held_at_target(const topology::AuditedComplex& complex, const stability::Settings& with,
                                          const stability::Analysis& analysis,
                                          const std::optional<stability::KeyGroups>* groups,
                                          const stability::DomainHeld& border, double target);

}  // namespace cleave::scene
