#include "closed_sets.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace cleave::support {

using geometry::Vec3;

namespace {

constexpr double turn = 2 * std::numbers::pi;

/// The four corners of a square of a box's side: the axis is constant.
Corners square(int axis, double at, double u0, double v0, double u1, double v1) {
  const auto corner = [&](double u, double v) {
    return axis == 0 ? Vec3{at, u, v} : axis == 1 ? Vec3{v, at, u} : Vec3{u, v, at};
  };
  return {corner(u0, v0), corner(u1, v0), corner(u1, v1), corner(u0, v1)};
}

double grid_line(int k, int n) { return -0.5 + static_cast<double>(k) / n; }

// ---- Voronoi cells: a corner is the set of the four seeds (or sides of the box) it is equally far from, so that its
// coordinates are the same numbers in all cells.

constexpr int sides_first = 1 << 20;
using Key = std::array<int, 4>;

struct Seeds {
  std::vector<Vec3> at;
  double half;
  /// Plane n . x = d that parts cell `i` from `j`; j may be a side of the box.
  [[nodiscard]] std::pair<Vec3, double> plane(int i, int j) const {
    if (j >= sides_first) {
      const int side = j - sides_first;
      const double sign = side % 2 == 0 ? 1 : -1;
      return {Vec3{side / 2 == 0 ? sign : 0, side / 2 == 1 ? sign : 0, side / 2 == 2 ? sign : 0}, half};
    }
    const Vec3 a = at[static_cast<std::size_t>(i)], b = at[static_cast<std::size_t>(j)];
    return {b - a, dot(b - a, 0.5 * (a + b))};
  }
  [[nodiscard]] Vec3 corner(const Key& key) const {  // sorted: the first is a seed
    std::array<std::pair<Vec3, double>, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = plane(key[0], key[k + 1]);
    const Vec3 c = cross(p[1].first, p[2].first);
    const double det = dot(p[0].first, c);
    return (p[0].second * c + p[1].second * cross(p[2].first, p[0].first) +
            p[2].second * cross(p[0].first, p[1].first)) /
           det;
  }
};

struct CellFace {
  int beyond;
  std::vector<Key> corners;  ///< sets with the cell's own seed
};

Key sorted(Key key) {
  std::ranges::sort(key);
  return key;
}

std::vector<CellFace> box_cell(int i) {
  std::vector<CellFace> faces;
  for (int axis = 0; axis < 3; ++axis) {
    for (int sign = 0; sign < 2; ++sign) {
      const auto at = [&](int u, int v) {
        const int a = sides_first + 2 * ((axis + 1) % 3) + u, b = sides_first + 2 * ((axis + 2) % 3) + v;
        return sorted({i, sides_first + 2 * axis + sign, a, b});
      };
      faces.push_back({sides_first + 2 * axis + sign, {at(0, 0), at(1, 0), at(1, 1), at(0, 1)}});
    }
  }
  return faces;
}

void clip(std::vector<CellFace>& faces, const Seeds& seeds, int i, int j) {
  const auto [n, d] = seeds.plane(i, j);
  const auto beyond = [&](const Key& key) { return dot(n, seeds.corner(key)) > d; };
  std::vector<CellFace> kept;
  std::map<Key, std::vector<Key>> rim;  // neighbours along the new face
  for (const CellFace& face : faces) {
    CellFace rest{face.beyond, {}};
    std::vector<Key> cut;
    for (std::size_t k = 0; k < face.corners.size(); ++k) {
      const Key &p = face.corners[k], &q = face.corners[(k + 1) % face.corners.size()];
      const bool out = beyond(p), out_next = beyond(q);
      if (!out) rest.corners.push_back(p);
      if (out == out_next) continue;
      int other = i;  // the face on the other side of the edge
      for (const int id : p) {
        if (id != i && id != face.beyond && std::ranges::find(q, id) != q.end()) other = id;
      }
      cut.push_back(sorted({i, face.beyond, other, j}));
      rest.corners.push_back(cut.back());
    }
    if (cut.size() == 2) {
      rim[cut[0]].push_back(cut[1]);
      rim[cut[1]].push_back(cut[0]);
    }
    if (rest.corners.size() >= 3) kept.push_back(std::move(rest));
  }
  if (rim.size() >= 3) {
    CellFace fresh{j, {rim.begin()->first}};
    Key before = fresh.corners.front(), at = rim.begin()->second.front();
    while (at != fresh.corners.front() && fresh.corners.size() <= rim.size()) {
      fresh.corners.push_back(at);
      const auto& next = rim.at(at);
      const Key after = next.front() == before ? next.back() : next.front();
      before = std::exchange(at, after);
    }
    kept.push_back(std::move(fresh));
  }
  faces = std::move(kept);
}

}  // namespace

