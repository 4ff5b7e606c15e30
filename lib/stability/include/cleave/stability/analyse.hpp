#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "cleave/core/cost.hpp"
#include "cleave/stability/actions.hpp"
#include "cleave/stability/result.hpp"
#include "cleave/stability/strength.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"

namespace cleave::stability {

// ---- How it is done -------------------------------------------------------------------------------------------------

/// Where the force transfer of Fu (2014, 4.3) can be read in two ways. The first of each is the default; it never lets
/// a force vanish without saying so.
struct TransferReadings {
  enum class Reach : std::uint8_t {
    any_earlier,  ///< to blocks of every earlier batch
    adjacent,     ///< to the batch just before only; the shares of others are lost (`Transferred::lost`)
  };
  enum class Force : std::uint8_t {
    net,      ///< T - R, what friction does not hold
    driving,  ///< T: an upper bound
  };
  enum class Along : std::uint8_t {
    motion,   ///< in line: along the direction of motion, by projected area
    normals,  ///< across each face only compression along its normal; planes that press take up the rest
  };
  enum class Receiver : std::uint8_t {
    judged_anew,  ///< mode and direction under the forces received
    keeps_mode,   ///< the mode from before, with its formulas
  };
  enum class Stabilised : std::uint8_t {
    keeps_batch,   ///< a block that the forces received make stable stays in its batch, and is listed as such
    batches_anew,  ///< it holds its place, and the batches are found again
  };
  enum class Interface : std::uint8_t {
    ignored,   ///< any shear crosses a face; `Transferred::shear_ratio` tells
    strength,  ///< no more shear than friction and cohesion of the face allow; the rest is lost
  };
  /// Of the blocks that pass forces on, where support is checked (the analysis itself is at full strengths).
  enum class Strengths : std::uint8_t {
    full,    ///< as Fu: blocks of a factor from 1 to the target push on nobody
    target,  ///< divided by the required factor of sliding, as those of the block that is to be held
  };
  Reach reach = Reach::any_earlier;
  Force force = Force::net;
  Along along = Along::motion;
  Receiver receiver = Receiver::judged_anew;
  Stabilised stabilised = Stabilised::keeps_batch;
  Interface interface = Interface::ignored;
  Strengths strengths = Strengths::full;
  friend bool operator==(const TransferReadings&, const TransferReadings&) = default;
};

/// Friction of several faces with one normal and different joints (Goodman & Shi take one joint a plane).
enum class GroupFriction : std::uint8_t {
  area_mean,  ///< tan(friction) weighted by contact area: equal normal stress on faces that move together
  smallest,   ///< lower bound
};

struct Settings {
  RockMass rock;
  StrengthTable strengths;
  Loads loads;
  PartialFactors partial = {};
  GroupFriction group_friction = GroupFriction::area_mean;
  /// Count a block removable only when it can leave all its contacts at once (cone of dimension 3).
  bool strict = false;
  /// Cohesion also on faces that are only brushed: parallel to the motion, without reaction.
  bool parallel_contact = false;
  bool force_transfer = true;
  TransferReadings transfer = {};
  std::uint32_t max_batches = 50;
  /// Blocks that count as gone from the start (micro-blocks): not judged, in no batch, and holding nothing.
  std::vector<topology::BlockId> left_out = {};
  /// Of a block that is known in part only (topology::Block::truncated) it is enough to know that it is no key block;
  /// otherwise it must be known not to move without friction either.
  bool only_key_blocks = false;
  /// The factor of safety that must be certain then: the scene's target, where blocks below it are counted.
  double least_factor = 1;
  /// Water and loads on free faces.
  Actions actions = {};
  /// With `decide` parts of a block are enough to know that it stays only when they leave it no direction.
  RotationCheck rotation = RotationCheck::off;
  /// Joint planes that are parallel but for less than this, metres a metre, count as parallel.
  double taper_ignored = 0;
};

/// The settings with friction and cohesion divided by a factor > 0, as well as by their partial factors: what moves
/// then has a lower factor of safety.
[[nodiscard]] Settings with_strengths_over(const Settings& settings, double factor);

/// Key blocks of the complex in batches, after Goodman & Shi (1985) with the mode found as the projection of the
/// resultant (Fu 2014, ch. 4, corrected). Translation; rotation of single blocks where asked (`Settings::rotation`); no
/// arching, in-situ stress ignored.
///
/// All blocks of a batch are judged in the same state and removed together; faces to removed blocks are free from then
/// on. Blocks with a fixed face never move. With `force_transfer` the net force of later batches is passed on to
/// earlier ones, last batch first. Deterministic; after the first batch the cost follows what changes.
[[nodiscard]] Analysis analyse(const topology::AuditedComplex& complex, const Settings& settings);

// ---- Sensitivity ----------------------------------------------------------------------------------------------------

/// Factor of safety of one block when one input is `share` lower and higher, all else as it is.
struct Sensitivity {
  topology::BlockId block;
  double share = 0;
  double base = 0;
  std::array<double, 2> friction{};  ///< tan(friction) lower, higher
  std::array<double, 2> cohesion{};
  std::array<double, 2> water{};  ///< pressures
};

/// Of the blocks of the first batch, each in the state after excavation without forces of later batches.
[[nodiscard]] std::vector<Sensitivity> sensitivity(const topology::AuditedComplex& complex, const Settings& settings,
                                                   const Analysis& analysis, double share = 0.2);

// ---- Near free faces only -------------------------------------------------------------------------------------------

/// The part of a scene in which key blocks are looked for: a box around all free faces, made larger as long as blocks
/// that it cuts through might move.
///
/// A block that the window cuts through stays for certain when its known faces leave it no direction of movement, or
/// when friction on them holds it whatever else belongs to it; only the others ask for a larger window.
class NearField final {
 public:
  /// Empty when there is no free face, or when the window would hold more than half of the domain: cut all of it then.
  /// The box goes `depth` m beyond the free faces at least.
  [[nodiscard]] static std::optional<NearField> around_free_faces(const topology::CutInput& input, double depth = 0);

