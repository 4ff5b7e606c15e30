#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cleave/bem/motion.hpp"
#include "cleave/bem/problem.hpp"
#include "cleave/core/cost.hpp"
#include "cleave/core/progress.hpp"
#include "cleave/core/quantity.hpp"
#include "cleave/scene/output.hpp"
#include "cleave/scene/plan.hpp"
#include "cleave/scene/problem.hpp"
#include "cleave/scene/time_course.hpp"

/// Scenes of plane elastic bodies: [[body]] instead of [domain]. x to the right, y up, metres; forces per metre of
/// thickness.
namespace cleave::scene {

struct KeyTable;

struct BodyLoadSpec {
  std::vector<std::size_t> sides;  ///< of all loops, counted on; empty: a point force
  bem::Vec2 at, force;             ///< point force, N/m
  double pressure = 0;             ///< Pa
  bem::Vec2 traction;              ///< Pa
  TimeFunction time;
  bool timed = false;
  bool follows = false;
};

struct BodySpec {
  std::string name;
  std::uint32_t line = 1;
  bem::Region region;  ///< one condition a side; loads of static scenes are in them
  bem::Extent extent = bem::Extent::bounded;
  double surface = 0;
  bem::InSitu in_situ = {};
  bool stressed = false;
  std::vector<BodyLoadSpec> loads = {};
  std::vector<bem::Vec2> pins = {};
  bem::Vec2 velocity = {};
  double spin = 0;
  bool bonded = false;
  bool held = false;  ///< has supports other than pins
};

struct PointSpec {
  std::string name;
  bem::Vec2 at;
  std::size_t body = 0;
  bool stress = false;  ///< its history is asked for
};

struct TimeSettings {
  double end = 0;   ///< s
  double step = 0;  ///< s
  bem::Scheme scheme;
  bem::Damping damping;
  std::size_t frames = 60;                ///< pictures kept
  std::optional<std::size_t> modes = {};  ///< of free bodies; empty: as many as the mesh has
  std::optional<double> rebuild = 0.02;   ///< change of the boundary's tangent at which operators are rebuilt
  bool estimate = true;                   ///< of the error, by a run half as fine
};

struct BodiesScene : SceneHead {
  std::vector<BodySpec> bodies;
  std::vector<PointSpec> points;
  bem::Vec2 gravity;
  bem::Options options;
  std::optional<double> tolerance;
  bool stress = false;          ///< contours of stress inside
  std::size_t frequencies = 0;  ///< natural ones that are asked for, of every body
  std::optional<TimeSettings> time;
};

[[nodiscard]] std::expected<BodiesScene, std::vector<Problem>> parse_bodies(std::string_view text,
                                                                            const std::string& shown);

[[nodiscard]] const KeyTable& elastic_scene_keys();
[[nodiscard]] Plan make_plan(const BodiesScene& scene);

/// One cell of a picture of stress.
struct StressCell {
  bem::Vec2 centre;
  double size = 0;
  bem::Vec2 displacement;
  bem::Sym2 stress;
  double out_of_plane = 0;
};

struct BodyResult {
  std::string name;
  bem::Vec2 centroid;   ///< at the end
  double rotation = 0;  ///< radians, at the end
  /// Points along each loop (the last is the first again), and where they are in each frame.
  std::vector<std::vector<bem::Vec2>> outline;
  std::vector<std::vector<std::vector<bem::Vec2>>> frames;
  std::vector<std::vector<bem::Sym2>> boundary_stress;     ///< static: along `outline`
  std::vector<std::vector<Stress>> boundary_out_of_plane;  ///< of those
  /// Moving, where stress is asked for: on the boundary in each frame, in the world's axes; and von Mises (Pa).
  std::vector<std::vector<std::vector<bem::Sym2>>> stress_frames;
  std::vector<std::vector<std::vector<double>>> mises_frames;
  std::vector<StressCell> cells;
  std::size_t elements = 0, unknowns = 0;
  double condition = 0, residual = 0, imbalance = 0, largest = 0;
  /// Estimate, relative, from runs with half and a quarter of the elements (moving: and modes, and two and four times
  /// the step). Empty: there is none, and why.
  std::optional<double> error;
  std::string no_estimate;
  std::vector<double> modes_hz;   ///< lowest natural frequencies, as supported; free bodies: without rigid motions
  std::size_t rebuilds = 0;       ///< moving
  double strain_since_build = 0;  ///< moving: largest change of the boundary's tangent since an operator was built
  std::string method;
};

struct PointResult {
  std::string name;
  bem::Vec2 at;
  std::vector<bem::Vec2> displacement;  ///< a frame
  std::vector<bem::Sym2> stress;        ///< a frame, where asked for, in the world's axes, Pa
};

/// Cost against error of the meshes tried (static scenes with a tolerance, or the picture of the report).
struct MeshTrial {
  std::string body;
  std::size_t elements = 0;
  double seconds = 0;
  double error = 0;
};

/// What the results of both two-dimensional scenes begin with.
struct Scene2dResult : ResultHead {
  bool converged = true;
  std::string stopped_why = {};
  std::uint64_t steps = 0;
  double residual = 0, largest_displacement = 0;
};
template <class V>
void status_fields(V& v, const Scene2dResult& x) {
  v("status", one_of(x.converged ? "converged" : "stopped", {"converged", "stopped"}));
  v("reason", when(!x.converged, x.stopped_why), "why it stopped");
}

struct BodiesResult : Scene2dResult {
  std::vector<BodyResult> bodies;
  std::vector<PointResult> points;
  std::vector<double> times;                  ///< of the frames, s; one zero for a static scene
  std::vector<std::array<double, 3>> energy;  ///< kinetic, elastic, gravity a frame, all bodies
  std::vector<MeshTrial> trials;
};

/// What is said of each body; `steps` of the run.
[[nodiscard]] inline auto body_fields(std::uint64_t steps) {
  return [steps](auto& b, const BodyResult& body) {
    b("name", body.name);
    b("centroid", body.centroid, "at the end, m");
    b("rotation", body.rotation * 180 / std::numbers::pi, "at the end, degrees counter-clockwise, whole turns counted");
    b("method", body.method);
    b("elements", body.elements);
    b("unknowns", body.unknowns);
    b("max_displacement_m", body.largest);
    b("condition", when(body.condition > 0, body.condition),
      "estimate of the system's condition number; static scenes");
    b("imbalance", when(body.condition > 0, body.imbalance),
      "sum of all forces over the sum of their magnitudes; static scenes");
    b("estimated_error", OrNull<double>{body.error},
      "relative, of displacement: from runs with half and a quarter of the elements (moving bodies: and modes, "
      "and two and four times the step); null: there is none, see no_estimate");
    b("no_estimate", when(!body.error, body.no_estimate.empty() ? std::string{"nothing moves"} : body.no_estimate),
      "why there is no estimate");
    b("modes_hz", when_any(body.modes_hz),
      "lowest natural frequencies, as supported; free bodies without rigid motions; none of pinned, bonded and "
      "infinite bodies");
    b("rebuilds", when(steps > 0, body.rebuilds),
      "moving bodies: how often the operator was rebuilt in the deformed shape");
    b("strain_since_build", when(steps > 0, body.strain_since_build),
      "moving bodies: largest change of the boundary's tangent since an operator was built");
  };
}

/// Section `elastic`.
template <class V>
void scene2d_fields(V& v, const BodiesResult& x) {
  v("elastic", group([&](auto& w) {
      status_fields(w, x);
      w("steps", x.steps, "time steps; 0 for a static scene");
      w("residual", x.residual, "of the linear systems, relative");
      w("max_displacement_m", x.largest_displacement);
      w("bodies", each(x.bodies, body_fields(x.steps)));
      w("points", each(x.points, [&](auto& p, const PointResult& point) {
          p("name", point.name);
          p("displacement", point.displacement.empty() ? bem::Vec2{} : point.displacement.back(), "at the end, m");
          const bem::Sym2 s = point.stress.empty() ? bem::Sym2{} : point.stress.back();
          p("stress", when(!point.stress.empty(), std::array{s.xx, s.yy, s.xy}),
            "[xx, yy, xy] at the end, Pa, where asked for");
        }));
    }),
    "Scenes of bodies only (then there are no `blocks`).");
}
template <class V>
void fields(V& v, const BodiesResult& x) {
  v("input", InputFigures{});
  scene2d_fields(v, x);
}

[[nodiscard]] std::expected<BodiesResult, std::vector<Problem>> run(const BodiesScene& scene, unsigned threads,
                                                                    StageTimer& timer, Progress& progress);

}  // namespace cleave::scene