ClosedSet cube_of_tiles(int n) {
  ClosedSet set{"cube of " + std::to_string(6 * n * n) + " squares", {}, 1, true};
  for (int axis = 0; axis < 3; ++axis) {
    for (const double at : {-0.5, 0.5}) {
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          set.polygons.push_back(
              square(axis, at, grid_line(i, n), grid_line(j, n), grid_line(i + 1, n), grid_line(j + 1, n)));
        }
      }
    }
  }
  return set;
}

ClosedSet cube_of_squares() { return cube_of_tiles(1); }

ClosedSet crate(int n) {
  ClosedSet set{"crate of " + std::to_string(n * n * n), {}, static_cast<std::size_t>(n * n * n), true};
  for (int axis = 0; axis < 3; ++axis) {
    for (int k = 0; k <= n; ++k) {
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          set.polygons.push_back(square(axis, grid_line(k, n), grid_line(i, n), grid_line(j, n), grid_line(i + 1, n),
                                        grid_line(j + 1, n)));
        }
      }
    }
  }
  return set;
}

ClosedSet dodecahedron() {
  const double g = std::numbers::phi, h = 1 / g, s = 0.4;
  std::vector<Vec3> corners;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) corners.push_back(s * Vec3{x, y, z});
      corners.push_back(s * Vec3{0, x * h, y * g});
      corners.push_back(s * Vec3{x * h, y * g, 0});
      corners.push_back(s * Vec3{y * g, 0, x * h});
    }
  }
  ClosedSet set{"dodecahedron", {}, 1, true};
  for (int axis = 0; axis < 3; ++axis) {
    for (const double a : {-1.0, 1.0}) {
      for (const double b : {-1.0, 1.0}) {
        const std::array n{0.0, a * g, b};
        const auto at = [&](int k) { return n[static_cast<std::size_t>((k + axis) % 3)]; };
        const Vec3 normal = geometry::normalized({at(0), at(1), at(2)});
        double most = 0;
        for (const Vec3& c : corners) most = std::max(most, dot(normal, c));
        Corners face;
        for (const Vec3& c : corners) {
          if (dot(normal, c) > most - 1e-9) face.push_back(c);
        }
        const Vec3 u = geometry::normalized(face[0] - most * normal), v = cross(normal, u);
        std::ranges::sort(face, {}, [&](Vec3 c) { return std::atan2(dot(v, c), dot(u, c)); });
        set.polygons.push_back(face);
      }
    }
  }
  return set;
}

ClosedSet prism(int n) {
  ClosedSet set{"prism over " + std::to_string(n), {}, 1, true};
  const auto at = [&](int k, double z) {
    return Vec3{0.5 * std::cos(turn * (k % n) / n), 0.5 * std::sin(turn * (k % n) / n), z};
  };
  Corners low, high;
  for (int k = 0; k < n; ++k) {
    low.push_back(at(k, -0.4));
    high.push_back(at(k, 0.4));
    set.polygons.push_back({at(k, -0.4), at(k + 1, -0.4), at(k + 1, 0.4), at(k, 0.4)});
  }
  set.polygons.push_back(low);
  set.polygons.push_back(high);
  return set;
}

ClosedSet bipyramid(int n) {
  ClosedSet set{"bipyramid over " + std::to_string(n), {}, 2, true};
  const auto at = [&](int k) {
    return Vec3{0.5 * std::cos(turn * (k % n) / n), 0.5 * std::sin(turn * (k % n) / n), 0};
  };
  Corners base;
  for (int k = 0; k < n; ++k) {
    base.push_back(at(k));
    set.polygons.push_back({at(k), at(k + 1), {0.1, 0, 0.6}});
    set.polygons.push_back({at(k), at(k + 1), {0, 0.1, -0.5}});
  }
  set.polygons.push_back(base);
  return set;
}

ClosedSet torus(int m, int n) {
  ClosedSet set{"torus of " + std::to_string(m * n), {}, 1, false};
  const auto at = [&](int i, int k) {
    const double a = turn * (i % m) / m, b = turn * (k % n) / n, r = 0.5 + 0.2 * std::cos(b);
    return Vec3{r * std::cos(a), r * std::sin(a), 0.2 * std::sin(b)};
  };
  for (int i = 0; i < m; ++i) {
    for (int k = 0; k < n; ++k) set.polygons.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)});
  }
  return set;
}

