#include <algorithm>
#include <cmath>
#include <utility>

#include "contact_candidate.hpp"

namespace cleave::dbem {
namespace {

struct Entry {
  std::int64_t x, y;
  std::uint32_t body;
  friend auto operator<=>(const Entry&, const Entry&) = default;
};

double size_of(const Box2& box) { return std::max(box.high.x - box.low.x, box.high.y - box.low.y); }

/// Calls `add` for pairs of boxes no larger than a cell, by the cell of their lower left corner: they overlap only from
/// neighbouring cells.
template <class Add>
void meet_neighbours(std::vector<Entry> entries, Add&& add) {
  std::ranges::sort(entries);
  const auto in_cell = [&](std::int64_t x, std::int64_t y) {
    return std::ranges::equal_range(entries, std::pair{x, y}, {}, [](const Entry& e) { return std::pair{e.x, e.y}; });
  };
  for (std::size_t from = 0; from < entries.size();) {
    const Entry here = entries[from];
    const auto same = in_cell(here.x, here.y);
    const auto right = in_cell(here.x + 1, here.y);
    const auto below = in_cell(here.x + 1, here.y - 1);
    const auto above = in_cell(here.x + 1, here.y + 1);
    const auto top = in_cell(here.x, here.y + 1);
    for (auto a = same.begin(); a != same.end(); ++a) {
      for (auto b = std::next(a); b != same.end(); ++b) add(a->body, b->body);
      for (const auto& other : {right, below, above, top}) {
        for (const Entry& b : other) add(a->body, b.body);
      }
    }
    from += same.size();
  }
}

}  // namespace

std::vector<BodyPair> overlapping_pairs(const std::vector<Box2>& boxes, const std::vector<std::uint8_t>& idle) {
  std::vector<BodyPair> pairs;
  const std::size_t n = boxes.size();
  if (n < 2) return pairs;
  std::vector<double> sizes(n);
  for (std::size_t k = 0; k < n; ++k) sizes[k] = size_of(boxes[k]);
  std::ranges::nth_element(sizes, sizes.begin() + static_cast<std::ptrdiff_t>(n / 2));
  const double usual = sizes[n / 2];
  double cell = usual;
  std::vector<std::uint32_t> large;
  std::vector<std::uint8_t> is_large(n, 0);
  Vec2 low = boxes[0].low;
  for (std::uint32_t k = 0; k < n; ++k) {
    low = {std::min(low.x, boxes[k].low.x), std::min(low.y, boxes[k].low.y)};
    const double size = size_of(boxes[k]);
    if (size > 4 * usual) {
      large.push_back(k);
      is_large[k] = 1;
    } else {
      cell = std::max(cell, size);
    }
  }
  const auto add = [&](std::uint32_t a, std::uint32_t b) {
    if (idle[a] != 0 && idle[b] != 0) return;
    if (overlap_boxes(boxes[a], boxes[b])) pairs.push_back({std::min(a, b), std::max(a, b)});
  };
  if (large.size() > n / 4 || !(cell > 0)) {  // no usual size: all against all
    for (std::uint32_t a = 0; a < n; ++a) {
      for (std::uint32_t b = a + 1; b < n; ++b) add(a, b);
    }
    return pairs;
  }
  for (const std::uint32_t a : large) {
    for (std::uint32_t b = 0; b < n; ++b) {
      if (b != a && !(is_large[b] != 0 && b < a)) add(a, b);
    }
  }
  std::vector<Entry> entries;
  entries.reserve(n);
  for (std::uint32_t k = 0; k < n; ++k) {
    if (is_large[k] != 0) continue;
    entries.push_back({static_cast<std::int64_t>(std::floor((boxes[k].low.x - low.x) / cell)),
                       static_cast<std::int64_t>(std::floor((boxes[k].low.y - low.y) / cell)), k});
  }
  meet_neighbours(std::move(entries), add);
  std::ranges::sort(pairs);
  return pairs;
}

}  // namespace cleave::dbem
