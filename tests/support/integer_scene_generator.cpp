#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "integer_scene.hpp"

namespace cleave::testing {

namespace {

constexpr std::int32_t reach = 8;  // of corners from the origin

/// Draws one joint after the other; each may lean on the ones before it. Choices are made one a statement, or in
/// braces: compilers differ in the order of arguments and operands, and the same choices must give the same scene.
class Generator final {
 public:
  Generator(const Choose& choose, const SceneLimits& limits) : choose_{choose}, limits_{limits} {}

  [[nodiscard]] IntegerScene run() {
    draw_box();
    const int some = choose_(0, limits_.max_joints), others = choose_(0, limits_.max_joints);
    const int wanted = std::max(some, others);
    for (int attempt = 0; attempt < 3 * limits_.max_joints && count() < wanted; ++attempt) add_shape();
    const int excavations = choose_(0, 3) == 3 ? choose_(1, std::max(1, limits_.max_excavations)) : 0;
    for (int e = 0; e < excavations && limits_.max_excavations > 0; ++e) add_excavation();
    return std::move(scene_);
  }

 private:
  [[nodiscard]] int count() const { return static_cast<int>(scene_.joints.size()); }
  [[nodiscard]] IntegerPoint point(std::int32_t r) { return {choose_(-r, r), choose_(-r, r), choose_(-r, r)}; }
  /// Mostly short, sometimes along an axis: short vectors meet each other's ends.
  [[nodiscard]] IntegerPoint direction() {
    const std::int32_t r = choose_(0, 3) == 0 ? 6 : 3;
    IntegerPoint v = point(r);
    const std::int32_t axis = choose_(0, 5);
    if (axis == 0) v = {v.x, 0, 0};
    if (axis == 1) v = {0, v.y, 0};
    if (axis == 2) v = {0, 0, v.z};
    return v;
  }
  [[nodiscard]] const IntegerPolygon& earlier() {
    return scene_.joints[static_cast<std::size_t>(choose_(0, count() - 1))];
  }
  /// A corner of an earlier joint or of the box.
  [[nodiscard]] IntegerPoint known_vertex() {
    if (!scene_.joints.empty() && choose_(0, 2) != 0) {
      const IntegerPolygon& p = earlier();
      return p[static_cast<std::size_t>(choose_(0, static_cast<std::int32_t>(p.size()) - 1))];
    }
    return {choose_(0, 1) == 0 ? scene_.min.x : scene_.max.x, choose_(0, 1) == 0 ? scene_.min.y : scene_.max.y,
            choose_(0, 1) == 0 ? scene_.min.z : scene_.max.z};
  }

  void draw_box() {
    static constexpr std::array<std::int32_t, 6> halves{3, 2, 4, 2, 3, 6};
    const std::int32_t h = halves[static_cast<std::size_t>(choose_(0, 5))];
    scene_.min = {-h, -h, -h};
    scene_.max = {h, h, h};
    if (choose_(0, 3) == 3) {
      scene_.max.x = h - choose_(0, h);
      scene_.min.z = -h + choose_(0, h);
    }
  }

  bool add(IntegerPolygon polygon) {
    const auto far = [](IntegerPoint p) {
      return std::abs(p.x) > reach || std::abs(p.y) > reach || std::abs(p.z) > reach;
    };
    if (std::ranges::any_of(polygon, far) || !is_valid_polygon(polygon)) return false;
    scene_.joints.push_back(std::move(polygon));
    return true;
  }
  void add_parallelogram(IntegerPoint o, IntegerPoint u, IntegerPoint v) { add({o, o + u, o + u + v, o + v}); }
  void add_parallelogram(IntegerPoint o) {
    const IntegerPoint u = direction(), v = direction();
    add_parallelogram(o, u, v);
  }

  void add_shape() {
    const std::int32_t shape = choose_(0, 26);
    switch (shape) {
      case 0: add_parallelogram(point(6)); return;
      case 1: add({point(reach), point(reach), point(reach)}); return;
      case 2:
      case 3:
      case 4: add_axis_rectangle(); return;
      case 5:
      case 6: add_full_rectangle(); return;
      case 7:
      case 8:
      case 9:
      case 23:
      case 24: add_wide_parallelogram(point(1)); return;
      case 10: add_closed_tetrahedron(point(3)); return;
      case 11:
      case 25: add_box(point(3)); return;
      case 12: add_l_shape(point(4)); return;
      default: break;
    }
    if (scene_.joints.empty()) {
      add_wide_parallelogram(point(1));
      return;
    }
    switch (shape) {
      case 13: add_repeated(); return;
      case 14: add_moved(direction()); return;
      case 15:
      case 16: add_coplanar(); return;
      case 17: add_on_edge(); return;
      case 18: add_long_parallelogram(known_vertex()); return;
      case 19: add_moved({choose_(-1, 1), choose_(-1, 1), choose_(-1, 1)}); return;
      case 20: add_box(known_vertex()); return;
      case 21: add_closed_tetrahedron(known_vertex()); return;
      case 22: add_wide_parallelogram(known_vertex()); return;
      default: add({known_vertex(), known_vertex(), known_vertex()}); return;
    }
  }

