#include "cleave/realize/places.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <queue>

#include "cleave/geometry/tunnel.hpp"
#include "cleave/stochastic/record.hpp"

namespace cleave::scene {
namespace {

using geometry::Vec3;

void sort_and_drop_repeated(auto& values) {
  std::ranges::sort(values);
  const auto repeated = std::ranges::unique(values);
  values.erase(repeated.begin(), repeated.end());
}

/// Frame of the section where the axis has this chainage.
geometry::SectionFrame frame_at(const TunnelLine& tunnel, double chainage) {
  const std::vector<Vec3>& axis = tunnel.axis;
  std::size_t i = 0;
  for (double left = chainage; i + 2 < axis.size(); ++i) {
    left -= geometry::norm(axis[i + 1] - axis[i]);
    if (left <= 0) break;
  }
  return geometry::section_frames(axis, tunnel.up)[i];
}

double distance_to_segment(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 along = b - a;
  const double square = dot(along, along);
  const double share = square > 0 ? std::clamp(dot(p - a, along) / square, 0.0, 1.0) : 0.0;
  return norm(p - (a + share * along));
}

/// From a point to a flat face with its holes.
double distance_to_face(const topology::BlockComplex& complex, const topology::Face& face, Vec3 p) {
  const Vec3 n = face.outward, some = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 x_axis = normalized(cross(n, some)), y_axis = cross(n, x_axis);
  double nearest = std::numeric_limits<double>::infinity(), height = 0;
  bool inside = false;
  for (const auto& loop : complex.loops(face)) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec3 a = complex.vertices()[loop[i]], b = complex.vertices()[loop[(i + 1) % loop.size()]];
      nearest = std::min(nearest, distance_to_segment(p, a, b));
      height = std::abs(dot(p - a, n));
      const double ya = dot(a - p, y_axis), yb = dot(b - p, y_axis);
      if ((ya > 0) == (yb > 0)) continue;
      const double xa = dot(a - p, x_axis), xb = dot(b - p, x_axis);
      if (xa + (xb - xa) * (ya / (ya - yb)) > 0) inside = !inside;
    }
  }
  return inside ? height : nearest;
}

constexpr double steepest_tunnel = 70 * std::numbers::pi / 180;  // what plunges more is a shaft

/// Of so many equal parts of a circle, the first in the middle of `up` and on to the right.
std::size_t nearest_of(int parts, double right, double up) {
  const double part = std::atan2(right, up) * parts / (2 * std::numbers::pi);
  return static_cast<std::size_t>((std::lround(part) + parts) % parts);
}

/// Free faces of a block that are not a tunnel's, by how they lie.
class OpenGround {
 public:
  void add(const topology::Face& face, bool cut) {
    Part& flat = cut ? floor_ : ground_;
    Part& part = face.outward.z >= level ? flat : face.outward.z <= -overhanging ? roof_ : wall_;
    const double area = face.area.si();
    part.area += area;
    part.height += area * face.centroid.z;
  }
  /// `wall`: the name of what is steep; empty without faces.
  [[nodiscard]] std::string_view name(std::string_view wall) const {
    for (const Part* above : {&floor_, &ground_}) {
      if (wall_.area > 0 && above->area > 0 && above->height / above->area > wall_.height / wall_.area) return "crest";
    }
    const std::array<std::pair<double, std::string_view>, 4> parts{
        {{wall_.area, wall}, {floor_.area, "floor"}, {ground_.area, "ground"}, {roof_.area, "roof"}}};
    const auto most = std::ranges::max_element(parts, {}, [](const auto& part) { return part.first; });
    return most->first > 0 ? most->second : std::string_view{};
  }

 private:
  /// What dips by less than ten degrees is level: slopes may be flat. A roof overhangs by more than forty-five.
  static constexpr double level = 0.984807753012208, overhanging = 0.7071067811865476;
  struct Part {
    double area = 0, height = 0;  ///< sums; heights by area
  };
  Part wall_, floor_, ground_, roof_;
};

/// How far a block reaches into the rock: of the points at which it meets other rock, or a side of the domain, the one
/// farthest from its free faces. Triangles of these faces are halved until none can hold a point that lies farther than
/// the best corner so far by more than a thousandth.
class Depth {
 public:
  Depth(const topology::BlockComplex& complex, topology::BlockId block) : complex_{complex} {
    for (const topology::FaceId id : complex.blocks()[block].faces) {
      const topology::Face face = complex.faces()[id];
      const bool free = face.role == topology::Role::free;
      (free ? free_ : held_).push_back(face);
      if (free) convex_.push_back(is_convex(face) ? 1 : 0);
    }
  }
  /// Empty without a free face, and where all are.
  [[nodiscard]] std::optional<Length> find() {
    if (free_.empty() || held_.empty()) return std::nullopt;
    for (const topology::Face& face : held_) search(face);
    return Length::from_si(best_);
  }

