#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cleave/geometry/vec3.hpp"

namespace cleave::assembly {

/// Which motions of a block are looked at. Sections lie in the plane of x and z and turn about y.
enum class Freedom : std::uint8_t {
  translation,          ///< three rows a block
  rigid,                ///< six: with moments
  section_translation,  ///< x and z
  section,              ///< x, z and turning about y
};
[[nodiscard]] constexpr bool turns(Freedom freedom) noexcept {
  return freedom == Freedom::rigid || freedom == Freedom::section;
}
[[nodiscard]] constexpr bool flat(Freedom freedom) noexcept {
  return freedom == Freedom::section_translation || freedom == Freedom::section;
}

/// A block that may move, and all forces on it but those of its contacts.
struct Body {
  geometry::Vec3 centroid;  ///< m
  geometry::Vec3 force;     ///< N
  geometry::Vec3 moment;    ///< N m about the centroid
  double mass = 1;          ///< kg, > 0
  /// kg m2 about the centroid: xx, yy, zz, xy, yz, zx. Used where blocks turn.
  std::array<double, 6> inertia = {1, 1, 1, 0, 0, 0};
};

/// A triangle of a patch that cohesion (spread evenly) and tension act on, as far as strength goes.
struct Bond {
  std::array<geometry::Vec3, 3> corners;  ///< m
  double cohesion = 0;                    ///< N
  double tension = 0;                     ///< N
};

/// A plane patch between two blocks, or between a block and rock that never moves. Friction acts at the points: the
/// corners of the patch's convex hull, which no pressure on the patch can leave. One point does where nothing turns.
/// Without points it is a tie, as a bolt is: nothing presses, and its bonds pull `body` against `normal` when it opens.
struct Contact {
  [[nodiscard]] bool is_tie() const noexcept { return points.empty(); }
  std::uint32_t body = 0;
  std::optional<std::uint32_t> other = {};  ///< none: fixed rock
  geometry::Vec3 normal;                    ///< unit, into `body`
  std::vector<geometry::Vec3> points;       ///< m
  double friction = 0;                      ///< tangent of the angle
  std::vector<Bond> bonds = {};
  /// N: what the intact rock beside the patch can carry at one point.
  double most = std::numeric_limits<double>::infinity();
};

struct AssemblySpec {
  Freedom freedom = Freedom::rigid;
  std::vector<Body> bodies = {};
  std::vector<Contact> contacts = {};
};

struct BadAssembly {
  std::string which;  ///< "body 3", "contact 12"
  std::string what;
};
[[nodiscard]] std::string describe(const BadAssembly& error);

/// Blocks, what touches what, and what acts. Invariant: all numbers finite; masses and inertias positive definite;
/// normals unit; contacts of different blocks that are there, with a point or a bond at least, ties without cohesion;
/// strengths >= 0.
class Assembly final {
 public:
  [[nodiscard]] static std::expected<Assembly, BadAssembly> make(AssemblySpec spec);
  [[nodiscard]] Freedom freedom() const noexcept { return spec_.freedom; }
  [[nodiscard]] const std::vector<Body>& bodies() const noexcept { return spec_.bodies; }
  [[nodiscard]] const std::vector<Contact>& contacts() const noexcept { return spec_.contacts; }
  /// Largest force, or moment over an arm of the block's contacts, on one block; N.
  [[nodiscard]] double load() const noexcept { return load_; }

  /// The bodies named (ascending), their contacts among each other and with fixed rock; what the others are to be:
  /// fixed or gone.
  enum class Others : std::uint8_t { fixed, gone };
  [[nodiscard]] Assembly part(std::span<const std::uint32_t> members, Others others) const;
  /// The same blocks with other freedoms.
  [[nodiscard]] Assembly with(Freedom freedom) const;
  /// The same to ten digits, with contacts, their sides, points and bonds in an order that sizes decide, and places of
  /// what is alike; bodies keep their numbers. Where Coulomb's law has several solutions the order of contacts, and
  /// roundings, decide which of them a search comes by: not how blocks are numbered.
  [[nodiscard]] Assembly canonical() const;

 private:
  explicit Assembly(AssemblySpec spec);
  AssemblySpec spec_;
  double load_ = 0;
};

/// Rate of motion of one block: m/s2 and 1/s2 of an acceleration, or any common multiple of both.
struct Rate {
  geometry::Vec3 velocity;
  geometry::Vec3 spin;
};
/// One a body.
using Motion = std::vector<Rate>;

/// Bodies that hang together by contacts, each part ascending, parts by their first member. `among`: only bodies marked
/// with 1 count.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> connected_parts(const Assembly& assembly,
                                                                      std::span<const std::uint8_t> among);

}  // namespace cleave::assembly
