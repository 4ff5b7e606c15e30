#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "cleave/core/version.hpp"
#include "cleave/exchange/json_fields.hpp"
#include "cleave/realize/monte_carlo.hpp"
#include "cleave/report/write.hpp"
#include "cleave/stochastic/paired.hpp"
#include "cleave/stochastic/record.hpp"
#include "commands.hpp"
#include "monte_carlo_folder.hpp"
#include "problems.hpp"

namespace cleave::cli {
namespace {

namespace fs = std::filesystem;
using stochastic::PairedEstimate;
using stochastic::Record;

ExitCode wrong(const std::string& folder, const std::string& what) {
  print_error(fmt::format("{}:1: OUT: {}", folder, what));
  return ExitCode::wrong_input;
}

/// The records of a finished run one by one, never all of them.
class Records final {
 public:
  explicit Records(const std::string& folder) : file_{fs::path{folder} / records_name, std::ios::binary} {
    std::string ignored;
    std::getline(file_, ignored);
    std::getline(file_, ignored);
  }
  [[nodiscard]] std::optional<Record> next() {
    std::string line;
    return std::getline(file_, line) ? stochastic::record_of(line) : std::nullopt;
  }

 private:
  std::ifstream file_;
};

std::string text_of(const std::vector<PairedEstimate>& rows) {
  std::string text = fmt::format("{:<40} {:>12} {:>12} {:>12} {:>11}  {:<26} {:>7}\n", "quantity", "first", "second",
                                 "difference", "error", "interval", "gain");
  for (const PairedEstimate& r : rows) {
    const std::string interval = std::isfinite(r.interval.high)
                                     ? fmt::format("[{:.4g}, {:.4g}]", r.interval.low, r.interval.high)
                                     : std::string{"no pair differs"};
    text += fmt::format("{:<40} {:>12.5g} {:>12.5g} {:>12.4g} {:>11.3g}  {}{:>{}}\n", r.name, r.first, r.second,
                        r.difference, r.standard_error, interval,
                        r.gain ? fmt::format("{:.3g}", *r.gain) : std::string{"-"}, 8);
  }
  return text;
}

std::string json_of(const std::vector<PairedEstimate>& rows, const std::string& first, const std::string& second,
                    double confidence, const std::vector<std::string>& notes) {
  report::JsonWriter json;
  report::JsonFields{json}.put(group([&](auto& v) {
    v("cleave", CLEAVE_VERSION);
    v("first", first);
    v("second", second);
    v("confidence", confidence);
    v("quantities", by_name(rows, &PairedEstimate::name, [](auto& q, const PairedEstimate& r) {
        q("pairs", r.pairs);
        q("first", r.first);
        q("second", r.second);
        q("difference", r.difference);
        q("standard_error", r.standard_error);
        q("low", or_null(r.interval.low));
        q("high", or_null(r.interval.high));
        q("correlation", r.correlation);
        q("gain", r.gain);
      }));
    v("notes", notes);
  }));
  return std::move(json).finish();
}

}  // namespace

ExitCode compare_results(const std::string& first, const std::string& second, const std::string& out) {
  std::uint64_t group = 0, seed = 0;
  double confidence = 0.95;
  for (const std::string* folder : {&first, &second}) {
    std::error_code ignored;
    if (!fs::exists(fs::path{*folder} / records_name, ignored)) {
      return wrong(*folder, "is no finished Monte Carlo result: it holds no realizations.csv; name the folder of one");
    }
    const auto identity = stochastic::read_records(fs::path{*folder} / records_name,
                                                   [](const Record&, std::string_view) { return true; });
    if (!identity) return wrong(*folder, "realizations.csv: " + describe(identity.error()));
    if (identity->shard.of > 1) return wrong(*folder, "is a shard; merge the parts first (cleave merge)");
    auto scene = load_copied_scene(*folder);
    if (!scene) return report_problems(scene.error());
    if (folder == &first) {
      group = strengths_per_geometry(*scene);
      seed = identity->seed;
      confidence = scene->monte_carlo ? scene->monte_carlo->confidence : confidence;
    } else if (identity->seed != seed) {
      return wrong(*folder,
                   fmt::format("has the seed {}, {} has {}: designs are compared on common random numbers; run "
                               "one of them with --seed of the other",
                               identity->seed, first, seed));
    } else if (strengths_per_geometry(*scene) != group) {
      return wrong(*folder, "has another strengths_per_geometry; give both scenes the same");
    }
  }
  stochastic::PairedComparison pairs{group};
  Records a{first}, b{second};
  std::uint64_t only_one = 0;
  for (;;) {
    const auto left = a.next(), right = b.next();
    if (!left && !right) break;
    if (!left || !right) {
      ++only_one;
    } else {
      pairs.add(*left, *right);
    }
  }
  const auto rows = pairs.estimates(confidence);
  if (rows.empty()) return wrong(second, "fewer than two realizations are in both; run more");
  std::vector<std::string> notes;
  if (only_one > 0)
    notes.push_back(fmt::format("{} realizations are in one of the two only and are left out", only_one));
  if (pairs.left_out() > 0) {
    notes.push_back(
        fmt::format("{} realizations could not be done in one of the two and are left out", pairs.left_out()));
  }
  if (pairs.other_joints() > 0) {
    notes.push_back(fmt::format("in {} realizations the two do not have as many joints: they are not the same rock",
                                pairs.other_joints()));
  }
  std::string text = fmt::format(
                         "{}\n{}\n{} pairs, {:g} % intervals of second - first; gain: so many times fewer "
                         "realizations than with independent random numbers\n",
                         first, second, rows.front().pairs, 100 * confidence) +
                     text_of(rows);
  for (const std::string& note : notes) text += "note: " + note + "\n";
  if (!out.empty()) {
    if (const auto written = report::write_file(out, json_of(rows, first, second, confidence, notes)); !written) {
      print_error(describe(written.error()));
      return ExitCode::machine_failed;
    }
    text += fmt::format("written to {}\n", out);
  }
  print(text);
  return ExitCode::done;
}

}  // namespace cleave::cli
