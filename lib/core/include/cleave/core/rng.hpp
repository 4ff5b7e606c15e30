#pragma once

/// Random numbers that are a pure function of a key: the same on every machine, thread count and order of work.
///
/// Philox4x32-10 (Salmon, Moraes, Dror and Shaw 2011, "Parallel random numbers: as easy as 1, 2, 3"), a counter-based
/// generator. Nothing is consumed in order, so adding a joint set or a property changes no other stream, and any
/// realization can be made again alone.

#include <array>
#include <cstddef>
#include <cstdint>

namespace cleave {

/// What a stream of a joint set is drawn for. The numbers are part of the definition of a realization: append only.
enum class Draw : std::uint8_t {
  count = 0,
  position = 1,
  orientation = 2,
  size = 3,
  aspect = 4,
  rotation = 5,
  termination = 6,
  friction = 7,
  cohesion = 8,
  tension = 9,
  aperture = 10,
  mapped = 11,
};

/// The purpose word of a stream: 256 * set number (order in the scene file, from 0) + what is drawn.
/// Precondition: set < 2^24.
[[nodiscard]] std::uint32_t stream_purpose(std::size_t set, Draw draw) noexcept;

/// Names one stream. `index` is, say, the number of a joint in its set.
struct StreamKey {
  std::uint64_t seed = 0;
  std::uint64_t realization = 0;
  std::uint32_t purpose = 0;
  std::uint32_t index = 0;
  friend bool operator==(const StreamKey&, const StreamKey&) = default;
};

/// One stream of random numbers. Cheap to make (no warm-up, 48 bytes) and to copy; a copy repeats the numbers.
///
/// Layout: counter = (block number, index, purpose, realization low 32 bits), key = (seed low 32 bits, seed high 32
/// bits xor realization high 32 bits). Each block of four words gives two numbers. At most 2^33 numbers a stream.
class Rng final {
 public:
  explicit Rng(const StreamKey& key) noexcept;
  /// The stream of purpose 0 and index 0 of realization 0: for tests and examples.
  explicit Rng(std::uint64_t seed) noexcept : Rng{StreamKey{.seed = seed}} {}

  /// 64 random bits.
  [[nodiscard]] std::uint64_t u64() noexcept;
  /// Uniform in the open interval (0, 1): (k + 1/2) 2^-52 with k = the top 52 bits of one u64(). Never 0 and never 1,
  /// so log(u) and log(1 - u) are finite; 53 bits centred the same way would round to 1.
  [[nodiscard]] double uniform() noexcept;
  /// Uniform integer in [lo, hi], both ends included, without bias (values of the incomplete last cycle are drawn
  /// again). Precondition: lo <= hi.
  [[nodiscard]] std::int64_t between(std::int64_t lo, std::int64_t hi) noexcept;
  /// Standard normal by inversion of one uniform(): larger u, larger number (kept for common random numbers).
  [[nodiscard]] double normal() noexcept;

 private:
  std::array<std::uint32_t, 4> counter_;
  std::array<std::uint32_t, 2> key_;
  std::array<std::uint64_t, 2> numbers_{};
  std::uint32_t used_ = 2;  // of numbers_
};

/// Inverse of the standard normal distribution function, relative error about 1e-16: algorithm AS 241, PPND16
/// (Wichura 1988, Applied Statistics 37, 477-484). Precondition: 0 < p < 1.
[[nodiscard]] double normal_quantile(double p) noexcept;

namespace detail {
/// The bare generator, open for the published test vectors.
[[nodiscard]] std::array<std::uint32_t, 4> philox4x32_10(const std::array<std::uint32_t, 4>& counter,
                                                         const std::array<std::uint32_t, 2>& key) noexcept;
}  // namespace detail

}  // namespace cleave
