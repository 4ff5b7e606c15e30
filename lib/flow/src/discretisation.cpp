#include "discretisation.hpp"

#include <algorithm>
#include <numeric>

namespace cleave::flow {

namespace {

/// A side of a triangle, on its way to a number: among those of its lower end.
struct Use {
  Index other, triangle, corner;
};

}  // namespace

Sides::Sides(const Mesh& mesh) : of_triangle_(mesh.triangles.size()) {
  const auto for_each_use = [&](const auto& visit) {
    for (Index t = 0; t < mesh.triangles.size(); ++t) {
      for (Index k = 0; k < 3; ++k) {
        const Index a = mesh.triangles[t][(k + 1) % 3], b = mesh.triangles[t][(k + 2) % 3];
        visit(std::min(a, b), Use{std::max(a, b), t, k});
      }
    }
  };
  std::vector<std::size_t> end(mesh.points.size() + 1, 0);  // of the uses of each point that is a lower end
  for_each_use([&](Index a, const Use&) { ++end[a + std::size_t{1}]; });
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<Use> uses(3 * mesh.triangles.size());
  for_each_use([&](Index a, const Use& use) { uses[end[a]++] = use; });
  ends_.reserve(uses.size() / 2 + 1);
  begin_.reserve(uses.size() / 2 + 2);
  triangles_.reserve(uses.size());
  std::size_t begin = 0;
  for (Index a = 0; a < mesh.points.size(); ++a) {
    const auto own = std::span{uses}.subspan(begin, end[a] - begin);
    begin = end[a];
    std::ranges::sort(own, [](const Use& x, const Use& y) {
      return x.other < y.other || (x.other == y.other && x.triangle < y.triangle);
    });
    for (std::size_t k = 0; k < own.size(); ++k) {
      if (k == 0 || own[k - 1].other != own[k].other) {
        ends_.push_back({a, own[k].other});
        begin_.push_back(static_cast<Index>(triangles_.size()));
      }
      of_triangle_[own[k].triangle][own[k].corner] = static_cast<Index>(ends_.size() - 1);
      triangles_.push_back(own[k].triangle);
    }
  }
  begin_.push_back(static_cast<Index>(triangles_.size()));
}

std::optional<Index> Sides::find(Index a, Index b) const {
  const std::array<Index, 2> wanted{std::min(a, b), std::max(a, b)};
  const auto found = std::ranges::lower_bound(ends_, wanted);
  if (found == ends_.end() || *found != wanted) return std::nullopt;
  return static_cast<Index>(found - ends_.begin());
}

}  // namespace cleave::flow
