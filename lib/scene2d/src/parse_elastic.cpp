#include "parse_elastic.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>

#include "body_keys.hpp"

namespace cleave::scene {

using bem::Vec2;
using std::string_view;

namespace {
constexpr NumberRule any_time{0, false, 1e12, false, " s"};
/// Laws of integration in time that a scene may ask for.
enum class Scheme : std::uint8_t { generalized_alpha, newmark, houbolt, backward_euler };

const KeyTable& damping_keys() {
  static const KeyTable keys{
      .name = "elastic.time.damping",
      .keys = {{"share", key::number({0, false, 10, false, ""}), "0", "of critical damping, of every mode"},
               {"alpha", key::number({0, false, 1e9, false, " 1/s"}), "0", "1/s, times the mass"},
               {"beta", key::number(any_time), "0", "s, times the stiffness"}}};
  return keys;
}

const KeyTable& time_keys() {
  static const KeyTable keys{
      .name = "elastic.time",
      .keys = {
          {"end", key::number(time_rule), required, "s"},
          {"step", key::number(time_rule), required, "s"},
          {"scheme", key::word<Scheme>(), "\"generalized_alpha\"", "integration in time"},
          {"rho", key::number({0, false, 1, false, ""}), "0.8", "spectral radius of `generalized_alpha`"},
          {"beta", key::number({0, true, 1, false, ""}), "0.25", "of `newmark`"},
          {"gamma", key::number({0.5, false, 1, false, ""}), "0.5", "of `newmark`"},
          {"damping", key::table(&damping_keys), "", "`{ share, alpha, beta }`"},
          {"frames", key::whole(1, 2000), "60", "pictures kept"},
          {"modes", key::whole(0, 1000), "", "of each body; none: of free bodies all that the mesh has"},
          {"rebuild", key::number({0, false, 1, false, ""}), "0.02",
           "change of the boundary's tangent (stretch, or local rotation against the body) since its operator was "
           "built, at which it is built again in the deformed shape; 0: never"},
          {"estimate", key::flag(), "true",
           "of the error, by two more runs of half and a quarter of the elements and modes and two and four times the "
           "step"}}};
  return keys;
}

const KeyTable& point_keys() {
  static const KeyTable keys = [] {
    KeyTable table{.name = "elastic.points", .keys = history_keys()};
    table.keys.push_back({"stress", key::flag(), "false", "true: its stress, too"});
    return table;
  }();
  return keys;
}
}  // namespace

const KeyTable& elastic_keys() {
  static const KeyTable keys{
      .name = "elastic",
      .keys = {
          {"plane", key::word<bem::PlaneState>(), "\"strain\"", "plane strain or plane stress"},
          {"gravity", key::either({key::number(rule::as_gravity(rule::acceleration)), key::pair(rule::acceleration)}),
           "0", "m/s2 downwards, or `[x, y]`"},
          {"order", key::word<bem::Order>(), "\"quadratic\"", "of the elements"},
          {"element", key::number(rule::length), "a sixteenth of the size", "m, longest element"},
          {"tolerance", key::number({1e-12, false, 1, false, ""}), "",
           "elements are doubled until displacements change by less, relative; not reached after 6 meshes: exit "
           "code 4"},
          {"integration", key::number({1e-15, false, 1e-2, false, ""}), "1e-10",
           "relative error target of the integrals"},
          {"stress", key::flag(), "true",
           "contours of stress inside (static scenes); stress on the boundary in each frame (moving ones)"},
          {"points", key::tables(&point_keys), "[]",
           "displacements (and with `stress` the stress) on the boundary or inside, in summary.json, points.csv "
           "and the report; of each frame in moving scenes"},
          {"frequencies", key::whole(0, 100), "0",
           "so many natural frequencies of every body that stands alone, in summary.json and the report (moving "
           "scenes: 6 without it)"},
          {"time", key::table(&time_keys), "none: static", "bodies move, below"}}};
  return keys;
}

void parse_elastic_time(const TableReader& elastic, BodiesScene& scene) {
  const auto found = elastic.sub("time");
  if (!found) return;
  const TableReader& table = *found;
  TimeSettings time;
  time.end = table.need_number("end").value_or(1);
  time.step = table.need_number("step").value_or(1);
  if (time.end / time.step > 5e7)
    table.error("step", "makes more than fifty million steps", "use a longer step or a shorter time");
  if (time.step > time.end) table.error("step", "is longer than the whole time", "use a shorter step");
  switch (table.word<Scheme>("scheme")) {
    case Scheme::generalized_alpha: time.scheme = bem::GeneralizedAlpha{table.value("rho")}; break;
    case Scheme::newmark: time.scheme = bem::Newmark{table.value("beta"), table.value("gamma")}; break;
    case Scheme::houbolt: time.scheme = bem::Houbolt{}; break;
    case Scheme::backward_euler: time.scheme = bem::BackwardEuler{}; break;
  }
  if (const auto damping = table.sub("damping")) {
    time.damping.share = damping->value("share");
    time.damping.alpha = damping->value("alpha");
    time.damping.beta = damping->value("beta");
  }
  time.frames = static_cast<std::size_t>(table.count("frames"));
  if (const auto modes = table.integer("modes")) time.modes = static_cast<std::size_t>(*modes);
  time.rebuild = table.value("rebuild");
  if (time.rebuild == 0) time.rebuild.reset();
  time.estimate = table.flag("estimate");
  scene.time = time;
}

void parse_elastic_points(const TableReader& elastic, BodiesScene& scene) {
  std::size_t number = 0;
  for (const TableReader& table : elastic.each("points")) {
    ++number;
    const auto at = pair(table, "at");
    if (!table.has("at")) table.missing("at", "write at = [x, y]");
    if (!at) continue;
    PointSpec point{.name = table.text("name").value_or(fmt::format("point {}", number)),
                    .at = *at,
                    .body = 0,
                    .stress = table.flag("stress")};
    const auto wanted = table.text("body");
    bool known = false;
    for (std::size_t b = 0; b < scene.bodies.size() && !known; ++b) {
      const BodySpec& body = scene.bodies[b];
      known = wanted ? body.name == *wanted
                     : (body.extent == bem::Extent::bounded ? bem::inside(body.region.loops, *at) : true);
      if (known) point.body = b;
    }
    if (!known && !wanted) {
      // On a boundary: the body whose outline is nearest.
      double best = 1e300;
      for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        for (const bem::Loop& loop : scene.bodies[b].region.loops) {
          for (std::size_t s = 0; s < loop.size(); ++s) {
            for (int k = 0; k <= 64; ++k) {
              const double d = norm(bem::point_on(loop, s, k / 64.0).x - *at);
              const double near = bem::length_of(loop, s) / 64;
              if (d < best && d <= near) {
                best = d;
                point.body = b;
                known = true;
              }
            }
          }
        }
      }
    }
    if (!known) {
      table.error(wanted ? "body" : "at", wanted ? "there is no body of that name" : "lies in no body",
                  "move the point, or name its body");
    }
    scene.points.push_back(point);
  }
}

}  // namespace cleave::scene
