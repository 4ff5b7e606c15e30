#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cleave/core/quantity.hpp"
#include "cleave/core/sha256.hpp"
#include "cleave/stochastic/record.hpp"
#include "cleave/stochastic/statistics.hpp"

namespace cleave::stochastic {

/// Number that every realization has, by its name in summary.json.
struct Quantity {
  std::string_view name;
  double (*of)(const Record&);
  bool stability;            ///< needs the stability stage
  bool whole_system;         ///< needs all blocks
  bool quantiles;            ///< its values are kept (on disk) for order statistics
  bool support = false;      ///< needs a support design
  bool probability = false;  ///< 0 or 1 in a realization
  bool groups = false;       ///< needs blocks judged together
  bool clamped = false;      ///< needs the stress across joints
  bool by_slivers = false;   ///< hangs on the thinnest block met: means do not settle
  bool by_case = false;      ///< given for each load case as well
  bool at_parts = false;     ///< needs an opening that is no cut from above
  bool openings = false;     ///< needs excavations, over whose area it is
  bool flow = false;         ///< needs [flow]
  bool water = false;        ///< needs water that stands somewhere
  bool lifted = false;       ///< 0 where no load lifts
  bool stages = false;       ///< needs a support that is judged after each stage
  bool turning = false;      ///< needs the check of rotation
  bool at_target = false;    ///< needs a target
  /// Whether the scene of this record asks for it.
  [[nodiscard]] bool asked_in(const Record& record) const noexcept;
};
[[nodiscard]] const std::vector<Quantity>& quantities();
/// The quantity of a scene's word: with or without its unit ("key_block_volume", "key_block_volume_m3").
[[nodiscard]] const Quantity* quantity_named(std::string_view word);

enum class Method : std::uint8_t {
  mean,   ///< over realizations, Student's t moved by the skewness (Hall 1992); probabilities: exact
  ratio,  ///< sum over all realizations / sum over all realizations, delta method, t as of a mean; shares exact
  mean_of_ratios,  ///< over the realizations whose denominator is not 0
};
[[nodiscard]] std::string_view name_of(Method method) noexcept;

struct Estimate {
  std::string name;
  Method method = Method::mean;
  std::uint64_t realizations = 0;
  /// `high` of what no realization has: of volumes the chance to meet one (Clopper-Pearson) times all of the rock, else
  /// infinite; of differences that never are any both ends are.
  double mean = 0, standard_error = 0, low = 0, high = 0, std = 0, skewness = 0, smallest = 0, largest = 0;
  /// A long tail seen in few realizations: the interval may cover some per cent less than it says.
  bool optimistic = false;
  bool estimable = true;  ///< false: no number of realizations shows the mean
  /// BCa, given when |skewness|/sqrt(n) > 0.2 and the values were kept; never inside of low and high.
  std::optional<Interval> bootstrap;
};

struct QuantileEstimate {
  std::string name;
  double p = 0.5, value = 0;
  std::optional<Interval> interval;  ///< order statistics, at least the confidence; empty: too few realizations
};

/// P(largest key block of a realization > volume), and key blocks above it per metre of tunnel.
struct Exceedance {
  double volume_m3 = 0;
  std::uint64_t realizations = 0;  ///< with such a block
  double probability = 0;
  Interval interval;                             ///< Clopper-Pearson
  double number = 0, number_standard_error = 0;  ///< mean number of such blocks a realization
  std::optional<double> per_metre, per_metre_standard_error;
  /// Per part of the axis: P(a key block above the volume has its centroid there), with its interval.
  std::vector<double> by_chainage;
  std::vector<Interval> by_chainage_interval;
};

/// Nested design: what of the variance comes from where.
struct VarianceShare {
  std::string name;
  double geometry = 0;  ///< variance between geometries, strengths averaged out; not below 0
  double strength = 0;  ///< mean variance between the strength draws of one geometry
};

/// An order of the excavation stages over the realizations; the difference is paired (same rock in each realization).
struct OrderFigures {
  Estimate key_blocks, key_m3;
  Estimate key_blocks_minus_first, key_m3_minus_first;
  double share_best = 0;  ///< of the realizations in which no order has less volume; those of like volume share it
};

/// P(largest key block of a realization > volume) under a load case.
struct CaseExceedance {
  Volume volume = {};
  double probability = 0;
  Interval interval = {};  ///< Clopper-Pearson
};
/// What moves under a load case: its name and the quantities given for each.
struct CaseEstimates {
  std::string name;
  std::vector<Estimate> estimates = {};
  std::vector<CaseExceedance> exceedances = {};  ///< at the volumes of the base case
};

/// One point of a size distribution: share of the key blocks, by number and by volume, below a volume; from all blocks
/// of all realizations, with delta-method standard errors for the share by number.
struct SizePoint {
  double volume_m3 = 0, share = 0, standard_error = 0;
};

/// One point of the size distribution of the rock's blocks: shares of their number and of their volume in blocks below
/// a volume.
struct SizeShare {
  Volume volume = {};
  double by_number = 0, by_volume = 0;
  Interval by_number_interval = {}, by_volume_interval = {};  ///< of the effective number of blocks, as of all shares
};
/// Volume below which the share p of the blocks lies; ends where the curve's interval reaches p (Woodruff 1952), empty
/// where it does not.
struct SizeLevel {
  double p = 0.5, volume_m3 = 0;
  std::optional<double> low = {}, high = {};
};
/// Sizes of the blocks that touch no fixed side of the domain, over all realizations.
struct BlockSizeFigures {
  std::uint64_t blocks = 0;  ///< counted
  /// Each block counts as often as blocks of its extents are cut by the domain's sides for one that is not.
  bool corrected = false;
  Estimate mean_volume = {};              ///< m3, ratio of sums
  Estimate met_share = {};                ///< of the rock's volume, that of the blocks counted
  std::array<Estimate, 4> shapes = {};    ///< shares of shape_class_names
  std::vector<SizeLevel> by_number = {};  ///< at EnsembleOptions::size_levels
  std::vector<SizeLevel> by_volume = {};
  std::vector<SizeShare> curve = {};
};
/// How much of a joint set is in the box around the domain, over realizations.
struct SetEstimates {
  std::string name;
  Estimate joints, p32, p10, p21;
};

/// A scanline over realizations.
struct LineEstimates {
  std::string name;
  Estimate frequency, rqd;
};

/// How often one cluster of joints connects two sides of the domain.
struct Percolation {
  std::string from, to;
  double probability = 0;
  Interval interval = {};  ///< Clopper-Pearson
};

/// One point of the distribution of factors of safety, of the blocks that would move without friction.
struct FactorPoint {
  double factor = 0;
  double share_below = 0;   ///< of those blocks, all realizations
  Interval share_interval;  ///< of the effective number of blocks, as of all shares
  double number_below = 0;  ///< mean a realization
  double probability = 0;   ///< that a realization has such a block: the distribution of its least factor
  Interval interval;        ///< Clopper-Pearson
};

/// P(what has to be held > pressure) of a realization: over the area of the excavations, and on a block of the first
/// batch.
struct PressureExceedance {
  Stress pressure;
  std::optional<double> probability;  ///< empty without excavations
  std::optional<Interval> interval;   ///< Clopper-Pearson
  double block_probability = 0;
  Interval block_interval;  ///< Clopper-Pearson
};

struct RunningPoint {
  std::uint64_t realizations = 0;
  double mean = 0, half_width = 0;
};

struct Extreme {
  std::uint64_t realization = 0;
  double volume_m3 = 0;
  std::uint64_t count = 0;
};

struct Figures {
  std::uint64_t realizations = 0;  ///< counted
  double confidence = 0.95;
  std::vector<Estimate> estimates;
  std::vector<QuantileEstimate> quantiles;
  std::vector<Exceedance> exceedances;
  std::vector<OrderFigures> orders;       ///< of a scene with [sequence]
  std::vector<CaseEstimates> cases = {};  ///< of a scene with [[load]]
  std::uint64_t strengths_per_geometry = 1;
  std::vector<VarianceShare> variances;  ///< of a nested design
  std::vector<SizePoint> sizes, first_sizes;
  std::vector<SetEstimates> sets = {};    ///< those that had joints
  std::vector<LineEstimates> lines = {};  ///< those that lie in rock
  /// Of a scene with [flow]; of more than `sides_in_full` sides without the pairs that no realization connects, of more
  /// than `most_sides` none.
  std::vector<Percolation> percolation = {};
  std::optional<Estimate> jv = {};                   ///< sum of p10 over the sets
  std::optional<BlockSizeFigures> block_sizes = {};  ///< where all blocks were cut and some are whole
  std::string running_quantity;
  std::vector<RunningPoint> running;
  std::vector<Extreme> worst, best;   ///< by key-block volume, at most 5 each
  std::vector<std::uint64_t> failed;  ///< realizations that could not be done, at most 1000 listed
  std::uint64_t failures = 0;
  std::uint64_t stopped_at_max_batches = 0;
  std::vector<FactorPoint> factors = {};  ///< empty when there are no such blocks
  std::vector<PressureExceedance> pressures =
      {};  ///< from the last pressure that all exceed to the first that none does
  /// Of the area of excavations' free faces, that of blocks which the domain's border holds; in the middle half of the
  /// tunnel; and the length at each end of the tunnel that is lost so, m. Empty where there is no such area.
  std::optional<double> free_area_fixed_share = {}, middle_fixed_share = {}, guard_length_m = {};
  double surface_fixed_share = 0;  ///< of blocks at free faces, those with a fixed face
  double beside_fixed_share = 0;   ///< of key-block volume, what lies beside a block with a fixed face
  std::vector<std::string> notes;
  std::string hash;  ///< SHA-256 of the records' lines
};

struct EnsembleOptions {
  bool stability = true;
  bool whole_system = true;  ///< all blocks were cut: they can be counted
  double confidence = 0.95;
  std::vector<double> volumes_m3;
  std::optional<double> tunnel_length_m;
  std::optional<Length> tunnel_in_rock = {};  ///< what of it removes rock; empty: all
  /// Of all rock there is: no mean of volumes lies above, however long their tail.
  std::optional<Volume> rock = {};
  /// What pulls at all of it in the base case: no mean of forces that its blocks lack lies above. Empty: not known.
  std::optional<Force> pull = {};
  std::vector<std::optional<Force>> cases_pull = {};  ///< the same of each load case
  std::uint32_t chainage_parts = 0;
  std::uint64_t seed = 1;                ///< of the bootstrap
  bool support = false;                  ///< a support design was checked
  bool stages = false;                   ///< and so it was after each stage of the excavation
  bool turning = false;                  ///< blocks that cannot slide were asked whether they turn
  bool at_target = false;                ///< blocks were asked what brings them to a target
  bool groups = false;                   ///< blocks were judged together
  bool clamped = false;                  ///< stress across joints was looked at
  bool at_parts = false;                 ///< an opening is no cut from above: key blocks are counted by where they are
  bool openings = true;                  ///< there are excavations
  std::size_t orders = 0;                ///< of excavation stages
  std::vector<std::string> cases = {};   ///< names of the load cases, in the order of the records
  bool lifts = true;                     ///< a load of the base case may lift blocks; weight alone lifts none
  std::vector<bool> cases_lift = {};     ///< the same of each load case
  std::vector<std::string> sets = {};    ///< names of the joint sets, in the order of the records
  std::vector<std::string> lines = {};   ///< names of the scanlines, in the order of the records
  bool flow = false;                     ///< joints that hang together were looked for
  bool water = false;                    ///< and water was sent through them
  std::vector<std::string> sides = {};   ///< names of the domain's sides, by the number in FlowTally
  std::vector<double> size_levels = {};  ///< shares at which block sizes are given
  bool undisturbed = false;              ///< blocks count by their weights: see Questions::undisturbed
  /// Nested design: so many realizations in a row have the same joints, each its own strengths and loads. Then the
  /// sample unit is the geometry: means over its realizations enter every estimate.
  std::uint64_t strengths_per_geometry = 1;
  std::string running_quantity = "key_block_volume_m3";
};

inline constexpr std::size_t sides_in_full = 8, most_sides = 100;

/// Sums of block sizes and of amounts of joints, for Ensemble.
class BlockSizeSums final {
 public:
  BlockSizeSums(std::size_t sets, std::size_t lines) : sets_(sets), lines_(lines) {}
  /// One realization's share, which `add_unit` takes in the same order from `next` on, summed over `realizations`.
  void add_numbers(const Record& record, std::vector<double>& numbers) const;
  void add_unit(std::span<const double> sums, std::size_t& next, double realizations);

