#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "clash.hpp"
#include "cleave/dbem/world.hpp"
#include "work.hpp"

namespace cleave::dbem {

/// Nearest point of a polygon's boundary.
struct BoundaryPoint {
  std::size_t edge = 0;
  double share = 0;  // along it
  double distance = 0;
};
[[nodiscard]] BoundaryPoint nearest_on(std::span<const Vec2> corners, Vec2 p);

/// Gaps and penetrations below this share of the smaller body's smallest feature count as touching.
constexpr double contact_depth = 1e-9;

/// What does not change about a body.
struct Shape {
  Vec2 local_centroid;        // in the coordinates of Body::outline
  std::vector<Vec2> corners;  // about the centroid, undeformed
  std::vector<std::uint8_t> sharp;
  bool convex = true;
  double mass = 0, inertia = 0;
  double inverse_x = 0, inverse_y = 0, inverse_spin = 0;  // 0 where held
  double radius = 0;                                      // of the farthest corner
  double feature = 0;  // smallest distance of a corner to an edge it does not belong to
  std::size_t modes = 0;
  bool timed = false;      // carries forces of its own
  bool stretches = false;  // as it spins
  bool fixed = false;      // no freedom at all
  struct LoadPlace {       // of a point force on the outline
    std::size_t edge;
    double share;
  };
  std::vector<LoadPlace> load_places;
};

struct State {
  std::vector<Vec2> x;  // centroids, about WorldState::anchor
  std::vector<double> angle;
  std::vector<Vec2> v;
  std::vector<double> spin;
  std::vector<double> e, de;  // modal amplitudes and rates of all bodies
};

struct ContactKey {
  std::uint32_t i, vertex, j, edge;
  friend auto operator<=>(const ContactKey&, const ContactKey&) = default;
};
inline ContactKey key_of(const ContactCandidate& t) { return {t.i, t.vertex, t.j, t.edge}; }

/// What a contact carries from step to step.
struct CachedContact {
  ContactKey key;
  Vec2 force;       // N/m
  Vec2 compliance;  // m2/N, normal and tangential
  Vec2 point, normal;
};

struct Bond {
  double cohesion;        // N/m
  double tension;         // N/m
  double residual;        // N/m, cohesion that is left when it broke by slip
  std::uint32_t section;  // of the joint it lies on
  double at;              // along it, from its middle, m
  bool broken = false;
  bool opened = false;  // nothing is left
};
/// How a bond is lost in a step.
enum class Loss : std::uint8_t { none, by_slip, torn };
/// A closed stretch of a joint between two bodies: bends as one.
struct JointSection {
  double length;   // m
  double tension;  // Pa
};
/// A corner at a body: what bonds are found by.
struct BondKey {
  std::uint32_t body, vertex, other;
  std::uint32_t bond;
  friend auto operator<=>(const BondKey&, const BondKey&) = default;
};

/// A side that fitted another body's rough side at the start.
struct Mated {
  std::uint32_t body, edge, other;
  friend auto operator<=>(const Mated&, const Mated&) = default;
};

/// What a tie carries from step to step.
struct Bar {
  double rest = 0;     // length without force, m
  double force = 0;    // N/m
  double plastic = 0;  // m, in `rest`
  bool installed = false, broken = false, yielding = false;
};

/// A group of bodies joined by contacts.
struct Island {
  std::vector<std::uint32_t> touches;
  std::vector<std::uint32_t> bodies;
  double theta = 0.5;
  bool impact = false;
  double rebound = 1;  // share of the restitution that is asked for
};

/// One side of a contact: body, arm from the place its impulse acts on to the contact point, modal rows.
struct Side {
  std::uint32_t body;
  Vec2 arm;
  double turn_n, turn_t;  // arm x n, arm x t, signed
  Vec2 n, t;              // signed
  std::size_t modal = 0;  // of the n row in Rows::modal, the t row follows
};
struct Rows {
  std::vector<Side> sides;    // two a contact: body of the corner, body of the edge
  std::vector<double> modal;  // unscaled
};

/// Two bodies that share space.
struct Clash {
  BodyPair pair;
  double depth;    // m
  double allowed;  // by the tolerance and by springs in their joints, m
};

/// A trial step.
struct Attempt {
  State state;
  std::vector<Vec2> corners;
  std::vector<Box2> boxes;
  std::vector<ContactCandidate> touches;  // at the end of the step
  std::vector<CornerChoice> choices;
  std::vector<CachedContact> memory;
  std::vector<Contact> contacts;
  std::vector<std::uint32_t> broken, closed;  // bonds that break; broken ones whose contact stays closed
  std::vector<Bar> bars;
  double friction = 0, work = 0, projected = 0, yielded = 0;
  std::vector<Island> islands;
  StepReport report;
  double limit = std::numeric_limits<double>::infinity();  // of the next step, by gaps
};

}  // namespace cleave::dbem
