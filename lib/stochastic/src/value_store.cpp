#include "cleave/stochastic/statistics.hpp"

namespace cleave::stochastic {

void ValueStore::push_back(double value) {
  recent_.push_back(value);
  if (recent_.size() < most_recent || in_memory_) return;
  if (!file_) file_.reset(std::tmpfile());
  if (!file_ || std::fwrite(recent_.data(), sizeof(double), recent_.size(), file_.get()) != recent_.size() ||
      std::fflush(file_.get()) != 0) {
    // What was written before stays there; a piece of a block is written over on reading back, by its count.
    in_memory_ = true;
    return;
  }
  written_ += recent_.size();
  recent_.clear();
}

std::vector<double> ValueStore::all() const {
  std::vector<double> values(written_);
  if (written_ > 0) {
    std::rewind(file_.get());
    const std::size_t read = std::fread(values.data(), sizeof(double), written_, file_.get());
    static_cast<void>(std::fseek(file_.get(), 0, SEEK_END));
    if (read != written_) return {};
  }
  values.insert(values.end(), recent_.begin(), recent_.end());
  return values;
}

}  // namespace cleave::stochastic
