#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "cleave/core/parallel.hpp"
#include "cleave/dfn/sample.hpp"
#include "cleave/field_data/survey_file.hpp"
#include "cleave/geometry/orientation.hpp"
#include "survey_laws.hpp"

namespace cleave::scene {

/// Sizes above ten means (or three times the longest trace) are cut off: a box is grown by the largest joint.
double largest_size(const survey::SetResult& set) {
  if (set.size->family == survey::Family::power) return set.size->max;
  if (set.size->family == survey::Family::constant) return set.size->mean;
  double longest = 0;
  for (const double l : set.seen_lengths) longest = std::max(longest, l);
  return std::max(10 * set.size->mean, 3 * longest / set.chords.disc.value_or(1));
}

double smallest_size(const survey::SetResult& set) { return 1e-3 * set.size->mean; }

bool usable(const survey::SetResult& set) {
  return (set.joints > 0 || set.orientation_stated) && set.p32 && set.p32->value && *set.p32->value > 0;
}

namespace {

dfn::SizeSpec size_spec(const survey::SetResult& set) {
  dfn::SizeSpec spec{.distribution = dfn::SizeDistribution::exponential,
                     .mean = metres(set.size->mean),
                     .std = {},
                     .exponent = {},
                     .min = {},
                     .max = metres(largest_size(set))};
  switch (set.size->family) {
    case survey::Family::exponential: break;
    case survey::Family::lognormal:
      spec.distribution = dfn::SizeDistribution::lognormal;
      spec.std = metres(set.size->std);
      break;
    case survey::Family::gamma:
      spec.distribution = dfn::SizeDistribution::gamma;
      spec.std = metres(set.size->std);
      spec.min = metres(smallest_size(set));
      break;
    case survey::Family::power:
      spec.distribution = dfn::SizeDistribution::power;
      spec.mean.reset();
      spec.exponent = set.size->exponent;
      spec.min = metres(set.size->min);
      break;
    case survey::Family::normal:
      spec.distribution = dfn::SizeDistribution::normal;
      spec.std = metres(set.size->std);
      break;
    case survey::Family::constant:
      spec.distribution = dfn::SizeDistribution::constant;
      spec.max.reset();
      break;
  }
  return spec;
}

dfn::Shape shape_of(const survey::SetResult& set, const dfn::SizeLaw& size) {
  switch (set.shape.shape) {
    case survey::JointShape::disc: return dfn::Disc{size, 32};
    case survey::JointShape::ellipse: return dfn::Ellipse{size, dfn::AspectRatio{set.shape.aspect}, 32};
    case survey::JointShape::rectangle: return dfn::Rectangle{size, dfn::AspectRatio{set.shape.aspect}};
  }
  std::unreachable();
}

}  // namespace

std::optional<std::vector<survey::Polyline>> simulated_traces(const SurveyScene& survey,
                                                              const survey::SurveyResult& result, std::size_t window,
                                                              std::uint64_t realization) {
  const survey::WindowSurvey& map = survey.input.windows[window];
  const geometry::Vec3 y = cross(map.normal, map.x_axis);
  // The box around the window, in space about the map's origin.
  geometry::Box box;
  const auto grow = [&](survey::MapPoint p) { box.add(p.x * map.x_axis + p.y * y); };
  if (const auto* circle = std::get_if<survey::CircleWindow>(&map.window)) {
    for (const double sx : {-1.0, 1.0}) {
      for (const double sy : {-1.0, 1.0}) {
        grow({circle->centre.x + sx * circle->radius, circle->centre.y + sy * circle->radius});
      }
    }
  } else {
    for (const survey::MapPoint p : std::get<survey::PolygonWindow>(map.window).corners) grow(p);
  }
  box = box.grown(1e-3 * norm(box.size()));
  std::vector<survey::Polyline> traces;
  for (std::size_t k = 0; k < result.sets.size(); ++k) {
    const survey::SetResult& set = result.sets[k];
    if (!usable(set) || !set.size || set.traces == 0) continue;
    const geometry::Attitude mean = geometry::attitude_of(set.orientation.mean);
    const auto size = dfn::SizeLaw::make(size_spec(set));
    if (!size) return std::nullopt;
    dfn::OrientationLaw law = dfn::FisherOrientation{
        mean.dip, mean.direction, std::isfinite(set.orientation.kappa) ? set.orientation.kappa : 1e9};
    if (!set.orientation.fisher && !set.orientation_stated) {
      law = dfn::BootstrapOrientation::make(set.normals, set.weights, 200);
    }
    auto joints = dfn::JointSet::make({std::move(law), shape_of(set, *size),
                                       dfn::FixedRotation{dfn::Rotation::degrees(set.shape.rotation)},
                                       dfn::P32{set.p32_of_all.value_or(*set.p32->value)}});
    if (!joints) return std::nullopt;
    auto sampled = dfn::sample(*joints, k, box, survey.input.seed, realization);
    if (!sampled) return std::nullopt;
    // Most joints of the rock around do not reach the map: their corners need not be written out.
    std::erase_if(*sampled, [&](const dfn::SampledJoint& joint) {
      const auto* outline = std::get_if<dfn::JointOutline>(&joint.shape);
      if (outline == nullptr) return false;
      const double reach = outline->first * std::abs(dot(outline->along, map.normal)) +
                           outline->second * std::abs(dot(outline->across, map.normal));
      return std::abs(dot(joint.centre, map.normal)) > 1.001 * reach;
    });
    for (const dfn::SampledJoint& joint : with_polygons(*std::move(sampled))) {
      const auto corners = std::get<geometry::Polygon>(joint.shape).corners();
      survey::Polyline line;
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const geometry::Vec3 p = corners[i], q = corners[(i + 1) % corners.size()];
        const double a = dot(p, map.normal), b = dot(q, map.normal);
        if ((a > 0) == (b > 0)) continue;
        const geometry::Vec3 x = p + (a / (a - b)) * (q - p);
        line.push_back({dot(x, map.x_axis), dot(x, y)});
      }
      if (line.size() == 2) traces.push_back(std::move(line));
    }
  }
  return traces;
}

