#include "discretisation.hpp"

#include <algorithm>

namespace cleave::flow {

namespace {

/// A side of a triangle, on its way to a number.
struct Use {
  std::array<Index, 2> ends;
  Index triangle, corner;
};

}  // namespace

Sides::Sides(const Mesh& mesh) : of_triangle_(mesh.triangles.size()) {
  std::vector<Use> uses;
  uses.reserve(3 * mesh.triangles.size());
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    for (Index k = 0; k < 3; ++k) {
      const Index a = mesh.triangles[t][(k + 1) % 3], b = mesh.triangles[t][(k + 2) % 3];
      uses.push_back({{std::min(a, b), std::max(a, b)}, t, k});
    }
  }
  std::ranges::sort(uses, [](const Use& a, const Use& b) {
    return a.ends < b.ends || (a.ends == b.ends && a.triangle < b.triangle);
  });
  triangles_.reserve(uses.size());
  for (const Use& use : uses) {
    if (ends_.empty() || ends_.back() != use.ends) {
      ends_.push_back(use.ends);
      begin_.push_back(static_cast<Index>(triangles_.size()));
    }
    of_triangle_[use.triangle][use.corner] = static_cast<Index>(ends_.size() - 1);
    triangles_.push_back(use.triangle);
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
