#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <vector>

namespace cleave::stochastic {

/// Numbers that are only needed again at the end. Beyond a few thousand they go to a temporary file without a name, so
/// that memory does not grow with their number; where no such file can be had they stay in memory.
class ValueStore final {
 public:
  void push_back(double value);
  [[nodiscard]] std::size_t size() const noexcept { return written_ + recent_.size(); }
  [[nodiscard]] bool empty() const noexcept { return size() == 0; }
  /// All of them, in their order. Empty when the temporary file cannot be read back (disk full).
  [[nodiscard]] std::vector<double> all() const;

 private:
  struct Close {
    void operator()(std::FILE* file) const noexcept { static_cast<void>(std::fclose(file)); }
  };
  static constexpr std::size_t most_recent = 2048;
  std::vector<double> recent_;
  std::unique_ptr<std::FILE, Close> file_;
  std::size_t written_ = 0;
  bool in_memory_ = false;
};

}  // namespace cleave::stochastic
