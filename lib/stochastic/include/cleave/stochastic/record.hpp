#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/core/version.hpp"
#include "cleave/geometry/polygon.hpp"
#include "cleave/geometry/vec3.hpp"
#include "cleave/stability/result.hpp"
#include "cleave/topology/block_complex.hpp"

/// What is kept of one realization: some hundred bytes, one line of realizations.csv.
namespace cleave::stochastic {

enum class Outcome : std::uint8_t {
  done,
  certificate_failed,  ///< the block system did not pass its own check: nothing of it is counted
  refused,             ///< these joints could not be drawn or cut
};

/// Shapes as Menendez-Diaz et al. (2009) and Fu (2014, 5.3.1) count them: by joint planes, coplanar faces once, all
/// free faces one. Tetrahedral: three joint planes, or two and at least two free planes; pentahedral: four; higher:
/// more; other: the rest.
enum class Shape : std::uint8_t { tetrahedral, pentahedral, hexahedral, higher, other };
inline constexpr std::array<std::string_view, 5> shape_names{"tetrahedral", "pentahedral", "hexahedral", "higher",
                                                             "other"};
/// In the order of stability::Mode.
inline constexpr std::array<std::string_view, 4> mode_names{"falling", "lifting", "sliding", "wedge"};

/// Volumes in bins of equal ratio: bin i holds 10^(-6 + i/8) <= V < 10^(-6 + (i+1)/8) m3; the first and the last also
/// what lies beyond.
class SizeHistogram final {
 public:
  static constexpr std::size_t bins = 112;
  static constexpr double lowest_exponent = -6, per_decade = 8;
  void add(double volume) noexcept;
  [[nodiscard]] static std::size_t bin_of(double volume) noexcept;
  [[nodiscard]] const std::array<std::uint32_t, bins>& counts() const noexcept { return counts_; }
  void set(std::size_t bin, std::uint32_t count) { counts_[bin] = count; }
  /// Lower end of a bin, m3.
  [[nodiscard]] static double edge(std::size_t bin) noexcept;
  friend bool operator==(const SizeHistogram&, const SizeHistogram&) = default;

