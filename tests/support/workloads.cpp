#include "workloads.hpp"

#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "cleave/core/assert.hpp"

// The order of the floating operations is part of the scenes: do not simplify. `through_memory` keeps the compiler from
// working out a sine of a constant by itself, which may differ from the library's in the last bit.

namespace cleave::testing {
namespace {

using geometry::Vec3;
using Corners = std::vector<Vec3>;

constexpr double pi = std::numbers::pi;

double through_memory(double x) {
  volatile double copy = x;
  return copy;
}
double sine(double x) { return std::sin(through_memory(x)); }
double cosine(double x) { return std::cos(through_memory(x)); }

Vec3 unit(Vec3 a) { return (1 / std::sqrt(geometry::dot(a, a))) * a; }

/// SplitMix64.
class Random final {
 public:
  explicit Random(std::uint64_t seed) : state_{seed} {}
  double uniform(double a, double b) { return a + (b - a) * (static_cast<double>(next() >> 11U) * 0x1p-53); }
  /// Negative exponential, truncated by rejection.
  double exponential(double mean, double lo, double hi) {
    while (true) {
      const double x = -mean * std::log(1.0 - uniform(0.0, 1.0));
      if (lo <= x && x <= hi) return x;
    }
  }
  Vec3 direction() {
    const double z = uniform(-1, 1);
    const double t = uniform(0, 2 * pi);
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(t), r * std::sin(t), z};
  }
  Vec3 point(Vec3 lo, Vec3 hi) {
    const double x = uniform(lo.x, hi.x);
    const double y = uniform(lo.y, hi.y);
    const double z = uniform(lo.z, hi.z);
    return {x, y, z};
  }

 private:
  std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31U);
  }
  std::uint64_t state_;
};

std::array<Vec3, 8> box_corners(Vec3 lo, Vec3 hi) {
  std::array<Vec3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    corners.at(i) = {(i & 1U) != 0 ? hi.x : lo.x, (i & 2U) != 0 ? hi.y : lo.y, (i & 4U) != 0 ? hi.z : lo.z};
  }
  return corners;
}

struct Frame {
  Vec3 strike, down, normal;
};
Frame frame(double dip, double dip_direction) {
  const double d = dip * (pi / 180), a = dip_direction * (pi / 180);
  return {{-std::cos(a), std::sin(a), 0.0},
          {std::sin(a) * std::cos(d), std::cos(a) * std::cos(d), -std::sin(d)},
          {std::sin(a) * std::sin(d), std::cos(a) * std::sin(d), std::cos(d)}};
}

std::pair<Vec3, Vec3> plane_frame(Vec3 n) {
  const Vec3 helper = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = unit(geometry::cross(n, helper));
  return {u, geometry::cross(n, u)};
}

double coordinate(const Vec3& p, int axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }
double& coordinate(Vec3& p, int axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

constexpr std::array<std::array<int, 2>, 4> square{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};

Corners parallelogram(Vec3 p, Vec3 u, double a, Vec3 v, double b) {
  Corners corners;
  for (const auto& [x, y] : square) corners.push_back(p + ((x * a) * u + (y * b) * v));
  return corners;
}

Corners clip_plane_to_box(Vec3 p, Vec3 n, Vec3 lo, Vec3 hi) {
  const auto [u, v] = plane_frame(n);
  const double r = 2 * std::sqrt(geometry::dot(hi - lo, hi - lo));
  Corners polygon = parallelogram(p, u, r, v, r);
  for (int axis = 0; axis < 3; ++axis) {
    for (const auto& [bound, side] : {std::pair{coordinate(lo, axis), 1}, std::pair{coordinate(hi, axis), -1}}) {
      Corners out;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3 q = polygon[i], w = polygon[(i + 1) % polygon.size()];
        const double dq = side * (coordinate(q, axis) - bound), dw = side * (coordinate(w, axis) - bound);
        if (dq >= 0) out.push_back(q);
        if ((dq > 0 && 0 > dw) || (dq < 0 && 0 < dw)) out.push_back(q + (dq / (dq - dw)) * (w - q));
      }
      polygon = std::move(out);
      if (polygon.size() < 3) return {};
    }
  }
  return polygon;
}

/// Turned by 0.71372911, 0.35193373, 1.12635471 rad about x, y, z.
Vec3 turned(Vec3 p) {
  const double cx = cosine(0.71372911), sx = sine(0.71372911), cy = cosine(0.35193373), sy = sine(0.35193373),
               cz = cosine(1.12635471), sz = sine(1.12635471);
  return {geometry::dot({cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx}, p),
          geometry::dot({sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx}, p),
          geometry::dot({-sy, cy * sx, cy * cx}, p)};
}

