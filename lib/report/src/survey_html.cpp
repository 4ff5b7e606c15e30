#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

#include "cleave/exchange/text.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/report/survey.hpp"
#include "html_parts.hpp"
#include "html_table.hpp"
#include "plot.hpp"
#include "stereonet.hpp"
#include "survey_windows.hpp"
#include "svg.hpp"

namespace cleave::report {
namespace {

using detail::Axis;
using detail::estimate_text;
using detail::fixed;
using detail::LineStyle;
using detail::Plot;
using detail::PlotPoint;
using geometry::Vec3;
using survey::Estimate;

/// Density of poles on the net in multiples of uniform, coloured, with contours at 2, 4, 8, 16: Fisher kernels with
/// kappa 100 (Diggle & Fisher 1985), about the 1 % counting circle.
class DensityNet final {
 public:
  DensityNet(const std::vector<Vec3>& normals, const std::vector<double>& weights, Net net) {
    const std::size_t stride = std::max<std::size_t>(1, normals.size() / 2000);
    for (std::size_t i = 0; i <= cells; ++i) {
      for (std::size_t j = 0; j <= cells; ++j) {
        const double x = place(i), y = place(j), r = std::hypot(x, y);
        // Beyond the rim as on it, so that contours run up to it.
        const double t = std::min(r, 1.0);
        const double theta = net == Net::equal_area ? 2 * std::asin(t / std::numbers::sqrt2) : 2 * std::atan(t);
        const Vec3 d{r > 0 ? std::sin(theta) * x / r : 0, r > 0 ? std::sin(theta) * y / r : 0, -std::cos(theta)};
        double density = 0, used = 0;
        for (std::size_t k = 0; k < normals.size(); k += stride) {
          density += weights[k] * std::exp(kernel * (std::abs(dot(normals[k], d)) - 1));
          used += weights[k];
        }
        at_.push_back(density * kernel / std::max(used, 1e-300));  // 1: uniform on the half sphere
      }
    }
  }

  [[nodiscard]] std::string svg() const {
    std::string out = "<svg viewBox=\"-110 -110 220 220\" role=\"img\" aria-label=\"Density of poles\">";
    for (std::size_t i = 0; i < cells; ++i) {
      for (std::size_t j = 0; j < cells; ++j) {
        const double x = (place(i) + place(i + 1)) / 2, y = (place(j) + place(j + 1)) / 2;
        const double density = (at(i, j) + at(i + 1, j) + at(i, j + 1) + at(i + 1, j + 1)) / 4;
        if (std::hypot(x, y) > 1 || density < 1) continue;
        const double shade = std::min(1.0, std::log2(density) / 5);
        out += "<rect x=\"" + fixed(100 * place(i)) + "\" y=\"" + fixed(-100 * place(j + 1)) +
               "\" width=\"3.5\" height=\"3.5\" fill=\"#0072B2\" fill-opacity=\"" + fixed(0.08 + 0.72 * shade) + "\"/>";
      }
    }
    for (const double level : {2.0, 4.0, 8.0, 16.0}) {
      const std::string path = contour(level);
      if (path.empty()) continue;
      out += "<path class=\"net-contour\" fill=\"none\" stroke=\"#14202b\" stroke-width=\"" +
             fixed(0.3 + 0.04 * level) + "\" d=\"" + path + "\"><title>" + display(level, 2) +
             " times uniform</title></path>";
    }
    return out + "<circle class=\"net-rim\" r=\"100\"/><path class=\"net-tick\" d=\"M0,-100V-105\"/></svg>";
  }

 private:
  static constexpr double kernel = 100;
  static constexpr std::size_t cells = 60;
  static double place(std::size_t i) { return 2 * static_cast<double>(i) / cells - 1; }
  [[nodiscard]] double at(std::size_t i, std::size_t j) const { return at_[i * (cells + 1) + j]; }

