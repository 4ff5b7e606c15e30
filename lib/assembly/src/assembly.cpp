#include "cleave/assembly/assembly.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <tuple>
#include <utility>

#include "parts.hpp"

namespace cleave::assembly {
namespace {

using geometry::Vec3;

std::optional<std::string> problem_of(const Body& body) {
  if (!is_finite(body.centroid)) return "its centroid is not finite";
  if (!is_finite(body.force) || !is_finite(body.moment)) return "its load is not finite";
  if (!(body.mass > 0) || !std::isfinite(body.mass)) return "its mass is not positive";
  const auto& [xx, yy, zz, xy, yz, zx] = body.inertia;
  const double second = xx * yy - xy * xy;
  const double third = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx);
  if (!(xx > 0 && second > 0 && third > 0 && std::isfinite(third))) return "its inertia is not positive definite";
  return {};
}

bool at_least_zero(double value) { return value >= 0 && std::isfinite(value); }

std::optional<std::string> problem_of(const Contact& contact, std::size_t bodies) {
  if (contact.body >= bodies || (contact.other && *contact.other >= bodies)) return "it names a body that is not there";
  if (contact.other == contact.body) return "it holds a body against itself";
  if (!(std::abs(norm(contact.normal) - 1) <= 1e-9)) return "its normal is no unit vector";
  if (contact.is_tie() && contact.bonds.empty()) return "it has no point";
  if (!std::ranges::all_of(contact.points, geometry::is_finite)) return "a point is not finite";
  if (!at_least_zero(contact.friction)) return "its friction is not zero or more";
  if (!(contact.most > 0)) return "what the rock beside it carries is not positive";
  for (const Bond& bond : contact.bonds) {
    if (!std::ranges::all_of(bond.corners, geometry::is_finite)) return "a corner of a bond is not finite";
    if (!at_least_zero(bond.cohesion) || !at_least_zero(bond.tension))
      return "the strength of a bond is not zero or more";
    if (contact.is_tie() && bond.cohesion > 0) return "a tie has cohesion, and nothing presses on it";
  }
  return {};
}

}  // namespace

std::string describe(const BadAssembly& error) { return error.which + ": " + error.what; }

std::expected<Assembly, BadAssembly> Assembly::make(AssemblySpec spec) {
  for (std::size_t b = 0; b < spec.bodies.size(); ++b) {
    if (auto problem = problem_of(spec.bodies[b])) {
      return std::unexpected(BadAssembly{"body " + std::to_string(b), std::move(*problem)});
    }
  }
  for (std::size_t c = 0; c < spec.contacts.size(); ++c) {
    if (auto problem = problem_of(spec.contacts[c], spec.bodies.size())) {
      return std::unexpected(BadAssembly{"contact " + std::to_string(c), std::move(*problem)});
    }
  }
  return Assembly{std::move(spec)};
}

Assembly::Assembly(AssemblySpec spec) : spec_{std::move(spec)} {
  std::vector<double> arm(spec_.bodies.size(), 0);
  const auto reach = [&](std::uint32_t b, Vec3 p) { arm[b] = std::max(arm[b], norm(p - spec_.bodies[b].centroid)); };
  for (const Contact& contact : spec_.contacts) {
    for (const Vec3 p : contact.points) {
      reach(contact.body, p);
      if (contact.other) reach(*contact.other, p);
    }
  }
  for (std::size_t b = 0; b < spec_.bodies.size(); ++b) {
    load_ = std::max(load_, norm(spec_.bodies[b].force));
    if (turns(spec_.freedom) && arm[b] > 0) load_ = std::max(load_, norm(spec_.bodies[b].moment) / arm[b]);
  }
}

Assembly Assembly::part(std::span<const std::uint32_t> members, Others others) const {
  constexpr auto outside = static_cast<std::uint32_t>(-1);
  AssemblySpec spec{.freedom = spec_.freedom};
  std::vector<std::uint32_t> number(spec_.bodies.size(), outside);
  for (const std::uint32_t b : members) {
    number[b] = static_cast<std::uint32_t>(spec.bodies.size());
    spec.bodies.push_back(spec_.bodies[b]);
  }
  for (const Contact& contact : spec_.contacts) {
    const bool first = number[contact.body] != outside;
    const bool second = contact.other && number[*contact.other] != outside;
    if (!first && !second) continue;
    if (others == Others::gone && (!first || (contact.other && !second))) continue;
    Contact own = contact;
    if (!first) {
      own.body = number[*contact.other];
      own.other.reset();
      own.normal = -contact.normal;
    } else {
      own.body = number[contact.body];
      own.other = second ? std::optional{number[*contact.other]} : std::nullopt;
    }
    spec.contacts.push_back(std::move(own));
  }
  return Assembly{std::move(spec)};
}

Assembly Assembly::with(Freedom freedom) const {
  AssemblySpec spec = spec_;
  spec.freedom = freedom;
  return Assembly{std::move(spec)};
}

