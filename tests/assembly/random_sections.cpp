#include "random_sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "cleave/core/rng.hpp"

namespace cleave::testing {
namespace {

/// x to the east, z up, m.
struct At {
  double x, z;
};
At operator+(At a, At b) { return {a.x + b.x, a.z + b.z}; }
At operator-(At a, At b) { return {a.x - b.x, a.z - b.z}; }
At operator*(double s, At a) { return {s * a.x, s * a.z}; }
At along(double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  return {std::cos(angle), std::sin(angle)};
}
At turned(At a) { return {-a.z, a.x}; }

class Drawing final {
 public:
  explicit Drawing(Rng& rng) : rng_{rng} {}
  [[nodiscard]] double number(double low, double high) { return low + (high - low) * rng_.uniform(); }
  [[nodiscard]] int count(int low, int high) { return static_cast<int>(rng_.between(low, high)); }
  [[nodiscard]] bool chance(double share) { return rng_.uniform() < share; }

  /// The ground, west to east; a ledge drops off before its first point, so that nothing slides into level ground with
  /// a corner, which is no contact of blocks.
  void ground_behind_a_drop(std::vector<At> points) {
    const At first = points.front();
    points.insert(points.begin(), {first + At{-6, -2}, first + At{-0.5, -2}});
    ground(std::move(points));
  }
  /// The ground, west to east.
  void ground(std::vector<At> points) { ground_ = std::move(points); }
  /// A joint from a to b, and a little beyond both.
  void joint(At a, At b, bool base = false) {
    const double length = std::hypot(b.x - a.x, b.z - a.z);
    if (length < 0.05) return;
    const At more = (0.01 / length) * (b - a);
    joints_.push_back({a - more, b + more, base});
  }
  /// A joint through `at` from end to end.
  void line(At at, double degrees, bool base) { joint(at - 60.0 * along(degrees), at + 60.0 * along(degrees), base); }

  [[nodiscard]] std::string scene(double strength) {
    double west = ground_.front().x - 6, east = ground_.back().x + 6, low = 1e9, high = -1e9;
    for (const At p : ground_) {
      low = std::min(low, p.z);
      high = std::max(high, p.z);
    }
    low -= 8;
    std::string text =
        fmt::format("[domain]\nbox = {{ min = [{}, 0, {}], max = [{}, 1, {}] }}\n", west, low, east, high + 1);
    text += "[[excavation]]\nkind = \"slope\"\nprofile = { direction = 90, points = [";
    for (const At p : ground_) text += fmt::format("[{}, {}], ", p.x, p.z);
    text += "] }\n";
    for (const Joint& j : joints_) {
      text += fmt::format(
          "[[joint]]\nset = \"{4}\"\npolygon = [[{0}, -1, {1}], [{2}, -1, {3}], [{2}, 2, {3}], [{0}, 2, {1}]]\n", j.a.x,
          j.a.z, j.b.x, j.b.z, j.base ? "base" : "cross");
    }
    const auto angle = [&](double degrees) {
      return std::atan(strength * std::tan(degrees * std::numbers::pi / 180)) * 180 / std::numbers::pi;
    };
    const double base = number(10, 60), cross = chance(0.5) ? base : number(10, 60);
    const double friction = angle(base), other = angle(cross);
    const double cohesion = strength * (chance(0.25) ? number(0, 15e3) : 0);
    text += fmt::format("[joints.default]\nfriction = {}\ncohesion = 0\n", other);
    if (std::ranges::any_of(joints_, &Joint::base)) {
      text += fmt::format("[joints.base]\nfriction = {}\ncohesion = {}\n", friction, cohesion);
    }
    text += "[rock]\ndensity = 2600\n[stability]\nfree = [\"south\", \"north\", \"top\"]\ngroups = \"note\"\n";
    const double push = chance(0.2) ? number(-0.3, 0.3) : 0;
    if (push != 0) text += fmt::format("seismic = [{}, 0, 0]\n", push);
    return text + "[output]\nsection = [{ through = [0, 0.5, 0], azimuth = 90 }]\n";
  }

