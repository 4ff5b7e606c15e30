#include "workloads.hpp"

#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "cleave/core/assert.hpp"

namespace cleave::support {
namespace {

using geometry::Vec3;
using Corners = std::vector<Vec3>;
using std::numbers::pi;

/// SplitMix64 (Steele, Lea and Flood 2014): the scenes must not change when the library's own streams do.
class SplitMix final {
 public:
  explicit SplitMix(std::uint64_t seed) : state_{seed} {}
  double uniform(double lo = 0.0, double hi = 1.0) {
    return lo + (hi - lo) * (static_cast<double>(u64() >> 11U) * 0x1p-53);
  }
  /// Exponential, drawn again until it lies in [lo, hi].
  double truncated_exponential(double mean, double lo, double hi) {
    for (;;) {
      const double x = -mean * std::log(1.0 - uniform());
      if (lo <= x && x <= hi) return x;
    }
  }
  Vec3 on_sphere() {
    const double z = uniform(-1, 1);
    const double t = uniform(0, 2 * pi);
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(t), r * std::sin(t), z};
  }

 private:
  std::uint64_t u64() {
    state_ += 0x9E3779B97F4A7C15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31U);
  }
  std::uint64_t state_;
};

double coordinate(Vec3 a, int axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }

struct Frame {
  Vec3 strike, down, normal;
};

Frame frame_of(double dip_degrees, double dip_direction_degrees) {
  const double d = dip_degrees * (pi / 180.0);
  const double a = dip_direction_degrees * (pi / 180.0);
  return {.strike = {-std::cos(a), std::sin(a), 0.0},
          .down = {std::sin(a) * std::cos(d), std::cos(a) * std::cos(d), -std::sin(d)},
          .normal = {std::sin(a) * std::sin(d), std::cos(a) * std::sin(d), std::cos(d)}};
}

std::pair<Vec3, Vec3> axes_across(Vec3 n) {
  const Vec3 h = std::abs(n.x) < 0.6 ? Vec3{1.0, 0.0, 0.0} : Vec3{0.0, 1.0, 0.0};
  const Vec3 c = cross(n, h);
  const Vec3 u = (1 / std::sqrt(dot(c, c))) * c;
  return {u, cross(n, u)};
}

/// The part of a convex polygon where sign * (coordinate - bound) >= 0.
Corners clip(const Corners& polygon, int axis, double bound, double sign) {
  Corners kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 q = polygon[i];
    const Vec3 w = polygon[(i + 1) % polygon.size()];
    const double dq = sign * (coordinate(q, axis) - bound);
    const double dw = sign * (coordinate(w, axis) - bound);
    if (dq >= 0) kept.push_back(q);
    if ((dq > 0 && 0 > dw) || (dq < 0 && 0 < dw)) {
      const double t = dq / (dq - dw);
      kept.push_back(q + t * (w - q));
    }
  }
  return kept;
}

Corners plane_in_box(Vec3 p, Vec3 n, Vec3 lo, Vec3 hi) {
  const auto axes = axes_across(n);
  const Vec3 d = hi - lo;
  const double r = 2 * std::sqrt(dot(d, d));
  const auto corner = [&](double a, double b) { return p + (r * a * axes.first + r * b * axes.second); };
  Corners polygon{corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)};
  for (int axis = 0; axis < 3; ++axis) {
    polygon = clip(polygon, axis, coordinate(lo, axis), 1);
    polygon = clip(polygon, axis, coordinate(hi, axis), -1);
  }
  return polygon;
}

std::array<Vec3, 8> box(Vec3 lo, Vec3 hi) {
  std::array<Vec3, 8> corners{};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = {((i & 1U) != 0 ? hi : lo).x, ((i & 2U) != 0 ? hi : lo).y, ((i & 4U) != 0 ? hi : lo).z};
  }
  return corners;
}

/// A turn by 0.71..., 0.35... and 1.13... rad about x, y and z: no coordinate stays a round number.
Vec3 turned(Vec3 p) {
  const double cx = std::cos(0.71372911);
  const double sx = std::sin(0.71372911);
  const double cy = std::cos(0.35193373);
  const double sy = std::sin(0.35193373);
  const double cz = std::cos(1.12635471);
  const double sz = std::sin(1.12635471);
  return {dot({cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx}, p),
          dot({sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx}, p), dot({-sy, cy * sx, cy * cx}, p)};
}

template <class Map>
Workload mapped(Workload w, std::string name, const Map& map) {
  w.name = std::move(name);
  for (Vec3& c : w.corners) c = map(c);
  for (Corners& polygon : w.polygons) {
    for (Vec3& p : polygon) p = map(p);
  }
  return w;
}

struct Range {
  double lo, hi;
};

