#include "cleave/core/rng.hpp"

// Random123 refuses machines that it was not tried on. Its generators are integer arithmetic, and the golden hashes and
// draws are the same on this one.
#ifdef __wasm__
#define __aarch64__ 1
#endif
#include <Random123/philox.h>
#ifdef __wasm__
#undef __aarch64__
#endif

#include <cmath>

#include "cleave/core/assert.hpp"

namespace cleave {
namespace {

constexpr std::uint32_t low_word(std::uint64_t v) noexcept { return static_cast<std::uint32_t>(v & 0xffffffffU); }
constexpr std::uint32_t high_word(std::uint64_t v) noexcept { return static_cast<std::uint32_t>(v >> 32U); }

/// c[0] + c[1] x + c[2] x^2 + ...
template <std::size_t N>
constexpr double polynomial(const std::array<double, N>& c, double x) noexcept {
  double value = 0.0;
  for (std::size_t i = N; i-- > 0;) value = value * x + c[i];
  return value;
}

// clang-format off
// Coefficients of AS 241 (Wichura 1988, PPND16): numerators and denominators for the middle, the tail and the far tail.
constexpr std::array middle_num{3.3871328727963666080e0, 1.3314166789178437745e+2, 1.9715909503065514427e+3,
                                1.3731693765509461125e+4, 4.5921953931549871457e+4, 6.7265770927008700853e+4,
                                3.3430575583588128105e+4, 2.5090809287301226727e+3};
constexpr std::array middle_den{1.0, 4.2313330701600911252e+1, 6.8718700749205790830e+2, 5.3941960214247511077e+3,
                                2.1213794301586595867e+4, 3.9307895800092710610e+4, 2.8729085735721942674e+4,
                                5.2264952788528545610e+3};
constexpr std::array tail_num{1.42343711074968357734e0, 4.63033784615654529590e0, 5.76949722146069140550e0,
                              3.64784832476320460504e0, 1.27045825245236838258e0, 2.41780725177450611770e-1,
                              2.27238449892691845833e-2, 7.74545014278341407640e-4};
constexpr std::array tail_den{1.0, 2.05319162663775882187e0, 1.67638483018380384940e0, 6.89767334985100004550e-1,
                              1.48103976427480074590e-1, 1.51986665636164571966e-2, 5.47593808499534494600e-4,
                              1.05075007164441684324e-9};
constexpr std::array far_num{6.65790464350110377720e0, 5.46378491116411436990e0, 1.78482653991729133580e0,
                             2.96560571828504891230e-1, 2.65321895265761230930e-2, 1.24266094738807843860e-3,
                             2.71155556874348757815e-5, 2.01033439929228813265e-7};
constexpr std::array far_den{1.0, 5.99832206555887937690e-1, 1.36929880922735805310e-1, 1.48753612908506148525e-2,
                             7.86869131145613259100e-4, 1.84631831751005468180e-5, 1.42151175831644588870e-7,
                             2.04426310338993978564e-15};
// clang-format on

}  // namespace

namespace detail {

std::array<std::uint32_t, 4> philox4x32_10(const std::array<std::uint32_t, 4>& counter,
                                           const std::array<std::uint32_t, 2>& key) noexcept {
  const philox4x32_ctr_t c{{counter[0], counter[1], counter[2], counter[3]}};
  const philox4x32_key_t k{{key[0], key[1]}};
  const philox4x32_ctr_t r = philox4x32_R(10, c, k);
  return {r[0], r[1], r[2], r[3]};
}

}  // namespace detail

std::uint32_t stream_purpose(std::size_t set, Draw draw) noexcept {
  CLEAVE_ASSERT(set < (std::size_t{1} << 24U));
  return static_cast<std::uint32_t>(set) * 256U + static_cast<std::uint32_t>(draw);
}

Rng::Rng(const StreamKey& key) noexcept
    : counter_{0, key.index, key.purpose, low_word(key.realization)},
      key_{low_word(key.seed), high_word(key.seed) ^ high_word(key.realization)} {}

std::uint64_t Rng::u64() noexcept {
  if (used_ == numbers_.size()) {
    const auto words = detail::philox4x32_10(counter_, key_);
    numbers_ = {(std::uint64_t{words[0]} << 32U) | words[1], (std::uint64_t{words[2]} << 32U) | words[3]};
    CLEAVE_ASSERT(counter_[0] != UINT32_MAX);  // the stream would start again from its first number
    ++counter_[0];
    used_ = 0;
  }
  return numbers_[used_++];
}

double Rng::uniform() noexcept { return (static_cast<double>(u64() >> 12U) + 0.5) * 0x1p-52; }

std::int64_t Rng::between(std::int64_t lo, std::int64_t hi) noexcept {
  CLEAVE_ASSERT(lo <= hi);
  const std::uint64_t width = static_cast<std::uint64_t>(hi) - static_cast<std::uint64_t>(lo) + 1;  // 0 means 2^64
  const auto offset = [&]() -> std::uint64_t {
    if (width == 0) return u64();
    // The first 2^64 mod width values make the number of accepted ones a multiple of width.
    const std::uint64_t refused = (0 - width) % width;
    for (;;) {
      if (const std::uint64_t bits = u64(); bits >= refused) return bits % width;
    }
  };
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(lo) + offset());
}

double Rng::normal() noexcept { return normal_quantile(uniform()); }

double normal_quantile(double p) noexcept {
  CLEAVE_ASSERT(p > 0.0 && p < 1.0);
  const double q = p - 0.5;
  if (std::abs(q) <= 0.425) {
    const double r = 0.180625 - q * q;
    return q * polynomial(middle_num, r) / polynomial(middle_den, r);
  }
  const double r = std::sqrt(-std::log(q < 0.0 ? p : 1.0 - p));
  const double size = r <= 5.0 ? polynomial(tail_num, r - 1.6) / polynomial(tail_den, r - 1.6)
                               : polynomial(far_num, r - 5.0) / polynomial(far_den, r - 5.0);
  return q < 0.0 ? -size : size;
}

}  // namespace cleave
