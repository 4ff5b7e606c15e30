#include "biconnected.hpp"

#include <algorithm>

#include "discretisation.hpp"

namespace cleave::flow {
std::vector<std::uint32_t> together_with_link(std::size_t nodes,
                                              std::span<const std::pair<std::uint32_t, std::uint32_t>> links,
                                              std::size_t link) {
  std::vector<std::size_t> begin(nodes + 1, 0);
  for (const auto& [a, b] : links) {
    ++begin[a + std::size_t{1}];
    ++begin[b + std::size_t{1}];
  }
  for (std::size_t n = 0; n < nodes; ++n) begin[n + 1] += begin[n];
  std::vector<std::uint32_t> to(2 * links.size());
  auto next = begin;
  for (const auto& [a, b] : links) {
    to[next[a]++] = b;
    to[next[b]++] = a;
  }
  // A walk into the depth that takes the link first: all that it reaches beyond, and from which it comes back to the
  // link's first end by other ways, is its component.
  const auto [root, first] = links[link];
  std::vector<std::uint32_t> number(nodes, none), lowest(nodes, none);
  struct Step {
    std::uint32_t node, from;
    std::size_t at;
  };
  std::vector<std::uint32_t> waiting;  // nodes of components that are not closed yet
  std::uint32_t count = 0;
  number[root] = lowest[root] = count++;
  number[first] = lowest[first] = count++;
  waiting.push_back(first);
  std::vector<Step> path{{first, root, begin[first]}};
  while (!path.empty()) {
    Step& step = path.back();
    const std::uint32_t node = step.node;
    if (step.at < begin[node + std::size_t{1}]) {
      const std::uint32_t other = to[step.at++];
      if (number[other] == none) {
        number[other] = lowest[other] = count++;
        waiting.push_back(other);
        path.push_back({other, node, begin[other]});
      } else {
        lowest[node] = std::min(lowest[node], number[other]);  // back to where it came from changes nothing below
      }
      continue;
    }
    const std::uint32_t from = step.from;
    path.pop_back();
    if (from == root) break;
    // Nothing in `node`'s branch goes back behind `from`: the branch is a component of its own.
    if (lowest[node] >= number[from]) {
      while (waiting.back() != node) waiting.pop_back();
      waiting.pop_back();
    } else {
      lowest[from] = std::min(lowest[from], lowest[node]);
    }
  }
  std::vector<std::uint32_t> found = std::move(waiting);
  found.push_back(root);
  std::ranges::sort(found);
  return found;
}

}  // namespace cleave::flow