/// Rectangle across `axis` at `at`; the ranges are those of the other two axes, in order.
Corners rectangle_across(int axis, double at, Range first, Range second) {
  const auto corner = [&](double a, double b) -> Vec3 {
    if (axis == 0) return {at, a, b};
    if (axis == 1) return {a, at, b};
    return {a, b, at};
  };
  return {corner(first.lo, second.lo), corner(first.hi, second.lo), corner(first.hi, second.hi),
          corner(first.lo, second.hi)};
}

constexpr Vec3 rock_size{80.0, 80.0, 60.0};

struct MeanOrientation {
  double dip, dip_direction;
};
constexpr std::array<MeanOrientation, 3> sets{{{30, 30}, {45, 150}, {60, 270}}};

Frame random_joint(SplitMix& random, MeanOrientation mean) {
  const double dip = mean.dip + random.uniform(-20, 20);
  const double dip_direction = mean.dip_direction + random.uniform(-20, 20);
  return frame_of(dip, dip_direction);
}

Vec3 random_point(SplitMix& random, Vec3 size) {
  const double x = random.uniform(0, size.x);
  const double y = random.uniform(0, size.y);
  const double z = random.uniform(0, size.z);
  return {x, y, z};
}

void add_closed_box(Workload& w, Vec3 lo, Vec3 hi) {
  for (int axis = 0; axis < 3; ++axis) {
    const int b = axis == 0 ? 1 : 0;
    const int c = axis == 2 ? 1 : 2;
    for (const Vec3& side : {lo, hi}) {
      w.polygons.push_back(rectangle_across(axis, coordinate(side, axis), {coordinate(lo, b), coordinate(hi, b)},
                                            {coordinate(lo, c), coordinate(hi, c)}));
    }
  }
}

Workload empty(std::string name, Vec3 lo, Vec3 hi, std::optional<std::uint64_t> blocks) {
  return {.name = std::move(name), .corners = box(lo, hi), .polygons = {}, .blocks = blocks};
}

std::optional<std::uint64_t> counted(std::uint32_t size,
                                     std::span<const std::pair<std::uint32_t, std::uint64_t>> known) {
  for (const auto& [k, blocks] : known) {
    if (k == size) return blocks;
  }
  return std::nullopt;
}

}  // namespace

Workload grid(std::uint32_t n) {
  Workload w = empty("grid-" + std::to_string(n), {0, 0, 0}, {1, 1, 1}, std::uint64_t{n} * n * n);
  for (int axis = 0; axis < 3; ++axis) {
    for (std::uint32_t i = 1; i < n; ++i) {
      w.polygons.push_back(
          rectangle_across(axis, static_cast<double>(i) / static_cast<double>(n), {-0.01, 1.01}, {-0.01, 1.01}));
    }
  }
  return w;
}

Workload rotated_grid(std::uint32_t n) { return mapped(grid(n), "gridr-" + std::to_string(n), turned); }

Workload persistent(std::uint32_t k) {
  using Known = std::pair<std::uint32_t, std::uint64_t>;
  constexpr std::array known{Known{13, 3671}, Known{26, 25599}, Known{39, 86095}};
  Workload w = empty("persist-" + std::to_string(k), {0, 0, 0}, rock_size, counted(k, known));
  SplitMix random{1000 + k};
  for (const MeanOrientation mean : sets) {
    for (std::uint32_t i = 0; i < k; ++i) {
      const Vec3 p = random_point(random, rock_size);
      const Frame frame = random_joint(random, mean);
      w.polygons.push_back(plane_in_box(p, frame.normal, {-1, -1, -1}, {81, 81, 61}));
    }
  }
  return w;
}

Workload rectangles(std::uint32_t k) {
  using Known = std::pair<std::uint32_t, std::uint64_t>;
  constexpr std::array known{Known{13, 347}, Known{50, 22782}};
  Workload w = empty("rect-" + std::to_string(k), {0, 0, 0}, rock_size, counted(k, known));
  SplitMix random{2000 + k};
  for (const MeanOrientation mean : sets) {
    for (std::uint32_t i = 0; i < k; ++i) {
      const Vec3 p = random_point(random, rock_size);
      const Frame f = random_joint(random, mean);
      const double a = random.truncated_exponential(80, 40, 120) / 2;
      const double b = random.truncated_exponential(80, 40, 120) / 2;
      const auto corner = [&](double x, double y) { return p + (x * a * f.strike + y * b * f.down); };
      w.polygons.push_back({corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)});
    }
  }
  return w;
}

Workload far_rectangles(double east, double north) {
  return mapped(rectangles(13), "rect-13-far", [&](Vec3 p) { return p + Vec3{east, north, 0.0}; });
}