 private:
  friend class Ensemble;
  struct Summed {
    Moments moments;
    Tail tail;
    void add(double x) {
      moments.add(x);
      tail.add(x);
    }
  };
  struct OfSet {
    Summed joints, p32, p10, p21;
  };
  double blocks_ = 0;
  PairMoments met_, mean_volume_;
  Tail mean_volume_tail_;
  std::array<PairMoments, 4> shapes_;
  std::array<PairMoments, SizeHistogram::bins> number_below_, volume_below_;  // below the upper end of bin i
  struct OfLine {
    Summed frequency, rqd;
    bool met = false;  // lies in the rock
  };
  std::vector<OfSet> sets_;
  std::vector<OfLine> lines_;
  Summed all_sets_;
};

/// Reduces records, one after the other in the order of their realizations, to figures with their errors. Realizations
/// are independent of each other, blocks of one realization are not: the sample size is the number of realizations.
/// Same records, same bits. Memory does not grow with their number.
class Ensemble final {
 public:
  explicit Ensemble(EnsembleOptions options);
  void add(const Record& record, std::string_view line);
  [[nodiscard]] std::uint64_t counted() const noexcept { return counted_; }
  [[nodiscard]] const Moments& moments(std::string_view quantity) const { return moments_[index_of(quantity)]; }
  [[nodiscard]] Figures figures() const;

