#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "cleave/stochastic/record.hpp"

namespace cleave::stochastic {

/// Who does what on several machines: geometries are handed out one by one, in order, to whoever asks first, and their
/// records are committed in order whenever they come back. A worker that asks for the next piece before it has ended
/// the one before never waits for an answer. Near the end, when as many pieces are left as every worker would do in a
/// few turns, a piece goes only to who has none: none may lie behind a long one. Knows nothing of how messages travel,
/// so that it can be simulated.
class Dispatch final {
 public:
  /// `group` realizations in a row are one piece of work, named by its first realization.
  explicit Dispatch(std::uint64_t group = 1);

  struct Piece {
    int worker;
    std::uint64_t first;  ///< realization
  };
  /// The pieces from that of realization `first` (perhaps not from its first realization on), every `step`-th, up to
  /// realization `end`. Precondition: nothing is out.
  void begin(std::uint64_t first, std::uint64_t end, std::uint64_t step);
  /// A worker can take one more piece.
  void ask(int worker);
  /// The next piece and who gets it; empty when there is no work or nobody who asked.
  [[nodiscard]] std::optional<Piece> next();
  /// Records of a piece are back. What is due is committed; `commit` returns false to stop.
  void back(std::vector<Record> records, const std::function<bool(const Record&)>& commit);
  /// No piece is out and none is left to be handed out.
  [[nodiscard]] bool done() const noexcept { return out_ == 0 && (stopped_ || next_ >= end_); }
  [[nodiscard]] const std::vector<int>& asking() const noexcept { return asking_; }

 private:
  [[nodiscard]] std::uint64_t after(std::uint64_t k) const noexcept { return (k / group_ + step_) * group_; }

  std::uint64_t group_, next_ = 0, due_ = 0, end_ = 0, step_ = 1;
  std::size_t out_ = 0;
  bool stopped_ = false;
  std::vector<int> asking_;           // first come, first served
  std::map<int, std::size_t> has_;    // pieces out, by worker that ever asked
  std::map<std::uint64_t, int> who_;  // works on the pieces that are out
  std::map<std::uint64_t, std::vector<Record>> early_;
};

}  // namespace cleave::stochastic
