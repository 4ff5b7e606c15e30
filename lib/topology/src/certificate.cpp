#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "cleave/topology/audit.hpp"
#include "detail/offenders.hpp"

namespace cleave::topology {
namespace {

constexpr std::size_t most_named = 20;

/// In order, each once, and no more than are named.
template <class T, class Place>
std::vector<T> first_of(std::vector<T> all, Place place) {
  std::ranges::sort(all, {}, place);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  all.erase(all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), most_named)), all.end());
  return all;
}

std::string describe(const Misfit& misfit) {
  std::string text = fmt::format("block {}: {}", misfit.block.value(), name_of(misfit.of));
  if (misfit.face) text += fmt::format(" of face {}", misfit.face->value());
  return text;
}

}  // namespace

std::string_view name_of(Misfit::Of of) noexcept {
  switch (of) {
    case Misfit::Of::corners: return "corners";
    case Misfit::Of::normal: return "normal";
    case Misfit::Of::neighbour: return "neighbour";
    case Misfit::Of::area: return "area";
    case Misfit::Of::volume: return "volume";
    case Misfit::Of::flags: return "flags";
    case Misfit::Of::owner: return "owner";
  }
  std::unreachable();
}

std::string describe(const Certificate& certificate) {
  std::string text;
  const auto add = [&](std::uint64_t count, std::string_view one, std::string_view many) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, count == 1 ? one : many);
  };
  add(certificate.open_shells, "block is not closed", "blocks are not closed");
  add(certificate.euler_violations, "block breaks Euler's formula", "blocks break Euler's formula");
  add(certificate.unpaired_patches, "contact differs on its two sides", "contacts differ on their two sides");
  add(certificate.misfits, "stored figure does not fit its corners", "stored figures do not fit their corners");
  for (std::size_t k = 0; k < certificate.first_misfits.size(); ++k) {
    text += (k == 0 ? " (" : "; ") + describe(certificate.first_misfits[k]);
  }
  if (!certificate.first_misfits.empty()) text += certificate.misfits > most_named ? "; ...)" : ")";
  text += fmt::format("{}volumes off by {:.1e}, face vectors by {:.1e}", text.empty() ? "" : ", ",
                      certificate.volume_relative_error, certificate.face_vector_max_relative);
  if (certificate.offenders.empty()) return text;
  text += certificate.offenders.size() == 1 ? "; block" : "; blocks";
  for (const BlockId block : certificate.offenders) {
    text += fmt::format("{} {}", block == certificate.offenders.front() ? "" : ",", block.value());
  }
  return text;
}

namespace detail {

std::vector<BlockId> unpaired_blocks(const BlockComplex& complex) {
  struct Sum {
    double area = 0, size = 0;
    std::size_t patches = 0;
  };
  std::map<std::tuple<BlockId, BlockId, PlaneId>, Sum> sums;
  for (const Face& face : complex.faces()) {
    for (const Patch& patch : complex.patches(face)) {
      if (!patch.neighbour) continue;
      const auto [low, high] = std::minmax(face.block, *patch.neighbour);
      Sum& sum = sums[{low, high, face.plane}];
      sum.area += low == face.block ? patch.area.si() : -patch.area.si();
      sum.size += patch.area.si();
      ++sum.patches;
    }
  }
  std::vector<BlockId> found;
  for (const auto& [between, sum] : sums) {
    if (unmatched(sum.area, sum.size, sum.patches)) found.insert(found.end(), {get<0>(between), get<1>(between)});
  }
  return found;
}

void Offenders::add(BlockId block) {
  if (block.index() < blocks_) offenders_.push_back(block);
}

void Offenders::add(std::span<const Misfit> misfits) {
  for (const Misfit& misfit : misfits) {
    add(misfit.block);
    misfits_.push_back(misfit);
  }
}

void Offenders::give(Certificate& certificate) {
  certificate.offenders = first_of(std::move(offenders_), [](BlockId block) { return block; });
  certificate.first_misfits =
      first_of(std::move(misfits_), [](const Misfit& m) { return std::tuple{m.block, m.face, m.of}; });
}

}  // namespace detail
}  // namespace cleave::topology
