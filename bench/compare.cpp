/// `bench_compare NEW.json... [--yardstick SECONDS] [--save FILE.json] [--baseline OLD.json...]`: a table of Google
/// Benchmark results, medians where a benchmark was repeated, beside the stored baselines; `--save` makes a baseline of
/// the new results. With the time of bench/yardstick.sh in the same run, times are given as multiples of it too.
/// Exit code 1 when a benchmark failed its answer check.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace {

using Json = nlohmann::json;

struct Result {
  std::vector<double> cpu_s;              // one a repetition
  std::map<std::string, double> figures;  // counters of the last repetition
  std::string error;
};

struct Results {
  std::string name;
  std::string machine;
  std::vector<std::string> order;
  std::map<std::string, Result> by_name;
};

double seconds(double time, std::string_view unit) {
  if (unit == "ns") return time * 1e-9;
  if (unit == "us") return time * 1e-6;
  if (unit == "ms") return time * 1e-3;
  return time;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

bool is_counter(const std::string& key) {
  constexpr std::array<std::string_view, 15> known{
      "name",         "run_name",   "run_type",       "repetitions",   "repetition_index",
      "threads",      "iterations", "real_time",      "cpu_time",      "time_unit",
      "family_index", "aggregate",  "error_occurred", "error_message", "per_family_instance_index"};
  return std::ranges::find(known, key) == known.end();
}

void add(Results& results, const Json& run) {
  if (run.value("run_type", "iteration") != "iteration") return;
  const auto name = run.value("run_name", run.value("name", std::string{"?"}));
  if (!results.by_name.contains(name)) results.order.push_back(name);
  Result& result = results.by_name[name];
  if (run.value("error_occurred", false)) {
    result.error = run.value("error_message", "failed");
    return;
  }
  result.cpu_s.push_back(seconds(run.value("cpu_time", 0.0), run.value("time_unit", "ns")));
  for (const auto& [key, value] : run.items()) {
    if (value.is_number() && is_counter(key)) result.figures[key] = value.get<double>();
  }
}

bool read(const std::filesystem::path& file, Results& results) {
  std::ifstream in{file};
  const Json json = Json::parse(in, nullptr, false);
  if (json.is_discarded() || !json.contains("benchmarks")) {
    fmt::print(stderr, "error: {} holds no benchmark results\n", file.string());
    return false;
  }
  for (const Json& run : json["benchmarks"]) add(results, run);
  if (const auto context = json.find("context"); context != json.end()) {
    results.machine = fmt::format("{} cores, {} MHz", context->value("num_cpus", 0), context->value("mhz_per_cpu", 0));
  }
  return true;
}

std::string time_text(double s) {
  if (s >= 1.0) return fmt::format("{:.3f} s", s);
  if (s >= 1e-3) return fmt::format("{:.3f} ms", s * 1e3);
  if (s >= 1e-6) return fmt::format("{:.3f} us", s * 1e6);
  return fmt::format("{:.3f} ns", s * 1e9);
}

/// How far the new time lies from the old one; differences within 5 % are noise.
std::string against(const Results& old, const std::string& name, double cpu_s) {
  const auto found = old.by_name.find(name);
  if (found == old.by_name.end() || found->second.cpu_s.empty()) return "-";
  const double before = median(found->second.cpu_s);
  const double change = 100.0 * (cpu_s / before - 1.0);
  const std::string_view word = change > 5.0 ? "slower" : change < -5.0 ? "faster" : "same";
  return fmt::format("{} {:+.0f} % {}", time_text(before), change, word);
}

/// One entry a benchmark, the median, in Google Benchmark's own form.
bool save(const std::filesystem::path& file, const Results& results) {
  Json runs = Json::array();
  for (const std::string& name : results.order) {
    const Result& result = results.by_name.at(name);
    if (!result.error.empty()) continue;
    Json run{{"name", name}, {"run_type", "iteration"}, {"cpu_time", 1e9 * median(result.cpu_s)}, {"time_unit", "ns"}};
    for (const auto& [key, value] : result.figures) run[key] = value;
    runs.push_back(std::move(run));
  }
  std::filesystem::create_directories(file.parent_path());
  std::ofstream out{file};
  out << Json{{"context", {{"machine", results.machine}}}, {"benchmarks", std::move(runs)}}.dump(2) << '\n';
  return static_cast<bool>(out.flush());
}

int print_table(const Results& results, const std::vector<Results>& baselines, std::optional<double> yardstick) {
  std::size_t width = 9;
  for (const std::string& name : results.order) width = std::max(width, name.size());
  if (yardstick) fmt::print("yardstick: {}\n", time_text(*yardstick));
  fmt::print("{:<{}}  {:>12}", "benchmark", width, "cpu time");
  if (yardstick) fmt::print("  {:>10}", "yardsticks");
  for (const Results& old : baselines) fmt::print("  {:>28}", "baseline " + old.name);
  fmt::print("  figures\n");
  int failed = 0;
  for (const std::string& name : results.order) {
    const Result& result = results.by_name.at(name);
    if (!result.error.empty()) {
      fmt::print("{:<{}}  WRONG ANSWER: {}\n", name, width, result.error);
      ++failed;
      continue;
    }
    const double cpu_s = median(result.cpu_s);
    fmt::print("{:<{}}  {:>12}", name, width, time_text(cpu_s));
    if (yardstick) fmt::print("  {:>10.4f}", cpu_s / *yardstick);
    for (const Results& old : baselines) fmt::print("  {:>28}", against(old, name, cpu_s));
    for (const auto& [key, value] : result.figures) fmt::print("  {}={:.6g}", key, value);
    fmt::print("\n");
  }
  return failed;
}

}  // namespace

int main(int argc, char** argv) {
#ifdef __clang__
#pragma clang unsafe_buffer_usage begin
#endif
  const std::span arguments{argv + 1, static_cast<std::size_t>(argc - 1)};
#ifdef __clang__
#pragma clang unsafe_buffer_usage end
#endif
  enum class Next : std::uint8_t { result, saved, baseline, yardstick };
  Next next = Next::result;
  Results results;
  std::vector<Results> baselines;
  std::optional<std::filesystem::path> saved;
  std::optional<double> yardstick;
  bool good = true;
  for (const std::string_view argument : arguments) {
    const std::filesystem::path file{argument};
    if (argument == "--baseline") {
      next = Next::baseline;
    } else if (argument == "--save") {
      next = Next::saved;
    } else if (argument == "--yardstick") {
      next = Next::yardstick;
    } else if (next == Next::yardstick) {
      double seconds_of_it = 0;
      const char* last = std::to_address(argument.end());
      const auto [end, failure] = std::from_chars(argument.data(), last, seconds_of_it);
      good = failure == std::errc{} && end == last && seconds_of_it > 0 && good;
      if (seconds_of_it > 0) yardstick = seconds_of_it;
      next = Next::result;
    } else if (next == Next::saved) {
      saved = file;
      next = Next::result;
    } else if (next == Next::baseline) {
      baselines.push_back({.name = file.stem().string(), .machine = {}, .order = {}, .by_name = {}});
      good = read(file, baselines.back()) && good;
    } else {
      good = read(file, results) && good;
    }
  }
  if (results.order.empty()) {
    fmt::print(stderr, "error: no benchmark ran\n");
    return 1;
  }
  const int failed = print_table(results, baselines, yardstick);
  if (saved && !save(*saved, results)) {
    fmt::print(stderr, "error: cannot write {}\n", saved->string());
    good = false;
  }
  return good && failed == 0 ? 0 : 1;
}