  [[nodiscard]] topology::Window window() const noexcept;
  /// Moves the sides that the undecided blocks reach. False when nearly all of the domain would be cut: cut all of it.
  [[nodiscard]] bool grow(const topology::BlockComplex& complex, std::span<const topology::BlockId> undecided);

 private:
  NearField() = default;
  [[nodiscard]] bool worth_while() const noexcept;
  std::array<double, 3> free_min_{}, free_max_{};      ///< box of the free faces within the domain's
  std::array<double, 3> domain_min_{}, domain_max_{};  ///< box of the domain
  std::array<double, 6> margin_{};                     ///< x-, x+, y-, y+, z-, z+; m
};

/// Key blocks without cutting more than their neighbourhood.
struct NearKeyBlocks {
  topology::AuditedComplex complex;        ///< of the window; blocks at its edge are marked truncated
  Analysis analysis;                       ///< that of the whole scene
  std::optional<topology::Window> window;  ///< empty when all was cut after all
  unsigned rounds = 1;                     ///< how many windows were cut
};
using NearError = std::variant<topology::CutError, topology::Certificate>;

/// What is asked of the same window beside the analysis.
struct NearFieldOptions {
  Length depth = {};  ///< how far behind free faces the first window goes at least (the longest bolt)
  /// Looks at a window in which the analysis is decided; returns the truncated blocks that its own answer depends on,
  /// none when it stands.
  std::function<std::vector<topology::BlockId>(const topology::AuditedComplex&, const Analysis&)> undecided = {};
};

using NearMore = NearFieldOptions;  ///< old name

/// Batches, key blocks and what moves them are those of `analyse` on the whole scene (block numbers are not), under all
/// loads: cost goes with the free surface, not with the volume. Of the blocks that would move but for friction those
/// below `Settings::least_factor` are listed, and others that lie in the window as a whole. With pressures stated joint
/// by joint a block that the window cuts through is decided only when nothing lets it move at all. Books its work under
/// "cut", "audit" and "stability".
[[nodiscard]] std::expected<NearKeyBlocks, NearError> analyse_near_field(const topology::CutInput& input,
                                                                         const Settings& settings,
                                                                         const topology::CutOptions& options,
                                                                         StageTimer& timer,
                                                                         const NearFieldOptions& more = {});

// ---- Held by what lies inside ---------------------------------------------------------------------------------------

/// A block that stays only because of blocks wholly inside it: a closed box of joints in its middle.
struct InterlockedByInclusion {
  topology::BlockId block;
  std::vector<topology::BlockId> inside = {};  ///< ascending
  /// Of all of them as one body, without forces of later batches.
  Mode mode = Mode::stable;
  geometry::Vec3 direction = {};
  Force net = {};
  double factor_of_safety = 0;
};

using HeldFromWithin = InterlockedByInclusion;  ///< old name

/// Blocks are judged one by one, so a block and what it encloses hold each other for ever: the one inside has no way
/// out, and its faces leave the one around it none. Really they go together. This finds such blocks in the state that
/// the analysis ends in, and those of them that leave as one body. Blocks that a window cuts through are not asked.
[[nodiscard]] std::vector<InterlockedByInclusion> held_from_within(const topology::AuditedComplex& complex,
                                                                   const Settings& settings, const Analysis& analysis);

/// A block that stays only for a reason that may be none.
struct Barred {
  topology::BlockId block;
  Volume volume = {};
  double factor_of_safety = 0;  ///< without it, the forces on the block as they are; below 1
};

/// Because blocks that are smaller, or removable, stand in its way or under it.
///
/// Blocks with something open, no key blocks, that would be were the neighbours that are smaller or removable not
/// there, in the state that the analysis ends in: whether they can push those out is what key groups tell. Blocks that
/// a window cuts through are neither asked nor taken away.
[[nodiscard]] std::vector<Barred> barred_by_lesser(const topology::AuditedComplex& complex, const Settings& settings,
                                                   const Analysis& analysis);

/// Joints that close on a block by less than this, metres a metre, hold it in numbers: not where rock gives way, and no
/// survey measures them so.
inline constexpr double slight_taper = 2e-3;
/// Because of a slight taper: blocks with something open, no key blocks, that would be were faces parallel that are so
/// but for that much, in the state that the analysis ends in.
[[nodiscard]] std::vector<Barred> held_by_taper(const topology::AuditedComplex& complex, const Settings& settings,
                                                const Analysis& analysis);

/// Points that stand for what a face shares with a neighbour, a quarter of its area each: their centroid is its own,
/// and they spread as it does along its two principal axes, times 1.2 in place of the square root of 2. So even
/// cohesion at them bears no more twisting than cohesion spread over a convex patch. Empty when nothing is shared.
[[nodiscard]] std::optional<std::array<geometry::Vec3, 4>> spread_of(const topology::BlockComplex& complex,
                                                                     const topology::Face& face,
                                                                     topology::BlockId neighbour);

/// Corners of the convex parts, or parts of them, that make up what a face shares with a neighbour: their hull is not
/// smaller than its own.
[[nodiscard]] std::vector<geometry::Vec3> shared_corners(const topology::BlockComplex& complex,
                                                         const topology::Face& face, topology::BlockId neighbour);

/// Blocks at free faces (or beside what has left) that touch a side of the domain that is not free are never judged:
/// the rock beyond is unknown. This finds those of them that would be key blocks, in the state the analysis ends in,
/// were these sides smooth joints. A side that such a block would stand on (one that looks up by more than 45 degrees)
/// holds as rock does. Blocks that a window cuts through are not asked.
[[nodiscard]] DomainHeld domain_held(const topology::AuditedComplex& complex, const Settings& settings,
                                     const Analysis& analysis);

}  // namespace cleave::stability
