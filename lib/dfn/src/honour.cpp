#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <expected>
#include <limits>
#include <optional>

#include "cleave/core/assert.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/core/rng.hpp"
#include "mapped.hpp"
#include "orientation.hpp"
#include "outline.hpp"
#include "shape.hpp"

namespace cleave::dfn {

using geometry::Vec3;

namespace {

constexpr double no_limit = std::numeric_limits<double>::infinity();

/// Candidates that could show the trace, of which one is drawn; and how many draws are made for them.
constexpr std::size_t enough_candidates = 64;
constexpr std::size_t most_draws = 1U << 15U;

struct FittedPlane {
  Vec3 through, normal;
};
/// Through all points where a joint was seen, by least squares. It counts where they lie so far apart across their line
/// that it is known better than the direction of a trace.
std::optional<FittedPlane> fitted_plane(const MappedJoint& joint, const Mapping& mapping) {
  std::vector<Vec3> points;
  for (const MappedTrace& trace : joint.traces) points.insert(points.end(), trace.ends.begin(), trace.ends.end());
  for (const MappedPick& pick : joint.picks) points.push_back(pick.at);
  if (points.size() < 3) return std::nullopt;
  Vec3 middle{};
  for (const Vec3& p : points) middle += p / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vec3& p : points) {
    const Eigen::Vector3d d{p.x - middle.x, p.y - middle.y, p.z - middle.z};
    spread += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes{spread};
  // Points that are off by half the largest error turn the plane by that over the root of their sum of squares.
  const double across = std::sqrt(std::max(0.0, axes.eigenvalues()[1]));
  if (!(mapping.error.si() / 2 <= mapping.turn.radians() * across)) return std::nullopt;
  const Eigen::Vector3d n = axes.eigenvectors().col(0);
  return FittedPlane{middle, {n.x(), n.y(), n.z()}};
}

/// What a joint is laid on: the trace that says most of it.
std::optional<MappedTrace> leading_trace(const MappedJoint& joint) {
  std::optional<MappedTrace> best;
  const auto says = [](const MappedTrace& t) {
    return std::pair{(t.goes_on[0] ? 0 : 1) + (t.goes_on[1] ? 0 : 1), detail::length(t)};
  };
  for (const MappedTrace& trace : joint.traces) {
    if (!best || says(*best) < says(trace)) best = trace;
  }
  return best;
}

/// A joint's corners as seen along a line in its plane: how its chords parallel to that line grow and shrink.
/// Coordinates from its centre, m: a along the line, b to the left of it.
class Chords final {
 public:
  Chords(std::span<const Vec2> corners, Vec2 along);

  struct Chord {
    double b, from, to;  ///< at b, from a = from to a = to
    [[nodiscard]] double length() const noexcept { return to - from; }
  };
  /// Measure (m) of the offsets b whose chord is from `least` to `most` long.
  [[nodiscard]] double offsets(double least, double most);
  /// One of those of the last `offsets`; u in (0, 1). Precondition: it was > 0.
  [[nodiscard]] Chord chord(double u) const;
  [[nodiscard]] const Chord& longest() const { return *std::ranges::max_element(breaks_, {}, &Chord::length); }

