#include "cleave/topology/audit.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <tuple>
#include <utility>

#include "detail/block_auditor.hpp"
#include "detail/fit_auditor.hpp"
#include "detail/offenders.hpp"
#include "detail/pieces.hpp"

namespace cleave::topology {
namespace {

/// Patches between two blocks in one plane whose areas are not matched from the other side; of pairs whose lower block
/// is one of [from, to).
std::uint64_t count_unpaired(const BlockComplex& complex, std::size_t from, std::size_t to, ThreadLimit threads) {
  struct Pair {
    std::uint32_t high, plane;
    double area;  ///< of the lower block's patches less those of the higher one's
  };
  const std::size_t blocks = complex.blocks().size();
  std::vector<std::uint32_t> begin(to - from + 1, 0);  // by lower block (CSR)
  const bool alone = threads.count() == 1;
  const auto count = [alone](std::uint32_t& number) {  // gives the number before
    return alone ? number++ : std::atomic_ref{number}.fetch_add(1, std::memory_order_relaxed);
  };
  const auto for_each = [&](const auto& visit) {
    detail::in_pieces(complex.faces().size(), 16384, threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t f = first; f < last; ++f) {
        const std::uint32_t block = complex.faces().block(FaceId{f}).value();
        complex.faces().visit_neighbours(
            FaceId{f}, [&](BlockId other, Area area) { visit(FaceId{f}, area, block, other.value()); });
      }
    });
  };
  std::atomic<std::uint64_t> found{0};
  for_each([&](FaceId, Area, std::uint32_t a, std::uint32_t b) {
    const std::size_t low = std::min(a, b);
    if (std::max(a, b) >= blocks) {
      if (from == 0) ++found;
    } else if (low >= from && low < to) {
      count(begin[low - from + 1]);
    }
  });
  for (std::size_t k = 1; k < begin.size(); ++k) begin[k] += begin[k - 1];
  std::vector<Pair> pairs(begin.back());
  auto next = begin;
  for_each([&](FaceId face, Area area, std::uint32_t a, std::uint32_t b) {
    const std::size_t low = std::min(a, b);
    if (std::max(a, b) >= blocks || low < from || low >= to) return;
    pairs[count(next[low - from])] = {std::max(a, b), complex.faces().plane(face).value(),
                                      a < b ? area.si() : -area.si()};
  });
  detail::in_pieces(to - from, 4096, threads, [&](std::size_t first_block, std::size_t last_block) {
    std::uint64_t here = 0;
    for (std::size_t b = first_block; b < last_block; ++b) {
      const std::span own = std::span{pairs}.subspan(begin[b], begin[b + 1] - begin[b]);
      const auto before = [](const Pair& x, const Pair& y) {
        return std::tie(x.high, x.plane, x.area) < std::tie(y.high, y.plane, y.area);
      };
      if (own.size() < 64) {  // insertion sort: most blocks have a few neighbours
        for (std::size_t i = 1; i < own.size(); ++i) {
          for (std::size_t j = i; j > 0 && before(own[j], own[j - 1]); --j) std::swap(own[j], own[j - 1]);
        }
      } else {
        std::ranges::sort(own, before);
      }
      for (std::size_t first = 0; first < own.size();) {
        double area = 0, size = 0;
        std::size_t last = first;
        for (; last < own.size() && own[last].high == own[first].high && own[last].plane == own[first].plane; ++last) {
          area += own[last].area;
          size += std::abs(own[last].area);
        }
        if (detail::unmatched(area, size, last - first)) ++here;
        first = last;
      }
    }
    found += here;
  });
  return found;
}

/// Kahan's sum.
class Sum {
 public:
  void add(double value) {
    const double y = value - compensation_, t = sum_ + y;
    compensation_ = (t - sum_) - y;
    sum_ = t;
  }
  [[nodiscard]] double value() const { return sum_; }

 private:
  double sum_ = 0, compensation_ = 0;
};

}  // namespace

