#pragma once

/// Frame of the studies: error against run time of one numerical method, as a table and plots.
///
/// A study is one program. It calls `run` with its name and a function that adds rows and plots; `run` reads the
/// arguments (`-o FOLDER`, `--quick` for sizes small enough for a test) and writes FOLDER/NAME.csv and the plots beside
/// it. `cleave_study(NAME ...)` in bench/study/CMakeLists.txt makes it known to `./x study` and to the tests.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "plot.hpp"

namespace cleave::study {

enum class Status : std::uint8_t {
  converged,  ///< an answer that holds what the method promises
  stopped,    ///< the method gave up, or its answer failed its check
  refused,    ///< the method said beforehand that the problem is not its own
};

/// Median processor and wall time, and the most memory held meanwhile (MB = 10^6 bytes; of the whole process).
struct Cost {
  double wall_s = 0, cpu_s = 0, peak_mb = 0;
};

struct Row {
  std::string problem, method, setting;  ///< no commas, quotes or line ends
  std::optional<double> error;           ///< relative to the exact or reference value; none only when not converged
  Cost cost;
  std::optional<double> condition;  ///< what the problem's answer is sensitive to; each study says what it means
  Status status = Status::converged;
};

class Study final {
 public:
  Study(std::string name, std::string folder, bool quick);
  /// True in tests: small sizes, one run each.
  [[nodiscard]] bool quick() const noexcept { return quick_; }
  /// Runs `work` until `at_least_s` of processor time are spent (once when quick) and at most `most` times.
  [[nodiscard]] Cost measure(const std::function<void()>& work, double at_least_s = 0.5, int most = 15) const;
  /// Also printed at once.
  void add(Row row);
  [[nodiscard]] const std::vector<Row>& rows() const noexcept { return rows_; }
  /// Says that a promise was not kept: a message, and the study's exit code is 1.
  void broken(const std::string& promise);
  [[nodiscard]] bool kept() const noexcept { return kept_; }
  /// Written as NAME-FILE.svg.
  void plot(const std::string& file, const Plot& plot);
  /// Written as NAME-FILE.
  void text(const std::string& file, const std::string& content);
  /// Writes NAME.csv. False (and a message) when the folder cannot be written.
  [[nodiscard]] bool finish() const;

 private:
  std::string name_, folder_;
  bool quick_;
  bool good_ = true, kept_ = true;
  std::vector<Row> rows_;
};

/// The whole `main` of a study. Exit code 0; 1 when a promise was not kept; 2 for wrong arguments; 3 when nothing could
/// be written.
[[nodiscard]] int run(const std::string& name, int argc, char** argv, const std::function<void(Study&)>& body);

}  // namespace cleave::study