 private:
  struct Part {
    std::size_t before;  ///< of breaks_
    double begin, end;   ///< shares of the way to the next one
    double measure;      ///< m
  };
  std::vector<Chord> breaks_;
  std::vector<Part> parts_;
};

Chords::Chords(std::span<const Vec2> corners, Vec2 along) {
  std::vector<Vec2> turned;
  turned.reserve(corners.size());
  for (const Vec2 c : corners) turned.push_back({dot(along, c), cross(along, c)});
  breaks_.reserve(turned.size());
  for (const Vec2 level : turned) {
    Chord chord{level.y, level.x, level.x};
    const auto reaches = [&](double a) {
      chord.from = std::min(chord.from, a);
      chord.to = std::max(chord.to, a);
    };
    for (std::size_t i = 0; i < turned.size(); ++i) {
      const Vec2 p = turned[i], q = turned[i + 1 < turned.size() ? i + 1 : 0];
      if (p.y == level.y) reaches(p.x);  // sides along the line
      if ((p.y > level.y) != (q.y > level.y)) reaches(p.x + (level.y - p.y) / (q.y - p.y) * (q.x - p.x));
    }
    breaks_.push_back(chord);
  }
  std::ranges::sort(breaks_, {}, &Chord::b);
}

double Chords::offsets(double least, double most) {
  parts_.clear();
  double sum = 0;
  for (std::size_t k = 0; k + 1 < breaks_.size(); ++k) {
    const double first = breaks_[k].length(), last = breaks_[k + 1].length();
    const double wide = breaks_[k + 1].b - breaks_[k].b;
    if (!(wide > 0)) continue;
    double begin = 0, end = 1;
    const auto keep = [&](double at_first, double at_last) {  // where a number that changes evenly is >= 0
      if (at_first < 0 && at_last < 0) end = begin;
      if (at_first < 0 && at_last >= 0) begin = std::max(begin, at_first / (at_first - at_last));
      if (at_first >= 0 && at_last < 0) end = std::min(end, at_first / (at_first - at_last));
    };
    keep(first - least, last - least);
    if (most < no_limit) keep(most - first, most - last);
    if (!(begin < end)) continue;
    parts_.push_back({k, begin, end, (end - begin) * wide});
    sum += parts_.back().measure;
  }
  return sum;
}

Chords::Chord Chords::chord(double u) const {
  CLEAVE_ASSERT(!parts_.empty());
  double left = 0;
  for (const Part& part : parts_) left += part.measure;
  left *= u;
  const Part* at = &parts_.back();
  for (const Part& part : parts_) {
    if (left <= part.measure) {
      at = &part;
      break;
    }
    left -= part.measure;
  }
  const Chord &p = breaks_[at->before], &q = breaks_[at->before + 1];
  const double t = at->begin + std::min(1.0, left / at->measure) * (at->end - at->begin);
  return {p.b + t * (q.b - p.b), p.from + t * (q.from - p.from), p.to + t * (q.to - p.to)};
}

/// A joint that could have been seen so, and how likely it would have been.
struct Candidate {
  double key;  ///< smaller, sooner drawn: an exponential number over the weight (Efraimidis & Spirakis 2006)
  std::size_t set;
  JointOutline outline;
  Vec3 centre, normal;
};

class Honourer final {
 public:
  Honourer(std::span<const JointSet* const> sets, const Mapping& mapping, std::uint64_t seed,
           std::uint64_t realization);

  [[nodiscard]] std::expected<HonouredJoint, SampleError> draw(std::size_t number) const;

 private:
  struct Law {
    std::size_t set;
    const JointSet* joints;
    detail::SizeDrawer size;
    detail::Frame mean;
    std::vector<detail::FlatPoint> unit;
    double density;  ///< centres per m3
  };
  /// A joint as it was seen, with what follows from it for all candidates.
  struct Seen {
    const MappedJoint& joint;
    std::optional<MappedTrace> trace;  ///< what it is laid on; none: its first pick
    std::optional<Vec3> normal;        ///< known without the law
    bool whatever = false;             ///< also what the law would not show so, as near as it comes
  };
  struct Draws {
    std::vector<Candidate> candidates;
    std::optional<geometry::PolygonError> too_small;  ///< where one was no polygon at these coordinates
  };
  struct Placed {
    double weight;
    Vec3 centre;
  };

  [[nodiscard]] Seen seen_of(const MappedJoint& joint) const;
  [[nodiscard]] std::optional<HonouredJoint> drawn_for(const Seen& seen, std::size_t number, Rng& rng,
                                                       Draws& draws) const;
  void add(const Law& law, const Seen& seen, Rng& rng, Draws& draws) const;
  /// The drawn frame turned so that it holds what was seen, and how likely it would be seen so; none: it is not.
  [[nodiscard]] std::optional<std::pair<detail::Frame, double>> turned(const Law& law, const Seen& seen,
                                                                       Rng& rng) const;
  [[nodiscard]] std::optional<Placed> laid_on_trace(const JointOutline& outline, std::span<const Vec2> corners,
                                                    const Seen& seen, Rng& rng) const;
  [[nodiscard]] double misfit(const MappedJoint& joint, const detail::SolidJoint& candidate) const;
  [[nodiscard]] double misfit_on(std::size_t face, const MappedJoint& joint, const detail::SolidJoint& candidate) const;

