#include "detail/shared_corners.hpp"

#include <algorithm>
#include <numeric>

namespace cleave::topology::detail {

using exact::LatticePoint;

void SharedCorners::add(std::span<const LatticePoint> corners) {
  corners_.insert(corners_.end(), corners.begin(), corners.end());
  begin_.push_back(corners_.size());
}

void SharedCorners::clear() {
  corners_.clear();
  begin_.assign(1, 0);
  sites_.clear();
  sides_.clear();
  repeated_.clear();
}

void SharedCorners::finish() {
  const std::size_t count = begin_.size() - 1;
  std::vector<LatticePoint> sorted = corners_;
  std::vector<std::span<LatticePoint>> sets(count);  // corners of each polygon, each once
  for (std::size_t k = 0; k < count; ++k) {
    const auto own = std::span{sorted}.subspan(begin_[k], begin_[k + 1] - begin_[k]);
    std::ranges::sort(own);
    sets[k] = own.first(own.size() - std::ranges::unique(own).size());
  }
  std::vector<Index> order(count);
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::sort(order, [&](Index a, Index b) {
    if (std::ranges::lexicographical_compare(sets[a], sets[b])) return true;
    return a < b && std::ranges::equal(sets[a], sets[b]);
  });
  std::vector<Index> distinct;
  std::vector<LatticePoint> uses;
  for (const Index k : order) {
    if (!distinct.empty() && std::ranges::equal(sets[distinct.back()], sets[k])) {
      repeated_.push_back({k, distinct.back()});
      continue;
    }
    distinct.push_back(k);
    uses.insert(uses.end(), sets[k].begin(), sets[k].end());
  }
  std::ranges::sort(repeated_, {}, &Repeated::polygon);
  std::ranges::sort(uses);
  for (std::size_t i = 1; i < uses.size(); ++i) {
    if (uses[i] == uses[i - 1] && (sites_.empty() || sites_.back() != uses[i])) sites_.push_back(uses[i]);
  }
  std::ranges::sort(surface_sides_);
  if (any()) find_sides(distinct);
}

void SharedCorners::find_sides(std::span<const Index> distinct) {
  std::vector<Side> all, own;
  for (const Index k : distinct) {
    const auto corners = std::span{corners_}.subspan(begin_[k], begin_[k + std::size_t{1}] - begin_[k]);
    own.clear();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const LatticePoint a = corners[i], b = corners[i + 1 < corners.size() ? i + 1 : 0];
      if (a != b && shared(a) && shared(b)) own.push_back(side_of(a, b));
    }
    std::ranges::sort(own);
    const auto again = std::ranges::unique(own);
    all.insert(all.end(), own.begin(), again.begin());
  }
  std::ranges::sort(all);
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (all[i] == all[i - 1] && (sides_.empty() || sides_.back() != all[i])) sides_.push_back(all[i]);
  }
}

bool SharedCorners::shared(LatticePoint corner) const { return std::ranges::binary_search(sites_, corner); }

bool SharedCorners::shared(LatticePoint a, LatticePoint b) const {
  return std::ranges::binary_search(sides_, side_of(a, b)) || std::ranges::binary_search(surface_sides_, side_of(a, b));
}

std::vector<std::size_t> SharedCorners::among(std::span<const LatticePoint> corners) const {
  std::vector<std::size_t> found;
  if (!any()) return found;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (shared(corners[i])) found.push_back(i);
  }
  return found;
}

Index SharedCorners::first_like(Index polygon) const {
  const auto found = std::ranges::lower_bound(repeated_, polygon, {}, &Repeated::polygon);
  return found != repeated_.end() && found->polygon == polygon ? found->first : polygon;
}

}  // namespace cleave::topology::detail