  /// Straight pieces through the two halves of every cell.
  [[nodiscard]] std::string contour(double level) const {
    struct Node {
      double x, y, value;
    };
    std::string path;
    const auto through = [&](const std::array<Node, 3>& corner) {
      std::array<std::pair<double, double>, 2> ends{};
      std::size_t found = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const Node &a = corner.at(k), &b = corner.at((k + 1) % 3);
        if ((a.value < level) == (b.value < level)) continue;
        const double t = (level - a.value) / (b.value - a.value);
        ends.at(found++) = {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
      }
      if (found < 2 || std::hypot(ends[0].first + ends[1].first, ends[0].second + ends[1].second) > 2) return;
      path += "M" + fixed(100 * ends[0].first) + "," + fixed(-100 * ends[0].second) + "L" + fixed(100 * ends[1].first) +
              "," + fixed(-100 * ends[1].second);
    };
    for (std::size_t i = 0; i < cells; ++i) {
      for (std::size_t j = 0; j < cells; ++j) {
        const auto node = [&](std::size_t u, std::size_t v) { return Node{place(u), place(v), at(u, v)}; };
        const Node a = node(i, j), b = node(i + 1, j), c = node(i + 1, j + 1), d = node(i, j + 1);
        through({a, b, c});
        through({a, c, d});
      }
    }
    return path;
  }