 private:
  std::array<std::uint32_t, bins> counts_{};
};

/// The key blocks of one realization: those of all batches, or those of the first.
struct Tally {
  std::uint64_t count = 0;
  double volume_m3 = 0;
  double largest_m3 = 0;
  double support_n = 0;              ///< sum of the net forces
  double support_transferred_n = 0;  ///< after force transfer, each force once, where it ends (equal without it)
  std::array<std::uint64_t, 4> modes{};
  std::array<std::uint64_t, 5> shapes{};
  std::uint64_t concave = 0;
  double sphericity_sum = 0;  ///< of Wadell's (1932) pi^(1/3) (6V)^(2/3)/S
  SizeHistogram sizes;
  friend bool operator==(const Tally&, const Tally&) = default;
};

/// Groups of blocks that miss their target together, with the support.
struct SupportedTogether {
  std::uint64_t not_held = 0;  ///< groups that still move
  std::uint64_t in_doubt = 0;  ///< groups that could not be decided
  Volume not_held_volume = {};
  bool too_many = false;  ///< more blocks than are judged together: nothing was looked for
  friend bool operator==(const SupportedTogether&, const SupportedTogether&) = default;
};

/// Where a block is, by its widest free faces: at tunnels and shafts, or at all other faces (slopes, benches, the ends
/// of openings, the ground).
enum class Part : std::uint8_t { roof, walls, floor, faces };
inline constexpr std::size_t part_count = 4;

/// Key blocks at one part.
struct PartTally {
  std::uint64_t count = 0;
  Volume volume = {};
  friend bool operator==(const PartTally&, const PartTally&) = default;
};

/// What the scene's support design comes to, where it has one.
struct Supported {
  std::uint64_t needing = 0;   ///< blocks below their required factor without support
  std::uint64_t not_held = 0;  ///< of those, blocks that the support does not bring up to it
  double not_held_m3 = 0;      ///< their volume
  double missing_n = 0;        ///< force that they lack, sum
  std::uint64_t spot_bolts = 0;
  std::uint64_t failing_bodies = 0;              ///< bodies stitched together by bolts that do not pass
  std::optional<SupportedTogether> groups = {};  ///< of a scene with groups = "decide"
  /// By Part: what 95 % of the free area of the blocks needing support there needs no more than, at most the plan's
  /// limit; 0 where there are none.
  std::array<Stress, part_count> pressures = {};
  friend bool operator==(const Supported&, const Supported&) = default;
};

/// Blocks judged together (key groups), where the scene decides by them: those that move are key blocks too.
struct Grouped {
  std::uint64_t moving = 0;    ///< groups that move or may
  std::uint64_t in_doubt = 0;  ///< groups that could not be decided
  Volume moving_volume = {}, in_doubt_volume = {};
  bool too_many = false;  ///< more blocks than are judged together: nothing was looked for
  friend bool operator==(const Grouped&, const Grouped&) = default;
};

/// Key blocks with the stress of the rock across their joints, where the scene states it.
struct Clamped {
  std::uint64_t held = 0;       ///< key blocks that the stress holds
  std::uint64_t undecided = 0;  ///< blocks that would move and of which the stress is not known
  Volume held_volume = {};
  friend bool operator==(const Clamped&, const Clamped&) = default;
};

/// Blocks at free faces that are not key blocks for a reason that may not hold.
struct Staying {
  std::uint64_t count = 0;
  Volume volume = {};
  friend bool operator==(const Staying&, const Staying&) = default;
};

/// The same of blocks that would miss their target.
struct StayingAtTarget {
  Staying border;   ///< by sides of the domain that are not free
  Staying tapered;  ///< because joints close on them by next to nothing
  friend bool operator==(const StayingAtTarget&, const StayingAtTarget&) = default;
};

/// The support after each stage of the excavation, with what is installed by then.
struct SupportedStages {
  std::uint64_t judged = 0;   ///< stages whose rock passed its check
  std::uint64_t failing = 0;  ///< of these, after which it does not hold, in the base case or under a load
  friend bool operator==(const SupportedStages&, const SupportedStages&) = default;
};

/// What moves under a load case, `[[load]]`.
struct CaseTally {
  std::uint64_t count = 0;  ///< key blocks
  Volume volume = {}, largest = {};
  Force net = {};                    ///< sum of the net forces
  std::optional<Supported> support;  ///< of a scene with [support]
  std::optional<Grouped> groups;     ///< of a scene with groups = "decide"
  std::optional<Staying> border;     ///< held only by sides of the domain that are not free, where it was asked
  std::optional<Staying> tapered;    ///< held only because joints close on them by next to nothing, where it was asked
  std::vector<PartTally> at_parts = {};       ///< by Part; empty where there are only cuts from above
  std::uint64_t lifting = 0;                  ///< of the key blocks
  std::optional<std::uint64_t> turning = {};  ///< as Record::turning
  std::optional<StayingAtTarget> at_target = {};
  friend bool operator==(const CaseTally&, const CaseTally&) = default;
};

/// Whole blocks of one bin of SizeHistogram. A block counts as often as its weight says.
struct SizeBin {
  std::uint32_t bin = 0;
  float number = 0, volume_m3 = 0;
  friend bool operator==(const SizeBin&, const SizeBin&) = default;
};
/// Blocks that touch no fixed side of the domain: the sizes of the rock's blocks.
struct WholeBlocks {
  std::uint64_t count = 0;         ///< blocks, without weights
  Volume volume = {};              ///< theirs, without weights
  std::array<double, 4> shapes{};  ///< by weight, in the order of shape_class_names
  std::vector<SizeBin> bins;       ///< those that hold a block, in order
  friend bool operator==(const WholeBlocks&, const WholeBlocks&) = default;
};
inline constexpr std::array<std::string_view, 4> shape_class_names{"cubic", "platy", "elongated", "bladed"};

/// How much of one joint set lies in the box around the domain.
struct SetTally {
  std::uint64_t joints = 0;  ///< that meet it
  double p32 = 0, p10 = 0, p21 = 0;
  friend bool operator==(const SetTally&, const SetTally&) = default;
};

/// What the joints cut one scanline into.
struct LineTally {
  std::uint64_t joints = 0;
  Length length = {};  ///< in the rock
  double rqd = 0;      ///< %
  friend bool operator==(const LineTally&, const LineTally&) = default;
};

/// Water in the joints of one network.
struct WaterTally {
  FlowRate inflow = {};          ///< out of all drained surfaces
  FlowRate low = {}, high = {};  ///< bounds of the exact rate of this network
  double wet_share = 0;          ///< of the area of joints: connected with standing water
  bool settled = false;          ///< to the tolerance asked for
  friend bool operator==(const WaterTally&, const WaterTally&) = default;
};
/// How the joints hang together. Shares are of their area.
struct FlowTally {
  std::uint64_t clusters = 0;
  double largest_share = 0;   ///< of the largest cluster
  double opening_share = 0;   ///< in clusters that reach an opening
  double backbone_share = 0;  ///< on ways from a fixed side of the domain to an opening
  /// Pairs of sides of the domain that one cluster connects, ascending, by `pair_of_sides`.
  std::vector<std::uint64_t> connected = {};
  std::optional<WaterTally> water = {};  ///< where some surface has a level
  friend bool operator==(const FlowTally&, const FlowTally&) = default;
};
/// The number of the pair `a` < `b` among all pairs of sides, whatever their number: (0, 1), (0, 2), (1, 2), (0, 3) ...
[[nodiscard]] constexpr std::uint64_t pair_of_sides(std::uint64_t a, std::uint64_t b) noexcept {
  return b * (b - 1) / 2 + a;
}

/// One order of the excavation stages: what leaves when it is followed.
struct OrderTally {
  std::uint64_t key_blocks = 0;
  double key_m3 = 0;
  friend bool operator==(const OrderTally&, const OrderTally&) = default;
};

/// Bins of Record::factors.
inline constexpr std::size_t factor_bins = 31;
inline constexpr double factor_step = 0.1;

struct Record {
  std::uint64_t realization = 0;
  Outcome outcome = Outcome::done;
  std::uint64_t joints = 0;
  std::uint64_t blocks = 0;
  double rock_m3 = 0;
  std::uint64_t concave_blocks = 0;
  std::uint32_t batches = 0;
  bool stopped_at_max_batches = false;
  std::uint64_t surface_blocks = 0;        ///< with a free face
  std::uint64_t surface_blocks_fixed = 0;  ///< of those, with a fixed face: they cannot move (domain too small?)
  double key_beside_fixed_m3 = 0;          ///< volume of key blocks with a neighbour that has a fixed face
  /// m2 of free faces of excavations, and of those of blocks that only the border of the domain holds; `middle`: in the
  /// middle half of the axis.
  double free_m2 = 0, free_fixed_m2 = 0, middle_m2 = 0, middle_fixed_m2 = 0;
  /// Pa: the largest force to be held at a block of the first batch over its free area.
  double largest_pressure_pa = 0;
  /// Blocks that would move without friction, by factor of safety: below 0.1, 0.2, ... 3.0, and above; empty when none.
  std::vector<std::uint64_t> factors;
  Tally all, first;
  std::vector<std::uint64_t> above;    ///< key blocks above each of the volumes asked for
  std::vector<double> chainage_m3;     ///< largest key block in each part of the axis; empty without a tunnel
  std::optional<Supported> support;    ///< of a scene with [support]
  std::optional<Grouped> groups;       ///< of a scene with groups = "decide"
  std::optional<Clamped> clamped;      ///< of a scene with [field_stress]
  std::optional<Staying> border;       ///< of a scene with the stability stage: held only by sides that are not free
  std::optional<Staying> tapered;      ///< the same: held only because joints close on them by next to nothing
  std::optional<WholeBlocks> whole;    ///< where all blocks are cut
  std::vector<SetTally> sets;          ///< in the order of the scene's sets
  std::vector<LineTally> lines;        ///< in the order of the scene's lines
  std::vector<OrderTally> orders;      ///< of a scene with [sequence]: its own order first, then those to compare
  std::vector<CaseTally> cases;        ///< in the order of the scene's load cases
  std::vector<PartTally> at_parts;     ///< by Part, key blocks with a free face; empty with cuts from above alone
  std::optional<FlowTally> flow = {};  ///< of a scene with [flow]
  std::optional<SupportedStages> supported_stages = {};  ///< of a scene with [support] that is dug in stages
  /// Blocks that turn or topple though they cannot slide, key blocks or not; empty where it was not asked.
  std::optional<std::uint64_t> turning = {};
  std::optional<StayingAtTarget> at_target = {};  ///< of a scene with a target, or with a support
  friend bool operator==(const Record&, const Record&) = default;
};

/// What quantities by load case are counted by: the realization under the load case of this number.
[[nodiscard]] Record under_case(const Record& record, std::size_t number);

/// One line without its end: numbers as shortest round trip, and a checksum (CRC-32 of what stands before it) last.
[[nodiscard]] std::string line_of(const Record& record);
/// Empty when the line is not whole or its checksum does not fit.
[[nodiscard]] std::optional<Record> record_of(std::string_view line);
/// The header of the columns.
[[nodiscard]] std::string_view record_columns() noexcept;

// ---- Files of records -----------------------------------------------------------------------------------------------

/// Part `number` of `of`: the realizations k with (k / group) mod of == number - 1. `group` realizations in a row
/// belong together (nested design); the scene says how many, so files do not.
struct Shard {
  std::uint64_t number = 1, of = 1;
  std::uint64_t group = 1;
  friend bool operator==(const Shard&, const Shard&) = default;
};

/// What the records of a file belong to; its first line.
struct RunIdentity {
  std::string version{cleave::version};  ///< of the program
  std::string scene_sha256;              ///< of the scene and the files it names
  std::uint64_t seed = 1;
  Shard shard;
  friend bool operator==(const RunIdentity&, const RunIdentity&) = default;
};
[[nodiscard]] std::string header_of(const RunIdentity& identity);

struct OtherRun {  ///< the file's first line is not that of this run
  std::string found, wanted;
};
struct InUse {};  ///< another process writes to the file
struct Unreadable {
  std::uint64_t line;  ///< where the file stops making sense, from 1
};
struct SystemFailure {  ///< the machine failed
  std::string reason;
};
using RecordFileError = std::variant<OtherRun, InUse, Unreadable, SystemFailure>;
[[nodiscard]] std::string describe(const RecordFileError& error);

/// The records of a run on disk, in the order of their realizations: the checkpoint. Each append is one write; a line
/// that was cut off (kill -9, power) is noticed by its checksum and taken away when the file is opened again.
///
/// Invariant: the file holds the header and whole records of the shard's realizations in their order.
class RecordFile final {
 public:
  /// Opens or makes the file and locks it against other processes.
  [[nodiscard]] static std::expected<RecordFile, RecordFileError> open(const std::filesystem::path& path,
                                                                       const RunIdentity& identity);
  RecordFile(RecordFile&& other) noexcept;
  RecordFile& operator=(RecordFile&&) = delete;
  ~RecordFile();