ClosedSet voronoi(std::size_t count, const Uniform& uniform, double half, bool hull) {
  ClosedSet set{"cells of " + std::to_string(count) + " seeds", {}, count, true};
  Seeds seeds{{}, half};
  for (std::size_t k = 0; k < count; ++k) {
    const double x = uniform(), y = uniform(), z = uniform();
    seeds.at.push_back(half * Vec3{2 * x - 1, 2 * y - 1, 2 * z - 1});
  }
  for (int i = 0; i < static_cast<int>(count); ++i) {
    std::vector<std::pair<double, int>> others;
    for (int j = 0; j < static_cast<int>(count); ++j) {
      if (j != i)
        others.emplace_back(
            geometry::norm(seeds.at[static_cast<std::size_t>(j)] - seeds.at[static_cast<std::size_t>(i)]), j);
    }
    std::ranges::sort(others);
    auto faces = box_cell(i);
    for (const auto& [distance, j] : others) {
      double reach = 0;
      for (const CellFace& face : faces) {
        for (const Key& key : face.corners)
          reach = std::max(reach, geometry::norm(seeds.corner(key) - seeds.at[static_cast<std::size_t>(i)]));
      }
      if (distance > 2 * reach) break;
      clip(faces, seeds, i, j);
    }
    for (const CellFace& face : faces) {
      if (face.beyond < i || (face.beyond >= sides_first && !hull)) continue;
      Corners corners;
      for (const Key& key : face.corners) corners.push_back(seeds.corner(key));
      set.polygons.push_back(std::move(corners));
    }
  }
  return set;
}

ClosedSet simple_polyhedron(int planes, const Uniform& uniform) {
  // The cell of a seed in the middle, with the others about it.
  Seeds seeds{{Vec3{0, 0, 0}}, 0.7};
  for (int k = 0; k < planes; ++k) {
    const double z = 2 * uniform() - 1, a = turn * uniform(), r = 0.7 + 0.3 * uniform(), s = std::sqrt(1 - z * z);
    seeds.at.push_back(r * Vec3{s * std::cos(a), s * std::sin(a), z});
  }
  auto faces = box_cell(0);
  for (int j = 1; j <= planes; ++j) clip(faces, seeds, 0, j);
  ClosedSet set{"inside of " + std::to_string(planes) + " planes", {}, 1, true};
  for (const CellFace& face : faces) {
    Corners corners;
    for (const Key& key : face.corners) corners.push_back(seeds.corner(key));
    set.polygons.push_back(std::move(corners));
  }
  return set;
}

ClosedSet any_closed_set(const Uniform& uniform) {
  const auto pick = [&](int lo, int hi) { return lo + static_cast<int>(uniform() * (hi - lo + 1)); };
  switch (pick(0, 9)) {
    case 0: return cube_of_squares();
    case 1: return cube_of_tiles(pick(2, 3));
    case 2: return crate(pick(1, 2));
    case 3: return dodecahedron();
    case 4: return prism(pick(3, 16));
    case 5: return bipyramid(pick(3, 12));
    case 6: return torus(pick(3, 8), pick(3, 6));
    case 7: return simple_polyhedron(pick(4, 24), uniform);
    default: return voronoi(static_cast<std::size_t>(pick(2, 9)), uniform);
  }
}

Vec3 Placement::operator()(Vec3 p) const {
  const auto turned = [](double& a, double& b, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    const double x = c * a - s * b, y = s * a + c * b;
    a = x;
    b = y;
  };
  turned(p.x, p.y, angles[0]);
  turned(p.y, p.z, angles[1]);
  turned(p.z, p.x, angles[2]);
  return scale * p + shift;
}

ClosedSet placed(ClosedSet set, const Placement& at) {
  for (Corners& polygon : set.polygons) std::ranges::transform(polygon, polygon.begin(), at);
  return set;
}

std::vector<Corners> some_again_in_pieces(const std::vector<Corners>& polygons, const Uniform& uniform) {
  std::vector<Corners> out = polygons;
  for (const Corners& whole : polygons) {
    const std::size_t count = whole.size();
    const double kind = uniform();
    if (kind < 0.3) {  // about a point inside
      Vec3 middle{};
      double sum = 0;
      for (const Vec3& c : whole) {
        const double weight = 0.2 + uniform();
        middle += weight * c;
        sum += weight;
      }
      middle = middle / sum;
      for (std::size_t i = 0; i < count; ++i) out.push_back({whole[i], whole[(i + 1) % count], middle});
    } else if (kind < 0.6) {  // from a point on one side to one on another
      const auto on = [&](std::size_t i) {
        return whole[i] + (0.1 + 0.8 * uniform()) * (whole[(i + 1) % count] - whole[i]);
      };
      const std::size_t to = 1 + static_cast<std::size_t>(uniform() * static_cast<double>(count - 1));
      const Vec3 p = on(0), q = on(to);
      Corners one{p}, other{q};
      for (std::size_t i = 1; i <= to; ++i) one.push_back(whole[i]);
      one.push_back(q);
      for (std::size_t i = to + 1; i <= count; ++i) other.push_back(whole[i % count]);
      other.push_back(p);
      out.push_back(std::move(one));
      out.push_back(std::move(other));
    }
  }
  return out;
}

}  // namespace cleave::support
