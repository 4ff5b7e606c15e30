#include "cleave/stochastic/record.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace cleave::stochastic {
namespace {

using topology::Block;
using topology::BlockComplex;
using topology::BlockId;
using topology::Face;
using topology::PlaneId;
using topology::Role;

constexpr std::uint32_t stays = UINT32_MAX;

class Measuring final {
 public:
  Measuring(const BlockComplex& complex, const stability::Analysis& analysis, const Questions& questions)
      : complex_{complex},
        analysis_{analysis},
        questions_{questions},
        left_{complex.blocks().size(), stays},
        part_length_{questions.chainage_parts > 0 ? length_of(questions.axis) / questions.chainage_parts : 0} {}

  void count(Record& record) {
    for (const stability::Batch& batch : analysis_.batches) {
      for (const BlockId block : batch.blocks) left_[block] = batch.number;
    }
    record.above.resize(questions_.volumes_m3.size());
    if (!questions_.axis.empty()) record.chainage_m3.resize(questions_.chainage_parts);
    for (const stability::Judgement& judgement : analysis_.judgements) {
      count_factor(record, judgement);
      if (!judgement.batch) continue;
      add(record.all, judgement);
      if (*judgement.batch == 1) {
        add(record.first, judgement);
        record.largest_pressure_pa = std::max(record.largest_pressure_pa, pressure_on(judgement));
      }
      const Block& block = complex_.blocks()[judgement.block];
      for (std::size_t i = 0; i < record.above.size(); ++i) {
        record.above[i] += block.volume.si() > questions_.volumes_m3[i] ? 1U : 0U;
      }
      if (!record.chainage_m3.empty()) {
        const double at = chainage_of(questions_.axis, block.centroid) / part_length_;
        const auto part = std::min(static_cast<std::size_t>(at), record.chainage_m3.size() - 1);
        record.chainage_m3[part] = std::max(record.chainage_m3[part], block.volume.si());
      }
      if (beside_fixed(block)) record.key_beside_fixed_m3 += block.volume.si();
    }
    record.batches = static_cast<std::uint32_t>(analysis_.batches.size());
    record.stopped_at_max_batches = analysis_.stopped_at_max_batches;
  }

 private:
  static double to_be_held(const stability::Judgement& judgement) {
    return judgement.transferred ? judgement.transferred->to_be_held().si() : std::max(0.0, judgement.net.si());
  }

  /// Pa over the block's free faces.
  [[nodiscard]] double pressure_on(const stability::Judgement& judgement) const {
    double area = 0;
    for (const auto id : complex_.blocks()[judgement.block].faces) {
      const Face& face = complex_.faces()[id];
      if (face.role == Role::free) area += face.area.si();
    }
    return area > 0 ? to_be_held(judgement) / area : 0;
  }

  static void count_factor(Record& record, const stability::Judgement& judgement) {
    if (!stability::moves(judgement.mode)) return;
    record.factors.resize(factor_bins);
    const double at = judgement.factor_of_safety / factor_step;
    const double last = static_cast<double>(factor_bins - 1);
    ++record.factors[static_cast<std::size_t>(at < last ? std::max(0.0, at) : last)];
  }

  void add(Tally& tally, const stability::Judgement& judgement) {
    const Block& block = complex_.blocks()[judgement.block];
    const double volume = block.volume.si();
    ++tally.count;
    tally.volume_m3 += volume;
    tally.largest_m3 = std::max(tally.largest_m3, volume);
    tally.support_n += std::max(0.0, judgement.net.si());
    tally.support_transferred_n +=
        judgement.transferred ? judgement.transferred->to_be_held().si() : std::max(Force{}, judgement.net).si();
    if (stability::moves(judgement.mode)) ++tally.modes[std::to_underlying(judgement.mode)];
    ++tally.shapes[std::to_underlying(shape_of(judgement.block))];
    tally.concave += block.convex ? 0U : 1U;
    double surface = 0;
    for (const auto face : block.faces) surface += complex_.faces()[face].area.si();
    tally.sphericity_sum += std::cbrt(std::numbers::pi) * std::pow(6 * volume, 2.0 / 3) / surface;
    tally.sizes.add(volume);
  }

  [[nodiscard]] bool was_free(const Face& face, std::uint32_t batch) const {
    if (face.role == Role::free) return true;
    return std::ranges::any_of(complex_.patches(face), [&](const topology::Patch& patch) {
      return patch.neighbour && left_[*patch.neighbour] < batch;
    });
  }