 private:
  static constexpr int most_halvings = 4'000;  // of one face
  static constexpr double close = 1e-3;
  struct Point {
    Vec3 at;
    std::vector<double> off;  ///< of each free face
  };
  struct Triangle {
    std::array<std::size_t, 3> corners = {};  // of points_
    double most = 0;                          // no point of it lies farther from all free faces
    friend bool operator<(const Triangle& a, const Triangle& b) { return a.most < b.most; }
  };

  [[nodiscard]] bool is_convex(const topology::Face& face) const {
    if (complex_.loops(face).size() != 1) return false;
    const auto loop = complex_.loops(face)[0];
    const auto at = [&](std::size_t i) { return complex_.vertices()[loop[i % loop.size()]]; };
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec3 to = at(i + 1) - at(i), on = at(i + 2) - at(i + 1);
      if (dot(cross(to, on), face.outward) < -1e-9 * norm(to) * norm(on)) return false;
    }
    return true;
  }
  /// It counts where it lies on the face `inside`; without one it does.
  std::size_t add(Vec3 at, const topology::Face* inside) {
    Point& point = points_.emplace_back(at);
    double nearest = std::numeric_limits<double>::infinity();
    for (const topology::Face& face : free_) {
      point.off.push_back(distance_to_face(complex_, face, at));
      nearest = std::min(nearest, point.off.back());
    }
    const auto on = [&] { return distance_to_face(complex_, *inside, at) <= 1e-9 * (nearest + best_); };
    if (nearest > best_ && (inside == nullptr || on())) best_ = nearest;
    return points_.size() - 1;
  }
  [[nodiscard]] double edge(const Triangle& t, std::size_t k) const {
    return norm(points_[t.corners.at(k)].at - points_[t.corners.at((k + 1) % 3)].at);
  }
  /// The distance to a convex face is largest at a corner; to others it grows by no more than the way.
  [[nodiscard]] Triangle bounded(std::array<std::size_t, 3> corners) const {
    Triangle t{corners, std::numeric_limits<double>::infinity()};
    const double across = std::max({edge(t, 0), edge(t, 1), edge(t, 2)});
    for (std::size_t f = 0; f < free_.size(); ++f) {
      const auto [low, high] =
          std::minmax({points_[corners[0]].off[f], points_[corners[1]].off[f], points_[corners[2]].off[f]});
      t.most = std::min(t.most, convex_[f] != 0 ? high : low + across);
    }
    return t;
  }
  /// The fans of its loops cover a face, and more where it is not convex.
  void search(const topology::Face& face) {
    points_.clear();
    const topology::Face* const inside = is_convex(face) ? nullptr : &face;
    std::priority_queue<Triangle> open;
    for (const auto& loop : complex_.loops(face)) {
      std::vector<std::size_t> corners;
      for (const topology::VertexId v : loop) corners.push_back(add(complex_.vertices()[v], nullptr));
      for (std::size_t i = 2; i < corners.size(); ++i) open.push(bounded({corners[0], corners[i - 1], corners[i]}));
    }
    for (int halvings = 0; !open.empty() && halvings < most_halvings; ++halvings) {
      const Triangle t = open.top();
      if (t.most <= best_ * (1 + close)) return;
      open.pop();
      const std::array<double, 3> edges{edge(t, 0), edge(t, 1), edge(t, 2)};
      std::size_t longest = edges[1] > edges[0] ? 1 : 0;
      if (edges[2] > edges.at(longest)) longest = 2;
      const std::size_t a = t.corners.at(longest), b = t.corners.at((longest + 1) % 3),
                        c = t.corners.at((longest + 2) % 3);
      const std::size_t middle = add(0.5 * (points_[a].at + points_[b].at), inside);
      const bool beside = inside != nullptr && distance_to_face(complex_, face, points_[middle].at) > edges.at(longest);
      if (beside) continue;  // all of it
      for (const auto& half : {std::array{a, middle, c}, std::array{middle, b, c}}) open.push(bounded(half));
    }
  }

  const topology::BlockComplex& complex_;
  std::vector<topology::Face> free_, held_;
  std::vector<std::uint8_t> convex_;  // by free face
  std::vector<Point> points_;         // of the face at work
  double best_ = 0;
};