  void add_axis_rectangle() {
    const std::int32_t a = choose_(-6, 1), b = choose_(-6, 1), axis = choose_(0, 2), at = choose_(-5, 5);
    const std::int32_t width = choose_(2, 11), height = choose_(2, 11);
    add(rectangle(axis, at, a, b, std::min(reach, a + width), std::min(reach, b + height)));
  }
  void add_full_rectangle() {
    const std::int32_t axis = choose_(0, 2), at = choose_(-4, 4);
    add(rectangle(axis, at, -reach, -reach, reach, reach));
  }
  void add_long_parallelogram(IntegerPoint o) {
    const std::int32_t j = choose_(1, 3), k = choose_(1, 3);
    const IntegerPoint u = direction(), v = direction();
    add_parallelogram(o, j * u, k * v);
  }
  /// As large as the corners' limit allows: cuts a small box through, or nearly.
  void add_wide_parallelogram(IntegerPoint o) {
    const IntegerPoint u = point(2), v = point(2);
    for (std::int32_t k = reach; k > 0; --k) {
      const IntegerPoint s = k * u, t = k * v;
      if (add({o - s - t, o + s - t, o + s + t, o - s + t})) return;
    }
  }
  void add_repeated() {
    IntegerPolygon p = earlier();
    if (choose_(0, 1) == 1) std::ranges::reverse(p);
    std::ranges::rotate(p, p.begin() + choose_(0, 2));
    add(std::move(p));
  }
  void add_moved(IntegerPoint by) {
    IntegerPolygon p = earlier();
    for (IntegerPoint& corner : p) corner = corner + by;
    add(std::move(p));
  }
  /// In the plane of an earlier one: side by side, overlapping, apart or touching at a corner.
  void add_coplanar() {
    const IntegerPolygon p = earlier();
    const IntegerPoint u = p[1] - p[0], v = p[2] - p[1];
    const std::array<std::int32_t, 6> k{choose_(-2, 2), choose_(-2, 2), choose_(-1, 2),
                                        choose_(-1, 1), choose_(-1, 1), choose_(-1, 2)};
    const IntegerPoint o = p[0] + k[0] * u + k[1] * v, s = k[2] * u + k[3] * v, t = k[4] * u + k[5] * v;
    if (choose_(0, 2) == 0) {
      add({o, o + s, o + t});
    } else {
      add_parallelogram(o, s, t);
    }
  }
  void add_on_edge() {
    const IntegerPolygon p = earlier();
    const auto i = static_cast<std::size_t>(choose_(0, static_cast<std::int32_t>(p.size()) - 1));
    const IntegerPoint a = p[i], b = p[(i + 1) % p.size()];
    if (choose_(0, 1) == 0) {
      add_parallelogram(a, b - a, direction());
    } else {
      add({a, b, a + direction()});
    }
  }
  void add_closed_tetrahedron(IntegerPoint a) {
    if (count() + 4 > limits_.max_joints) return;
    const IntegerPoint b = a + direction(), c = a + direction(), d = a + direction();
    add({a, b, c});
    add({a, b, d});
    add({a, c, d});
    add({b, c, d});
  }
  void add_box(IntegerPoint a) {
    if (count() + 6 > limits_.max_joints) return;
    const auto side = [&] { return choose_(0, 1) == 0 ? choose_(1, 4) : -choose_(1, 4); };
    const IntegerPoint b = a + IntegerPoint{side(), side(), side()};
    const auto [x0, x1] = std::minmax(a.x, b.x);
    const auto [y0, y1] = std::minmax(a.y, b.y);
    const auto [z0, z1] = std::minmax(a.z, b.z);
    add(rectangle(0, x0, y0, z0, y1, z1));
    add(rectangle(0, x1, y0, z0, y1, z1));
    add(rectangle(1, y0, x0, z0, x1, z1));
    add(rectangle(1, y1, x0, z0, x1, z1));
    add(rectangle(2, z0, x0, y0, x1, y1));
    add(rectangle(2, z1, x0, y0, x1, y1));
  }
  void add_l_shape(IntegerPoint o) {
    const IntegerPoint u = point(4), v = point(4);
    add({o, o + 2 * u, o + 2 * u + v, o + u + v, o + u + 2 * v, o + 2 * v});
  }

  void add_excavation() {
    const IntegerPoint a = choose_(0, 2) == 0 ? known_vertex() : point(4);
    if (choose_(0, 3) == 3) {
      add_tetrahedral_excavation(a);
      return;
    }
    const IntegerPoint size{choose_(1, 6), choose_(1, 6), choose_(1, 6)};
    IntegerPoint lo = a, hi = a + size;
    const std::int32_t through = choose_(0, 5);  // a tunnel
    if (through == 0) lo.x = -reach, hi.x = reach;
    if (through == 1) lo.y = -reach, hi.y = reach;
    if (through == 2) lo.z = -reach, hi.z = reach;
    scene_.excavations.push_back(integer_box(lo, hi));
  }
  void add_tetrahedral_excavation(IntegerPoint a) {
    const IntegerPoint u = direction(), v = direction(), w = direction();
    const std::int32_t det =
        u.x * (v.y * w.z - v.z * w.y) - u.y * (v.x * w.z - v.z * w.x) + u.z * (v.x * w.y - v.y * w.x);
    if (det == 0) return;
    IntegerSolid solid{{a, a + u, a + v, a + w}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
    if (det < 0) std::swap(solid.vertices[1], solid.vertices[2]);
    scene_.excavations.push_back(std::move(solid));
  }

  const Choose& choose_;
  SceneLimits limits_;
  IntegerScene scene_;
};

}  // namespace

IntegerScene make_integer_scene(const Choose& choose, const SceneLimits& limits) {
  return Generator{choose, limits}.run();
}

IntegerScene integer_scene_from_bytes(std::span<const std::uint8_t> bytes, const SceneLimits& limits) {
  std::size_t used = 0;
  const Choose choose = [&](std::int32_t lo, std::int32_t hi) {
    const std::int32_t byte = used < bytes.size() ? bytes[used++] : 0;
    return lo + byte % (hi - lo + 1);
  };
  return make_integer_scene(choose, limits);
}

}  // namespace cleave::testing