 private:
  struct Joint {
    At a, b;
    bool base;
  };
  Rng& rng_;
  std::vector<At> ground_;
  std::vector<Joint> joints_;
};

/// A layer on a joint behind a toe block on a flatter one.
void slab(Drawing& d) {
  const double dip = d.number(20, 55), thick = d.number(1, 4), length = d.number(8, 25), wide = d.number(0.5, 4);
  const double flat = d.number(-10, 12);
  const At up = along(dip), flatter = along(flat);
  const At toe = -wide * flatter, top = length * up;
  const double lift = thick / std::cos(dip * std::numbers::pi / 180);
  // A steep front, the surface parallel to the layer, level ground behind.
  const double steep = d.number(0.02, 0.6);
  const At front{toe.x + steep, toe.z + std::max(0.5, lift - d.number(0, 0.5) * lift)};
  d.ground_behind_a_drop({toe, front, {top.x, top.z + lift}, {top.x + 8, top.z + lift}});
  d.joint({0, 0}, top, true);
  d.joint(toe, {0, 0}, true);
  d.joint(0.05 * up, 0.05 * up + 30.0 * along(d.number(60, 120)));
  d.joint(top, top + At{0, 30}, true);
  for (int k = d.count(0, 4); k > 0; --k) {
    const At at = d.number(0.1, 0.9) * top;
    d.joint(at, at + 30.0 * along(d.chance(0.5) ? 90 : d.number(60, 120)));
  }
}

/// A layer cut in blocks by joints across and along, its foot open.
void layer(Drawing& d) {
  const double dip = d.number(8, 50), thick = d.number(0.5, 4), length = d.number(5, 20);
  const At up = along(dip), top = length * up;
  const double lift = thick / std::cos(dip * std::numbers::pi / 180);
  d.ground_behind_a_drop({{0, 0}, {d.number(0.02, 1), lift}, {top.x, top.z + lift}, {top.x + 8, top.z + lift}});
  d.joint({0, 0}, top, true);
  d.joint(top, top + At{0, 30}, true);
  const double share = d.chance(0.5) ? d.number(0.2, 0.8) : 1;
  const At in = share * lift * At{0, 1};
  if (share < 1) d.joint(in, top + in);
  const int cuts = d.count(1, 5);
  for (int k = 0; k < cuts; ++k) {
    const At at = ((k + d.number(0.2, 0.6)) / cuts) * top;
    const double steep = d.number(60, 120);
    // Above the joint along the layer it starts anew: where four corners meet, bodies in contact catch on rounding.
    const double below = share < 1 ? share * thick / std::sin(steep * std::numbers::pi / 180) : 30;
    d.joint(at, at + below * along(dip + steep));
    const At above = in + at + d.number(0.1, 0.3) / cuts * top + below * std::cos(steep * std::numbers::pi / 180) * up;
    if (share < 1) d.joint(above, above + 30.0 * along(dip + d.number(60, 120)));
  }
}

/// Courses of stones on an inclined base.
void wall(Drawing& d) {
  const double dip = d.number(-5, 35), wide = d.number(1, 8), course = d.number(0.5, 2);
  const int courses = d.count(1, 4);
  const At right = along(dip), up = turned(right);
  const double tall = courses * course;
  const At foot = wide * right;
  d.ground({{-8, -8 * right.z}, {0, 0}, {0.05, tall}, {foot.x - 0.05, foot.z + tall}, foot, foot + 8.0 * right});
  d.joint({0, 0}, foot, true);
  const double apart = d.number(0.7, 3), lean = d.chance(0.6) ? 0 : d.number(-15, 15);
  for (int c = 0; c < courses; ++c) {
    const At low = c * course * up;
    if (c > 0) d.joint(low - 9.0 * right, low + 15.0 * right);
    for (double s = apart * d.number(-4, -3); s < wide + 5; s += apart) {
      d.joint(low + s * right, low + s * right + course * along(dip + 90 + lean));
    }
  }
}

/// Columns that dip into the slope, on a base that comes out of it.
void columns(Drawing& d) {
  const double dip = d.number(10, 40), face = d.number(45, 80), tall = d.number(4, 12);
  const At up = along(face);
  const double crest = tall / up.z * up.x;
  const double back = crest + d.number(1, 5);
  const At end = (back / along(dip).x) * along(dip);
  d.ground_behind_a_drop({{0, 0}, {crest, tall}, {back + 8, tall + d.number(0, 1)}});
  d.joint({0, 0}, end, true);
  const int cuts = d.count(2, 8);
  const double lean = d.number(85, 120);
  for (int k = 1; k <= cuts; ++k) {
    const At at = (static_cast<double>(k) / cuts) * end;
    d.joint(at, at + 30.0 * along(k == cuts ? 90 : lean), k == cuts);
  }
}

/// A circle in chords, with vertical sides or others.
void slices(Drawing& d) {
  const double face = d.number(35, 65), tall = d.number(5, 12);
  const double crest = tall / along(face).z * along(face).x, back = crest + d.number(1, 4);
  d.ground_behind_a_drop({{0, 0}, {crest, tall}, {back + 6, tall}});
  const double bow = d.number(0.05, 0.3);
  const int cuts = d.count(2, 9);
  At before{0, 0};
  for (int k = 1; k <= cuts; ++k) {
    const double s = static_cast<double>(k) / cuts;
    const At at = s * At{back, tall} + (-4 * bow * tall * s * (1 - s)) * At{-0.5, 1};
    d.joint(before, at, true);
    // Not where chords meet: three joints through a point leave slivers.
    const At foot = before + 0.95 * (at - before);
    if (k < cuts) d.joint(foot, foot + 30.0 * along(d.chance(0.7) ? 90 : d.number(60, 120)));
    before = at;
  }
}

/// A slope in random joints.
void cut_slope(Drawing& d) {
  const double face = d.number(45, 85), tall = d.number(4, 10);
  const double crest = tall / along(face).z * along(face).x;
  d.ground({{-7, 0}, {0, 0}, {crest, tall}, {crest + 9, tall + d.number(-0.5, 1)}});
  for (int k = d.count(2, 5); k > 0; --k) {
    const bool flat = d.chance(0.5);
    d.line({d.number(-1, crest + 4), d.number(0.1, 0.9) * tall}, flat ? d.number(5, 60) : d.number(60, 175), flat);
  }
}

/// A mound in random joints: rubble.
void mound(Drawing& d) {
  const double dip = d.number(-5, 30), wide = d.number(3, 9), tall = d.number(1.5, 6);
  const At right = along(dip), foot = wide * right;
  const double in = d.number(0.05, 0.3) * wide;
  d.ground({{-6, -6 * right.z},
            {0, 0},
            {in, in * right.z + tall},
            {foot.x - in, foot.z + tall * d.number(0.5, 1)},
            foot,
            foot + 6.0 * right});
  d.joint({0, 0}, foot, true);
  for (int k = d.count(1, 5); k > 0; --k) {
    const At at{d.number(0.1, 0.9) * foot.x, 0};
    // Above the base alone.
    const At from = at + At{0, at.x / right.x * right.z};
    const double direction = dip + d.number(10, 170);
    d.joint(from, from + 30.0 * along(direction));
    if (d.chance(0.4)) {
      const At side = from + d.number(0.2, 0.8) * tall * At{0, 1};
      d.joint(side - 30.0 * right, side + 30.0 * right);
    }
  }
}

/// Blocks between two steep sides: wedges, keystones, pushers.
void slot(Drawing& d) {
  const double wide = d.number(2, 6), deep = d.number(2, 5), left = d.number(70, 110), right = d.number(70, 110);
  d.ground({{-8, 0}, {wide + 8, d.number(-1, 1)}});
  const At corner{wide, -deep - d.number(-1, 1)};
  d.joint({0, -deep}, corner, true);
  d.joint({0, -deep}, At{0, -deep} + 30.0 * along(left), true);
  d.joint(corner, corner + 30.0 * along(right), true);
  for (int k = d.count(1, 4); k > 0; --k) {
    const At at{d.number(0.1, 0.9) * wide, -d.number(0.2, 1) * deep};
    d.joint(at - 15.0 * along(0), at + 15.0 * along(d.number(-30, 30)));
    d.joint(at, at + 30.0 * along(d.number(45, 135)));
  }
}

}  // namespace

RandomSection random_section(std::uint64_t seed, std::uint32_t trial, double strength) {
  Rng rng{{.seed = seed, .realization = 0, .purpose = 11, .index = trial}};
  Drawing drawing{rng};
  using Family = std::pair<const char*, void (*)(Drawing&)>;
  static constexpr std::array<Family, 8> families{{{"slab", slab},
                                                   {"layer", layer},
                                                   {"wall", wall},
                                                   {"columns", columns},
                                                   {"slices", slices},
                                                   {"cut_slope", cut_slope},
                                                   {"mound", mound},
                                                   {"slot", slot}}};
  const auto& [name, draw] = families.at(trial % families.size());
  draw(drawing);
  return {name, drawing.scene(strength)};
}

}  // namespace cleave::testing