 private:
  struct Ratio {
    std::string_view name;
    double (*top)(const Record&);
    double (*bottom)(const Record&);
    bool stability, whole_system;
    [[nodiscard]] bool share() const noexcept { return name.contains("share_") || name.ends_with("_share"); }
  };
  [[nodiscard]] bool has(bool stability, bool whole_system) const {
    return (options_.stability || !stability) && (options_.whole_system || !whole_system);
  }
  [[nodiscard]] bool of_case(const Quantity& q) const { return q.by_case && has(q); }
  [[nodiscard]] bool has(const Quantity& q) const {
    return has(q.stability, q.whole_system) && (options_.support || !q.support) && (options_.groups || !q.groups) &&
           (options_.clamped || !q.clamped) && (options_.at_parts || !q.at_parts) &&
           (options_.openings || !q.openings) && (options_.flow || !q.flow) && (options_.water || !q.water) &&
           (options_.stages || !q.stages) && (options_.turning || !q.turning) && (options_.at_target || !q.at_target);
  }
  static const std::vector<Ratio>& ratios();
  [[nodiscard]] static std::size_t index_of(std::string_view quantity);
  [[nodiscard]] std::vector<double> numbers_of(const Record& record) const;
  void add_unit(const std::vector<double>& sums);
  void add_extremes(const Record& record);
  /// Of the loads of the base case or of a load case: some may lift blocks, and what pulls at all rock.
  struct UnderLoads {
    bool lifts = true;
    std::optional<Force> pull = {};
  };
  [[nodiscard]] UnderLoads base_loads() const { return {options_.lifts, options_.pull}; }
  /// With the interval of a probability where it is one.
  [[nodiscard]] Estimate estimate(const Quantity& quantity, const Moments& moments, const Tail& tail,
                                  const UnderLoads& loads) const;
  [[nodiscard]] Estimate estimate(std::string name, const Moments& moments, const Tail& tail, Method method,
                                  const std::optional<Force>& pull = {}) const;
  /// No mean of this name can be larger; empty where nothing says so.
  [[nodiscard]] std::optional<double> most_of(std::string_view name, const std::optional<Force>& pull) const;
  /// `most`: independent trials that there can be at most.
  [[nodiscard]] Interval share_interval(const PairMoments& pair, double most) const;
  [[nodiscard]] Estimate difference(std::string name, const Moments& moments) const;
  [[nodiscard]] Estimate ratio_estimate(std::string name, const PairMoments& pair, const Tail& tail, bool share) const;
  [[nodiscard]] double probability_of(const Moments& hits) const;
  [[nodiscard]] Interval probability_interval(const Moments& hits) const;
  [[nodiscard]] Interval volume_share_interval(const PairMoments& pair, double most) const;
  void add_orders(Figures& figures) const;
  void add_cases(Figures& figures) const;
  void add_block_sizes(Figures& figures) const;
  void add_variances(Figures& figures) const;
  void add_estimates(Figures& figures) const;
  void add_quantiles(Figures& figures) const;
  void add_exceedances(Figures& figures) const;
  void add_border(Figures& figures) const;
  [[nodiscard]] double metres_in_rock() const {
    return options_.tunnel_in_rock ? options_.tunnel_in_rock->si() : options_.tunnel_length_m.value_or(1);
  }
  void add_factors(Figures& figures) const;
  void add_pressures(Figures& figures) const;
  void add_percolation(Figures& figures) const;
  void add_notes(Figures& figures) const;