/// Depth and extent of a block.
void measure(const topology::BlockComplex& complex, topology::BlockId block, BlockPlace& place) {
  std::vector<topology::VertexId> corners;
  for (const topology::FaceId id : complex.blocks()[block].faces) {
    for (const auto& loop : complex.loops(id)) corners.insert(corners.end(), loop.begin(), loop.end());
  }
  sort_and_drop_repeated(corners);
  double extent = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 p = complex.vertices()[corners[i]];
    for (std::size_t k = 0; k < i; ++k) extent = std::max(extent, norm(p - complex.vertices()[corners[k]]));
  }
  place.depth = Depth{complex, block}.find();
  place.extent = Length::from_si(extent);
}

}  // namespace

bool at_shaft(const geometry::SectionFrame& section) { return std::abs(section.along.z) >= std::sin(steepest_tunnel); }

namespace {
/// Its level part, to the east and to true north.
std::array<double, 2> east_and_north(Vec3 away, geometry::North north) {
  const double c = geometry::cos_degrees(north.degrees()), s = geometry::sin_degrees(north.degrees());
  return {away.x * c - away.y * s, away.x * s + away.y * c};
}
}  // namespace

std::string_view location_of(const geometry::SectionFrame& section, Vec3 away, geometry::North north) {
  static constexpr std::array<std::string_view, 4> tunnel{"roof", "right wall", "floor", "left wall"};
  static constexpr std::array<std::string_view, 4> shaft{"north wall", "east wall", "south wall", "west wall"};
  if (at_shaft(section)) {
    const auto [x, y] = east_and_north(away, north);
    return shaft[nearest_of(4, x, y)];
  }
  const double angle = std::atan2(dot(away, section.right), dot(away, section.up)) * 180 / std::numbers::pi;
  if (std::abs(angle) <= 45) return tunnel[0];
  if (std::abs(angle) >= 135) return tunnel[2];
  return tunnel[angle > 0 ? 1 : 3];
}

std::string_view position_of(const geometry::SectionFrame& section, Vec3 away, geometry::North north) {
  static constexpr std::array<std::string_view, 8> tunnel{"roof",  "upper right", "right", "lower right",
                                                          "floor", "lower left",  "left",  "upper left"};
  static constexpr std::array<std::string_view, 8> shaft{"north", "northeast", "east", "southeast",
                                                         "south", "southwest", "west", "northwest"};
  if (at_shaft(section)) {
    const auto [x, y] = east_and_north(away, north);
    return shaft[nearest_of(8, x, y)];
  }
  return tunnel[nearest_of(8, dot(away, section.right), dot(away, section.up))];
}

double clock_of(const geometry::SectionFrame& section, Vec3 away) {
  const double hours = std::atan2(dot(away, section.right), dot(away, section.up)) * 6 / std::numbers::pi;
  return hours > 0 ? hours : hours + 12;
}

std::span<const std::string_view> all_locations() {
  static constexpr std::array<std::string_view, 13> all{"roof",      "left wall",  "right wall", "floor", "north wall",
                                                        "east wall", "south wall", "west wall",  "crest", "slope",
                                                        "bench",     "face",       "ground"};
  return all;
}

std::vector<topology::JointId> joints_of(const topology::BlockComplex& complex, topology::BlockId block) {
  std::vector<topology::JointId> joints;
  for (const topology::FaceId id : complex.blocks()[block].faces) {
    const topology::Face& face = complex.faces()[id];
    if (face.joint) joints.push_back(*face.joint);
    for (const topology::Patch& patch : complex.patches(face)) {
      if (patch.joint) joints.push_back(*patch.joint);
    }
  }
  sort_and_drop_repeated(joints);
  return joints;
}

