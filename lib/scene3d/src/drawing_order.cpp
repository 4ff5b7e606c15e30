#include "cleave/scene3d/drawing_order.hpp"

#include <algorithm>

#include "cleave/dfn/sample.hpp"

namespace cleave::scene {

std::vector<std::size_t> drawing_order(const std::vector<RandomSet>& sets) {
  std::vector<std::size_t> order;
  const auto done = [&](std::size_t number) {  // given joints always are
    return number >= sets.size() || std::ranges::find(order, number) != order.end();
  };
  bool more = true;
  while (more) {
    more = false;
    for (std::size_t i = 0; i < sets.size(); ++i) {
      if (done(i) || !std::ranges::all_of(dfn::terminates_at(sets[i].law), done)) continue;
      order.push_back(i);
      more = true;
    }
  }
  return order;
}

}  // namespace cleave::scene
