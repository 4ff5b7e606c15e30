/// Study "monte_carlo": half width of the 95 % interval against run time. Problems are quantities of a tunnel in three
/// random sets (three estimates of one design), and the difference of two designs (friction 24 and 28 degrees).
/// Methods: `plain`; for the difference `independent` (another seed for the second design) and `common` (the same
/// random numbers: streams are keyed, so the second design sees the same joints); for a random seismic coefficient
/// `antithetic` (pairs u, 1 - u of its quantile) and `stratified` (eight strata) beside `plain`, on the scene of random
/// joints (`seismic_random_rock`: support force, where the rock decides and neither helps) and on one rock for all
/// (`seismic_fixed_rock`, where both do). `error` is the relative half width, `condition` the coefficient of variation
/// of what is averaged. Antithetic joints would need a response that rises with every number drawn; key blocks do not.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "cleave/core/rng.hpp"
#include "cleave/realize/monte_carlo.hpp"
#include "cleave/scene3d/scene.hpp"
#include "cleave/stochastic/statistics.hpp"
#include "study.hpp"

namespace cleave {
namespace {

scene::Scene scene_of(double friction, std::uint64_t seed, const std::string& more = "") {
  std::string text = fmt::format(
      "schema = 1\nseed = {}\n[domain]\nbox = {{ min = [0, 0, 0], max = [24, 16, 24] }}\n[joints.default]\nfriction = "
      "{}\n[[excavation]]\nname = \"t\"\nkind = \"tunnel\"\nsection = {{ shape = \"horseshoe\", width = 6, height = 6 "
      "}}\n"
      "axis = [[12, 0, 12], [12, 16, 12]]\n[output]\nblocks = \"key\"\n[monte_carlo]\nrealizations = 1\n",
      seed, friction);
  text += more;
  const std::vector<std::pair<int, int>> orientations{{30, 30}, {60, 150}, {70, 270}};
  for (const auto& [dip, direction] : orientations) {
    text += fmt::format(
        "[[joint_set]]\nname = \"S{0}\"\nshape = \"disc\"\nintensity = {{ p32 = 0.25 }}\norientation = {{ dip = {0}, "
        "dip_direction = {1}, distribution = \"fisher\", kappa = 40 }}\nsize = {{ distribution = \"lognormal\", mean = "
        "15, "
        "std = 6, min = 2, max = 40 }}\n",
        dip, direction);
  }
  auto scene = scene::parse(text, "study", [](const std::string&) {
    return std::expected<scene::LoadedFile, scene::FileRefusal>{std::unexpect, "no files here", ""};
  });
  if (!scene) std::abort();
  return *std::move(scene);
}

struct Curve {
  study::Study& study;
  std::string problem, method;
  study::Cost spent = {};
  stochastic::Moments moments = {};
  std::vector<std::pair<double, double>> points = {};  ///< relative half widths against time
  std::vector<std::pair<double, double>> widths = {};  ///< half widths themselves: a difference may be next to nothing

