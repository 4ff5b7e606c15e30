#include "cleave/topology/section.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace cleave::topology {
namespace {

using geometry::Vec3;
using Key = std::pair<VertexId, VertexId>;

double length(SectionPoint a) { return std::hypot(a.x, a.y); }

struct Loop {
  std::vector<SectionPoint> corners;
  std::vector<SectionSide> sides;
};

double area_of(const Loop& loop) {
  double sum = 0;
  for (std::size_t k = 0; k < loop.corners.size(); ++k) {
    sum += cross(loop.corners[k] - loop.corners[0], loop.corners[(k + 1) % loop.corners.size()] - loop.corners[0]) / 2;
  }
  return sum;
}

bool contains(const Loop& loop, SectionPoint p) {
  bool in = false;
  for (std::size_t k = 0; k < loop.corners.size(); ++k) {
    const SectionPoint a = loop.corners[k], b = loop.corners[(k + 1) % loop.corners.size()];
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) in = !in;
  }
  return in;
}

/// A piece of the plane's cut with one face, the block on its left.
struct Piece {
  Key start, end;
  SectionPoint from, to;
  SectionSide side;
  bool used = false;
};

struct Crossing {
  Key key;
  SectionPoint at;
  double along;
};

class Cutter final {
 public:
  Cutter(const BlockComplex& complex, const SectionPlane& plane) : complex_{complex}, plane_{plane} {
    const Vec3 normal = cross(plane.right, plane.up);
    for (const VertexId v : complex.vertices().ids()) {
      const Vec3 d = complex.vertices()[v] + (complex.origin() - plane.origin);
      height_.push_back(dot(normal, d));
      place_.push_back({dot(plane.right, d), dot(plane.up, d)});
    }
  }

  [[nodiscard]] std::vector<Piece> pieces_of(const Block& block) const {
    std::vector<Piece> pieces;
    for (const FaceId id : block.faces) {
      const Face& face = complex_.faces()[id];
      // The block lies to the left of the walk: outward is to its right.
      const SectionPoint outward{dot(plane_.right, face.outward), dot(plane_.up, face.outward)};
      const SectionPoint along{-outward.y, outward.x};
      std::vector<Crossing> found;
      for (const auto& loop : complex_.loops(face)) {
        for (std::size_t k = 0; k < loop.size(); ++k) {
          const VertexId a = loop[k], b = loop[k + 1 == loop.size() ? 0 : k + 1];
          if (above(a) == above(b)) continue;
          const SectionPoint at = point_of(a, b);
          found.push_back({a < b ? Key{a, b} : Key{b, a}, at, at.x * along.x + at.y * along.y});
        }
      }
      std::ranges::stable_sort(found, {}, &Crossing::along);
      for (std::size_t k = 0; k + 1 < found.size(); k += 2) {
        pieces.push_back(
            {found[k].key, found[k + 1].key, found[k].at, found[k + 1].at, {face.role, face.joint, false}});
      }
    }
    return pieces;
  }

 private:
  [[nodiscard]] bool above(VertexId v) const { return height_[v.value()] >= 0; }
  /// The same for both senses of an edge, to the last bit.
  [[nodiscard]] SectionPoint point_of(VertexId a, VertexId b) const {
    if (b < a) std::swap(a, b);
    const double ha = height_[a.value()], hb = height_[b.value()];
    const double t = ha / (ha - hb);
    const SectionPoint p = place_[a.value()], q = place_[b.value()];
    return {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)};
  }

  const BlockComplex& complex_;
  const SectionPlane& plane_;
  std::vector<double> height_;
  std::vector<SectionPoint> place_;
};

