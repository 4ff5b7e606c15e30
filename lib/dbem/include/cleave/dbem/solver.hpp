#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "cleave/dbem/body.hpp"

/// Solvers of the contact law on the condensed form y = b + W p.
namespace cleave::dbem {

/// A symmetric matrix of 2x2 blocks by rows; row and column r of a block belong to contact r, (normal, tangential).
struct BlockMatrix {
  std::vector<std::size_t> starts;  ///< of the rows, one more than rows
  std::vector<std::uint32_t> columns;
  std::vector<bem::Mat2> values;
  std::vector<std::size_t> diagonal;  ///< index of each diagonal block
  [[nodiscard]] std::size_t rows() const noexcept { return diagonal.size(); }
  /// y += W x.
  void add_product(const std::vector<Vec2>& x, std::vector<Vec2>& y) const;
};

/// Where W comes from when all bodies are rigid: W = J M^-1 J^T + a diagonal. Large groups are then factorised in the
/// freedoms of the bodies, of which there are fewer than contact forces.
struct RigidForm {
  static constexpr std::uint32_t ground = static_cast<std::uint32_t>(-1);
  struct Side {
    std::uint32_t body = ground;     ///< index into inverse_mass
    std::array<double, 3> n{}, t{};  ///< rows of J on (x, y, turn) of the body
  };
  std::vector<std::array<Side, 2>> sides;           ///< two a contact
  std::vector<std::array<double, 3>> inverse_mass;  ///< of each body; 0 where held
};

/// Coulomb contact at velocity level. Unknown impulses p = (n, t) per contact, y = b + W p = (g, s):
///   0 <= n + tau  _|_  g >= 0,   |t| <= max(0, mu n + c),   s = 0 inside the bound, else opposite to t.
struct ContactProblem {
  BlockMatrix w;        ///< compliances and regularisation included
  std::vector<Vec2> b;  ///< m/s
  std::vector<double> mu;
  std::vector<double> cohesion;  ///< N s/m
  std::vector<double> tension;   ///< N s/m
  std::vector<Vec2> start;       ///< warm start; empty: cold
  /// Part of the diagonal that only regularises, about `start`; empty: none. Forces that meet the law without it are an
  /// answer too: it never moves what forces of redundant contacts the bodies do not feel.
  std::vector<Vec2> yielding = {};
  std::optional<RigidForm> rigid = {};
  [[nodiscard]] std::size_t contacts() const noexcept { return b.size(); }
};

enum class Method : std::uint8_t {
  none,          ///< nothing touched
  open_close,    ///< Shi's iteration over contact states: the reference
  newton,        ///< semi-smooth, on the natural map
  continuation,  ///< Newton along a falling compliance
  lemke,         ///< complementary pivoting, at most 100 contacts
  interior,      ///< interior points on convex programmes, with Newton from there
  cascade,       ///< all of them, cheapest first: the default
};
/// Empty for what is no method. No default: the compiler asks for the name of a new one.
[[nodiscard]] constexpr std::string_view name_of(Method method) noexcept {
  switch (method) {
    case Method::none: return "none needed";
    case Method::open_close: return "open_close";
    case Method::newton: return "newton";
    case Method::continuation: return "continuation";
    case Method::lemke: return "lemke";
    case Method::interior: return "interior_points";
    case Method::cascade: return "cascade";
  }
  return "";
}
inline constexpr std::size_t method_count = static_cast<std::size_t>(Method::cascade) + 1;
static_assert(name_of(static_cast<Method>(method_count)).empty(), "a method behind the last: counts would lack it");
/// One number a method, in the order of `Method`.
template <class Number>
using PerMethod = std::array<Number, method_count>;

struct SolverOptions {
  Method method = Method::cascade;
  double accept = 1e-8;   ///< residual above which an answer is never called converged
  double target = 1e-13;  ///< residual at which an iteration stops; it also stops where rounding lets it get no lower
  std::size_t newton_iterations = 60;
  std::size_t open_close_passes = 6;
  std::size_t path = 6000;  ///< factors that paths may take where all else failed, rigid bodies only
  /// Linear solves after which the cascade tries nothing more; empty: there is no such number.
  std::optional<std::size_t> max_linear_solves = {};
};

/// What a solver says of its answer; `residual` is that of the natural map at the answer, recomputed whatever found it.
struct ContactReport {
  enum class Status : std::uint8_t {
    converged,
    open,           ///< no contact carries anything
    not_converged,  ///< the best answer found; never to be used as if it were right
  };
  Status status = Status::open;
  /// The larger of: in impulses, over max(|p|, max |b / diag W|); in velocities, over max |b|
  /// (or 10^-6 of the largest W p, where rounding begins).
  double residual = 0;
  double missed_speed = 0;  ///< largest velocity by which a contact misses the law, m/s
  Method method = Method::none;
  std::size_t iterations = 0;  ///< linear solves or pivots, of all tries
  std::size_t stick = 0, slip = 0, opened = 0;
  double max_penetration = 0;  ///< largest -g, m/s
};

struct ContactSolution {
  std::vector<Vec2> impulse;
  ContactReport report;
};

[[nodiscard]] ContactSolution solve(const ContactProblem& problem, const SolverOptions& options = {});

/// Residual of the natural map (Alart and Curnier 1991) of any impulses, scaled as in ContactReport.
[[nodiscard]] double natural_residual(const ContactProblem& problem, const std::vector<Vec2>& impulse);

}  // namespace cleave::dbem