  [[nodiscard]] Shape shape_of(BlockId id) {
    joints_.clear();
    free_.clear();
    for (const auto face_id : complex_.blocks()[id].faces) {
      const Face& face = complex_.faces()[face_id];
      (was_free(face, left_[id]) ? free_ : joints_).push_back(face.plane);
    }
    const auto distinct = [](std::vector<PlaneId>& planes) {
      std::ranges::sort(planes);
      return static_cast<std::size_t>(std::ranges::unique(planes).begin() - planes.begin());
    };
    const std::size_t joints = distinct(joints_), free = distinct(free_);
    if (joints == 3 || (joints == 2 && free >= 2)) return Shape::tetrahedral;
    if (joints == 4) return Shape::pentahedral;
    if (joints == 5) return Shape::hexahedral;
    return joints > 5 ? Shape::higher : Shape::other;
  }

  [[nodiscard]] bool beside_fixed(const Block& block) const {
    return std::ranges::any_of(block.faces, [&](const topology::FaceId id) {
      return std::ranges::any_of(complex_.patches(complex_.faces()[id]), [&](const topology::Patch& patch) {
        return patch.neighbour && complex_.blocks()[*patch.neighbour].fixed;
      });
    });
  }

  const BlockComplex& complex_;
  const stability::Analysis& analysis_;
  const Questions& questions_;
  IdVector<BlockId, std::uint32_t> left_;  // batch in which a block leaves
  double part_length_;
  std::vector<PlaneId> joints_, free_;
};

}  // namespace

double length_of(std::span<const geometry::Vec3> axis) noexcept {
  double length = 0;
  for (std::size_t i = 1; i < axis.size(); ++i) length += norm(axis[i] - axis[i - 1]);
  return length;
}

double chainage_of(std::span<const geometry::Vec3> axis, geometry::Vec3 point) noexcept {
  double before = 0, best = 0, nearest = INFINITY;
  for (std::size_t i = 1; i < axis.size(); ++i) {
    const geometry::Vec3 along = axis[i] - axis[i - 1];
    const double length = norm(along);
    const double share = length > 0 ? std::clamp(dot(point - axis[i - 1], along) / (length * length), 0.0, 1.0) : 0.0;
    const double distance = norm(point - (axis[i - 1] + share * along));
    if (distance < nearest) {
      nearest = distance;
      best = before + share * length;
    }
    before += length;
  }
  return best;
}

namespace {

/// How much of the free face of excavations belongs to blocks that the domain's border holds: that only it holds, where
/// that is known, else that it touches.
void measure_border(const BlockComplex& complex, const Questions& questions, const stability::DomainHeld* held,
                    Record& record) {
  const double length = length_of(questions.axis);
  for (const topology::BlockId block_id : complex.blocks().ids()) {
    const Block& block = complex.blocks()[block_id];
    if (!block.free) continue;
    const bool lost = held != nullptr ? std::ranges::binary_search(held->blocks, block_id) : block.fixed;
    for (const auto id : block.faces) {
      const Face& face = complex.faces()[id];
      if (face.role != Role::free || !face.excavation) continue;
      const double area = face.area.si();
      record.free_m2 += area;
      record.free_fixed_m2 += lost ? area : 0;
      if (!(length > 0)) continue;
      const double at = chainage_of(questions.axis, face.centroid);
      if (at < 0.25 * length || at > 0.75 * length) continue;
      record.middle_m2 += area;
      record.middle_fixed_m2 += lost ? area : 0;
    }
  }
}

}  // namespace

Record measure(const BlockComplex& complex, const stability::Analysis* analysis, const Questions& questions,
               const stability::DomainHeld* held) {
  Record record;
  record.blocks = complex.blocks().size();
  record.rock_m3 = complex.rock_volume().si();
  for (const Block& block : complex.blocks()) {
    record.concave_blocks += block.convex ? 0U : 1U;
    record.surface_blocks += block.free ? 1U : 0U;
    record.surface_blocks_fixed += block.free && block.fixed ? 1U : 0U;
  }
  measure_border(complex, questions, held, record);
  if (held != nullptr) record.border = Staying{held->blocks.size(), held->volume};
  if (analysis != nullptr) Measuring{complex, *analysis, questions}.count(record);
  return record;
}

std::optional<std::uint64_t> count_turning(const stability::Analysis& analysis) {
  if (analysis.rotation == stability::RotationCheck::off) return std::nullopt;
  return static_cast<std::uint64_t>(std::ranges::count_if(
      analysis.judgements, [](const stability::Judgement& j) { return j.rotation && j.rotation->turns; }));
}

CaseTally measure_case(const BlockComplex& complex, const stability::Analysis& analysis) {
  CaseTally tally;
  for (const stability::Judgement& judgement : analysis.judgements) {
    if (!judgement.batch) continue;
    const Volume volume = complex.blocks()[judgement.block].volume;
    ++tally.count;
    tally.volume += volume;
    tally.largest = std::max(tally.largest, volume);
    tally.lifting += judgement.mode == stability::Mode::lifting ? 1U : 0U;
    tally.net += std::max(Force{}, judgement.net);
  }
  return tally;
}

}  // namespace cleave::stochastic