  [[nodiscard]] std::uint64_t records() const noexcept { return records_; }
  [[nodiscard]] std::uint64_t next_realization() const noexcept {
    return (shard_.number - 1 + records_ / shard_.group * shard_.of) * shard_.group + records_ % shard_.group;
  }
  [[nodiscard]] std::expected<void, RecordFileError> append(const Record& record);
  [[nodiscard]] std::expected<void, RecordFileError> flush_to_disk() const;

 private:
  RecordFile(int descriptor, Shard shard) : descriptor_{descriptor}, shard_{shard} {}
  int descriptor_;
  Shard shard_;
  std::uint64_t records_ = 0;
};

/// Reads a whole file of records one by one, without keeping them. `use` returns false to stop.
[[nodiscard]] std::expected<RunIdentity, RecordFileError> read_records(
    const std::filesystem::path& path, const std::function<bool(const Record&, std::string_view line)>& use);

/// What is asked of every realization besides the counts.
struct Questions {
  std::vector<double> volumes_m3;    ///< count key blocks above each
  std::vector<geometry::Vec3> axis;  ///< polyline of the tunnel that chainage runs along; empty: none
  std::uint32_t chainage_parts = 0;  ///< equal parts of the axis
  bool groups = false;               ///< blocks judged together decide
  bool clamped = false;              ///< stress across joints is looked at
  bool whole = false;                ///< all blocks are cut: their sizes are counted
  /// The domain where it is a box of rock without openings and free sides.
  std::optional<geometry::Box> undisturbed = {};
};

/// Length of a polyline, m.
[[nodiscard]] double length_of(std::span<const geometry::Vec3> axis) noexcept;
/// Where the foot of `point` on the polyline lies, m from its start: the nearest one, the first of equally near ones.
[[nodiscard]] double chainage_of(std::span<const geometry::Vec3> axis, geometry::Vec3 point) noexcept;

/// Counts one realization. `analysis` may be null: no stability stage. `held`: what only the border of the domain
/// holds, where it was asked. A face to a block that left before counts as free, as it was when the block was judged.
[[nodiscard]] Record measure(const topology::BlockComplex& complex, const stability::Analysis* analysis,
                             const Questions& questions, const stability::DomainHeld* held = nullptr);
/// Blocks that turn though translation lets them stay; empty where it was not asked.
[[nodiscard]] std::optional<std::uint64_t> count_turning(const stability::Analysis& analysis);
/// The key blocks under a load case.
[[nodiscard]] CaseTally measure_case(const topology::BlockComplex& complex, const stability::Analysis& analysis);

}  // namespace cleave::stochastic