MapFigures map_figures(const survey::WindowSurvey& map, const std::vector<survey::Polyline>& traces, double border,
                       double confidence) {
  const auto seen = seen_through(map.window, traces, border);
  const survey::WindowCounts counts = count(map.window, seen);
  MapFigures figures;
  figures.traces = static_cast<double>(counts.traces());
  figures.estimates = {survey::p20(counts, confidence), survey::p21(counts, confidence),
                       survey::mean_length(counts, confidence)};
  figures.p20 = figures.estimates[0].value.value_or(0);
  figures.p21 = figures.estimates[1].value.value_or(0);
  figures.mean_length = figures.estimates[2].value.value_or(0);
  if (seen.size() <= survey::most_traces_of_nodes) {
    const survey::Nodes met = nodes(map.window, traces, 1e-3 * figures.mean_length, confidence);
    figures.connections = met.connections.value.value_or(0);
    figures.estimates.push_back(met.connections);
  }
  const geometry::Vec3 y = cross(map.normal, map.x_axis);
  std::vector<survey::WeightedAxis> axes;
  for (const survey::SeenTrace& t : seen) {
    const geometry::Vec3 d = t.direction.x * map.x_axis + t.direction.y * y;
    axes.push_back({std::atan2(d.x, d.y) - map.north * std::numbers::pi / 180, t.length});
  }
  const survey::MeanAxis mean = mean_axis(axes, confidence);
  figures.direction = mean.direction.value.value_or(0);
  figures.alignment = mean.alignment.value.value_or(0);
  figures.estimates.push_back(mean.direction);
  figures.estimates.push_back(mean.alignment);
  return figures;
}

namespace {

/// A simulated map.
struct DrawnMap {
  MapFigures figures;
  std::optional<std::vector<survey::Polyline>> traces;  ///< of the first map
};

/// Without those of which the window shows less than its truncation: they would not have been mapped.
void mapped_only(const survey::WindowSurvey& window, std::vector<survey::Polyline>& traces) {
  if (!(window.truncation.si() > 0)) return;
  std::vector<double> seen(traces.size());
  for (const survey::SeenTrace& t : seen_through(window.window, traces, 0)) seen[t.trace] += t.length;
  std::vector<survey::Polyline> kept;
  for (std::size_t i = 0; i < traces.size(); ++i) {
    if (seen[i] >= window.truncation.si()) kept.push_back(std::move(traces[i]));
  }
  traces = std::move(kept);
}

std::vector<DrawnMap> drawn_maps(const SurveyScene& survey, const survey::SurveyResult& result, std::size_t window,
                                 std::uint64_t maps) {
  auto drawn = parallel_map(maps, ThreadLimit::all(), [&](std::size_t k) -> std::optional<DrawnMap> {
    auto traces = simulated_traces(survey, result, window, k);
    if (!traces || traces->empty()) return std::nullopt;
    mapped_only(survey.input.windows[window], *traces);
    DrawnMap map{map_figures(survey.input.windows[window], *traces, 0, survey.input.confidence), {}};
    if (k == 0) map.traces = std::move(traces);
    return map;
  });
  std::vector<DrawnMap> kept;
  for (auto& map : drawn) {
    if (!map) break;
    kept.push_back(*std::move(map));
  }
  return kept;
}

}  // namespace

std::vector<SimulatedTraceMaps> simulated_trace_maps(const SurveyScene& survey, const survey::SurveyResult& result) {
  std::vector<SimulatedTraceMaps> all;
  for (std::size_t w = 0; w < survey.input.windows.size(); ++w) {
    const survey::WindowSurvey& window = survey.input.windows[w];
    SimulatedTraceMaps maps{map_figures(window, window.traces, window.border.si(), survey.input.confidence), {}, {}};
    for (DrawnMap& map : drawn_maps(survey, result, w, window.traces.size() > 20'000 ? 1 : simulated_maps)) {
      if (map.traces) maps.first = std::move(map.traces);
      maps.simulated.push_back(std::move(map.figures));
    }
    all.push_back(std::move(maps));
  }
  return all;
}

}  // namespace cleave::scene