Workload discs(std::uint32_t n) {
  using Known = std::pair<std::uint32_t, std::uint64_t>;
  constexpr std::array known{Known{1000, 1}};
  Workload w = empty("disc-" + std::to_string(n), {0, 0, 0}, {100, 100, 100}, counted(n, known));
  SplitMix random{3000 + n};
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vec3 p = random_point(random, {100, 100, 100});
    const auto [u, v] = axes_across(random.on_sphere());
    const double radius = random.truncated_exponential(4, 1, 15);
    const double start = random.uniform(0, 2 * pi);
    Corners polygon;
    for (int corner = 0; corner < 8; ++corner) {
      const double t = start + corner * pi / 4;
      polygon.push_back(p + (radius * std::cos(t) * u + radius * std::sin(t) * v));
    }
    w.polygons.push_back(std::move(polygon));
  }
  return w;
}

Workload coplanar_squares() {
  Workload w = empty("deg-coplanar", {0, 0, 0}, {1, 1, 1}, 8);
  constexpr double a = -0.0625;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      const double x = a + i * 0.28125;
      const double y = a + j * 0.28125;
      w.polygons.push_back(rectangle_across(2, 0.5, {x, x + 0.3125}, {y, y + 0.3125}));
    }
  }
  w.polygons.push_back(rectangle_across(2, 0.5, {0.25, 0.75}, {0.25, 0.75}));
  w.polygons.push_back(rectangle_across(2, 0.5, {0.25, 0.75}, {0.25, 0.75}));
  w.polygons.push_back(rectangle_across(2, 0.5, {0.25, 0.5}, {0.25, 0.75}));
  w.polygons.push_back(rectangle_across(2, 0.5, {0.375, 0.625}, {0.375, 0.625}));
  for (const int axis : {0, 1}) w.polygons.push_back(rectangle_across(axis, 0.5, {a, 1 - a}, {a, 1 - a}));
  return w;
}

Workload rotated_coplanar_squares() { return mapped(coplanar_squares(), "deg-coplanarr", turned); }

Workload fan() {
  Workload w = empty("deg-fan12", {-1, -1, -1}, {1, 1, 1}, 24);
  for (int i = 0; i < 12; ++i) {
    const double t = 2 * pi * (i + 0.25) / 12;
    const double x = 2 * std::cos(t);
    const double y = 2 * std::sin(t);
    w.polygons.push_back({{0, 0, -1.5}, {0, 0, 1.5}, {x, y, 1.5}, {x, y, -1.5}});
  }
  w.polygons.push_back(rectangle_across(2, 0.0, {-1.5, 1.5}, {-1.5, 1.5}));
  return w;
}

Workload rotated_fan() { return mapped(fan(), "deg-fan12r", turned); }

Workload common_vertex(std::uint32_t m) {
  Workload w = empty("deg-vertex" + std::to_string(m), {-1, -1, -1}, {1, 1, 1}, std::uint64_t{m} * m - m + 2);
  SplitMix random{77};
  for (std::uint32_t i = 0; i < m; ++i) {
    const auto [across, along] = axes_across(random.on_sphere());
    const Vec3 u = 4 * across;
    const Vec3 v = 4 * along;
    w.polygons.push_back({u, v, -1 * u, -1 * v});
  }
  return w;
}

Workload rotated_common_vertex(std::uint32_t m) {
  return mapped(common_vertex(m), "deg-vertex" + std::to_string(m) + "r",
                [](Vec3 p) { return turned(p) + Vec3{0.1, 0.2, 0.3}; });
}

Workload slivers(std::uint32_t m, double angle) {
  SplitMix random{99};
  std::vector<double> at(m);
  for (double& c : at) c = random.uniform(0.2, 0.8);
  const auto tilt = [&](std::uint32_t i) { return i * angle; };
  std::uint64_t blocks = 1 + std::uint64_t{m};  // plus the crossings of the lines in the section, inside the box
  for (std::uint32_t i = 0; i < m; ++i) {
    for (std::uint32_t j = 0; j < i; ++j) {
      const double x = (tilt(i) * at[i] - tilt(j) * at[j]) / (tilt(i) - tilt(j));
      if (0 < x && x < 1) ++blocks;
    }
  }
  Workload w = empty("deg-sliver" + std::to_string(m), {0, 0, 0}, {1, 1, 1}, blocks);
  for (std::uint32_t i = 0; i < m; ++i) {
    const double low = 0.5 + tilt(i) * (-0.5 - at[i]);
    const double high = 0.5 + tilt(i) * (1.5 - at[i]);
    w.polygons.push_back({{-0.5, -0.5, low}, {1.5, -0.5, high}, {1.5, 1.5, high}, {-0.5, 1.5, low}});
  }
  return w;
}