class Scene final {
 public:
  Scene(Vec3 lo, Vec3 hi, std::optional<std::uint64_t> expected = {})
      : out_{.name = {}, .corners = box_corners(lo, hi), .polygons = {}, .expected = expected, .consensus = {}} {}
  void add(Corners polygon) {
    if (polygon.size() >= 3) out_.polygons.push_back(std::move(polygon));
  }
  /// Rectangle at right angles to an axis; lo and hi are those of the other two axes in order.
  void add_rectangle(int axis, double at, std::array<double, 2> lo, std::array<double, 2> hi) {
    const int b = axis == 0 ? 1 : 0, c = axis == 2 ? 1 : 2;
    Corners corners;
    for (const auto& [x, y] : square) {
      Vec3 p;
      coordinate(p, axis) = at;
      coordinate(p, b) = x < 0 ? lo[0] : hi[0];
      coordinate(p, c) = y < 0 ? lo[1] : hi[1];
      corners.push_back(p);
    }
    add(std::move(corners));
  }
  void add_closed_box(Vec3 lo, Vec3 hi) {
    for (int axis = 0; axis < 3; ++axis) {
      const int b = axis == 0 ? 1 : 0, c = axis == 2 ? 1 : 2;
      for (const Vec3 end : {lo, hi}) {
        add_rectangle(axis, coordinate(end, axis), {coordinate(lo, b), coordinate(lo, c)},
                      {coordinate(hi, b), coordinate(hi, c)});
      }
    }
  }
  template <class Map>
  Workload mapped(const Map& map) && {
    for (Vec3& p : out_.corners) p = map(p);
    for (Corners& polygon : out_.polygons) {
      for (Vec3& p : polygon) p = map(p);
    }
    return std::move(out_);
  }
  Workload turned_if(bool turn) && {
    return turn ? std::move(*this).mapped(turned) : std::move(out_);
  }
  Workload done() && { return std::move(out_); }
  std::optional<std::uint64_t>& expected() { return out_.expected; }

 private:
  Workload out_;
};

Workload grid(int n, bool turn) {
  Scene s{{0, 0, 0}, {1, 1, 1}, static_cast<std::uint64_t>(n) * static_cast<std::uint64_t>(n) * static_cast<std::uint64_t>(n)};
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 1; i < n; ++i) s.add_rectangle(axis, static_cast<double>(i) / n, {-0.01, -0.01}, {1.01, 1.01});
  }
  return std::move(s).turned_if(turn);
}

constexpr Vec3 rock_lo{0, 0, 0}, rock_hi{80, 80, 60};

/// Mean dip and dip direction of the sets, each plus or minus 20 degrees.
Frame joint_of_set(Random& random, std::size_t set) {
  constexpr std::array<std::array<double, 2>, 3> means{{{30, 30}, {45, 150}, {60, 270}}};
  const double dip = means.at(set)[0] + random.uniform(-20, 20);
  const double direction = means.at(set)[1] + random.uniform(-20, 20);
  return frame(dip, direction);
}

Workload persistent(int k) {
  Random random{1000 + static_cast<std::uint64_t>(k)};
  Scene s{rock_lo, rock_hi};
  for (std::size_t set = 0; set < 3; ++set) {
    for (int i = 0; i < k; ++i) {
      const Vec3 p = random.point(rock_lo, rock_hi);
      s.add(clip_plane_to_box(p, joint_of_set(random, set).normal, {-1, -1, -1}, {81, 81, 61}));
    }
  }
  return std::move(s).done();
}

Scene rectangles(int k) {
  Random random{2000 + static_cast<std::uint64_t>(k)};
  Scene s{rock_lo, rock_hi};
  for (std::size_t set = 0; set < 3; ++set) {
    for (int i = 0; i < k; ++i) {
      const Vec3 p = random.point(rock_lo, rock_hi);
      const Frame f = joint_of_set(random, set);
      const double a = random.exponential(80, 40, 120) / 2;
      const double b = random.exponential(80, 40, 120) / 2;
      s.add(parallelogram(p, f.strike, a, f.down, b));
    }
  }
  return s;
}

Workload discs(int n) {
  Random random{3000 + static_cast<std::uint64_t>(n)};
  Scene s{{0, 0, 0}, {100, 100, 100}};
  for (int i = 0; i < n; ++i) {
    const Vec3 p = random.point({0, 0, 0}, {100, 100, 100});
    const auto [u, v] = plane_frame(random.direction());
    const double radius = random.exponential(4, 1, 15);
    const double phase = random.uniform(0, 2 * pi);
    Corners corners;
    for (int k = 0; k < 8; ++k) {
      const double angle = phase + k * pi / 4;
      corners.push_back(p + ((radius * std::cos(angle)) * u + (radius * std::sin(angle)) * v));
    }
    s.add(std::move(corners));
  }
  return std::move(s).done();
}