  /// After `moments.count()` realizations.
  void look() {
    const auto n = moments.count();
    const double half = moments.mean() - stochastic::t_interval(moments.mean(), moments.standard_error(), n, 0.95).low;
    const double relative = half / std::abs(moments.mean());
    const bool known = std::isfinite(relative);
    study.add({.problem = problem,
               .method = method,
               .setting = fmt::format("n={}", n),
               .error = known ? std::optional{relative} : std::nullopt,
               .cost = spent,
               .condition = known ? std::optional{moments.std() / std::abs(moments.mean())} : std::nullopt,
               .status = known ? study::Status::converged : study::Status::stopped});
    if (known) points.emplace_back(spent.cpu_s, relative);
    widths.emplace_back(spent.cpu_s, half);
  }
};

/// Random seismic coefficient: its quantile plain, in pairs, in strata. The unit that is averaged is the realization,
/// the pair, the round of all strata.
void study_seismic(study::Study& study, bool fixed_rock, std::vector<study::Series>& series) {
  const std::uint64_t most = study.quick() ? 16 : 512;
  constexpr std::uint64_t strata = 8;
  scene::Scene scene = scene_of(28, 1, "[stability]\nseismic = [0.15, 0, 0]\n");
  const scene::Shared shared = shared_by_realizations(scene);
  // A rock in which more blocks fall the harder it shakes: below that the support force is a straight line.
  std::uint64_t rock = 0;
  const auto key_blocks = [&](double factor) {
    scene.monte_carlo->seismic_factor.mean = factor;
    return make_record(scene, shared, rock).all.count;
  };
  while (fixed_rock && rock < 300 && (key_blocks(0.2) == 0 || key_blocks(0.2) == key_blocks(1.8))) ++rock;
  const std::string problem = fixed_rock ? "seismic_fixed_rock" : "seismic_random_rock";
  struct Variant {
    const char* method;
    std::uint64_t size;  // realizations of a unit
  };
  for (const auto& [method, size] : {Variant{"plain", 1}, Variant{"antithetic", 2}, Variant{"stratified", strata}}) {
    Curve curve{study, problem, method};
    double sum = 0, u = 0;
    std::uint64_t next = 8;
    for (std::uint64_t k = 0; k < most; ++k) {
      Rng rng{{.seed = 1, .realization = k, .purpose = 0xfffffff0U, .index = 0}};
      const std::uint64_t part = k % size;
      if (size == 2) {
        u = part == 0 ? rng.uniform() : 1 - u;
      } else {
        u = (static_cast<double>(part) + rng.uniform()) / static_cast<double>(size);
      }
      // Factors from 0 to 2, as [monte_carlo] seismic_factor would draw them.
      scene.monte_carlo->seismic_factor.mean = 2 * u;
      stochastic::Record record;
      const study::Cost cost = study.measure([&] { record = make_record(scene, shared, fixed_rock ? rock : k); }, 0, 1);
      curve.spent.wall_s += cost.wall_s;
      curve.spent.cpu_s += cost.cpu_s;
      curve.spent.peak_mb = std::max(curve.spent.peak_mb, cost.peak_mb);
      sum += record.all.support_n;
      if (part + 1 < size) continue;
      curve.moments.add(sum / static_cast<double>(size));
      sum = 0;
      if (k + 1 >= next && curve.moments.count() >= 8) {  // fewer pairs may agree by chance
        curve.look();
        next *= 2;
      }
    }
    series.push_back({.name = problem.substr(8) + ", " + method, .points = curve.points, .line = true, .fit = true});
  }
}

void study_monte_carlo(study::Study& study) {
  const std::uint64_t most = study.quick() ? 16 : 512;
  const scene::Scene weak = scene_of(24, 1), strong = scene_of(28, 1), other = scene_of(28, 2);
  const scene::Shared shared = shared_by_realizations(weak);
  using stochastic::Record;
  const std::vector<std::pair<std::string, double (*)(const Record&)>> quantities{
      {"key_block_volume", [](const Record& r) { return r.all.volume_m3; }},
      {"key_block_count", [](const Record& r) { return static_cast<double>(r.all.count); }},
      {"key_block_above_1m3", [](const Record& r) { return r.above.at(1) > 0 ? 1.0 : 0.0; }}};
  std::vector<Curve> curves;
  for (const auto& [name, of] : quantities) curves.push_back({study, name, "plain"});
  Curve common{study, "difference_of_designs", "common"}, independent{study, "difference_of_designs", "independent"};
  std::uint64_t next = 8;
  for (std::uint64_t k = 0; k < most; ++k) {
    Record a, b, c;
    const auto timed = [&](Record& record, const scene::Scene& scene) {
      return study.measure([&] { record = make_record(scene, shared, k); }, 0, 1);
    };
    const auto spend = [](Curve& curve, const study::Cost& cost) {
      curve.spent.wall_s += cost.wall_s;
      curve.spent.cpu_s += cost.cpu_s;
      curve.spent.peak_mb = std::max(curve.spent.peak_mb, cost.peak_mb);
    };
    const study::Cost first = timed(a, weak), second = timed(b, strong), third = timed(c, other);
    for (std::size_t i = 0; i < curves.size(); ++i) {
      curves[i].moments.add(quantities[i].second(a));
      spend(curves[i], first);
    }
    common.moments.add(a.all.volume_m3 - b.all.volume_m3);
    spend(common, first);
    spend(common, second);
    independent.moments.add(a.all.volume_m3 - c.all.volume_m3);
    spend(independent, first);
    spend(independent, third);
    if (k + 1 == next) {
      for (Curve& curve : curves) curve.look();
      common.look();
      independent.look();
      next *= 2;
    }
  }
  std::vector<study::Series> series;
  for (const Curve& curve : curves)
    series.push_back({.name = curve.problem, .points = curve.points, .line = true, .fit = true});
  study.plot("half_width", {.title = "half width of the 95 % interval against time",
                            .x_label = "processor time (s)",
                            .y_label = "relative half width",
                            .series = std::move(series)});
  study.plot("designs", {.title = "difference of two designs: common random numbers",
                         .x_label = "processor time (s)",
                         .y_label = "half width (m3)",
                         .series = {{.name = "common", .points = common.widths, .line = true, .fit = true},
                                    {.name = "independent", .points = independent.widths, .line = true, .fit = true}}});
  std::vector<study::Series> variants;
  study_seismic(study, false, variants);
  study_seismic(study, true, variants);
  study.plot("seismic", {.title = "random seismic coefficient: antithetic and stratified draws",
                         .x_label = "processor time (s)",
                         .y_label = "relative half width",
                         .series = std::move(variants)});
}

}  // namespace
}  // namespace cleave

int main(int argc, char** argv) { return cleave::study::run("monte_carlo", argc, argv, cleave::study_monte_carlo); }
