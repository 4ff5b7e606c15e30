#include "study.hpp"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <span>
#include <string_view>
#include <system_error>

#include "cleave/core/cost.hpp"

namespace cleave::study {
namespace {

std::string_view word(Status status) {
  switch (status) {
    case Status::converged: return "converged";
    case Status::stopped: return "stopped";
    case Status::refused: return "refused";
  }
  return "";
}

/// From here on the kernel's high-water mark of this process counts anew. Only studies and benchmarks do this: it hides
/// the past. Where the kernel forbids it the mark is that of the whole run.
void forget_peak_memory() {
  malloc_trim(0);
  std::ofstream{"/proc/self/clear_refs"} << 5;
}

double peak_memory_since_mb() {
  std::ifstream status{"/proc/self/status"};
  double kib = 0.0;
  for (std::string name; status >> name;) {
    if (name == "VmHWM:") status >> kib;
  }
  return kib > 0 ? kib * 1024.0 / 1e6 : peak_memory_mb();
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

std::string text(const std::optional<double>& value) { return value ? fmt::format("{:.6g}", *value) : std::string{}; }

std::string line_of(const Row& row) {
  return fmt::format("{},{},{},{},{:.6g},{:.6g},{:.6g},{},{}", row.problem, row.method, row.setting, text(row.error),
                     row.cost.wall_s, row.cost.cpu_s, row.cost.peak_mb, text(row.condition), word(row.status));
}

constexpr std::string_view header = "problem,method,setting,error,wall_s,cpu_s,peak_mb,condition,status";

bool write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out{file, std::ios::binary};
  out << text;
  out.flush();
  if (!out) fmt::print(stderr, "error: cannot write {}\n", file.string());
  return static_cast<bool>(out);
}

}  // namespace

Study::Study(std::string name, std::string folder, bool quick)
    : name_{std::move(name)}, folder_{std::move(folder)}, quick_{quick} {
  fmt::print("{}\n", header);
}

Cost Study::measure(const std::function<void()>& work, double at_least_s, int most) const {
  forget_peak_memory();
  std::vector<double> wall, cpu;
  double spent = 0;
  do {
    const auto wall_start = std::chrono::steady_clock::now();
    const double cpu_start = cpu_seconds();
    work();
    cpu.push_back(cpu_seconds() - cpu_start);
    wall.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start).count());
    spent += cpu.back();
  } while (!quick_ && spent < at_least_s && static_cast<int>(cpu.size()) < most);
  return {.wall_s = median(wall), .cpu_s = median(cpu), .peak_mb = peak_memory_since_mb()};
}

void Study::add(Row row) {
  fmt::print("{}\n", line_of(row));
  std::fflush(stdout);
  rows_.push_back(std::move(row));
}

void Study::broken(const std::string& promise) {
  kept_ = false;
  fmt::print(stderr, "error: study {}: promise not kept: {}\n", name_, promise);
}

void Study::plot(const std::string& file, const Plot& plot) {
  good_ = write(std::filesystem::path{folder_} / fmt::format("{}-{}.svg", name_, file), svg(plot)) && good_;
}

void Study::text(const std::string& file, const std::string& content) {
  good_ = write(std::filesystem::path{folder_} / fmt::format("{}-{}", name_, file), content) && good_;
}

bool Study::finish() const {
  std::string csv = fmt::format("{}\n", header);
  for (const Row& row : rows_) csv += line_of(row) + '\n';
  return write(std::filesystem::path{folder_} / (name_ + ".csv"), csv) && good_;
}

int run(const std::string& name, int argc, char** argv, const std::function<void(Study&)>& body) {
#ifdef __clang__
#pragma clang unsafe_buffer_usage begin
#endif
  const std::vector<std::string_view> arguments(argv + 1, argv + argc);
#ifdef __clang__
#pragma clang unsafe_buffer_usage end
#endif
  std::string folder = ".";
  bool quick = false, folder_next = false;
  for (const std::string_view argument : arguments) {
    if (folder_next) {
      folder = argument;
      folder_next = false;
    } else if (argument == "-o") {
      folder_next = true;
    } else if (argument == "--quick") {
      quick = true;
    } else {
      fmt::print(stderr, "error: study {} knows no argument '{}'; there are -o FOLDER and --quick\n", name, argument);
      return 2;
    }
  }
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    fmt::print(stderr, "error: cannot make {}: {}\n", folder, error.message());
    return 3;
  }
  Study study{name, folder, quick};
  body(study);
  return !study.finish() ? 3 : study.kept() ? 0 : 1;
}

}  // namespace cleave::study