/// Twenty overlapping squares in the plane z = 1/2 that together cover the section, and x = 1/2 and y = 1/2.
Workload coplanar(bool turn) {
  Scene s{{0, 0, 0}, {1, 1, 1}, 8};
  constexpr double a = -0.0625;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      const double x = a + i * 0.28125, y = a + j * 0.28125;
      s.add_rectangle(2, 0.5, {x, y}, {x + 0.3125, y + 0.3125});
    }
  }
  s.add_rectangle(2, 0.5, {0.25, 0.25}, {0.75, 0.75});
  s.add_rectangle(2, 0.5, {0.25, 0.25}, {0.75, 0.75});
  s.add_rectangle(2, 0.5, {0.25, 0.25}, {0.5, 0.75});
  s.add_rectangle(2, 0.5, {0.375, 0.375}, {0.625, 0.625});
  for (const int axis : {0, 1}) s.add_rectangle(axis, 0.5, {a, a}, {1 - a, 1 - a});
  return std::move(s).turned_if(turn);
}

/// Twelve half-planes that share the edge x = y = 0 (exactly, unless turned), and z = 0.
Workload fan(bool turn) {
  Scene s{{-1, -1, -1}, {1, 1, 1}, 24};
  for (int i = 0; i < 12; ++i) {
    const double t = 2 * pi * (i + 0.25) / 12;
    const double x = 2 * cosine(t), y = 2 * sine(t);
    s.add({{0, 0, -1.5}, {0, 0, 1.5}, {x, y, 1.5}, {x, y, -1.5}});
  }
  s.add_rectangle(2, 0.0, {-1.5, -1.5}, {1.5, 1.5});
  return std::move(s).turned_if(turn);
}

/// m planes through one vertex (exactly, unless turned and moved) in general directions: m^2 - m + 2 blocks.
Workload vertex(int m, bool turn) {
  Scene s{{-1, -1, -1}, {1, 1, 1}, static_cast<std::uint64_t>(m * m - m + 2)};
  Random random{77};
  for (int i = 0; i < m; ++i) {
    const auto [u, v] = plane_frame(random.direction());
    const Vec3 a = 4.0 * u, b = 4.0 * v;
    s.add({a, b, -1.0 * a, -1.0 * b});
  }
  if (!turn) return std::move(s).done();
  return std::move(s).mapped([](Vec3 p) { return turned(p) + Vec3{0.1, 0.2, 0.3}; });
}

/// Nearly coplanar planes: plane i contains the line z = 1/2, x = c_i and is tilted by i times the slope about it.
Workload sliver(int m, double slope) {
  Random random{99};
  std::vector<double> c, tilt;
  for (int i = 0; i < m; ++i) c.push_back(random.uniform(0.2, 0.8));
  for (int i = 0; i < m; ++i) tilt.push_back(i * slope);
  std::uint64_t blocks = 1 + static_cast<std::uint64_t>(m);
  for (std::size_t i = 0; i < c.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double x = (tilt[i] * c[i] - tilt[j] * c[j]) / (tilt[i] - tilt[j]);
      if (0 < x && x < 1) ++blocks;
    }
  }
  Scene s{{0, 0, 0}, {1, 1, 1}, blocks};
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double left = 0.5 + tilt[i] * (-0.5 - c[i]), right = 0.5 + tilt[i] * (1.5 - c[i]);
    s.add({{-0.5, -0.5, left}, {1.5, -0.5, right}, {1.5, 1.5, right}, {-0.5, 1.5, left}});
  }
  return std::move(s).done();
}

/// Contacts at exactly an edge or a vertex, and three dangling polygons.
Workload touch() {
  Scene s{{0, 0, 0}, {1, 1, 1}, 4};
  s.add_rectangle(0, 0.5, {-0.25, -0.25}, {1.25, 1.25});
  s.add({{-0.25, -0.25, 0.5}, {0.5, -0.25, 0.5}, {0.5, 1.25, 0.5}, {-0.25, 1.25, 0.5}});
  s.add({{0.5, 0.5, -0.25}, {1.25, 0.5, -0.25}, {1.25, 0.5, 1.25}, {0.5, 0.5, 1.25}});
  s.add({{0.5, 0.25, 0.25}, {0.5, 0.375, 0.25}, {0.75, 0.375, 0.25}, {0.75, 0.25, 0.25}});
  s.add({{0.5, 0.5, 0.5}, {0.625, 0.75, 0.625}, {0.625, 0.75, 0.75}});
  s.add({{0.25, 0.25, 0.5}, {0.25, 0.375, 0.75}, {0.375, 0.25, 0.75}});
  return std::move(s).done();
}

