#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace cleave {

/// SHA-256 (FIPS 180-4) of bytes that come in pieces. Used to name scenes and results, not for secrets.
class Sha256 final {
 public:
  using Digest = std::array<std::uint8_t, 32>;

  Sha256& update(std::span<const std::byte> bytes) noexcept;
  Sha256& update(std::string_view text) noexcept;
  /// Eight bytes, least significant first, on every machine.
  Sha256& update(std::uint64_t number) noexcept;
  /// The digest of all bytes so far; more may follow.
  [[nodiscard]] Digest digest() const noexcept;
  /// The same as 64 lower-case hexadecimal digits.
  [[nodiscard]] std::string hex() const;

 private:
  void add(std::uint8_t byte) noexcept;
  void compress() noexcept;

  std::array<std::uint32_t, 8> state_{0x6a09e667U, 0xbb67ae85U, 0x3c6ef372U, 0xa54ff53aU,
                                      0x510e527fU, 0x9b05688cU, 0x1f83d9abU, 0x5be0cd19U};
  std::array<std::uint8_t, 64> block_{};
  std::uint64_t length_ = 0;  // bytes seen; length_ % 64 of them wait in block_
};

/// 64 lower-case hexadecimal digits.
[[nodiscard]] std::string sha256_hex(std::string_view text);

/// Why nothing goes on from saved bytes, which lie behind their sum: a world in motion, a block system, a run.
enum class SavedFault : std::uint8_t {
  foreign,        ///< they are nothing of this kind
  other_version,  ///< written by a version that holds something else
  damaged,        ///< cut short or changed, or of a world that cannot be
  inconsistent,   ///< of a block system, whole: numbers in them name what is not there, or are not finite
  other_world,    ///< of a world of other bodies, laws or gravity
};
[[nodiscard]] std::string describe(SavedFault fault);

}  // namespace cleave