namespace {

Vec3 middle(std::span<const Vec3> points) {
  Vec3 sum;
  for (const Vec3 p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

/// Numbers of about `size` to ten digits: what depends on the order of sums falls away. Multiples of a power of two.
class Digits final {
 public:
  explicit Digits(double size) : unit_{size > 0 && std::isfinite(size) ? std::ldexp(1.0, std::ilogb(size) - 33) : 0} {}
  void round(double& x) const {
    if (unit_ > 0) x = unit_ * std::round(x / unit_);
  }
  void round(Vec3& v) const {
    for (double* x : {&v.x, &v.y, &v.z}) round(*x);
  }

 private:
  double unit_;
};

void round_number(double& x) {
  if (std::isfinite(x)) Digits{std::abs(x)}.round(x);
}

void round_body(Body& body, const Digits& places, double extent) {
  const double load = std::max(norm(body.force), norm(body.moment) / extent);
  places.round(body.centroid);
  Digits{load}.round(body.force);
  Digits{load * extent}.round(body.moment);
  round_number(body.mass);
  const std::array<double, 6> as_given = body.inertia;
  const Digits inertia{as_given[0] + as_given[1] + as_given[2]};
  for (double& i : body.inertia) inertia.round(i);
  // Of next to no inertia about an axis ten digits may leave none.
  if (problem_of(body)) body.inertia = as_given;
}

void round_contact(Contact& contact, const Digits& places) {
  for (Vec3& p : contact.points) places.round(p);
  round_number(contact.friction);
  round_number(contact.most);
  for (Bond& bond : contact.bonds) {
    for (Vec3& p : bond.corners) places.round(p);
    round_number(bond.cohesion);
    round_number(bond.tension);
  }
}

/// Seen from the heavier body; points round from the one farthest from it, by its farther neighbour. Of equals, as they
/// are where blocks are alike, places decide.
void put_in_order(Contact& contact, const std::vector<Body>& bodies, const Digits& places) {
  const auto weight = [&](std::uint32_t b) { return std::pair{bodies[b].mass, along_generic(bodies[b].centroid)}; };
  if (contact.other && weight(contact.body) < weight(*contact.other)) {
    std::swap(contact.body, *contact.other);
    contact.normal = -contact.normal;
  }
  std::vector<Vec3>& points = contact.points;
  const auto reach = [&](Vec3 p) {
    double far = norm(p - bodies[contact.body].centroid);
    places.round(far);
    return std::pair{far, along_generic(p)};
  };
  std::ranges::rotate(points, std::ranges::max_element(points, {}, reach));
  if (points.size() > 2 && reach(points[1]) < reach(points.back()))
    std::ranges::reverse(points.begin() + 1, points.end());
  std::ranges::stable_sort(contact.bonds, std::ranges::greater{}, [](const Bond& b) {
    return std::tuple{b.cohesion, b.tension, along_generic(middle(b.corners))};
  });
}

/// What says which contact comes first: the largest and those of the heaviest bodies. None of it hangs on axes, but of
/// equals, where places decide.
using Rank = std::array<double, 5>;
Rank rank_of(const Contact& contact, const std::vector<Body>& bodies) {
  const Vec3 at = contact.is_tie() ? middle(contact.bonds.front().corners) : middle(contact.points);
  return {contact.most, bodies[contact.body].mass, contact.other ? bodies[*contact.other].mass : 0, along_generic(at),
          along_generic(contact.normal)};
}

}  // namespace

Assembly Assembly::canonical() const {
  struct Placed {
    Rank rank;
    Contact contact;
  };
  geometry::Box box;
  for (const Body& body : spec_.bodies) box.add(body.centroid);
  for (const Contact& contact : spec_.contacts) box.grow(geometry::box_of(contact.points));
  const double extent = spec_.bodies.empty() ? 1 : norm(box.size());
  const Digits places{extent};
  AssemblySpec spec{.freedom = spec_.freedom, .bodies = spec_.bodies};
  for (Body& body : spec.bodies) round_body(body, places, extent > 0 ? extent : 1);
  std::vector<Placed> placed;
  for (const Contact& contact : spec_.contacts) {
    Contact& own = placed.emplace_back(Placed{{}, contact}).contact;
    round_contact(own, places);
    put_in_order(own, spec.bodies, places);
    placed.back().rank = rank_of(own, spec.bodies);
  }
  std::ranges::stable_sort(placed, std::ranges::greater{}, &Placed::rank);
  for (Placed& p : placed) spec.contacts.push_back(std::move(p.contact));
  return Assembly{std::move(spec)};
}

std::vector<std::vector<std::uint32_t>> connected_parts(const Assembly& assembly, std::span<const std::uint8_t> among) {
  return linked_parts(assembly.contacts(), among);
}

}  // namespace cleave::assembly
