#pragma once

#include <expected>
#include <optional>

#include "interrupt.hpp"
#include "out_folder.hpp"

namespace cleave::cli {

/// A folder for a result that an interrupt takes away, from before it is made until it is published or discarded: there
/// is no moment at which it stands and nobody would.
class WatchedFolder final {
 public:
  /// `make` gives std::expected<OutFolder, OutError>.
  template <class Make>
  WatchedFolder(InterruptWatch& interrupts, const Make& make) : interrupts_{interrupts} {
    interrupts_.on_interrupt([this] { discard(); });
    interrupts_.guarded([&] { folder_.emplace(make()); });
  }
  WatchedFolder(const WatchedFolder&) = delete;
  WatchedFolder& operator=(const WatchedFolder&) = delete;
  ~WatchedFolder() {
    interrupts_.guarded([this] { discard(); });
    interrupts_.on_interrupt({});
  }

  [[nodiscard]] std::expected<OutFolder, OutError>& operator*() noexcept { return *folder_; }
  [[nodiscard]] std::expected<OutFolder, OutError>* operator->() noexcept { return &*folder_; }

 private:
  void discard() noexcept {
    if (folder_ && *folder_) (*folder_)->discard();
  }
  InterruptWatch& interrupts_;
  std::optional<std::expected<OutFolder, OutError>> folder_;
};

}  // namespace cleave::cli
