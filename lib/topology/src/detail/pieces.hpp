#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "cleave/core/parallel.hpp"

namespace cleave::topology::detail {

/// Calls `body(first, last)` for neighbouring pieces that cover [0, count); one piece on one thread.
template <class Body>
void in_pieces(std::size_t count, std::size_t grain, ThreadLimit threads, const Body& body) {
  if (threads.count() == 1 || count <= grain) {
    if (count > 0) body(std::size_t{0}, count);
    return;
  }
  parallel_for((count + grain - 1) / grain, threads,
               [&](std::size_t piece) { body(piece * grain, std::min(count, (piece + 1) * grain)); });
}

/// What `make(first, last)` made of neighbouring pieces that cover [0, count), in order; one piece on one thread. Put
/// behind one another (`joined`) the results must be those of one piece.
template <class Make>
[[nodiscard]] auto made_in_pieces(std::size_t count, ThreadLimit threads, const Make& make) {
  constexpr std::size_t many = 32;  // so many that pieces of unequal work still share out evenly
  const std::size_t pieces = threads.count() == 1 ? 1 : std::clamp<std::size_t>(count, 1, many);
  return parallel_map(pieces, threads,
                      [&](std::size_t piece) { return make(count * piece / pieces, count * (piece + 1) / pieces); });
}

/// The values of all parts in order; the parts' own are gone. `adapt(value, part)` changes each, with the number of its
/// part.
template <class Part, class T, class Adapt>
[[nodiscard]] std::vector<T> joined(std::vector<Part>& parts, std::vector<T> Part::* member, ThreadLimit threads,
                                    const Adapt& adapt) {
  std::vector<T> all = std::move(parts[0].*member);
  if (parts.size() == 1) return all;
  std::vector<std::size_t> begin{0, all.size()};
  for (std::size_t k = 1; k < parts.size(); ++k) begin.push_back(begin.back() + (parts[k].*member).size());
  all.resize(begin.back());
  parallel_for(parts.size() - 1, threads, [&](std::size_t before) {
    std::vector<T> own = std::move(parts[before + 1].*member);
    for (std::size_t i = 0; i < own.size(); ++i) {
      adapt(own[i], before + 1);
      all[begin[before + 1] + i] = std::move(own[i]);
    }
  });
  return all;
}

/// Of the values of each part: how many there are in the parts before it.
template <class Part, class T>
[[nodiscard]] std::vector<std::size_t> offsets_of(const std::vector<Part>& parts, std::vector<T> Part::* member) {
  std::vector<std::size_t> offsets;
  std::size_t sum = 0;
  for (const Part& part : parts) {
    offsets.push_back(sum);
    sum += (part.*member).size();
  }
  return offsets;
}

/// Gives the memory back, too; `values = {}` would keep it.
template <class T>
void let_go(std::vector<T>& values) {
  std::vector<T>{}.swap(values);
}

/// Sums up what the numbers in `begin` count, so that begin[i] .. begin[i + 1] are the places of group i (CSR); they
/// are counted one place further on.
template <class Number>
void begin_from_counts(std::vector<Number>& begin) {
  for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
}

}  // namespace cleave::topology::detail