  const Mapping& mapping_;
  std::uint64_t seed_, realization_;
  double error_;
  std::vector<Law> laws_;
  std::vector<detail::Face> faces_;
};

Honourer::Honourer(std::span<const JointSet* const> sets, const Mapping& mapping, std::uint64_t seed,
                   std::uint64_t realization)
    : mapping_{mapping}, seed_{seed}, realization_{realization}, error_{mapping.error.si()} {
  for (std::size_t set = 0; set < sets.size(); ++set) {
    if (sets[set] == nullptr) continue;
    const JointSet& joints = *sets[set];
    CLEAVE_ASSERT(!cannot_honour(joints));
    const detail::SizeDrawer size{joints.spec().shape};
    laws_.push_back({set, &joints, size, detail::mean_frame(joints.spec().orientation),
                     detail::unit_corners(size.sides()), joints.expected_p32(1) / joints.mean_area()});
  }
  for (const MappedFace& face : mapping.faces) faces_.push_back(detail::face_of(face));
}

std::optional<std::pair<detail::Frame, double>> Honourer::turned(const Law& law, const Seen& seen, Rng& rng) const {
  const double u = rng.uniform(), v = rng.uniform();
  const bool law_decides = !seen.normal || !seen.joint.set;  // among several sets the law says which
  detail::Frame frame = law.mean;
  if (law_decides) frame = detail::draw(law.joints->spec().orientation, law.mean, u, v);
  const auto hole_shows = [&](const MappedPick& pick) {
    const MappedHole& hole = mapping_.holes[pick.hole];
    return std::abs(dot(frame.normal, geometry::normalized(hole.to - hole.from)));
  };
  if (seen.normal) {
    if (law_decides) {
      const double apart = norm(cross(frame.normal, *seen.normal));
      if (!seen.whatever && !(apart <= std::sin(2 * mapping_.turn.radians()))) return std::nullopt;
    }
    return std::pair{detail::frame_of_normal(*seen.normal, frame.strike), 1.0};
  }
  if (!seen.trace) return std::pair{frame, seen.whatever ? 1.0 : hole_shows(seen.joint.picks.front())};
  // A face shows joints as the sine of the angle between them; their traces lie along face x joint.
  const Vec3 line = cross(faces_[seen.trace->face].frame.normal, frame.normal);
  const double sine = norm(line);
  const Vec3 along = geometry::normalized(seen.trace->ends[1] - seen.trace->ends[0]);
  const bool shows = sine > 1e-9 && norm(cross(line, along)) <= sine * std::sin(mapping_.turn.radians());
  if (!shows && !seen.whatever) return std::nullopt;
  Vec3 across = frame.normal - dot(frame.normal, along) * along;
  if (!(norm(across) > 1e-9)) across = detail::flat_frame({}, along).x;  // the trace is square to the joint: any turn
  return std::pair{detail::frame_of_normal(geometry::normalized(across), frame.strike), shows ? sine : 1.0};
}

/// Of all places that show the trace, those of a Poisson process are even: over the offset from the centre where both
/// ends are seen, over offset and ends that are not seen elsewhere.
std::optional<Honourer::Placed> Honourer::laid_on_trace(const JointOutline& outline, std::span<const Vec2> corners,
                                                        const Seen& joint, Rng& rng) const {
  const MappedTrace& trace = *joint.trace;
  const double seen = detail::length(trace);
  const Vec3 along = geometry::normalized(trace.ends[1] - trace.ends[0]);
  const Vec3 left = cross(cross(outline.along, outline.across), along);
  const Vec2 line{dot(along, outline.along), dot(along, outline.across)};
  Chords chords{corners, line / norm(line)};
  const bool ends = !trace.goes_on[0] && !trace.goes_on[1];
  const double least = ends ? seen - error_ : seen;
  double weight = chords.offsets(least, ends ? seen + error_ : no_limit);
  if (!(weight > 0) && !joint.whatever) return std::nullopt;
  const Chords::Chord chord = weight > 0 ? chords.chord(rng.uniform()) : chords.longest();
  const double spare = chord.length() - seen;
  double start = chord.from;  // of the trace, in the joint
  if (ends) start += spare / 2;
  if (!ends && trace.goes_on[0]) start = chord.to - seen;
  if (trace.goes_on[0] && trace.goes_on[1]) {
    start = chord.from + rng.uniform() * spare;
    weight *= spare;
  }
  if (joint.whatever) weight = std::exp(-std::abs(spare) / error_);
  return Placed{std::max(weight, joint.whatever ? 1e-300 : 0.0), trace.ends[0] - start * along - chord.b * left};
}

/// A point of a polygon that is convex, and its area.
std::pair<Vec2, double> point_in(std::span<const Vec2> corners, Rng& rng) {
  double area = 0;
  const auto part = [&](std::size_t i) { return cross(corners[i] - corners[0], corners[i + 1] - corners[0]) / 2; };
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) area += part(i);
  double left = rng.uniform() * area;
  std::size_t at = 1;
  while (at + 2 < corners.size() && left > part(at)) left -= part(at++);
  double s = rng.uniform(), t = rng.uniform();
  if (s + t > 1) {
    s = 1 - s;
    t = 1 - t;
  }
  return {corners[0] + s * (corners[at] - corners[0]) + t * (corners[at + 1] - corners[0]), area};
}

void Honourer::add(const Law& law, const Seen& seen, Rng& rng, Draws& draws) const {
  const auto posed = turned(law, seen, rng);
  if (!posed) return;
  const auto& [frame, shown] = *posed;
  const double u = rng.uniform(), v = rng.uniform();
  const detail::HalfAxes half = law.size.draw(u, law.size.two_draws() ? v : 0.5);
  const double rotation = detail::draw_rotation(law.joints->spec().rotation, rng);
  static_cast<void>(rng.uniform());  // what the rotation used
  const JointOutline outline = detail::outline_of(frame, rotation, half, law.size.sides());
  std::vector<Vec2> corners;
  corners.reserve(law.unit.size());
  for (const detail::FlatPoint& p : law.unit) corners.push_back({half.first * p.x, half.second * p.y});
  std::optional<Placed> placed;
  if (seen.trace) {
    placed = laid_on_trace(outline, corners, seen, rng);
  } else {
    const auto [point, area] = point_in(corners, rng);
    placed = Placed{area, seen.joint.picks.front().at - point.x * outline.along - point.y * outline.across};
  }
  if (!placed) return;
  if (!detail::surely_valid(outline, placed->centre)) {
    const auto polygon = geometry::Polygon::make(detail::corners_of(outline, placed->centre, law.unit));
    if (!polygon) {
      draws.too_small = polygon.error();
      return;
    }
  }
  const double weight = (seen.whatever ? 1 : law.density) * shown * placed->weight;
  if (!(weight > 0)) return;
  draws.candidates.push_back({-std::log(rng.uniform()) / weight, law.set, outline, placed->centre, frame.normal});
}

/// How far what a candidate shows on a face is from what was seen there.
double Honourer::misfit_on(std::size_t face, const MappedJoint& joint, const detail::SolidJoint& candidate) const {
  const std::vector<MappedTrace> shown = all_traces(candidate, faces_[face], face);
  std::vector<bool> matched(shown.size(), false);
  double worst = 0;
  for (const MappedTrace& trace : joint.traces) {
    if (trace.face != face) continue;
    double best = detail::length(trace);  // where nothing shows it
    std::optional<std::size_t> match;
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const auto& [from, to] = shown[i].ends;
      const double same = std::max(norm(from - trace.ends[0]), norm(to - trace.ends[1]));
      const double turned = std::max(norm(from - trace.ends[1]), norm(to - trace.ends[0]));
      if (const double apart = std::min(same, turned); apart < best) {
        best = apart;
        match = i;
      }
    }
    if (match) matched[*match] = true;
    worst = std::max(worst, best);
  }
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (!matched[i] && detail::length(shown[i]) > mapping_.shortest.si()) {
      worst = std::max(worst, detail::length(shown[i]));
    }
  }
  return worst;
}