  EnsembleOptions options_;
  std::uint64_t counted_ = 0;       // realizations
  std::uint64_t units_ = 0;         // geometries whose realizations are all there; realizations without nesting
  std::vector<Moments> moments_;    // of quantities()
  std::vector<Tail> tails_;         // the same
  std::vector<ValueStore> values_;  // of those with quantiles; of a nested design the first of each geometry
  std::vector<ValueStore> means_;   // of those with quantiles, of a nested design, over a geometry
  std::vector<PairMoments> ratios_;
  std::vector<Tail> ratio_tails_;  // of the ratio in each geometry, by what is below
  Moments mean_volume_per_realization_;
  Tail mean_volume_per_realization_tail_;
  std::vector<Moments> exceeding_;  // 1 for a realization with a block above the volume
  std::vector<Moments> numbers_above_;
  std::vector<std::vector<Moments>> chainage_;  // by volume, by part
  struct OrderMoments {
    Moments count, volume, count_difference, volume_difference, best;
    Tail count_tail, volume_tail;
  };
  std::vector<OrderMoments> orders_;
  struct CaseMoments {
    std::vector<Moments> moments;  // of quantities()
    std::vector<Tail> tails;
    std::vector<Moments> exceeding;  // as `exceeding_`
  };
  std::vector<CaseMoments> cases_;
  BlockSizeSums block_sizes_;
  // Of the geometry at work: sums over its realizations, moments of the quantities, how many are there.
  std::vector<double> sums_;
  std::vector<Moments> within_;
  std::uint64_t in_unit_ = 0, seen_in_unit_ = 0;
  std::vector<double> within_squares_;  // sum over geometries of squares about the geometry's mean, by quantity
  std::vector<PairMoments> below_, first_below_;  // share of blocks below the upper end of bin i
  std::vector<RunningPoint> running_;
  std::uint64_t next_running_ = 10;
  std::size_t running_index_ = 0;
  std::vector<Extreme> worst_, best_;
  std::vector<std::uint64_t> failed_;
  std::uint64_t failures_ = 0, stopped_ = 0;
  std::uint64_t surface_ = 0, surface_fixed_ = 0;
  double free_ = 0, free_fixed_ = 0, middle_ = 0, middle_fixed_ = 0;  // m2
  std::vector<PairMoments> factors_below_;                            // share of blocks below the upper end of bin i
  std::vector<Moments> with_factor_below_;                            // 1 for a realization with such a block
  std::vector<Moments> pressing_, pressing_blocks_;                   // 1 for a realization above the pressure
  double key_volume_ = 0, beside_fixed_ = 0;
  std::vector<Moments> connected_;  // 1 for a realization that connects this pair of sides
  Sha256 hash_;
};

}  // namespace cleave::stochastic