/// Closed boxes of joints: one in another, and three in a chain that touch along an edge and at a vertex.
Workload cavity() {
  Scene s{{0, 0, 0}, {8, 8, 8}, 6};
  s.add_closed_box({1, 1, 1}, {4, 4, 4});
  s.add_closed_box({2, 2, 2}, {3, 3, 3});
  s.add_closed_box({5, 1, 1}, {6, 2, 2});
  s.add_closed_box({6, 2, 1}, {7, 3, 2});
  s.add_closed_box({7, 3, 2}, {7.5, 3.5, 2.5});
  return std::move(s).done();
}

/// A closed square ring of joints in the middle; every wall has rims that lead nowhere.
Workload ring() {
  Scene s{{0, 0, 0}, {8, 8, 8}, 2};
  for (const double z : {3.0, 5.0}) {
    s.add_rectangle(2, z, {1, 1}, {7, 3});
    s.add_rectangle(2, z, {1, 5}, {7, 7});
    s.add_rectangle(2, z, {1, 3}, {3, 5});
    s.add_rectangle(2, z, {5, 3}, {7, 5});
  }
  for (const int axis : {0, 1}) {
    for (const double at : {1.5, 6.5}) s.add_rectangle(axis, at, {1.25, 2.5}, {6.75, 5.5});
    for (const double at : {3.0, 5.0}) s.add_rectangle(axis, at, {3, 2.5}, {5, 5.5});
  }
  return std::move(s).done();
}

std::optional<int> number_after(std::string_view name, std::string_view prefix) {
  if (!name.starts_with(prefix)) return std::nullopt;
  name.remove_prefix(prefix.size());
  int value = 0;
  // NOLINTNEXTLINE(bugprone-suspicious-stringview-data-usage): the end is given too
  const auto [end, error] = std::from_chars(name.data(), std::to_address(name.end()), value);
  if (error != std::errc{} || end != std::to_address(name.end()) || value < 1) return std::nullopt;
  return value;
}

std::optional<Workload> make(std::string_view name) {
  if (const auto n = number_after(name, "grid-")) return grid(*n, false);
  if (const auto n = number_after(name, "gridr-")) return grid(*n, true);
  if (const auto n = number_after(name, "persist-")) return persistent(*n);
  if (const auto n = number_after(name, "rect-")) return rectangles(*n).done();
  if (const auto n = number_after(name, "disc-")) return discs(*n);
  for (const auto& [suffix, turn] : {std::pair<std::string_view, bool>{"", false}, {"r", true}}) {
    const auto is = [&](std::string_view stem) {
      return name.size() == stem.size() + suffix.size() && name.starts_with(stem) && name.ends_with(suffix);
    };
    if (is("deg-coplanar")) return coplanar(turn);
    if (is("deg-fan12")) return fan(turn);
    if (is("deg-vertex8")) return vertex(8, turn);
    if (is("deg-vertex20")) return vertex(20, turn);
  }
  if (name == "deg-sliver10-1e-06") return sliver(10, 1e-6);
  if (name == "deg-sliver10-1e-09") return sliver(10, 1e-9);
  if (name == "deg-sliver10-1e-12") return sliver(10, 1e-12);
  if (name == "deg-touch") return touch();
  if (name == "deg-cavity") return cavity();
  if (name == "deg-ring") return ring();
  for (const auto& [suffix, offset] : {std::pair<std::string_view, double>{"deg-utm6", 1e6}, {"deg-utm7", 1e7}}) {
    if (name == suffix) {
      return rectangles(13).mapped([east = offset](Vec3 p) { return p + Vec3{east, east, 0.0}; });
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<Workload> make_workload(std::string_view name) {
  static const std::map<std::string, std::uint64_t, std::less<>> consensus{
      {"persist-13", 3671},  {"persist-26", 25599}, {"persist-39", 86095},   {"rect-13", 347}, {"rect-50", 22782},
      {"disc-1000", 1},      {"deg-utm6", 347},     {"deg-utm7", 347},       {"gridr-4", 64},  {"gridr-6", 216},
      {"deg-vertex8r", 93},  {"gridr-10", 1000},    {"deg-vertex20r", 1351}, {"deg-fan12r", 24}};
  auto workload = make(name);
  if (!workload) return std::nullopt;
  workload->name = name;
  if (const auto found = consensus.find(name); found != consensus.end()) workload->consensus = found->second;
  return workload;
}

topology::CutInput cut_input(const Workload& workload, Length snap) {
  auto domain = geometry::make_hexahedron(workload.corners);
  CLEAVE_ASSERT(domain.has_value());
  topology::CutInput input{.domain = std::move(*domain), .joints = {}, .excavations = {}, .free_domain_tags = {}, .snap = snap};
  for (const auto& corners : workload.polygons) {
    auto polygon = geometry::Polygon::make(corners);
    CLEAVE_ASSERT(polygon.has_value());
    input.joints.emplace_back(topology::Joint{{std::move(*polygon)}});
  }
  return input;
}

}  // namespace cleave::testing
