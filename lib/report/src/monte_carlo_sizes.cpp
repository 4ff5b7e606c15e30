#include "monte_carlo_parts.hpp"

#include <optional>
#include <utility>
#include <vector>

#include "html_table.hpp"
#include "plot.hpp"

namespace cleave::report::detail {
namespace {

using stochastic::Estimate;
using stochastic::Figures;

Html mean_of(const Estimate& e) { return Html{display(e.mean) + " [" + interval(e.low, e.high) + "]"}; }

}  // namespace

std::string block_size_figure(const Figures& f) {
  if (!f.block_sizes || f.block_sizes->curve.size() < 2) return {};
  const std::vector<stochastic::SizeShare>& curve = f.block_sizes->curve;
  Plot plot{decades(curve.front().volume.si(), curve.back().volume.si(), "block volume V (m³)"),
            Axis{0, 1, false, "share below V"}, "Size distribution of the blocks"};
  const auto line = [&](auto share) {
    std::vector<PlotPoint> points;
    for (const stochastic::SizeShare& p : curve) points.push_back({p.volume.si(), share(p)});
    return points;
  };
  using Point = const stochastic::SizeShare&;
  plot.band(line([](Point p) { return p.by_volume_interval.low; }),
            line([](Point p) { return p.by_volume_interval.high; }));
  plot.line(line([](Point p) { return p.by_volume; }));
  plot.line(line([](Point p) { return p.by_number; }), LineStyle::dashed);
  return "<figure>" + std::move(plot).svg() +
         "<figcaption>Share of the blocks’ <span class=\"key-a\">volume</span> (in-situ block size distribution, with "
         "its " +
         percent(f.confidence) +
         " band) and of their <span class=\"key-b\">number</span> in blocks smaller than V.</figcaption></figure>\n";
}

std::string block_size_tables(const Figures& f) {
  if (!f.block_sizes) return {};
  const stochastic::BlockSizeFigures& sizes = *f.block_sizes;
  const auto end = [](std::optional<double> x) { return x ? display(*x) : std::string{"–"}; };
  const auto volume = [&](const stochastic::SizeLevel& level) {
    return Html{display(level.volume_m3) + " [" + end(level.low) + " … " + end(level.high) + "]"};
  };
  const auto row = [&](auto& v, const stochastic::SizeLevel& level, std::size_t i) {
    v("p", Html{percent(level.p)});
    v("number", volume(level));
    v("volume", volume(i < sizes.by_volume.size() ? sizes.by_volume[i] : level));
  };
  std::string out =
      "<section id=\"block-sizes\"><h2>Block sizes</h2>\n<p class=\"small\">" + display_count(sizes.blocks) +
      " blocks that touch no fixed side of the domain, " + percent(sizes.met_share.mean) + " of the rock. " +
      (sizes.corrected ? "Each counts as often as blocks of its extents are cut by the sides for one that is not."
                       : "Large blocks touch a side more often and are too rare here: only in a box without openings "
                         "and free sides is it known by how much.") +
      " Mean volume " + display(sizes.mean_volume.mean) + " [" +
      interval(sizes.mean_volume.low, sizes.mean_volume.high) + "] m³.</p>\n<div class=\"columns\">";
  out += html_table({{"p", "Share below"}, {"number", "Volume (m³), by number"}, {"volume", "by volume"}},
                    each(sizes.by_number, row));
  const auto shape = [](auto& v, const Estimate& e) {
    v("shape", e.name);
    v("share", Html{percent(e.mean) + " [" + percent(e.low) + " … " + percent(e.high) + "]"});
  };
  out += html_table({{"shape", "Shape (Zingg)"}, {"share", "Share of the number"}}, each(sizes.shapes, shape));
  return out + "</div></section>\n";
}

std::string sets_table(const Figures& f) {
  if (f.sets.empty()) return {};
  const auto row = [](auto& v, const stochastic::SetEstimates& set) {
    v("name", set.name);
    v("joints", mean_of(set.joints));
    v("p32", mean_of(set.p32));
    v("p10", mean_of(set.p10));
    v("p21", mean_of(set.p21));
  };
  return "<section id=\"sets\"><h2>Joint sets as drawn</h2>\n<p class=\"small\">Means over realizations. Volumetric "
         "joint count Jv " +
         (f.jv ? display(f.jv->mean) + " [" + interval(f.jv->low, f.jv->high) + "] 1/m" : std::string{"–"}) +
         ".</p>\n" +
         html_table({{.name = "name", .heading = "Set", .kind = "wide"},
                     {"joints"},
                     {"p32", "P32 (1/m)"},
                     {"p10", "P10 along the normal (1/m)"},
                     {"p21", "P21 on level planes (1/m)"}},
                    each(f.sets, row)) +
         "</section>\n";
}

std::string lines_table(const Figures& f) {
  if (f.lines.empty()) return {};
  const auto row = [](auto& v, const stochastic::LineEstimates& line) {
    v("name", line.name);
    v("frequency", mean_of(line.frequency));
    v("rqd", mean_of(line.rqd));
    v("spread", line.rqd.std);
  };
  return "<section id=\"lines\"><h2>Scanlines</h2>\n" +
         html_table({{.name = "name", .heading = "Line", .kind = "wide"},
                     {"frequency", "Joints per m"},
                     {"rqd", "RQD (%)"},
                     {"spread", "Its standard deviation between realizations", 3}},
                    each(f.lines, row)) +
         "</section>\n";
}

std::string percolation_table(const Figures& f) {
  if (f.percolation.empty()) return {};
  const auto row = [](auto& v, const stochastic::Percolation& pair) {
    v("from", pair.from);
    v("to", pair.to);
    v("share",
      Html{percent(pair.probability) + " [" + percent(pair.interval.low) + " … " + percent(pair.interval.high) + "]"});
  };
  return "<section id=\"percolation\"><h2>Joints from side to side</h2>\n<p class=\"small\">Share of the realizations "
         "in which joints that hang together reach both sides of the domain.</p>\n" +
         html_table({{.name = "from", .heading = "From", .kind = "wide"},
                     {.name = "to", .heading = "To", .kind = "wide"},
                     {"share", "Share of the realizations"}},
                    each(f.percolation, row)) +
         "</section>\n";
}

}  // namespace cleave::report::detail