Workload touching() {
  Workload w = empty("deg-touch", {0, 0, 0}, {1, 1, 1}, 4);
  w.polygons = {rectangle_across(0, 0.5, {-0.25, 1.25}, {-0.25, 1.25}),
                {{-0.25, -0.25, 0.5}, {0.5, -0.25, 0.5}, {0.5, 1.25, 0.5}, {-0.25, 1.25, 0.5}},
                {{0.5, 0.5, -0.25}, {1.25, 0.5, -0.25}, {1.25, 0.5, 1.25}, {0.5, 0.5, 1.25}},
                {{0.5, 0.25, 0.25}, {0.5, 0.375, 0.25}, {0.75, 0.375, 0.25}, {0.75, 0.25, 0.25}},
                {{0.5, 0.5, 0.5}, {0.625, 0.75, 0.625}, {0.625, 0.75, 0.75}},
                {{0.25, 0.25, 0.5}, {0.25, 0.375, 0.75}, {0.375, 0.25, 0.75}}};
  return w;
}

Workload cavities() {
  Workload w = empty("deg-cavity", {0, 0, 0}, {8, 8, 8}, 6);
  add_closed_box(w, {1, 1, 1}, {4, 4, 4});
  add_closed_box(w, {2, 2, 2}, {3, 3, 3});
  add_closed_box(w, {5, 1, 1}, {6, 2, 2});
  add_closed_box(w, {6, 2, 1}, {7, 3, 2});
  add_closed_box(w, {7, 3, 2}, {7.5, 3.5, 2.5});
  return w;
}

Workload ring() {
  Workload w = empty("deg-ring", {0, 0, 0}, {8, 8, 8}, 2);
  for (const double z : {3.0, 5.0}) {  // floor and lid
    w.polygons.push_back(rectangle_across(2, z, {1, 7}, {1, 3}));
    w.polygons.push_back(rectangle_across(2, z, {1, 7}, {5, 7}));
    w.polygons.push_back(rectangle_across(2, z, {1, 3}, {3, 5}));
    w.polygons.push_back(rectangle_across(2, z, {5, 7}, {3, 5}));
  }
  for (const int axis : {0, 1}) {
    for (const double at : {1.5, 6.5}) w.polygons.push_back(rectangle_across(axis, at, {1.25, 6.75}, {2.5, 5.5}));
    for (const double at : {3.0, 5.0}) w.polygons.push_back(rectangle_across(axis, at, {3, 5}, {2.5, 5.5}));
  }
  return w;
}

std::optional<Workload> workload_named(std::string_view name) {
  for (const auto& [prefix, make] : {std::pair<std::string_view, Workload (*)(std::uint32_t)>{"grid-", grid},
                                     {"gridr-", rotated_grid},
                                     {"persist-", persistent},
                                     {"rect-", rectangles},
                                     {"disc-", discs}}) {
    if (!name.starts_with(prefix)) continue;
    const std::string digits{name.substr(prefix.size())};
    const bool good =
        !digits.empty() && digits.size() < 7 && digits.find_first_not_of("0123456789") == std::string::npos;
    if (!good || std::stoul(digits) == 0) return std::nullopt;
    return make(static_cast<std::uint32_t>(std::stoul(digits)));
  }
  if (name == "deg-coplanar") return coplanar_squares();
  if (name == "deg-coplanarr") return rotated_coplanar_squares();
  if (name == "deg-fan12") return fan();
  if (name == "deg-fan12r") return rotated_fan();
  if (name == "deg-vertex8") return common_vertex(8);
  if (name == "deg-vertex20") return common_vertex(20);
  if (name == "deg-vertex8r") return rotated_common_vertex(8);
  if (name == "deg-vertex20r") return rotated_common_vertex(20);
  if (name == "deg-sliver10-1e-06") return slivers(10, 1e-6);
  if (name == "deg-sliver10-1e-09") return slivers(10, 1e-9);
  if (name == "deg-sliver10-1e-12") return slivers(10, 1e-12);
  if (name == "deg-touch") return touching();
  if (name == "deg-cavity") return cavities();
  if (name == "deg-ring") return ring();
  if (name == "deg-utm6") return far_rectangles(1e6, 1e6);
  if (name == "deg-utm7") return far_rectangles(1e7, 1e7);
  return std::nullopt;
}

topology::CutInput cut_input(const Workload& workload) {
  auto domain = geometry::make_hexahedron(workload.corners);
  CLEAVE_ASSERT(domain.has_value());
  topology::CutInput input{
      .domain = *std::move(domain), .joints = {}, .excavations = {}, .free_domain_tags = {}, .snap = metres(0)};
  input.joints.reserve(workload.polygons.size());
  for (const Corners& corners : workload.polygons) {
    auto polygon = geometry::Polygon::make(corners);
    CLEAVE_ASSERT(polygon.has_value());
    input.joints.emplace_back(topology::Joint{.polygons = {*std::move(polygon)}});
  }
  return input;
}

}  // namespace cleave::support