  std::vector<double> at_;
};

/// What a histogram shows: values, the laws fitted to them (the best first), and words.
struct Lengths {
  std::vector<double> values;
  std::vector<survey::Fit> laws;  ///< `p_value` is shown where there is one
  std::string axis, label, caption;
};

std::string histogram(Lengths shown) {
  if (shown.values.size() < 5 || shown.laws.empty()) return {};
  std::ranges::sort(shown.values);
  const double high = shown.values[static_cast<std::size_t>(0.98 * static_cast<double>(shown.values.size() - 1))];
  if (!(high > 0)) return {};
  constexpr std::size_t bins = 20;
  std::array<double, bins> counts{};
  for (const double l : shown.values) {
    if (l < high) counts[static_cast<std::size_t>(l / high * bins)] += 1;
  }
  const double width = high / bins, n = static_cast<double>(shown.values.size());
  double top = 0;
  for (const double c : counts) top = std::max(top, c / n / width);
  Plot plot{Axis{0, high, false, shown.axis}, detail::from_zero(1.2 * top, "density (1/m)"), shown.label};
  for (std::size_t i = 0; i < bins; ++i) {
    plot.bar(width * static_cast<double>(i), width * static_cast<double>(i + 1), counts[i] / n / width, "#9aa5ae");
  }
  std::string names;
  for (std::size_t k = 0; k < std::min<std::size_t>(2, shown.laws.size()); ++k) {
    std::vector<PlotPoint> line;
    for (int i = 1; i <= 200; ++i) {
      const double x = high * i / 200;
      line.push_back({x, std::min(shown.laws[k].density(x), 1.2 * top)});
    }
    plot.line(line, k == 0 ? LineStyle::solid : LineStyle::dashed);
    names += std::string{k == 0 ? "<span class=\"key-a\">" : ", <span class=\"key-b\">"} +
             std::string{name_of(shown.laws[k].family)} + "</span>";
    if (shown.laws[k].p_value) names += " (Kolmogorov-Smirnov p = " + display(*shown.laws[k].p_value, 2) + ")";
  }
  return "<figure>" + std::move(plot).svg() + "<figcaption>" + escape_xml(shown.caption) + ": " + names +
         ".</figcaption></figure>";
}

std::string length_histogram(const survey::SetResult& set) {
  Lengths shown{set.seen_lengths,
                {},
                "trace length (m)",
                "Histogram of trace lengths with the fitted laws",
                set.name + ": lengths as seen, and the laws of the whole traces, fitted with censoring"};
  for (const survey::FittedLaw& law : set.lengths) {
    shown.laws.push_back(law.fit);
    if (law.test) shown.laws.back().p_value = law.test->p_value;
  }
  return histogram(std::move(shown));
}
std::string spacing_histogram(const survey::SetResult& set) {
  return histogram({set.gaps, set.spacings, "spacing along the mean normal (m)",
                    "Histogram of spacings with the fitted laws", set.name + ": spacings and the laws fitted to them"});
}

std::string range(double low, double high, int digits = 3) {
  return "(" + display(low, digits) + " … " + display(high, digits) + ")";
}

/// Dip and dip direction with what is known of their error.
std::string attitude_text(const survey::SetResult& set) {
  const geometry::Attitude mean = survey::compass_attitude(set.orientation.mean, set.north);
  std::string out = display(mean.dip.degrees(), 3) + "° / " + display(mean.direction.degrees(), 4) + "°";
  if (!set.orientation_stated) {
    const auto cone = set.orientation.cone_degrees;
    return out + (cone ? " ± " + display(*cone, 2) + "°" : " (error not known)");
  }
  if (set.direction) out += " " + range(set.direction->low, set.direction->high, 4);
  return out + (set.direction ? ", dip stated" : " (stated)");
}
/// Kappa, and Bingham's parameters where Fisher's law is refused.
std::string concentration_text(const survey::SetResult& set) {
  const survey::FisherFit& fit = set.orientation;
  if (set.joints < 2 && !(fit.kappa_high > 0))
    return set.orientation_stated ? display(fit.kappa, 3) + " (stated)" : "–";
  std::string out = display(fit.kappa, 3) + " " + range(fit.kappa_low, fit.kappa_high);
  if (!fit.fisher) out += ", not Fisher";
  if (const auto& b = set.bingham) {
    const auto low = [](double k) { return std::isfinite(k) ? display(k, 3) : std::string{"−∞"}; };
    out += ": Bingham k1 " + display(b->k1, 3) + " (" + low(b->first[0]) + " … " + display(b->first[1], 3) + "), k2 " +
           display(b->k2, 3) + " (" + low(b->second[0]) + " … " + display(b->second[1], 3) + ")";
  }
  return out;
}
std::string size_text(const survey::SetResult& set) {
  if (!set.size) return "–";
  std::string out{name_of(set.size->family)};
  if (!set.size_mean || !set.size_std) {
    return out + " " + display(set.size->mean, 3) + " ± " + display(set.size->std, 3);
  }
  return out + ", mean " + estimate_text(*set.size_mean) + ", standard deviation " + estimate_text(*set.size_std);
}

std::string sets_section(const survey::SurveyResult& result) {
  const auto row = [](auto& v, const survey::SetResult& set) {
    const bool known = set.joints > 0 || set.orientation_stated;
    const auto if_known = [&](auto text) { return known ? Html{text(set)} : Html{"–"}; };
    const auto estimate = [](const std::optional<Estimate>& e) { return Html{e ? estimate_text(*e) : "–"}; };
    v("set", set.name);
    v("joints", set.joints);
    v("traces", set.traces);
    v("attitude", if_known(attitude_text));
    v("kappa", if_known(concentration_text));
    v("p32", estimate(set.p32));
    v("p30", estimate(set.p30));
    v("mean_length", estimate(set.mean_length));
    v("size", Html{size_text(set)});
  };
  std::string out =
      "<section id=\"sets\"><h2>Joint sets</h2>\n" +
      html_table(
          {{"set"}, {"joints"}, {"traces"}, {"attitude", "Mean dip / dip direction"}, {"kappa", "Concentration κ"}},
          each(result.sets, row)) +
      html_table({{"set"},
                  {"p32", "P32 (1/m)"},
                  {"p30", "P30 (1/m³)"},
                  {"mean_length", "Mean trace (m)"},
                  {.name = "size", .heading = "Size (m)", .kind = "wide"}},
                 each(result.sets, row)) +
      "<ul>\n";
  for (const survey::SetResult& set : result.sets) {
    for (const std::string& note : set.notes) out += "<li>" + escape_xml(set.name + ": " + note) + "</li>\n";
  }
  return out + "</ul></section>\n";
}

std::string nets_section(const scene::SurveyScene& scene, const survey::SurveyResult& result) {
  if (scene.input.orientations.empty()) return {};
  std::vector<Pole> poles;
  std::vector<NetSet> sets;
  std::vector<Vec3> normals;
  std::vector<double> weights;
  for (const survey::SetResult& set : result.sets) sets.push_back({set.name, set.joints});
  sets.push_back({"unassigned", result.unassigned});
  for (std::size_t i = 0; i < scene.input.orientations.size(); ++i) {
    const std::size_t set = result.set_of[i].value_or(result.sets.size());
    const auto& o = scene.input.orientations[i];
    // True north at the top.
    const Vec3 normal = geometry::upward_normal(survey::compass_attitude(o.normal, scene.input.north.degrees()));
    poles.push_back({normal, static_cast<std::uint32_t>(set)});
    normals.push_back(normal);
    weights.push_back(survey::weight_of(o, scene.input.weight_cap));
  }
  std::string out = "<section id=\"net\"><h2>Stereonets</h2>\n<div class=\"columns\">";
  for (const Net net : {Net::equal_area, Net::equal_angle}) {
    const std::string name = net == Net::equal_area ? "equal area" : "equal angle";
    out += "<figure class=\"net\">" + stereonet_svg(poles, sets, net, 0) + "<figcaption>Poles, lower hemisphere, " +
           name + ".</figcaption></figure><figure class=\"net\">" + DensityNet{normals, weights, net}.svg() +
           "<figcaption>Density of poles, weighted against the bias of line or outcrop, " + name +
           ": contours at 2, 4, 8, 16 times uniform, by Fisher kernels (κ = 100).</figcaption></figure>\n";
  }
  out += "</div>\n";
  if (!result.silhouettes.empty()) {
    out += "<p class=\"small\">Mean silhouette of axial K-means by number of sets (nearer to 1: better parted): ";
    for (const auto& [k, value] : result.silhouettes) out += std::to_string(k) + ": " + display(value, 3) + "; ";
    out += "the choice is yours.</p>\n";
  }
  return out + "</section>\n";
}

}  // namespace

std::string survey_html(const scene::SurveyScene& scene, const survey::SurveyResult& result,
                        std::span<const scene::SimulatedTraceMaps> maps) {
  const std::string title = escape_xml(scene.input.title);
  std::string out = detail::page_begin(title, escape_xml(scene.file_name) + " · field survey · intervals at " +
                                                  display(100 * scene.input.confidence, 3) + " %");
  out += "<section class=\"cards\" aria-label=\"Key figures\">\n";
  out += detail::key_figure("Orientations", display_count(scene.input.orientations.size()),
                            display_count(result.unassigned) + " of no set");
  std::uint64_t traces = 0;
  for (const auto& w : result.windows) traces += w.counts.traces();
  out +=
      detail::key_figure("Traces", display_count(traces), "in " + std::to_string(result.windows.size()) + " windows");
  const auto usable = static_cast<std::size_t>(std::ranges::count_if(result.sets, scene::usable));
  const bool all = usable == result.sets.size();
  out += detail::key_figure("Sets", display_count(result.sets.size()),
                            all ? "in sets.toml" : display_count(usable) + " of them in sets.toml");
  out += "</section>\n";
  out += sets_section(result);
  out += nets_section(scene, result);
  out += detail::survey_windows(scene, result, maps);
  std::string histograms;
  for (const survey::SetResult& set : result.sets) histograms += length_histogram(set);
  if (!histograms.empty()) {
    out += "<section id=\"lengths\"><h2>Trace lengths</h2><div class=\"columns\">" + histograms + "</div></section>\n";
  }
  std::string spacings;
  for (const survey::SetResult& set : result.sets) spacings += spacing_histogram(set);
  if (!spacings.empty()) {
    out += "<section id=\"spacings\"><h2>Spacings</h2><div class=\"columns\">" + spacings + "</div></section>\n";
  }
  if (!result.lines.empty()) {
    const auto row = [](auto& v, const survey::LineResult& line) {
      v("line", line.name);
      v("length_m", line.length);
      v("frequency", Html{estimate_text(line.frequency)});
      v("rqd", Html{estimate_text(line.rqd)});
      v("rqd_by_frequency", Html{estimate_text(line.rqd_by_frequency)});
    };
    out += "<section id=\"lines\"><h2>Lines</h2>" +
           html_table({{"line"},
                       {"length_m"},
                       {"frequency", "Frequency (1/m)"},
                       {"rqd", "RQD, measured"},
                       {"rqd_by_frequency", "RQD, from the frequency"}},
                      each(result.lines, row), {}, Frame::none) +
           "</section>\n";
  }
  std::string notes;
  for (const std::string& note : result.notes) notes += "<li>" + escape_xml(note) + "</li>\n";
  for (const scene::Problem& note : scene.notes) notes += "<li>" + escape_xml(describe(note)) + "</li>\n";
  if (!notes.empty()) out += "<section id=\"notes\"><h2>Notes</h2><ul>\n" + notes + "</ul></section>\n";
  constexpr std::array<std::string_view, 5> limits{
      "Joints are flat discs or ellipses, the same statistically throughout the rock.",
      "Intervals are those of sampling: errors of compass, tape and observer are not in them.",
      "Directions are weighted by their angle to line or outcrop, up to the cap; joints parallel to it are not seen.",
      "Lengths and spacings are those of what windows and lines have met; nothing is said of rock beyond them.",
      "Strength, roughness, filling and water of joints are not estimated."};
  out += detail::inputs_section(detail::input_rows("Survey", scene.file_name, scene.sha256, scene.files, std::nullopt),
                                limits);
  return out + detail::page_foot() + std::string{detail::page_end};
}

}  // namespace cleave::report
