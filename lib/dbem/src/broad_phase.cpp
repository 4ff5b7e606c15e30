#include <algorithm>
#include <cmath>
#include <utility>

#include "cleave/dbem/touch.hpp"

namespace cleave::dbem {
namespace {

bool overlap_boxes(const Box& a, const Box& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y;
}

struct Entry {
  std::int64_t x, y;
  std::uint32_t body;
  friend auto operator<=>(const Entry&, const Entry&) = default;
};

}  // namespace

std::vector<BodyPair> overlapping_pairs(const std::vector<Box>& boxes, const std::vector<std::uint8_t>& idle) {
  std::vector<BodyPair> pairs;
  const std::size_t n = boxes.size();
  if (n < 2) return pairs;
  const auto size_of = [&](std::size_t k) {
    return std::max(boxes[k].high.x - boxes[k].low.x, boxes[k].high.y - boxes[k].low.y);
  };
  std::vector<double> sizes(n);
  for (std::size_t k = 0; k < n; ++k) sizes[k] = size_of(k);
  std::ranges::nth_element(sizes, sizes.begin() + static_cast<std::ptrdiff_t>(n / 2));
  const double usual = sizes[n / 2];
  double cell = usual;
  std::vector<std::uint32_t> large;
  Vec2 low = boxes[0].low;
  for (std::size_t k = 0; k < n; ++k) {
    low = {std::min(low.x, boxes[k].low.x), std::min(low.y, boxes[k].low.y)};
    const double size = size_of(k);
    if (size > 4 * usual) {
      large.push_back(static_cast<std::uint32_t>(k));
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
  std::vector<std::uint8_t> is_large(n, 0);
  for (const std::uint32_t k : large) is_large[k] = 1;
  for (const std::uint32_t a : large) {
    for (std::uint32_t b = 0; b < n; ++b) {
      if (b != a && !(is_large[b] != 0 && b < a)) add(a, b);
    }
  }
  // By the cell of the lower left corner: two boxes no larger than a cell overlap only from neighbouring cells.
  std::vector<Entry> entries;
  entries.reserve(n);
  for (std::uint32_t k = 0; k < n; ++k) {
    if (is_large[k] != 0) continue;
    entries.push_back({static_cast<std::int64_t>(std::floor((boxes[k].low.x - low.x) / cell)),
                       static_cast<std::int64_t>(std::floor((boxes[k].low.y - low.y) / cell)), k});
  }
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
  std::ranges::sort(pairs);
  return pairs;
}

}  // namespace cleave::dbem
