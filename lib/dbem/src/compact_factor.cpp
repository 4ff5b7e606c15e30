#include "compact_factor.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace cleave::dbem {
namespace {

/// A set of nodes.
using Nodes = std::array<std::uint64_t, CompactFactor::most_nodes / 64>;

void put(Nodes& set, std::size_t node) { set[node / 64] |= std::uint64_t{1} << (node % 64); }
void take(Nodes& set, std::size_t node) { set[node / 64] &= ~(std::uint64_t{1} << (node % 64)); }
int count(const Nodes& set) {
  int sum = 0;
  for (const std::uint64_t word : set) sum += std::popcount(word);
  return sum;
}
template <class Visit>
void each(const Nodes& set, Visit&& visit) {
  for (std::size_t w = 0; w < set.size(); ++w) {
    for (std::uint64_t left = set[w]; left != 0; left &= left - 1) {
      visit(static_cast<std::uint32_t>(64 * w + static_cast<std::size_t>(std::countr_zero(left))));
    }
  }
}

/// a b
Block3 product(const Block3& a, const Block3& b) {
  Block3 out;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) {
      out[3 * r + c] = a[3 * r] * b[c] + a[3 * r + 1] * b[3 + c] + a[3 * r + 2] * b[6 + c];
    }
  }
  return out;
}

/// to -= a b
void subtract(Block3& to, const Block3& a, const Block3& b) {
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) {
      to[3 * r + c] -= a[3 * r] * b[c] + a[3 * r + 1] * b[3 + c] + a[3 * r + 2] * b[6 + c];
    }
  }
}

/// In place, by elimination with rows swapped; false when a pivot vanishes.
bool invert(Block3& block) {
  Block3 a = block, out{1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (std::size_t k = 0; k < 3; ++k) {
    std::size_t pivot = k;
    for (std::size_t r = k + 1; r < 3; ++r) {
      if (std::abs(a[3 * r + k]) > std::abs(a[3 * pivot + k])) pivot = r;
    }
    const double most = a[3 * pivot + k];
    if (!(std::abs(most) > 0) || !std::isfinite(most)) return false;
    for (std::size_t c = 0; c < 3 && pivot != k; ++c) {
      std::swap(a[3 * k + c], a[3 * pivot + c]);
      std::swap(out[3 * k + c], out[3 * pivot + c]);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      a[3 * k + c] /= most;
      out[3 * k + c] /= most;
    }
    for (std::size_t r = 0; r < 3; ++r) {
      if (r == k) continue;
      const double share = a[3 * r + k];
      for (std::size_t c = 0; c < 3; ++c) {
        a[3 * r + c] -= share * a[3 * k + c];
        out[3 * r + c] -= share * out[3 * k + c];
      }
    }
  }
  block = out;
  return true;
}

}  // namespace

CompactFactor::CompactFactor(std::size_t nodes, std::span<const std::pair<std::uint32_t, std::uint32_t>> links) {
  std::vector<Nodes> linked(nodes);
  for (const auto& [a, b] : links) {
    put(linked[a], b);
    put(linked[b], a);
  }
  Nodes left{};
  for (std::size_t k = 0; k < nodes; ++k) put(left, k);
  place_.assign(nodes * nodes, 0);
  order_.reserve(nodes);
  std::uint16_t blocks = 0;
  for (std::size_t k = 0; k < nodes; ++k) place_[k * nodes + k] = blocks++;
  starts_.assign(1, 0);
  for (std::size_t k = 0; k < nodes; ++k) {
    std::uint32_t node = 0;
    int least = static_cast<int>(nodes) + 1;
    each(left, [&](std::uint32_t candidate) {
      const int degree = count(linked[candidate]);
      if (degree < least) {
        least = degree;
        node = candidate;
      }
    });
    order_.push_back(node);
    take(left, node);
    each(linked[node], [&](std::uint32_t other) {
      later_.push_back(other);
      place_[node * nodes + other] = blocks++;
      place_[other * nodes + node] = blocks++;
      for (std::size_t w = 0; w < linked[other].size(); ++w) linked[other][w] |= linked[node][w];
      take(linked[other], other);
      take(linked[other], node);
    });
    starts_.push_back(static_cast<std::uint32_t>(later_.size()));
    const auto many = static_cast<double>(later_.size() - starts_[k]);
    factor_work_ += 60 + 27 * many * (1 + many);
    solve_work_ += 9 + 18 * many;
  }
  values_.resize(blocks);
}

void CompactFactor::clear() { std::ranges::fill(values_, Block3{}); }

bool CompactFactor::factorise() {
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const std::size_t p = order_[k];
    Block3& pivot = values_[at(p, p)];
    if (!invert(pivot)) return false;
    for (std::size_t i = starts_[k]; i < starts_[k + 1]; ++i) {
      Block3& left = values_[at(later_[i], p)];
      left = product(left, pivot);
      for (std::size_t j = starts_[k]; j < starts_[k + 1]; ++j) {
        subtract(values_[at(later_[i], later_[j])], left, values_[at(p, later_[j])]);
      }
    }
  }
  return true;
}

void CompactFactor::solve(std::vector<Three>& x) const {
  const auto less = [](const Block3& a, const Three& from, Three& to) {
    for (std::size_t r = 0; r < 3; ++r) to[r] -= a[3 * r] * from[0] + a[3 * r + 1] * from[1] + a[3 * r + 2] * from[2];
  };
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const std::size_t p = order_[k];
    for (std::size_t i = starts_[k]; i < starts_[k + 1]; ++i) less(values_[at(later_[i], p)], x[p], x[later_[i]]);
  }
  for (std::size_t k = order_.size(); k-- > 0;) {
    const std::size_t p = order_[k];
    for (std::size_t i = starts_[k]; i < starts_[k + 1]; ++i) less(values_[at(p, later_[i])], x[later_[i]], x[p]);
    const Three now = x[p];
    const Block3& inverse = values_[at(p, p)];
    for (std::size_t r = 0; r < 3; ++r) {
      x[p][r] = inverse[3 * r] * now[0] + inverse[3 * r + 1] * now[1] + inverse[3 * r + 2] * now[2];
    }
  }
}

}  // namespace cleave::dbem
