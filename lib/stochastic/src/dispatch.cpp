#include "cleave/stochastic/dispatch.hpp"

#include <algorithm>
#include <utility>

#include "cleave/core/assert.hpp"

namespace cleave::stochastic {

namespace {
constexpr std::size_t turns_at_the_end = 5;
}

Dispatch::Dispatch(std::uint64_t group) : group_{group} { CLEAVE_ASSERT(group >= 1); }

void Dispatch::begin(std::uint64_t first, std::uint64_t end, std::uint64_t step) {
  CLEAVE_ASSERT(out_ == 0 && step >= 1);
  next_ = due_ = first;
  end_ = end;
  step_ = step;
  stopped_ = false;
  early_.clear();
}

void Dispatch::ask(int worker) {
  asking_.push_back(worker);
  has_.try_emplace(worker, 0);
}

std::optional<Dispatch::Piece> Dispatch::next() {
  if (asking_.empty() || stopped_ || next_ >= end_) return std::nullopt;
  const std::uint64_t left = (end_ - next_ - 1) / (group_ * step_) + 1;
  auto who = asking_.begin();
  if (left < turns_at_the_end * has_.size()) {
    who = std::ranges::find_if(asking_, [&](int worker) { return has_.at(worker) == 0; });
    if (who == asking_.end()) return std::nullopt;
  }
  const Piece piece{*who, next_};
  asking_.erase(who);
  ++has_.at(piece.worker);
  who_.emplace(piece.first, piece.worker);
  next_ = after(next_);
  ++out_;
  return piece;
}

void Dispatch::back(std::vector<Record> records, const std::function<bool(const Record&)>& commit) {
  CLEAVE_ASSERT(!records.empty() && out_ > 0);
  --out_;
  const std::uint64_t first = records.front().realization;
  if (const auto piece = who_.extract(first)) --has_.at(piece.mapped());
  early_.emplace(first, std::move(records));
  for (auto it = early_.find(due_); it != early_.end() && !stopped_; it = early_.find(due_)) {
    stopped_ = !std::ranges::all_of(it->second, [&](const Record& record) { return commit(record); });
    early_.erase(it);
    due_ = after(due_);
  }
}

}  // namespace cleave::stochastic
