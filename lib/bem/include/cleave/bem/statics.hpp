#pragma once

#include <array>
#include <cstddef>
#include <expected>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "cleave/bem/problem.hpp"

namespace cleave::bem {

/// Regions, loops, sides and forces count from 0.
struct BadOutline {
  std::size_t region;
  OutlineError why;
};
struct UnknownCondition {
  std::size_t region, loop, side;
};
/// The supports leave these rigid motions free ("translation along (0, 1)", "rotation about (2, 3)").
struct FreeMotions {
  std::vector<std::string> motions;
  bool finer_holds = false;  ///< constant elements are held in their middles: more of them leave nothing free
};
struct UnbondedSide {
  std::size_t region, loop, side;
};
/// Two sides give different displacements to the corner they share.
struct TornCorner {
  std::size_t region;
  Vec2 at;
  double gap;  ///< m
};
struct ForceOffBoundary {
  std::size_t force;
  double distance;  ///< m from the nearest side
};
struct ForceOnSupport {
  std::size_t force;
};
struct NotInBalance {
  Vec2 missing;  ///< N/m3 of body force that the in-situ stress does not carry
};
struct AboveSurface {
  std::size_t region, loop;
};
struct NoRegion {};
/// A number of the problem or of the options that has no meaning.
struct BadNumber {
  std::string what;
  double value;
};
struct TooManyUnknowns {
  std::size_t unknowns;
  double needed_mb;
};
struct SingularSystem {
  double condition;
};
using SolveError =
    std::variant<BadOutline, UnknownCondition, FreeMotions, UnbondedSide, TornCorner, ForceOffBoundary, ForceOnSupport,
                 NotInBalance, AboveSurface, NoRegion, BadNumber, TooManyUnknowns, SingularSystem>;
[[nodiscard]] std::string describe(const SolveError& error);

/// Rigid motions, as in FreeMotions, that the supports of a region which stands alone leave free on any mesh; a mesh
/// may leave more. Precondition: its loops have passed check_loops.
[[nodiscard]] std::vector<std::string> unheld_motions(const Region& region);

/// Flamant's field of a force on the straight edge of a half plane (Timoshenko and Goodier 1951, section 36), by
/// Muskhelishvili's potentials phi = -F ln z / 2 pi, psi = conj(F) ln z / 2 pi. The edge's outward normal says where
/// the angle's cut runs: outside the body.
struct PointField {
  Vec2 at, normal, force;
  double cut = 0;  ///< closer than this the displacement is that at this distance: it is infinite at the point itself
};

/// Displacement and stress that carry the body loads, without looking at the boundary (in the scaled frame).
struct Particular {
  double mu = 1, nu = 0.25;
  Vec2 body;                    ///< constant body force
  double spin = 0;              ///< rho omega^2
  double twist = 0;             ///< rho alpha
  Sym2 initial, initial_slope;  ///< stress before loading, linear in y
  std::vector<PointField> points = {};

  [[nodiscard]] Vec2 displacement(Vec2 x) const noexcept;
  [[nodiscard]] Sym2 stress(Vec2 x) const noexcept;  ///< with the initial stress
  [[nodiscard]] Sym2 initial_at(Vec2 x) const noexcept { return initial + x.y * initial_slope; }
};

struct BoundaryPoint {
  Vec2 x;  ///< m
  Vec2 normal;
  Vec2 displacement;  ///< m
  Vec2 traction;      ///< Pa
  Sym2 stress;        ///< Pa
};

/// How good a solution is.
struct Diagnostics {
  std::size_t elements = 0;
  std::size_t unknowns = 0;
  double condition = 0;  ///< estimate in the 1-norm
  double residual = 0;   ///< |Ax - b| / (|A||x| + |b|), largest row
  double imbalance =
      0;              ///< |sum of all forces| / sum of their magnitudes: discretisation, collocation does not conserve
  double energy = 0;  ///< half the work of boundary tractions and displacements, J/m (without body loads)
};

/// One mesh of a series.
struct MeshError {
  std::size_t elements = 0;
  double seconds = 0;  ///< processor time of all threads since the start of the series
  double error = 0;    ///< as of Refined
};

class InsideRules;

/// The solution of a static problem: values on the boundary, and by quadrature everywhere.
class Solution final {
 public:
  struct RegionPart {
    Material material;
    std::vector<Loop> loops;
    Mesh mesh;  ///< in the scaled frame
    Particular particular;
    std::vector<Vec2> displacement;             ///< nodes, m
    std::vector<std::array<Vec2, 3>> traction;  ///< elements, Pa
    std::vector<Vec2> u_part;                   ///< scaled, without the particular solution
    std::vector<std::array<Vec2, 3>> t_part;
  };

  [[nodiscard]] const Diagnostics& diagnostics() const noexcept { return diagnostics_; }
  [[nodiscard]] const std::vector<RegionPart>& regions() const noexcept { return regions_; }
  /// The region that holds the point; empty when none does.
  [[nodiscard]] std::optional<std::size_t> region_at(Vec2 x) const;
  /// Node position in m.
  [[nodiscard]] Vec2 node(std::size_t region, std::size_t node) const;
  [[nodiscard]] BoundaryPoint boundary(std::size_t region, std::size_t element, double s) const;
  /// Inside or on the boundary of a region; empty outside of it, in an opening and above the surface. Closer to the
  /// boundary than an element the linear field of the nearest boundary point is taken out first, which keeps the error
  /// bounded up to the boundary.
  [[nodiscard]] std::optional<Vec2> displacement(std::size_t region, Vec2 x) const;
  [[nodiscard]] std::optional<Sym2> stress(std::size_t region, Vec2 x) const;
  /// Largest nodal displacement, m.
  [[nodiscard]] double largest_displacement() const noexcept;
  [[nodiscard]] Extent extent() const noexcept { return extent_; }

 private:
  friend struct SolutionMaker;
  [[nodiscard]] bool within(std::size_t region, Vec2 x) const;
  std::vector<RegionPart> regions_;
  std::vector<std::shared_ptr<const InsideRules>> inside_;  // by region
  Diagnostics diagnostics_;
  Extent extent_ = Extent::bounded;
  std::optional<double> surface_;  // scaled
  Vec2 origin_;
  double scale_ = 1;
  double mu_ = 1;
};

/// Direct collocation (Rizzo 1967), dense LU. O(n^2) memory and O(n^3) time in the boundary unknowns.
[[nodiscard]] std::expected<Solution, SolveError> solve(const Problem& problem, const Options& options);

/// A solution with an estimate of its error from meshes of n and 2n elements.
struct Refined {
  Solution solution;
  /// Relative, of displacement: difference to the mesh before over the largest displacement. Infinite where all that
  /// moves lies within three elements of a point force: no mesh settles there, and none counts as good.
  double error = 0;
  std::size_t meshes = 0;
  bool reached = false;
  std::vector<MeshError> series = {};  ///< from the second mesh on
};
/// Doubles all element counts until the displacements at the nodes of the first mesh change by less than `tolerance`
/// (relative), at most `most_meshes` times.
[[nodiscard]] std::expected<Refined, SolveError> solve_to(const Problem& problem, Options options, double tolerance,
                                                          std::size_t most_meshes = 6);

}  // namespace cleave::bem
