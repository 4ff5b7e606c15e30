#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <expected>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "cleave/core/expected.hpp"
#include "cleave/core/version.hpp"
#include "cleave/exchange/json_fields.hpp"
#include "cleave/realize/monte_carlo.hpp"
#include "cleave/realize/run.hpp"
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

/// A load case that both scenes have, by its name.
struct SameCase {
  std::string name;
  std::size_t in_first, in_second;  ///< numbers in the records
  stochastic::PairedComparison pairs;
  std::vector<PairedEstimate> rows = {};
};

std::vector<SameCase> same_cases(const scene::Scene& first, const scene::Scene& second, std::uint64_t unit) {
  std::vector<SameCase> same;
  if (!first.stability || !second.stability) return same;
  const auto& a = first.stability->cases;
  const auto& b = second.stability->cases;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto other = std::ranges::find(b, a[i].name, &scene::LoadCase::name);
    if (other == b.end()) continue;
    same.push_back({a[i].name, i, static_cast<std::size_t>(other - b.begin()), stochastic::PairedComparison{unit}});
  }
  return same;
}

constexpr auto quantity_fields = [](auto& q, const PairedEstimate& r) {
  q("pairs", r.pairs);
  q("first", r.first);
  q("second", r.second);
  q("difference", r.difference);
  q("standard_error", r.standard_error);
  q("low", or_null(r.interval.low));
  q("high", or_null(r.interval.high));
  q("correlation", r.correlation);
  q("gain", r.gain);
};

std::string json_of(const std::vector<PairedEstimate>& rows, const std::vector<SameCase>& cases,
                    const std::string& first, const std::string& second, double confidence,
                    const std::vector<std::string>& notes) {
  report::JsonWriter json;
  report::JsonFields{json}.put(group([&](auto& v) {
    v("cleave", CLEAVE_VERSION);
    v("first", first);
    v("second", second);
    v("confidence", confidence);
    v("quantities", by_name(rows, &PairedEstimate::name, quantity_fields));
    v("load_cases", by_name(cases, &SameCase::name, [](auto& c, const SameCase& under) {
        c("quantities", by_name(under.rows, &PairedEstimate::name, quantity_fields));
      }));
    v("notes", notes);
  }));
  return std::move(json).finish();
}

/// What two results must share, and what of them is compared.
struct Compared {
  scene::Scene one, other;
  std::uint64_t unit;
  double confidence;
  std::vector<SameCase> cases;
};

bool same_joint(const topology::Joint& a, const topology::Joint& b) {
  return std::ranges::equal(a.polygons, b.polygons,
                            [](const auto& p, const auto& q) { return std::ranges::equal(p.corners(), q.corners()); });
}
bool same_joint(const topology::PersistentJoint& a, const topology::PersistentJoint& b) {
  return a.through == b.through && a.normal == b.normal;
}

/// Whether the joints of a realization are the same; strengths may be others.
bool same_rock(const Compared& found, std::uint64_t realization) {
  const auto first = sample(found.one, realization), second = sample(found.other, realization);
  if (!first || !second) return true;  // said where it was run
  return std::ranges::equal(first->input.joints, second->input.joints, [](const auto& a, const auto& b) {
    return std::visit(
        [](const auto& x, const auto& y) {
          if constexpr (std::same_as<decltype(x), decltype(y)>) {
            return same_joint(x, y);
          } else {
            return false;
          }
        },
        a, b);
  });
}

/// The first joint set whose place in its scene another one has in the other.
std::string moved_set(const Compared& found) {
  const auto names = [](const scene::Scene& scene) {
    std::vector<std::string> all;
    for (const scene::RandomSet& set : scene.joint_sets) all.push_back(scene.sets[set.set].name);
    return all;
  };
  const auto first = names(found.one), second = names(found.other);
  for (std::size_t k = 0; k < first.size(); ++k) {
    const auto at = std::ranges::find(second, first[k]);
    if (at == second.end() || (k < second.size() && second[k] == first[k])) continue;
    return fmt::format(" ({} is [[joint_set]] {} in the first and {} in the second)", first[k], k + 1,
                       at - second.begin() + 1);
  }
  return {};
}

std::string note_on_rock(const Compared& found, std::uint64_t realization) {
  return fmt::format(
      "the joints of realization {} are not the same in both: they are not the same rock, and what differs is not of "
      "the designs alone; sets draw by their place among [[joint_set]]{}: give both scenes the same sets and domain, "
      "in the same order",
      realization, moved_set(found));
}