std::expected<AuditedComplex, Certificate> audit(BlockComplex complex, unsigned thread_count) {
  const ThreadLimit threads{std::max(1U, thread_count)};
  const std::size_t blocks = complex.blocks().size();
  struct Verdict {
    detail::BlockMeasure measure;
    bool closed = false, euler = false;
  };
  std::vector<Verdict> verdicts(blocks);
  const detail::FitAuditor fit{complex};
  const std::size_t grain = std::max<std::size_t>(8192, blocks / (8 * threads.count()));  // each piece is set up anew
  detail::in_pieces(blocks, grain, threads, [&](std::size_t first, std::size_t last) {
    detail::BlockAuditor auditor{complex};
    for (std::size_t b = first; b < last; ++b) {
      const BlockId id{b};
      verdicts[b].closed = auditor.closed(complex.blocks()[id]);
      verdicts[b].euler = auditor.euler_holds();
      verdicts[b].measure = fit.measure(id);
    }
  });

  Certificate certificate;
  detail::Offenders named{blocks};
  Sum volume;
  bool closures_hold = true;
  for (std::size_t b = 0; b < blocks; ++b) {
    const Verdict& verdict = verdicts[b];
    const detail::BlockMeasure& m = verdict.measure;
    if (!verdict.closed) ++certificate.open_shells;
    if (!verdict.euler) ++certificate.euler_violations;
    certificate.misfits += m.misfits;
    certificate.face_vector_max_relative = std::max(certificate.face_vector_max_relative, m.closure);
    const bool closes = detail::FitAuditor::closes(m.closure, complex.blocks()[BlockId{b}].faces.size());
    closures_hold = closures_hold && closes;
    if (!verdict.closed || !verdict.euler || !closes) named.add(BlockId{b});
    if (m.misfits > 0) {
      std::vector<Misfit> own;
      fit.measure(BlockId{b}, &own);
      named.add(own);
    }
    volume.add(m.volume);
  }
  const std::size_t half = blocks - blocks / 2;  // one after the other in half the memory
  certificate.unpaired_patches = count_unpaired(complex, 0, half, threads);
  if (half < blocks) certificate.unpaired_patches += count_unpaired(complex, half, blocks, threads);
  if (certificate.unpaired_patches > 0) {
    for (const BlockId block : detail::unpaired_blocks(complex)) named.add(block);
  }
  const auto lost = fit.faces_without_block();
  certificate.misfits += lost.size();
  named.add(lost);
  named.give(certificate);
  const double rock = complex.rock_volume().si();
  const auto off = [rock](double sum) { return rock > 0 ? std::abs(sum - rock) / rock : 1; };
  constexpr double allowed = 1e-10;
  const bool refine = certificate.misfits == 0 && certificate.open_shells == 0;
  if (off(volume.value()) > allowed && refine) {
    // Thin rock in a large scene: blocks that doubles cannot measure well enough are measured by integers. Where
    // polygons share edges, faces are bent by a rounding between their corners: each stored volume agrees with its
    // corners within that, and all of them, which know the bends, must fill the rock.
    const bool bent = complex.report().bend_m > 0;
    volume = {};
    for (std::size_t b = 0; b < blocks; ++b) {
      const BlockId id{b};
      volume.add(bent ? complex.blocks()[id].volume.si() : fit.volume(id, verdicts[b].measure.volume, allowed / 10));
    }
  }
  certificate.volume = cubic_metres(volume.value());
  certificate.volume_relative_error = off(volume.value());
  certificate.passed = certificate.euler_violations == 0 && certificate.open_shells == 0 &&
                       certificate.unpaired_patches == 0 && certificate.misfits == 0 && closures_hold &&
                       certificate.volume_relative_error <= allowed;
  if (!certificate.passed) return std::unexpected(std::move(certificate));
  return AuditedComplex{std::move(complex), std::move(certificate)};
}

}  // namespace cleave::topology