double Honourer::misfit(const MappedJoint& joint, const detail::SolidJoint& candidate) const {
  double worst = 0;
  for (std::size_t hole = 0; hole < mapping_.holes.size(); ++hole) {
    const auto pick = std::ranges::find(joint.picks, hole, &MappedPick::hole);
    const auto at = detail::crossing(candidate, mapping_.holes[hole]);
    if (at.has_value() != (pick != joint.picks.end())) return no_limit;
    if (at) worst = std::max(worst, norm(*at - pick->at));
  }
  for (std::size_t face = 0; face < faces_.size(); ++face) {
    worst = std::max(worst, misfit_on(face, joint, candidate));
  }
  return worst;
}

std::expected<HonouredJoint, SampleError> Honourer::draw(std::size_t number) const {
  const MappedJoint& joint = mapping_.joints[number];
  Rng rng{{.seed = seed_,
           .realization = realization_,
           .purpose = stream_purpose(0, Draw::mapped),
           .index = static_cast<std::uint32_t>(number)}};
  Seen seen = seen_of(joint);
  Draws draws;
  auto drawn = drawn_for(seen, number, rng, draws);
  if (drawn) return *std::move(drawn);
  // The law shows no such joint: that it is there is certain.
  seen.whatever = true;
  drawn = drawn_for(seen, number, rng, draws);
  if (!drawn) return std::unexpected(JointTooSmall{number, draws.too_small.value_or(geometry::ZeroArea{})});
  drawn->honours = false;
  return *std::move(drawn);
}

