#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "cleave/dfn/sample.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/scene/survey_file.hpp"

namespace cleave::scene {
namespace {

std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c >= 0 && c < ' ' ? ' ' : c;
  }
  return out + "\"";
}

/// A name that may stand in a file name.
std::string plain(std::string_view name) {
  std::string out;
  for (const char c : name) {
    const bool good = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    out += good ? c : '_';
  }
  return out.empty() ? "set" : out;
}

/// Diameters above ten means (or three times the longest trace) are cut off: a box is grown by the largest joint.
double largest_diameter(const survey::SetResult& set) {
  double longest = 0;
  for (const double l : set.seen_lengths) longest = std::max(longest, l);
  return std::max(10 * set.size->mean, 3 * longest);
}

bool usable(const survey::SetResult& set) {
  return (set.joints > 0 || set.orientation_stated) && set.p32 && set.p32->value && *set.p32->value > 0;
}

std::string size_text(const survey::SetResult& set) {
  const survey::DiscLaw& law = *set.size;
  std::string text = fmt::format("{{ distribution = \"{}\", mean = {}", name_of(law.family), law.mean);
  if (law.family != survey::Family::exponential) text += fmt::format(", std = {}", law.std);
  return text + fmt::format(", max = {} }}", largest_diameter(set));
}

}  // namespace

SetsFile sets_file(const SurveyScene& survey, const survey::SurveyResult& result) {
  SetsFile file;
  file.toml = fmt::format(
      "# Joint sets of {} (sha256 {}), by cleave survey. A scene takes them with include = [\"sets.toml\"].\n",
      survey.file_name, survey.sha256);
  for (const survey::SetResult& set : result.sets) {
    file.toml += "\n";
    if (!usable(set)) {
      file.toml += fmt::format("# {}: left out, its {} not known\n", set.name,
                               set.joints > 0 || set.orientation_stated ? "intensity is" : "orientation is");
      continue;
    }
    const geometry::Attitude mean = geometry::attitude_of(set.orientation.mean);
    file.toml += fmt::format("[[joint_set]]\nname = {}\nmodel = \"baecher\"\n", in_quotes(set.name));
    const bool fisher = set.orientation.fisher && std::isfinite(set.orientation.kappa);
    if (fisher || set.orientation_stated) {
      file.toml +=
          fmt::format("orientation = {{ dip = {}, dip_direction = {}, distribution = \"fisher\", kappa = {} }}",
                      mean.dip.degrees(), mean.direction.degrees(), set.orientation.kappa);
      file.toml += set.orientation_stated ? "   # dip stated\n"
                                          : fmt::format("   # kappa {:.3g} to {:.3g}, mean within {:.1f} degrees\n",
                                                        set.orientation.kappa_low, set.orientation.kappa_high,
                                                        set.orientation.cone_degrees);
    } else if (set.joints == 1 || std::isinf(set.orientation.kappa)) {
      file.toml += fmt::format("orientation = {{ dip = {}, dip_direction = {} }}   # all parallel\n",
                               mean.dip.degrees(), mean.direction.degrees());
    } else {
      const std::string name = fmt::format("sets_{}.csv", plain(set.name));
      // Each pole as often as its weight says, in quarters of the smallest.
      const double least = *std::ranges::min_element(set.weights);
      std::string csv = "dip,dip_direction\n";
      for (std::size_t i = 0; i < set.normals.size(); ++i) {
        const geometry::Attitude a = geometry::attitude_of(set.normals[i]);
        const auto times = std::clamp(std::lround(4 * set.weights[i] / least), 1L, 400L);
        for (long t = 0; t < times; ++t) csv += fmt::format("{},{}\n", a.dip.degrees(), a.direction.degrees());
      }
      file.files.emplace_back(name, std::move(csv));
      file.toml += fmt::format("orientation = {{ distribution = \"bootstrap\", file = \"{}\", jitter = 200 }}\n", name);
    }
    if (set.size) {
      file.toml += "shape = \"disc\"\nsize = " + size_text(set) + "   # diameter, m\n";
    } else {
      file.toml += "size = \"persistent\"   # no trace lengths were measured\n";
    }
    file.toml += fmt::format("intensity = {{ p32 = {} }}   # 1/m, {:.3g} to {:.3g}; {}\n", *set.p32->value,
                             set.p32->low, set.p32->high, set.p32->method);
  }
  return file;
}

std::optional<std::vector<survey::Polyline>> simulated_traces(const SurveyScene& survey,
                                                              const survey::SurveyResult& result, std::size_t window,
                                                              std::uint64_t realization) {
  const survey::WindowSurvey& map = survey.input.windows[window];
  const geometry::Vec3 y = cross(map.normal, map.x_axis);
  // The box around the window, in space about the map's origin.
  geometry::Vec3 lo{INFINITY, INFINITY, INFINITY}, hi = -lo;
  const auto grow = [&](survey::MapPoint p) {
    const geometry::Vec3 q = p.x * map.x_axis + p.y * y;
    lo = {std::min(lo.x, q.x), std::min(lo.y, q.y), std::min(lo.z, q.z)};
    hi = {std::max(hi.x, q.x), std::max(hi.y, q.y), std::max(hi.z, q.z)};
  };
  if (const auto* circle = std::get_if<survey::CircleWindow>(&map.window)) {
    for (const double sx : {-1.0, 1.0}) {
      for (const double sy : {-1.0, 1.0}) {
        grow({circle->centre.x + sx * circle->radius, circle->centre.y + sy * circle->radius});
      }
    }
  } else {
    for (const survey::MapPoint p : std::get<survey::PolygonWindow>(map.window).corners) grow(p);
  }
  const double margin = 1e-3 * norm(hi - lo);
  lo -= geometry::Vec3{margin, margin, margin};
  hi += geometry::Vec3{margin, margin, margin};
  std::vector<survey::Polyline> traces;
  for (std::size_t k = 0; k < result.sets.size(); ++k) {
    const survey::SetResult& set = result.sets[k];
    if (!usable(set) || !set.size || set.traces == 0) continue;
    const geometry::Attitude mean = geometry::attitude_of(set.orientation.mean);
    const auto distribution = set.size->family == survey::Family::exponential ? dfn::SizeDistribution::exponential
                              : set.size->family == survey::Family::lognormal ? dfn::SizeDistribution::lognormal
                                                                              : dfn::SizeDistribution::gamma;
    auto size = dfn::SizeLaw::make({.distribution = distribution,
                                    .mean = metres(set.size->mean),
                                    .std = metres(set.size->std),
                                    .exponent = {},
                                    .min = {},
                                    .max = metres(largest_diameter(set))});
    if (!size) return std::nullopt;
    dfn::OrientationLaw law = dfn::FisherOrientation{
        mean.dip, mean.direction, std::isfinite(set.orientation.kappa) ? set.orientation.kappa : 1e9};
    if (!set.orientation.fisher && !set.orientation_stated) {
      law = dfn::BootstrapOrientation::make(set.normals, set.weights, 200);
    }
    auto joints =
        dfn::JointSet::make({std::move(law), dfn::Disc{*size, 32}, dfn::FixedRotation{}, dfn::P32{*set.p32->value}});
    if (!joints) return std::nullopt;
    const auto sampled = dfn::sample(*joints, k, {lo, hi}, survey.input.seed, realization);
    if (!sampled) return std::nullopt;
    for (const dfn::SampledJoint& joint : *sampled) {
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

}  // namespace cleave::scene
