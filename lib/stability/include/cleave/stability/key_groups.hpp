#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "cleave/assembly/groups.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/stability/support.hpp"

namespace cleave::stability {

/// What key groups are for.
enum class GroupsCheck : std::uint8_t {
  off,
  note,    ///< found and said; batches of key blocks stay as they are
  decide,  ///< blocks of groups that are not in doubt are key blocks too
};

/// Blocks that move together, or may.
struct KeyGroup {
  std::uint32_t batch = 0;  ///< 1, 2, ...: in whose state it was found; groups of a state leave together
  assembly::Verdict verdict = assembly::Verdict::in_doubt;
  bool moments = false;                        ///< blocks turn: translation alone does not move them
  std::vector<topology::BlockId> blocks = {};  ///< ascending
  std::vector<assembly::Rate> rates = {};      ///< of `blocks`: m/s2 and 1/s2, about their centroids
  Volume volume = {};
  geometry::Vec3 direction = {};  ///< unit, of the largest block; zero when in doubt
  /// What is out of balance: mass times acceleration, summed over the blocks. Empty when in doubt.
  std::optional<Force> net = {};
  double factor_up = 0;    ///< above it motion is certain; infinite when there is no such factor
  double factor_move = 0;  ///< factor of safety of the group
  /// With moments, of what translation alone moves; empty where it was not looked for.
  std::optional<double> factor_turning = {};
  /// The lesser of both.
  [[nodiscard]] double least_factor() const noexcept {
    return factor_turning ? std::min(factor_move, *factor_turning) : factor_move;
  }
  /// At which its largest block starts to move, of both the lesser: where that is more, to 0.1 %. Empty: the group has
  /// one block, or is too large.
  std::optional<double> factor_of_largest = {};
  /// In doubt as it rests, but would move with 5 % less strength, or where cohesion breaks bit by bit; false: what was
  /// not decided.
  bool weaker = false;
  bool factors = true;  ///< false: too large a group for factors
};

/// At most so many blocks are looked at together, and so many with moments. Any number of threads finds the same.
struct Together {
  std::size_t blocks = 0, turning = 0;
  unsigned threads = 1;  ///< at least 1
};
/// Where groups are only noted, so many that it costs little.
inline constexpr Together most_together{20'000, 20'000}, most_noted{3'000, 300};

struct KeyGroups {
  std::vector<KeyGroup> groups = {};  ///< by batch, then by lowest block
  std::size_t blocks = 0;             ///< looked at together in the first state
  bool stopped_at_max_batches = false;
  /// More blocks than are looked at together: nothing was looked for.
  bool too_many = false;
  /// More than are looked at with moments: in translation alone.
  bool without_moments = false;
  /// A group that moves touches more blocks that may move than are looked at together: more may move than it says.
  bool cut_off = false;
  /// A block that is known in part only was taken to stay beside a block that moves.
  bool at_the_edge = false;
  /// Those beside groups that move: in a larger window more may move, or more of them together.
  std::vector<topology::BlockId> edge = {};
};

/// Blocks near free faces judged together, state by state: first in translation, then with moments. With them go the
/// blocks farther off that would not stay without them, however many behind one another: taken to be fixed those would
/// press on nothing. All else is taken to be fixed, which only adds support; groups that touch its end are looked at
/// again in more rock around them. `most`: of more blocks nothing is looked for, and `too_many` says so.
[[nodiscard]] KeyGroups find_key_groups(const topology::AuditedComplex& complex, const Settings& settings,
                                        const Together& most = most_together);

/// The factor of safety of all blocks near free faces together, single ones too, as a bracket: strengths over `stands`
/// nothing moves nor is in doubt, over `moves` something does.
struct FactorTogether {
  double stands = 0;                                       ///< 0: below 0.1
  double moves = std::numeric_limits<double>::infinity();  ///< infinite: above 10; 0: below 0.1
  std::vector<topology::BlockId> blocks = {};              ///< that move at `moves`; ascending
  bool without_moments = false;                            ///< more blocks than are looked at with moments, somewhere
};
/// Either end to 1 %, in about twenty searches of the first state; empty when there are too many blocks.
[[nodiscard]] std::optional<FactorTogether> factor_together(const topology::AuditedComplex& complex,
                                                            const Settings& settings,
                                                            const Together& most = most_together);

/// Makes the blocks of groups that are not in doubt key blocks of the batch that their group was found in, where they
/// are in no batch. `analysis` and `groups` are of this complex.
void decide_by_groups(const topology::AuditedComplex& complex, const Settings& settings, const KeyGroups& groups,
                      Analysis& analysis);

/// Adds to what single blocks gave (`domain_held`) the groups with a block of the border that move together, its sides
/// smooth; `analysis` and `groups` say what has left. Of more blocks than `most` nothing is looked for: false.
bool add_held_together(const topology::AuditedComplex& complex, const Settings& settings, const Analysis& analysis,
                       const KeyGroups& groups, DomainHeld& held, const Together& most = most_noted);

// ---- Support of groups ----------------------------------------------------------------------------------------------

/// Groups that miss their target of safety, and what the support leaves of them: strengths over the target for sliding,
/// bolts and sprayed concrete over that of the block that they hold (falling: nothing carries it without them).
struct GroupSupport {
  KeyGroups below;  ///< without support
  KeyGroups left;   ///< with it: what still moves, or is in doubt
  /// More blocks than are judged together: nothing is known.
  [[nodiscard]] bool too_many() const noexcept { return below.too_many || left.too_many; }
  /// The worst verdict on blocks of `group` with the support; empty: all of them are held.
  [[nodiscard]] std::optional<assembly::Verdict> left_of(const KeyGroup& group) const;
  /// `net` of the groups left with blocks of `group`, sum. Empty: all are held, or one is in doubt.
  [[nodiscard]] std::optional<Force> net_left_of(const KeyGroup& group) const;
};

/// Bolts pull along their axes alone, as plate, bond, anchor and tendon let them between any two pieces of rock that
/// they go through: shear across them is left out, which is on the safe side. Sprayed concrete holds each edge of a
/// free face against what would come out of it. `support`: where its bolts go.
[[nodiscard]] GroupSupport check_groups(const topology::AuditedComplex& complex, const Settings& settings,
                                        const SupportPlan& plan, const SupportResult& support,
                                        const Together& most = most_together);
/// `GroupSupport::below` alone, which depends on nothing of the plan but its targets: made once, many plans are
/// checked. `untied`, empty at first, goes from plan to plan.
[[nodiscard]] KeyGroups groups_below_target(const topology::AuditedComplex& complex, const Settings& settings,
                                            const SupportPlan& plan, const Together& most = most_together);
[[nodiscard]] GroupSupport check_groups(const topology::AuditedComplex& complex, const Settings& settings,
                                        const SupportPlan& plan, const SupportResult& support, KeyGroups below,
                                        assembly::UntiedSets& untied, const Together& most = most_together);
/// Makes bolts that no single block or stitched body needs those of a group, where they pull at blocks of one that is
/// below its target, held or not: whether it would do without one of them is not asked, so that none of them counts as
/// redundant. A group that is one block of `support` alone changes nothing. `groups` is of this support.
void mark_bolts_of_groups(const GroupSupport& groups, SupportResult& support);
/// Of key blocks that only turn says which are held: those that move together, or alone, without the support and not
/// with it. Nothing where blocks were judged in translation only.
void judge_turning(const GroupSupport& groups, SupportResult& support);

}  // namespace cleave::stability