/// Joins pieces to closed loops: by the edges they end on, else by the nearest start there is.
std::vector<Loop> loops_of(std::vector<Piece> pieces) {
  std::vector<Loop> loops;
  for (std::size_t first = 0; first < pieces.size(); ++first) {
    if (pieces[first].used) continue;
    Loop loop;
    std::size_t at = first;
    for (;;) {
      pieces[at].used = true;
      loop.corners.push_back(pieces[at].from);
      loop.sides.push_back(pieces[at].side);
      if (pieces[at].end == pieces[first].start) break;
      std::size_t next = pieces.size();
      double nearest = 1e300;
      for (std::size_t k = 0; k < pieces.size(); ++k) {
        if (pieces[k].used) continue;
        const double distance = pieces[k].start == pieces[at].end ? -1 : length(pieces[k].from - pieces[at].to);
        if (distance < nearest) {
          nearest = distance;
          next = k;
        }
      }
      if (next == pieces.size() || length(pieces[first].from - pieces[at].to) < nearest) break;
      at = next;
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

bool same(const SectionSide& a, const SectionSide& b) {
  return a.role == b.role && a.joint == b.joint && a.cut == b.cut;
}

/// Drops sides without length, and corners in the middle of a straight side.
void clean(Loop& loop, double tolerance) {
  for (bool again = true; again && loop.corners.size() > 2;) {
    again = false;
    for (std::size_t k = 0; k < loop.corners.size() && loop.corners.size() > 2; ++k) {
      const std::size_t n = loop.corners.size(), before = (k + n - 1) % n, after = (k + 1) % n;
      const SectionPoint in = loop.corners[k] - loop.corners[before], out = loop.corners[after] - loop.corners[k];
      const bool short_side = length(out) < tolerance;
      const bool straight = std::abs(cross(in, out)) < 1e-12 * length(in) * length(out) &&
                            in.x * out.x + in.y * out.y > 0 && same(loop.sides[before], loop.sides[k]);
      if (!short_side && !straight) continue;
      const auto at = static_cast<std::ptrdiff_t>(k);
      loop.corners.erase(loop.corners.begin() + at);
      loop.sides.erase(loop.sides.begin() + at);
      again = true;
      --k;
      if (k + 1 == 0) break;
    }
  }
}

/// The part of a region (its loops) on one side of the line x = level; empty loops when ends do not match.
std::vector<Loop> clipped(const std::vector<Loop>& loops, double level, bool left) {
  struct Chain {
    Loop loop;
    double start = 0, end = 0;  // y on the line
    bool used = false;
  };
  std::vector<Loop> out;
  std::vector<Chain> chains;
  const auto inside = [&](SectionPoint p) { return left ? p.x < level : p.x >= level; };
  for (const Loop& loop : loops) {
    const std::size_t n = loop.corners.size();
    std::size_t entry = n;
    for (std::size_t k = 0; k < n && entry == n; ++k) {
      if (!inside(loop.corners[k]) && inside(loop.corners[(k + 1) % n])) entry = k;
    }
    if (entry == n) {
      if (inside(loop.corners[0])) out.push_back(loop);
      continue;
    }
    const auto crossing = [&](std::size_t k) {
      const SectionPoint a = loop.corners[k % n], b = loop.corners[(k + 1) % n];
      return a.y + (level - a.x) / (b.x - a.x) * (b.y - a.y);
    };
    for (std::size_t step = 0; step < n; ++step) {
      const std::size_t k = (entry + step) % n;
      const bool from = inside(loop.corners[k]), to = inside(loop.corners[(k + 1) % n]);
      if (!from && to) {
        Chain chain;
        chain.start = crossing(k);
        chain.loop.corners = {{level, chain.start}};
        chain.loop.sides = {loop.sides[k]};
        chains.push_back(std::move(chain));
      } else if (from) {
        chains.back().loop.corners.push_back(loop.corners[k]);
        chains.back().loop.sides.push_back(loop.sides[k]);
        if (!to) {
          chains.back().end = crossing(k);
          chains.back().loop.corners.push_back({level, chains.back().end});
          chains.back().loop.sides.push_back({Role::joint, std::nullopt, true});
        }
      }
    }
  }
  struct End {
    double y;
    std::size_t chain;
    bool start;
  };
  std::vector<End> ends;
  for (std::size_t c = 0; c < chains.size(); ++c) {
    ends.push_back({chains[c].start, c, true});
    ends.push_back({chains[c].end, c, false});
  }
  std::ranges::stable_sort(ends, {}, &End::y);
  std::vector<std::size_t> next(chains.size());
  for (std::size_t k = 0; k + 1 < ends.size(); k += 2) {
    if (ends[k].start == ends[k + 1].start) return {};
    const End& leaves = ends[k].start ? ends[k + 1] : ends[k];
    const End& enters = ends[k].start ? ends[k] : ends[k + 1];
    next[leaves.chain] = enters.chain;
  }
  for (std::size_t c = 0; c < chains.size(); ++c) {
    Loop loop;
    for (std::size_t at = c; !chains[at].used; at = next[at]) {
      chains[at].used = true;
      loop.corners.insert(loop.corners.end(), chains[at].loop.corners.begin(), chains[at].loop.corners.end());
      loop.sides.insert(loop.sides.end(), chains[at].loop.sides.begin(), chains[at].loop.sides.end());
    }
    if (!loop.corners.empty()) out.push_back(std::move(loop));
  }
  return out;
}

/// Regions as outer loops with their holes.
std::vector<std::vector<Loop>> regions_of(std::vector<Loop> loops) {
  std::vector<std::vector<Loop>> regions;
  std::vector<Loop> holes;
  for (Loop& loop : loops) {
    if (area_of(loop) > 0) {
      regions.push_back({std::move(loop)});
    } else {
      holes.push_back(std::move(loop));
    }
  }
  for (Loop& hole : holes) {
    std::size_t best = regions.size();
    for (std::size_t r = 0; r < regions.size(); ++r) {
      if (!contains(regions[r][0], hole.corners[0])) continue;
      if (best == regions.size() || area_of(regions[r][0]) < area_of(regions[best][0])) best = r;
    }
    if (best < regions.size()) regions[best].push_back(std::move(hole));
  }
  return regions;
}

/// Cuts through the middle of holes until there are none.
void part(std::vector<Loop> region, std::vector<Loop>& out, int depth) {
  if (region.size() == 1 || depth > 40) {
    out.push_back(std::move(region[0]));
    return;
  }
  double low = 1e300, high = -1e300;
  for (const SectionPoint p : region[1].corners) {
    low = std::min(low, p.x);
    high = std::max(high, p.x);
  }
  for (const bool left : {true, false}) {
    for (auto& half : regions_of(clipped(region, (low + high) / 2, left))) part(std::move(half), out, depth + 1);
  }
}

}  // namespace

Section section(const BlockComplex& complex, const SectionPlane& plane) {
  Section out;
  const Cutter cutter{complex, plane};
  std::vector<std::pair<BlockId, std::vector<Loop>>> found;
  Box2 box;
  for (const BlockId id : complex.blocks().ids()) {
    auto loops = loops_of(cutter.pieces_of(complex.blocks()[id]));
    for (const Loop& loop : loops) {
      for (const SectionPoint p : loop.corners) box.add(p);
    }
    if (!loops.empty()) found.emplace_back(id, std::move(loops));
  }
  const double extent = std::max(box.high.x - box.low.x, box.high.y - box.low.y);
  for (auto& [id, loops] : found) {
    for (Loop& loop : loops) {
      out.area += area_of(loop);
      clean(loop, 1e-10 * extent);
    }
    std::erase_if(loops, [](const Loop& loop) { return loop.corners.size() < 3; });
    std::vector<Loop> simple;
    bool parted = false;
    for (auto& region : regions_of(std::move(loops))) {
      parted = parted || region.size() > 1;
      part(std::move(region), simple, 0);
    }
    out.parted += parted ? 1U : 0U;
    for (Loop& loop : simple) {
      clean(loop, 1e-10 * extent);
      double around = 0;
      for (std::size_t k = 0; k < loop.corners.size(); ++k) {
        around += length(loop.corners[(k + 1) % loop.corners.size()] - loop.corners[k]);
      }
      const double area = loop.corners.size() < 3 ? 0 : area_of(loop);
      if (!(area > 1e-7 * extent * around / 2)) {
        ++out.left_out;
        out.left_out_area += std::abs(area);
        continue;
      }
      out.polygons.push_back({id, std::move(loop.corners), std::move(loop.sides)});
    }
  }
  return out;
}

}  // namespace cleave::topology
