#include "cleave/linear/fronts.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/Sparse>
#include <algorithm>
#include <numeric>
#include <span>

namespace cleave::linear {
namespace {

constexpr auto none = static_cast<std::uint32_t>(-1);

/// Neighbours by rows, from pairs in either order; the diagonal included.
void rows_of_links(std::size_t nodes, const std::vector<std::pair<std::uint32_t, std::uint32_t>>& links,
                   std::vector<std::size_t>& starts, std::vector<std::uint32_t>& columns) {
  std::vector<std::size_t> ends(nodes + 1, 0);
  for (std::uint32_t k = 0; k < nodes; ++k) ends[k + 1] = 1;
  for (const auto& [a, b] : links) {
    ++ends[a + 1];
    ++ends[b + 1];
  }
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<std::uint32_t> all(ends[nodes]);
  std::vector<std::size_t> next{ends};
  for (std::uint32_t k = 0; k < nodes; ++k) all[next[k]++] = k;
  for (const auto& [a, b] : links) {
    all[next[a]++] = b;
    all[next[b]++] = a;
  }
  starts.assign(1, 0);
  columns.clear();
  columns.reserve(all.size());
  for (std::size_t r = 0; r < nodes; ++r) {
    const auto row = std::span{all}.subspan(ends[r], ends[r + 1] - ends[r]);
    std::ranges::sort(row);
    std::ranges::unique_copy(row, std::back_inserter(columns));
    starts.push_back(columns.size());
  }
}

/// Elimination tree (Liu 1986): the parent of each row, `none` of roots.
std::vector<std::uint32_t> elimination_tree(const std::vector<std::size_t>& starts,
                                            const std::vector<std::uint32_t>& columns) {
  const std::size_t n = starts.size() - 1;
  std::vector<std::uint32_t> parent(n, none), ancestor(n, none);
  for (std::uint32_t r = 0; r < n; ++r) {
    for (std::size_t at = starts[r]; at < starts[r + 1] && columns[at] < r; ++at) {
      for (std::uint32_t k = columns[at]; k != none && k < r;) {
        const std::uint32_t next = ancestor[k];
        ancestor[k] = r;
        if (next == none) parent[k] = r;
        k = next;
      }
    }
  }
  return parent;
}

/// Children before parents, subtrees without gaps: entry k is the row that comes k-th.
std::vector<std::uint32_t> postorder(const std::vector<std::uint32_t>& parent) {
  const std::size_t n = parent.size();
  std::vector<std::uint32_t> head(n, none), next(n, none), order, stack;
  for (std::size_t k = n; k-- > 0;) {
    if (parent[k] == none) continue;
    next[k] = head[parent[k]];
    head[parent[k]] = static_cast<std::uint32_t>(k);
  }
  for (std::uint32_t root = 0; root < n; ++root) {
    if (parent[root] != none) continue;
    stack.push_back(root);
    while (!stack.empty()) {
      const std::uint32_t top = stack.back();
      if (head[top] != none) {
        stack.push_back(head[top]);
        head[top] = next[head[top]];
      } else {
        order.push_back(top);
        stack.pop_back();
      }
    }
  }
  return order;
}

/// Members of a and b, both ascending, from `from` on.
std::vector<std::uint32_t> joined(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b,
                                  std::uint32_t from) {
  std::vector<std::uint32_t> out;
  out.reserve(a.size() + b.size());
  std::ranges::set_union(a, b, std::back_inserter(out));
  out.erase(out.begin(), std::ranges::lower_bound(out, from));
  return out;
}

}  // namespace

FrontalFactor::FrontalFactor(std::size_t nodes, Eigen::Index width,
                             std::vector<std::pair<std::uint32_t, std::uint32_t>> links)
    : width_{width}, place_(nodes), links_{std::move(links)} {
  order();
}

void FrontalFactor::order() {
  const std::size_t n = nodes();
  rows_of_links(n, links_, starts_, columns_);
  // Least degree first, then a postorder of the tree that gives.
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(columns_.size());
  for (std::size_t r = 0; r < n; ++r) {
    for (std::size_t at = starts_[r]; at < starts_[r + 1]; ++at) {
      entries.emplace_back(static_cast<int>(r), static_cast<int>(columns_[at]), 1.0);
    }
  }
  Eigen::SparseMatrix<double> graph(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  graph.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> least;
  Eigen::AMDOrdering<int>{}(graph, least);
  for (std::size_t k = 0; k < n; ++k) {
    // Its indices say which node comes k-th.
    place_[static_cast<std::size_t>(least.indices()[static_cast<Eigen::Index>(k)])] = static_cast<std::uint32_t>(k);
  }
  const auto renumber = [&](const std::vector<std::uint32_t>& to) {
    for (auto& [a, b] : links_) {
      a = to[a];
      b = to[b];
    }
    rows_of_links(n, links_, starts_, columns_);
  };
  renumber(place_);
  const std::vector<std::uint32_t> order = postorder(elimination_tree(starts_, columns_));
  std::vector<std::uint32_t> again(n);
  for (std::uint32_t k = 0; k < n; ++k) again[order[k]] = k;
  renumber(again);
  for (std::uint32_t& at : place_) at = again[at];
  const std::vector<std::uint32_t> parent = elimination_tree(starts_, columns_);
  mirror_.resize(columns_.size());
  for (std::uint32_t r = 0; r < n; ++r) {
    for (std::size_t at = starts_[r]; at < starts_[r + 1]; ++at) {
      const std::uint32_t c = columns_[at];
      const auto row = std::span{columns_}.subspan(starts_[c], starts_[c + 1] - starts_[c]);
      mirror_[at] = starts_[c] + static_cast<std::size_t>(std::ranges::lower_bound(row, r) - row.begin());
    }
  }
  // Rows below each pivot.
  std::vector<std::vector<std::uint32_t>> below(n);
  for (std::uint32_t k = 0; k < n; ++k) {
    const auto own = std::span{columns_}.subspan(starts_[k], starts_[k + 1] - starts_[k]);
    below[k] = joined(own, below[k], k + 1);
    if (parent[k] != none) below[parent[k]] = joined(below[k], below[parent[k]], parent[k] + 1);
  }
  find_fronts(parent, std::move(below));
  values_.assign(columns_.size() * static_cast<std::size_t>(width_ * width_), 0.0);
}

void FrontalFactor::find_fronts(const std::vector<std::uint32_t>& parent,
                                std::vector<std::vector<std::uint32_t>>&& below) {
  const auto n = static_cast<std::uint32_t>(nodes());
  std::vector<std::uint32_t> front_of(n);
  for (std::uint32_t first = 0; first < n;) {
    std::uint32_t last = first + 1;
    std::size_t zeros = 0;
    while (last < n && parent[last - 1] == last) {
      // Taking one more pivot pads the columns before it.
      const std::size_t more = (below[last].size() + 1 - below[last - 1].size()) * (last - first);
      const std::size_t size = (last + 1 - first) * (last + 1 - first + below[last].size());
      if (more > 0 && zeros + more > size / 4 && last + 1 - first > 4) break;
      zeros += more;
      ++last;
    }
    for (std::uint32_t k = first; k < last; ++k) front_of[k] = static_cast<std::uint32_t>(fronts_.size());
    fronts_.push_back({first, last, std::move(below[last - 1]), {}});
    first = last;
  }
  for (std::uint32_t k = 0; k < fronts_.size(); ++k) {
    const std::uint32_t up = parent[fronts_[k].last - 1];
    if (up != none) fronts_[front_of[up]].children.push_back(k);
  }
  factors_.resize(fronts_.size());
  constexpr double handling = 500;
  for (const Front& front : fronts_) {
    const auto inner = static_cast<double>(width_) * (front.last - front.first);
    const auto outer = static_cast<double>(width_) * static_cast<double>(front.rows.size());
    factor_work_ += handling + inner * (inner * inner / 6 + inner * outer / 2 + outer * outer / 2);
    solve_work_ += 0.1 * handling + inner * (inner + 2 * outer);
  }
}

void FrontalFactor::clear(bool symmetric) {
  symmetric_ = symmetric;
  std::ranges::fill(values_, 0.0);
}

double* FrontalFactor::values_of(std::size_t row, std::size_t column) {
  const std::uint32_t r = place_[row];
  const auto of_row = std::span{columns_}.subspan(starts_[r], starts_[r + 1] - starts_[r]);
  const auto found = std::ranges::lower_bound(of_row, place_[column]) - of_row.begin();
  const std::size_t at = (starts_[r] + static_cast<std::size_t>(found)) * static_cast<std::size_t>(width_ * width_);
  return std::span{values_}.subspan(at).data();
}

bool FrontalFactor::factorise() {
  switch (width_) {
    case 3: return eliminate<3>();
    case 6: return eliminate<6>();
    default: return eliminate<Eigen::Dynamic>();
  }
}

/// Entries of the pivots and of the fronts below; of a symmetric matrix those on and below the diagonal.
template <int Width>
Eigen::MatrixXd FrontalFactor::assemble(const Front& front, const std::vector<std::uint32_t>& local,
                                        std::vector<Eigen::MatrixXd>& updates) const {
  const Eigen::Index w = width_;
  const auto first_of = [&](std::uint32_t node) { return w * static_cast<Eigen::Index>(local[node]); };
  const auto size = static_cast<std::size_t>(front.last - front.first) + front.rows.size();
  Eigen::MatrixXd full =
      Eigen::MatrixXd::Zero(w * static_cast<Eigen::Index>(size), w * static_cast<Eigen::Index>(size));
  const auto values = [&](std::size_t which) {
    const std::size_t at = which * static_cast<std::size_t>(w * w);
    return Eigen::Map<const Eigen::Matrix<double, Width, Width>>(std::span{values_}.subspan(at).data(), w, w);
  };
  for (std::uint32_t r = front.first; r < front.last; ++r) {
    for (std::size_t at = starts_[r]; at < starts_[r + 1]; ++at) {
      if (columns_[at] < front.first) continue;
      const Eigen::Index i = first_of(r), j = first_of(columns_[at]);
      full.block<Width, Width>(i, j, w, w) = values(at);
      if (columns_[at] >= front.last) full.block<Width, Width>(j, i, w, w) = values(mirror_[at]);
    }
  }
  for (const std::uint32_t child : front.children) {
    const std::vector<std::uint32_t>& rows = fronts_[child].rows;
    for (std::size_t c = 0; c < rows.size(); ++c) {
      for (std::size_t r = symmetric_ ? c : 0; r < rows.size(); ++r) {
        full.block<Width, Width>(first_of(rows[r]), first_of(rows[c]), w, w) += updates[child].block<Width, Width>(
            w * static_cast<Eigen::Index>(r), w * static_cast<Eigen::Index>(c), w, w);
      }
    }
    updates[child].resize(0, 0);
  }
  return full;
}

template <int Width>
bool FrontalFactor::eliminate() {
  std::vector<Eigen::MatrixXd> updates(fronts_.size());
  std::vector<std::uint32_t> local(nodes(), none);
  for (std::size_t f = 0; f < fronts_.size(); ++f) {
    const Front& front = fronts_[f];
    const std::uint32_t pivots = front.last - front.first;
    for (std::uint32_t k = 0; k < front.rows.size(); ++k) local[front.rows[k]] = pivots + k;
    for (std::uint32_t k = 0; k < pivots; ++k) local[front.first + k] = k;
    const Eigen::Index inner = width_ * static_cast<Eigen::Index>(pivots);
    const Eigen::Index outer = width_ * static_cast<Eigen::Index>(front.rows.size());
    const Eigen::MatrixXd full = assemble<Width>(front, local, updates);
    Factor& factor = factors_[f];
    factor.below = full.bottomLeftCorner(outer, inner);
    if (symmetric_) {
      factor.cholesky.compute(full.topLeftCorner(inner, inner));
      if (factor.cholesky.info() != Eigen::Success) return false;
      if (outer == 0) continue;
      factor.cholesky.matrixU().solveInPlace<Eigen::OnTheRight>(factor.below);
      updates[f] = full.bottomRightCorner(outer, outer);
      updates[f].selfadjointView<Eigen::Lower>().rankUpdate(factor.below, -1.0);
    } else {
      factor.lu.compute(full.topLeftCorner(inner, inner));
      if (!(factor.lu.matrixLU().diagonal().cwiseAbs().minCoeff() > 0)) return false;
      if (outer == 0) continue;
      factor.right = factor.lu.permutationP() * full.topRightCorner(inner, outer);
      const auto triangles = factor.lu.matrixLU();
      triangles.template triangularView<Eigen::Upper>().template solveInPlace<Eigen::OnTheRight>(factor.below);
      triangles.template triangularView<Eigen::UnitLower>().solveInPlace(factor.right);
      updates[f] = full.bottomRightCorner(outer, outer);
      updates[f].noalias() -= factor.below * factor.right;
    }
  }
  return true;
}

int FrontalFactor::sign() const {
  int sign = 1;
  if (symmetric_) return sign;  // Cholesky's: all pivots are positive
  for (const Factor& factor : factors_) {
    if (factor.lu.permutationP().determinant() < 0) sign = -sign;
    const auto pivots = factor.lu.matrixLU().diagonal();
    for (Eigen::Index k = 0; k < pivots.size(); ++k) sign = pivots[k] < 0 ? -sign : sign;
  }
  return sign;
}

void FrontalFactor::solve(Eigen::VectorXd& x) const {
  const Eigen::Index w = width_;
  Eigen::VectorXd y(x.size());
  for (std::size_t k = 0; k < nodes(); ++k) {
    y.segment(w * static_cast<Eigen::Index>(place_[k]), w) = x.segment(w * static_cast<Eigen::Index>(k), w);
  }
  Eigen::VectorXd far;
  const auto gather = [&](const Front& front) {
    far.resize(w * static_cast<Eigen::Index>(front.rows.size()));
    for (std::size_t k = 0; k < front.rows.size(); ++k) {
      far.segment(w * static_cast<Eigen::Index>(k), w) = y.segment(w * static_cast<Eigen::Index>(front.rows[k]), w);
    }
  };
  for (std::size_t f = 0; f < fronts_.size(); ++f) {
    const Front& front = fronts_[f];
    const Factor& factor = factors_[f];
    auto own =
        y.segment(w * static_cast<Eigen::Index>(front.first), w * static_cast<Eigen::Index>(front.last - front.first));
    if (symmetric_) {
      factor.cholesky.matrixL().solveInPlace(own);
    } else {
      own = (factor.lu.permutationP() * own).eval();
      factor.lu.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(own);
    }
    if (front.rows.empty()) continue;
    far.noalias() = factor.below * own;
    for (std::size_t k = 0; k < front.rows.size(); ++k) {
      y.segment(w * static_cast<Eigen::Index>(front.rows[k]), w) -= far.segment(w * static_cast<Eigen::Index>(k), w);
    }
  }
  for (std::size_t f = fronts_.size(); f-- > 0;) {
    const Front& front = fronts_[f];
    const Factor& factor = factors_[f];
    auto own =
        y.segment(w * static_cast<Eigen::Index>(front.first), w * static_cast<Eigen::Index>(front.last - front.first));
    if (!front.rows.empty()) {
      gather(front);
      if (symmetric_) {
        own.noalias() -= factor.below.transpose() * far;
      } else {
        own.noalias() -= factor.right * far;
      }
    }
    if (symmetric_) {
      factor.cholesky.matrixU().solveInPlace(own);
    } else {
      factor.lu.matrixLU().triangularView<Eigen::Upper>().solveInPlace(own);
    }
  }
  for (std::size_t k = 0; k < nodes(); ++k) {
    x.segment(w * static_cast<Eigen::Index>(k), w) = y.segment(w * static_cast<Eigen::Index>(place_[k]), w);
  }
}

}  // namespace cleave::linear