/// The scene of a result, with the seed it was run with.
std::expected<std::pair<scene::Scene, std::uint64_t>, ExitCode> design_of(const std::string& folder) {
  std::error_code ignored;
  const auto refused = [&](const std::string& what) { return std::unexpected(wrong(folder, what)); };
  if (!fs::exists(fs::path{folder} / records_name, ignored)) {
    return refused("is no finished Monte Carlo result: it holds no realizations.csv; name the folder of one");
  }
  const auto identity =
      stochastic::read_records(fs::path{folder} / records_name, [](const Record&, std::string_view) { return true; });
  if (!identity) return refused("realizations.csv: " + describe(identity.error()));
  if (identity->shard.of > 1) return refused("is a shard; merge the parts first (cleave merge)");
  auto scene = load_copied_scene(folder);
  if (!scene) return std::unexpected(report_problems(scene.error()));
  scene->seed = identity->seed;
  return std::pair{*std::move(scene), identity->seed};
}

std::expected<Compared, ExitCode> comparable(const std::string& first, const std::string& second) {
  CLEAVE_TRY(auto one, design_of(first));
  CLEAVE_TRY(auto other, design_of(second));
  const auto refused = [&](const std::string& what) { return std::unexpected(wrong(second, what)); };
  if (other.second != one.second) {
    return refused(
        fmt::format("has the seed {}, {} has {}: designs are compared on common random numbers; run one of them with "
                    "--seed of the other",
                    other.second, first, one.second));
  }
  const std::uint64_t unit = strengths_per_geometry(one.first);
  if (strengths_per_geometry(other.first) != unit) {
    return refused("has another strengths_per_geometry; give both scenes the same");
  }
  const double confidence = one.first.monte_carlo ? one.first.monte_carlo->confidence : 0.95;
  auto cases = same_cases(one.first, other.first, unit);
  return Compared{std::move(one.first), std::move(other.first), unit, confidence, std::move(cases)};
}

std::vector<std::string> notes_of(const stochastic::PairedComparison& pairs, std::uint64_t only_one,
                                  const std::string& first, const std::string& second) {
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
  const stochastic::PairedComparison::OnlyInOne only = pairs.only_in_one();
  for (const auto& [names, folder] : {std::pair{&only.first, &first}, {&only.second, &second}}) {
    if (names->empty()) continue;
    notes.push_back(
        fmt::format("only {} has {}: not compared. To see what bolts do give both scenes [support] with the same "
                    "`target`, one of them without bolts",
                    *folder, fmt::join(*names, ", ")));
  }
  return notes;
}

}  // namespace

ExitCode compare_results(const std::string& first, const std::string& second, const std::string& out) {
  auto found = comparable(first, second);
  if (!found) return found.error();
  stochastic::PairedComparison pairs{found->unit};
  Records a{first}, b{second};
  std::uint64_t only_one = 0;
  std::optional<std::uint64_t> first_pair;
  for (;;) {
    const auto left = a.next(), right = b.next();
    if (!left && !right) break;
    if (!left || !right) {
      ++only_one;
      continue;
    }
    pairs.add(*left, *right);
    if (left->outcome == stochastic::Outcome::done && right->outcome == stochastic::Outcome::done && !first_pair) {
      first_pair = left->realization;
    }
    for (SameCase& under : found->cases) {
      under.pairs.add(under_case(*left, under.in_first), under_case(*right, under.in_second));
    }
  }
  const auto rows = pairs.estimates(found->confidence);
  if (rows.empty()) return wrong(second, "fewer than two realizations are in both; run more");
  for (SameCase& under : found->cases) under.rows = under.pairs.estimates(found->confidence, true);
  std::vector<std::string> notes = notes_of(pairs, only_one, first, second);
  if (first_pair && !same_rock(*found, *first_pair)) notes.insert(notes.begin(), note_on_rock(*found, *first_pair));
  std::string text = fmt::format(
                         "{}\n{}\n{} pairs, {:g} % intervals of second - first; gain: so many times fewer "
                         "realizations than with independent random numbers\n",
                         first, second, rows.front().pairs, 100 * found->confidence) +
                     text_of(rows);
  for (const SameCase& under : found->cases) text += fmt::format("under {}:\n", under.name) + text_of(under.rows);
  for (const std::string& note : notes) text += "note: " + note + "\n";
  if (!out.empty()) {
    const std::string json = json_of(rows, found->cases, first, second, found->confidence, notes);
    if (const auto written = report::write_file(out, json); !written) {
      print_error(describe(written.error()));
      return ExitCode::machine_failed;
    }
    text += fmt::format("written to {}\n", out);
  }
  print(text);
  return ExitCode::done;
}

}  // namespace cleave::cli
