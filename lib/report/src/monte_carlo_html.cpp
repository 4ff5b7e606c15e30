#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "cleave/exchange/text.hpp"
#include "cleave/report/monte_carlo.hpp"
#include "cleave/report/monte_carlo_fields.hpp"
#include "html_parts.hpp"
#include "html_table.hpp"
#include "monte_carlo_parts.hpp"
#include "plot.hpp"

namespace cleave::report {
namespace {

using detail::Axis;
using detail::interval;
using detail::LineStyle;
using detail::percent;
using detail::Plot;
using detail::PlotPoint;
using stochastic::Estimate;
using stochastic::Figures;

const Estimate* find(const Figures& figures, std::string_view name) {
  const auto it = std::ranges::find(figures.estimates, name, &Estimate::name);
  return it == figures.estimates.end() ? nullptr : &*it;
}

/// The name of a quantity in words, its unit behind a comma.
std::string words(std::string name) {
  std::ranges::replace(name, '_', ' ');
  for (const auto& [end, unit] : {std::pair<std::string_view, std::string_view>{" m3 per metre", ", m³ per metre"},
                                  {" n per metre", ", N per metre"},
                                  {" m3 s", ", m³/s"},
                                  {" m3", ", m³"},
                                  {" pa", ", Pa"},
                                  {" n", ", N"}}) {
    if (name.ends_with(end)) return name.substr(0, name.size() - end.size()) + std::string{unit};
  }
  return name;
}

std::string cards(const MonteCarloPage& page) {
  const Figures& f = page.result.figures;
  std::string out = "<section class=\"cards\" aria-label=\"Key figures\">\n";
  out += detail::key_figure("Realizations", display_count(f.realizations),
                            page.result.stopped_by == scene::StoppedBy::max         ? "stated precision not reached"
                            : page.result.stopped_by == scene::StoppedBy::precision ? "stopped at the stated precision"
                                                                                    : "as many as asked for",
                            page.result.stopped_by == scene::StoppedBy::max || f.failures > 0 ? "warn" : "good");
  const auto add = [&](std::string_view label, std::string_view name, std::string_view unit) {
    if (const Estimate* e = find(f, name)) {
      out += detail::key_figure(label, display(e->mean) + std::string{unit},
                                percent(f.confidence) + " interval " + interval(e->low, e->high));
    }
  };
  add("Key-block volume", "key_block_volume_m3", " m³");
  add("Key blocks", "key_block_count", "");
  add("First batch", "first_batch_volume_m3", " m³");
  add("Blocks", "block_count", "");
  add("Inflow", "inflow_m3_s", " m³/s");
  out += detail::notes_figure(page.notes.size());
  if (f.failures > 0) {
    out += detail::key_figure("Failed", display_count(f.failures), "realizations, left out of the figures", "bad");
  }
  return out + "</section>\n";
}

std::string running_figure(const Figures& f) {
  if (f.running.size() < 2) return {};
  double high = 0;
  std::vector<PlotPoint> mean, low, up;
  for (const auto& p : f.running) {
    const auto n = static_cast<double>(p.realizations);
    mean.push_back({n, p.mean});
    low.push_back({n, p.mean - p.half_width});
    up.push_back({n, p.mean + p.half_width});
    high = std::max(high, p.mean + p.half_width);
  }
  Plot plot{detail::decades(mean.front().x, mean.back().x, "realizations"),
            detail::from_zero(std::min(high, 3 * mean.back().y), "mean of " + words(f.running_quantity)),
            "Running mean with its confidence band"};
  plot.band(low, up);
  plot.line(mean);
  return "<figure>" + std::move(plot).svg() + "<figcaption>Running mean of " + escape_xml(words(f.running_quantity)) +
         " with its " + percent(f.confidence) +
         " band (pointwise). A line that looks flat proves nothing: the band does.</figcaption></figure>\n";
}

std::string size_figure(const Figures& f) {
  if (f.sizes.empty()) return {};
  Plot plot{detail::decades(f.sizes.front().volume_m3, f.sizes.back().volume_m3, "key-block volume V (m³)"),
            Axis{0, 1, false, "share of key blocks below V"}, "Size distribution of key blocks"};
  std::vector<PlotPoint> all, low, high, first;
  for (const auto& p : f.sizes) {
    all.push_back({p.volume_m3, p.share});
    low.push_back({p.volume_m3, p.share - 1.96 * p.standard_error});
    high.push_back({p.volume_m3, p.share + 1.96 * p.standard_error});
  }
  for (const auto& p : f.first_sizes) first.push_back({p.volume_m3, p.share});
  plot.band(low, high);
  plot.line(all);
  plot.line(first, LineStyle::dashed);
  return "<figure>" + std::move(plot).svg() +
         "<figcaption>Share of key blocks smaller than V, by number: <span class=\"key-a\">all batches</span> (band: "
         "two "
         "standard errors over realizations) and <span class=\"key-b\">first batch</span>.</figcaption></figure>\n";
}

std::string exceedance_figure(const Figures& f) {
  if (f.exceedances.size() < 2) return {};
  double low = 1;
  std::vector<double> volumes;
  for (const auto& e : f.exceedances) {
    if (e.volume_m3 <= 0) continue;
    volumes.push_back(e.volume_m3);
    low = std::min({low, std::max(e.interval.low, e.interval.high / 1000), e.interval.high});
  }
  if (volumes.empty()) return {};
  Plot plot{detail::decades(volumes.front(), volumes.back(), "volume v (m³)"),
            Axis{std::pow(10.0, std::floor(std::log10(std::max(low, 1e-9)))), 1, true, "P(a key block above v)"},
            "Probability of a key block above a volume"};
  std::vector<PlotPoint> line;
  for (const auto& e : f.exceedances) {
    if (e.volume_m3 <= 0) continue;
    plot.whisker(e.volume_m3, e.interval.low, e.interval.high);
    if (e.probability > 0) {
      plot.dot(e.volume_m3, e.probability);
      line.push_back({e.volume_m3, e.probability});
    }
  }
  plot.line(line);
  return "<figure>" + std::move(plot).svg() +
         "<figcaption>Probability that the largest key block of a realization exceeds v, with exact "
         "(Clopper–Pearson) " +
         percent(f.confidence) + " intervals.</figcaption></figure>\n";
}

std::string factor_figure(const Figures& f) {
  if (f.factors.empty()) return {};
  Plot plot{Axis{0, f.factors.back().factor, false, "factor of safety F"}, Axis{0, 1, false, "share, probability"},
            "Distribution of the factor of safety"};
  std::vector<PlotPoint> blocks, least;
  for (const auto& row : f.factors) {
    plot.whisker(row.factor, row.interval.low, row.interval.high);
    plot.dot(row.factor, row.probability);
    least.push_back({row.factor, row.probability});
    blocks.push_back({row.factor, row.share_below});
  }
  plot.line(least);
  plot.line(blocks, LineStyle::dashed);
  return "<figure>" + std::move(plot).svg() +
         "<figcaption><span class=\"key-a\">Probability that the least factor of safety of a realization lies below "
         "F</span>, with exact " +
         percent(f.confidence) +
         " intervals, and <span class=\"key-b\">share of all blocks that would move without friction with a factor "
         "below F</span>.</figcaption></figure>\n";
}

std::string pressure_table(const Figures& f) {
  if (f.pressures.empty()) return {};
  std::string out =
      "<section id=\"pressures\"><h2>Probability of support pressures</h2>\n<p class=\"small\">What has to be held, "
      "each passed force once: over the area of the excavations, and on a block of the first batch over its own free "
      "area (slivers included).</p>\n";
  out += html_table({{"pressure_pa", "Pressure above (kPa)"},
                     {"probability", "Over the area"},
                     {"low", "Exact interval from"},
                     {"high", "to"},
                     {"block_probability", "On a block"},
                     {"block_low", "Exact interval from"},
                     {"block_high", "to"}},
                    stochastic::PressureExceedance{}, f.pressures);
  return out + "</section>\n";
}

std::string chainage_figure(const MonteCarloPage& page) {
  const Figures& f = page.result.figures;
  if (!page.tunnel_length_m) return {};
  std::string out;
  for (const auto& e : f.exceedances) {
    if (e.by_chainage.empty() || e.realizations == 0) continue;
    double high = 0;
    for (const auto& i : e.by_chainage_interval) high = std::max(high, i.high);
    Plot plot{Axis{0, *page.tunnel_length_m, false, "chainage (m)"},
              detail::from_zero(high, "P(key block above " + display(e.volume_m3) + " m³)"), "Probability by chainage"};
    const double part = *page.tunnel_length_m / static_cast<double>(e.by_chainage.size());
    for (std::size_t i = 0; i < e.by_chainage.size(); ++i) {
      const double from = part * static_cast<double>(i);
      plot.bar(from, from + part, e.by_chainage[i]);
      plot.whisker(from + part / 2, e.by_chainage_interval[i].low, e.by_chainage_interval[i].high);
    }
    out += "<figure>" + std::move(plot).svg() + "<figcaption>Key blocks above " + display(e.volume_m3) +
           " m³ along the first tunnel: probability that one has its centroid in each part.</figcaption></figure>\n";
  }
  return out;
}

/// A quantity with what a reader wants to know of its estimate.
struct EstimateRow {
  const Estimate& e;
  double confidence = 0;
};
template <class V>
void fields(V& v, const EstimateRow& x) {
  const Estimate& e = x.e;
  const bool ratio = e.method == stochastic::Method::ratio;
  std::string range = interval(e.low, e.high);
  if (e.optimistic) {
    range += e.bootstrap ? "; bootstrap " + interval(e.bootstrap->low, e.bootstrap->high) : "";
    range += e.estimable ? " (optimistic)" : " (no mean to be had: see quantiles)";
  }
  v("name", words(e.name));
  v("interval", Html{range});
  v("spread", ratio ? Html{"–"} : Html{display(e.std, 3)});
  v("range", ratio ? Html{"–"} : Html{interval(e.smallest, e.largest)});
  v("kind", words(std::string{stochastic::name_of(e.method)}));
  quantity_fields(v, e, x.confidence);
}

std::string estimates_table(const Figures& f) {
  const Estimate none{};
  const std::string interval_heading = percent(f.confidence) + " interval";
  HtmlTable table{{{"name", "Quantity"},
                   {"mean"},
                   {"standard_error", {}, 3},
                   {"interval", interval_heading},
                   {"spread", "Standard deviation"},
                   {"range", "Smallest … largest"},
                   {"kind"}},
                  EstimateRow{none}};
  for (const Estimate& e : f.estimates) table.add(EstimateRow{e, f.confidence});
  return "<section id=\"estimates\"><h2>Estimates</h2>\n<p class=\"small\">The sample size is the number of "
         "realizations, not of blocks. “ratio”: sum over all realizations over sum over all realizations, delta "
         "method.</p>\n" +
         std::move(table).html() + "</section>\n";
}

std::string probability_table(const Figures& f) {
  if (f.exceedances.empty()) return {};
  return "<section id=\"probability\"><h2>Probability of large key blocks</h2>\n" +
         html_table({{"volume_m3", "Volume above (m³)"},
                     {"realizations", "Realizations with one"},
                     {"probability"},
                     {"low", "Exact interval from"},
                     {"high", "to"},
                     {"number", "Mean number"},
                     {"number_standard_error", "±", 2},
                     {"per_metre", "Number per metre of tunnel"},
                     {"per_metre_standard_error", "±", 2}},
                    stochastic::Exceedance{}, f.exceedances) +
         "</section>\n";
}

std::string orders_table(const MonteCarloPage& page) {
  const Figures& f = page.result.figures;
  if (f.orders.empty()) return {};
  std::string out =
      "<section id=\"orders\"><h2>Orders of excavation</h2>\n<p class=\"small\">Each realization is excavated in every "
      "order: differences are paired, on the same rock.</p>\n";
  const auto mean = [](const Estimate& e) { return Html{display(e.mean) + " ± " + display(e.standard_error, 2)}; };
  const auto row = [&](auto& v, const stochastic::OrderFigures& order, std::size_t i) {
    const Estimate& difference = order.key_m3_minus_first;
    v("stages", page.orders.at(i));
    v("key_blocks", mean(order.key_blocks));
    v("key_volume_m3", mean(order.key_m3));
    v("key_volume_minus_first_m3", i == 0 ? std::nullopt : std::optional{difference.mean});
    v("interval", i == 0 ? std::nullopt : std::optional{interval(difference.low, difference.high)});
    v("share_best", Html{percent(order.share_best)});
  };
  return out +
         html_table({{.name = "stages", .kind = "wide"},
                     {"key_blocks"},
                     {"key_volume_m3", "Their volume (m³)"},
                     {"key_volume_minus_first_m3", "Volume minus the first order’s"},
                     {"interval"},
                     {"share_best", "Best in"}},
                    each(f.orders, row)) +
         "</section>\n";
}

/// Roof, walls, floor and all other faces, with what leaves there and what it asks for.
std::string parts_table(const Figures& f) {
  constexpr std::array<std::string_view, 4> parts{"roof", "walls", "floor", "faces"};
  const auto row = [&](auto& v, std::string_view part) {
    const auto of = [&](const std::string& name) {
      const auto it = std::ranges::find(f.estimates, name, &Estimate::name);
      return it == f.estimates.end() ? std::nullopt : std::optional{*it};
    };
    const auto quantile = [&](double p) {
      const auto it = std::ranges::find_if(f.quantiles, [&](const stochastic::QuantileEstimate& q) {
        return q.p == p && q.name == fmt::format("required_pressure_{}_pa", part);
      });
      return it == f.quantiles.end() ? std::nullopt : std::optional{it->value / 1e3};
    };
    const auto probability = of(fmt::format("probability_of_failure_{}", part));
    const auto volume = of(fmt::format("key_block_volume_{}_m3", part));
    v("part", part);
    v("probability", probability ? std::optional{probability->mean} : std::nullopt);
    v("range", probability ? std::optional{interval(probability->low, probability->high)} : std::nullopt);
    v("volume_m3", volume ? std::optional{volume->mean} : std::nullopt);
    v("p50", quantile(0.5));
    v("p90", quantile(0.9));
  };
  const auto known =
      std::ranges::any_of(f.estimates, [](const Estimate& e) { return e.name == "probability_of_failure_roof"; });
  if (!known) return {};
  return "<section id=\"parts\"><h2>Where blocks leave</h2>\n<p class=\"small\">By the widest free face of a block. "
         "Required pressure: what 95 % of the free area of the blocks below their target there needs no more than, in "
         "half of the realizations and in nine of ten.</p>\n" +
         html_table({{"part", "Part"},
                     {"probability", "Probability of a key block"},
                     {"range", percent(f.confidence) + " interval"},
                     {"volume_m3", "Their mean volume (m³)"},
                     {.name = "p50", .heading = "Required pressure, median (kPa)", .optional = true},
                     {.name = "p90", .heading = "90 % (kPa)", .optional = true}},
                    each(parts, row)) +
         "</section>\n";
}

/// The base case and each load case, with what its estimates tell of failure.
std::string cases_table(const Figures& f) {
  if (f.cases.empty()) return {};
  const std::string confidence = percent(f.confidence) + " interval";
  std::vector<stochastic::CaseEstimates> rows{{"base case", f.estimates}};
  rows.insert(rows.end(), f.cases.begin(), f.cases.end());
  const auto row = [](auto& v, const stochastic::CaseEstimates& c) {
    const auto of = [&](std::string_view name) {
      const auto it = std::ranges::find(c.estimates, name, &Estimate::name);
      return it == c.estimates.end() ? std::nullopt : std::optional{*it};
    };
    const auto mean = [&](std::string_view name) {
      const auto e = of(name);
      return e ? std::optional{e->mean} : std::nullopt;
    };
    const auto range = [&](std::string_view name) {
      const auto e = of(name);
      return e ? std::optional{interval(e->low, e->high)} : std::nullopt;
    };
    v("name", c.name);
    v("probability", mean("probability_of_failure"));
    v("probability_interval", range("probability_of_failure"));
    v("count", mean("key_block_count"));
    v("volume_m3", mean("key_block_volume_m3"));
    v("volume_interval", range("key_block_volume_m3"));
    v("support_fails", mean("support_fails"));
    v("support_interval", range("support_fails"));
  };
  return "<section id=\"load-cases\"><h2>Load cases</h2>\n<p class=\"small\">The same realizations under each "
         "load. All quantities: summary.json.</p>\n" +
         html_table({{"name", "Case"},
                     {"probability", "Probability of a key block"},
                     {"probability_interval", confidence},
                     {"count", "Key blocks"},
                     {"volume_m3", "Their volume (m³)"},
                     {"volume_interval", confidence},
                     {.name = "support_fails", .heading = "Probability that the support fails", .optional = true},
                     {.name = "support_interval", .heading = confidence, .optional = true}},
                    each(rows, row)) +
         "</section>\n";
}

std::string variances_table(const Figures& f) {
  if (f.variances.empty()) return {};
  std::string out =
      "<section id=\"variances\"><h2>Where the spread comes from</h2>\n<p class=\"small\">Nested design, " +
      display_count(f.strengths_per_geometry) +
      " draws of strengths and loads for each geometry. The standard error of a mean over n geometries is √((geometry "
      "+ "
      "strength/" +
      display_count(f.strengths_per_geometry) + ")/n).</p>\n";
  const auto row = [](auto& v, const stochastic::VarianceShare& x) {
    v("quantity", words(x.name));
    v("geometry", std::sqrt(x.geometry));
    v("strength", std::sqrt(x.strength));
  };
  return out +
         html_table({{.name = "quantity", .kind = "wide"},
                     {"geometry", "Standard deviation between geometries", 3},
                     {"strength", "between strengths of one geometry", 3}},
                    each(f.variances, row)) +
         "</section>\n";
}

std::string quantile_table(const Figures& f) {
  if (f.quantiles.empty()) return {};
  HtmlTable table{{{"quantity"}, {"p"}, {"value"}, {"low", "Interval from"}, {"high", "to"}, {"reason", " "}},
                  stochastic::QuantileEstimate{}};
  for (stochastic::QuantileEstimate q : f.quantiles) {
    q.name = words(q.name);
    table.add(q);
  }
  return "<section id=\"quantiles\"><h2>Quantiles</h2>\n<p class=\"small\">By order statistics: no law is "
         "assumed.</p>" +
         std::move(table).html() + "</section>\n";
}

std::string extremes_section(const Figures& f) {
  if (f.worst.empty()) return {};
  std::string out =
      "<section id=\"extremes\"><h2>Worst and best realizations</h2>\n<p class=\"small\">Scenes to look at, not "
      "bounds: "
      "<code>cleave replay OUT --realization K</code> makes any of them again as a full run.</p>\n<div "
      "class=\"columns\">";
  for (const auto& [name, rows] : {std::pair{"Worst", &f.worst}, std::pair{"Best", &f.best}}) {
    out += html_table({{"realization", name}, {"key_block_volume_m3"}, {"key_block_count", "Key blocks"}},
                      stochastic::Extreme{}, *rows);
  }
  return out + "</div></section>\n";
}

std::string notes_section(const MonteCarloPage& page) {
  std::string items;
  for (const std::string& note : page.notes) items += "<li>" + escape_xml(note) + "</li>\n";
  if (items.empty()) return {};
  return "<section id=\"notes\"><h2>Notes</h2>\n<ul>\n" + items + "</ul></section>\n";
}

std::string inputs_section(const MonteCarloPage& page) {
  const auto row = [](std::string_view name, const std::string& value) { return detail::fact(name, value, "wide"); };
  std::string out = detail::input_rows("Scene", page.scene_file, page.scene_sha256, page.files, page.seed);
  for (const scene::ExcavationFigures& e : page.excavations) {
    out += row(
        "Excavation",
        escape_xml(e.name) + ", " + display(e.volume.si(), 4) + " m³" +
            (e.outside_share.value_or(0) > 0 ? ", " + percent(*e.outside_share) + " of it outside the domain" : ""));
  }
  out += row("Hash of the records", "<code>" + escape_xml(page.result.figures.hash) + "</code>");
  constexpr std::array<std::string_view, 6> limits{
      "Blocks are rigid. Joints are flat, have the Coulomb (or Barton–Bandis) strengths of the scene and no stiffness.",
      "A block is judged by limit equilibrium of its own translation, in the state after the batches before it; what "
      "only moves together with others (key groups) is not counted.",
      "Intervals tell how far the mean of the realizations is known. That the laws of joints and strengths are right "
      "is taken for granted.",
      "In-situ stress counts only in figures whose name ends with “clamped”.",
      "Sides of the domain that are not free hold what touches them.",
      "Earthquakes are static forces; blasting, creep, weathering and loss of strength with movement are not counted."};
  return detail::inputs_section(out, limits);
}

std::string stages_table(const MonteCarloPage& page) {
  if (page.result.stages.empty()) return {};
  double all = 0;
  for (const scene::StepSeconds& row : page.result.stages) all += row.seconds;
  std::string out =
      "<section id=\"stages\"><h2>Cost of the realizations by stage</h2>\n<p class=\"small\">Of those made by this "
      "run, over all threads.</p>\n";
  const auto shown = [&](auto& v, const scene::StepSeconds& row) {
    fields(v, row);
    v("share", all > 0 ? row.seconds / all : 0);
  };
  return out +
         html_table({{"stage"}, {"thread_s", "Seconds of a thread", 3}, {"share"}}, each(page.result.stages, shown)) +
         "</section>\n";
}

}  // namespace

std::string monte_carlo_html(const MonteCarloPage& page) {
  const Figures& f = page.result.figures;
  const std::string title = escape_xml(page.title.empty() ? "cleave report" : page.title);
  std::string shard;
  if (page.result.shard.of > 1) {
    shard = " · part " + std::to_string(page.result.shard.number) + " of " + std::to_string(page.result.shard.of) +
            ": merge all parts before you use the figures";
  }
  std::string out = detail::page_begin(title, detail::project_line(page.project) + escape_xml(page.scene_file) +
                                                  " · Monte Carlo, seed " + std::to_string(page.seed) + shard);
  out += cards(page);
  const std::string figures = running_figure(f) + detail::block_size_figure(f) + size_figure(f) + exceedance_figure(f) +
                              factor_figure(f) + chainage_figure(page);
  if (!figures.empty()) {
    out += "<section id=\"figures\"><h2>Convergence, sizes, probabilities</h2>\n<div class=\"columns\">" + figures +
           "</div></section>\n";
  }
  out += detail::block_size_tables(f);
  out += detail::sets_table(f);
  out += detail::lines_table(f);
  out += detail::percolation_table(f);
  out += probability_table(f);
  out += pressure_table(f);
  out += parts_table(f);
  out += cases_table(f);
  out += orders_table(page);
  out += estimates_table(f);
  out += variances_table(f);
  out += quantile_table(f);
  out += extremes_section(f);
  out += notes_section(page);
  out += detail::plan_section(page.plan);
  out += detail::cost_section(page.cost);
  out += stages_table(page);
  out += inputs_section(page);
  return out + detail::page_foot() + std::string{detail::page_end};
}

}  // namespace cleave::report