Honourer::Seen Honourer::seen_of(const MappedJoint& joint) const {
  Seen seen{joint, leading_trace(joint), {}};
  if (const auto plane = fitted_plane(joint, mapping_)) {
    seen.normal = plane->normal;
    if (seen.trace) {
      for (Vec3& end : seen.trace->ends) end = end - dot(end - plane->through, plane->normal) * plane->normal;
    }
    return seen;
  }
  for (const MappedTrace& trace : joint.traces) seen.normal = seen.normal ? seen.normal : trace.normal;
  for (const MappedPick& pick : joint.picks) seen.normal = seen.normal ? seen.normal : pick.normal;
  if (seen.normal && seen.trace) {  // turned so that it holds the trace
    const Vec3 along = geometry::normalized(seen.trace->ends[1] - seen.trace->ends[0]);
    const Vec3 across = *seen.normal - dot(*seen.normal, along) * along;
    seen.normal = norm(across) > 1e-9 ? std::optional{geometry::normalized(across)} : std::nullopt;
  }
  return seen;
}

std::optional<HonouredJoint> Honourer::drawn_for(const Seen& seen, std::size_t number, Rng& rng, Draws& draws) const {
  const MappedJoint& joint = seen.joint;
  std::vector<Candidate>& candidates = draws.candidates;
  std::optional<HonouredJoint> nearest;
  std::size_t drawn = 0;
  for (std::size_t wanted = enough_candidates; drawn < most_draws; wanted *= 8) {
    const std::size_t looked_at = candidates.size();
    for (; drawn < most_draws && candidates.size() < wanted; ++drawn) {
      for (const Law& law : laws_) {
        if (!joint.set || law.set == *joint.set) add(law, seen, rng, draws);
      }
    }
    // Those of earlier rounds did not fit.
    const std::span fresh = std::span{candidates}.subspan(looked_at);
    std::ranges::sort(fresh, {}, &Candidate::key);
    for (const Candidate& c : fresh) {
      SampledJoint laid{c.outline, c.centre, c.normal, 0x80000000U + static_cast<std::uint32_t>(number)};
      const double off = misfit(joint, detail::solid_joint(laid));
      if (nearest && !(off < nearest->misfit.si())) continue;
      nearest = HonouredJoint{number, c.set, std::move(laid), metres(off), off <= error_};
      if (nearest->honours) return nearest;
    }
  }
  return nearest;
}

}  // namespace

std::expected<std::vector<HonouredJoint>, SampleError> honour(std::span<const JointSet* const> sets,
                                                              const Mapping& mapping, std::uint64_t seed,
                                                              std::uint64_t realization) {
  const Honourer honourer{sets, mapping, seed, realization};
  std::vector<HonouredJoint> joints;
  joints.reserve(mapping.joints.size());
  for (std::size_t number = 0; number < mapping.joints.size(); ++number) {
    CLEAVE_TRY(HonouredJoint joint, honourer.draw(number));
    joints.push_back(std::move(joint));
  }
  return joints;
}

}  // namespace cleave::dfn