namespace {
/// `excavations`: of a scene or of a result, with their tunnel and what their walls are called.
OpenPlace open_place(const auto& excavations, geometry::North north, const topology::BlockComplex& complex,
                     const auto& faces, Vec3 centroid) {
  OpenPlace place;
  struct Opening {
    double area = 0;
    Vec3 towards;  ///< sum of outward area vectors
  };
  std::map<std::uint32_t, Opening> openings;  // by excavation
  OpenGround ground;
  for (const topology::FaceId id : faces) {
    const topology::Face& face = complex.faces()[id];
    if (face.role != topology::Role::free) continue;
    place.free_area += face.area;
    const bool cut = face.excavation && *face.excavation < excavations.size();
    ground.add(face, cut);
    if (!cut) continue;
    Opening& opening = openings[*face.excavation];
    opening.area += face.area.si();
    opening.towards += face.area.si() * face.outward;
  }
  const auto widest = std::ranges::max_element(openings, {}, [](const auto& entry) { return entry.second.area; });
  if (widest == openings.end()) {
    place.location = ground.name("face");
    return place;
  }
  const auto& tunnel = excavations[widest->first].tunnel;
  place.location = excavations[widest->first].wall;
  if (!tunnel || tunnel->axis.size() < 2) {
    place.location = ground.name(place.location);
    return place;
  }
  place.chainage = stochastic::chainage_of(tunnel->axis, centroid);
  const geometry::SectionFrame section = frame_at(*tunnel, *place.chainage);
  const Vec3 away = -widest->second.towards;
  const double across = std::hypot(dot(away, section.right), dot(away, section.up));
  if (!(across > std::abs(dot(away, section.along)))) return place;
  place.location = location_of(section, away, north);
  place.clock = clock_of(section, away);
  return place;
}

OpenPlace open_place(const auto& excavations, geometry::North north, const topology::BlockComplex& complex,
                     topology::BlockId block) {
  const topology::Block& of = complex.blocks()[block];
  return open_place(excavations, north, complex, of.faces, of.centroid);
}

OpenPlace open_place(const auto& excavations, geometry::North north, const topology::BlockComplex& complex,
                     topology::FaceId face) {
  return open_place(excavations, north, complex, std::array{face}, complex.faces()[face].centroid);
}

std::vector<OpenPlace> pressed_places(const auto& excavations, geometry::North north,
                                      const topology::BlockComplex& complex, const stability::SupportedBlock& block) {
  std::vector<OpenPlace> places;
  const auto add = [&](const auto& faces) {
    for (const topology::FaceId face : faces) {
      if (complex.faces()[face].role != topology::Role::free) continue;
      places.push_back(open_place(excavations, north, complex, face));
    }
  };
  add(block.out_of);
  if (places.empty()) add(complex.blocks()[block.block].faces);
  return places;
}
}  // namespace

std::vector<OpenPlace> pressed_places(const Scene& scene, const topology::BlockComplex& complex,
                                      const stability::SupportedBlock& block) {
  return pressed_places(scene.excavations, geometry::North::degrees(scene.north), complex, block);
}

std::vector<OpenPlace> pressed_places(const RunResult& result, const topology::BlockComplex& complex,
                                      const stability::SupportedBlock& block) {
  return pressed_places(result.excavations, geometry::North::degrees(result.north), complex, block);
}

std::vector<OpenPlace> walls_of_openings(const RunResult& result, const topology::BlockComplex& complex) {
  std::vector<OpenPlace> walls;
  for (const topology::FaceId id : complex.faces().ids()) {
    const topology::Face& face = complex.faces()[id];
    if (face.role != topology::Role::free || !face.excavation) continue;
    walls.push_back(open_place(result.excavations, geometry::North::degrees(result.north), complex, id));
  }
  return walls;
}

OpenPlace open_place_of(const Scene& scene, const topology::BlockComplex& complex, topology::BlockId block) {
  return open_place(scene.excavations, geometry::North::degrees(scene.north), complex, block);
}

std::optional<stochastic::Part> part_of(const OpenPlace& place) {
  if (place.location.empty()) return std::nullopt;
  if (place.location == "roof") return stochastic::Part::roof;
  if (place.location == "floor") return stochastic::Part::floor;
  return place.location.ends_with("wall") ? stochastic::Part::walls : stochastic::Part::faces;
}

BlockPlace place_of(const RunResult& result, const topology::BlockComplex& complex, topology::BlockId block,
                    const std::vector<topology::JointId>& joints) {
  BlockPlace place{open_place(result.excavations, geometry::North::degrees(result.north), complex, block)};
  place.centroid = complex.blocks()[block].centroid;
  for (const topology::JointId joint : joints) {
    if (joint.index() < result.joints.size()) place.sets.push_back(result.joints[joint].set);
  }
  sort_and_drop_repeated(place.sets);
  measure(complex, block, place);
  return place;
}

GroupPlace place_of(const RunResult& result, const topology::BlockComplex& complex,
                    const std::vector<topology::BlockId>& group) {
  GroupPlace out;
  Area most;
  Volume whole;
  for (const topology::BlockId id : group) {
    const BlockPlace place = place_of(result, complex, id, joints_of(complex, id));
    const Volume volume = complex.blocks()[id].volume;
    out.centroid = out.centroid + volume.si() * place.centroid;
    whole += volume;
    out.free_area += place.free_area;
    out.sets.insert(out.sets.end(), place.sets.begin(), place.sets.end());
    if (!(place.free_area > most)) continue;
    most = place.free_area;
    out.location = place.location;
    out.chainage = place.chainage ? std::optional{Length::from_si(*place.chainage)} : std::nullopt;
    out.clock = place.clock;
  }
  if (whole.si() > 0) out.centroid = (1 / whole.si()) * out.centroid;
  sort_and_drop_repeated(out.sets);
  return out;
}

}  // namespace cleave::scene
