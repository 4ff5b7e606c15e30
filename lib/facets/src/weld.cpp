#include "detail/weld.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>

#include "cleave/core/assert.hpp"
#include "cleave/core/disjoint_sets.hpp"
#include "cleave/facets/prepared.hpp"
#include "detail/as_vec3.hpp"

namespace cleave::topology::detail {

using exact::LatticePoint;

void Weld::finish() {
  std::ranges::sort(sites_);  // of solids before of joints
  const auto again = std::ranges::unique(sites_, {}, &std::pair<LatticePoint, bool>::first);
  sites_.erase(again.begin(), again.end());
  // Cells half as wide as the distance: all sites of one are a class, and any two classes that touch are at most two
  // cells apart.
  const double size = std::max(distance_ / 2, 0.5);
  using Cell = std::array<std::int64_t, 3>;
  const auto cell_of = [&](LatticePoint p) {
    const auto c = [&](std::int64_t x) { return static_cast<std::int64_t>(std::floor(static_cast<double>(x) / size)); };
    return Cell{c(p.x), c(p.y), c(p.z)};
  };
  std::map<Cell, std::vector<Index>> cells;
  for (Index k = 0; k < sites_.size(); ++k) cells[cell_of(sites_[k].first)].push_back(k);
  DisjointSets<Index> classes{static_cast<Index>(sites_.size())};
  for (const auto& [cell, own] : cells) {
    for (const Index k : own) classes.join(own.front(), k);
    for (std::int64_t i = -2; i <= 2; ++i) {
      for (std::int64_t j = -2; j <= 2; ++j) {
        const auto first = cells.lower_bound({cell[0] + i, cell[1] + j, cell[2] - 2});
        for (auto other = first; other != cells.end() && other->first <= Cell{cell[0] + i, cell[1] + j, cell[2] + 2};
             ++other) {
          for (const Index a : own) {
            if (classes.find(a) == classes.find(other->second.front())) break;
            for (const Index b : other->second) {
              if (distance(sites_[a].first, sites_[b].first) <= distance_) classes.join(a, b);
            }
          }
        }
      }
    }
  }
  std::vector<Index> best(sites_.size(), none);
  for (Index k = 0; k < sites_.size(); ++k) {
    Index& of_class = best[classes.find(k)];
    const auto rank = [&](Index s) { return std::pair{sites_[s].second, sites_[s].first}; };
    if (of_class == none || rank(k) < rank(of_class)) of_class = k;
  }
  becomes_.clear();
  for (Index k = 0; k < sites_.size(); ++k) becomes_.push_back(sites_[best[classes.find(k)]].first);
}

LatticePoint Weld::operator()(LatticePoint site) const {
  const auto found = std::ranges::lower_bound(sites_, site, {}, &std::pair<LatticePoint, bool>::first);
  CLEAVE_ASSERT(found != sites_.end() && found->first == site);
  return becomes_[static_cast<std::size_t>(found - sites_.begin())];
}

void Moves::finish() {
  std::ranges::sort(moves_);
  const auto again = std::ranges::unique(moves_, {}, &std::pair<LatticePoint, LatticePoint>::first);
  moves_.erase(again.begin(), again.end());
}

LatticePoint Moves::operator()(LatticePoint site) const {
  const auto found = std::ranges::lower_bound(moves_, site, {}, &std::pair<LatticePoint, LatticePoint>::first);
  return found != moves_.end() && found->first == site ? found->second : site;
}

}  // namespace cleave::topology::detail
