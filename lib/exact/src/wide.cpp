#include "cleave/exact/wide.hpp"

#include "cleave/core/assert.hpp"

namespace cleave::exact {

Wide widened(const Int192& value) noexcept {
  const bool negative = (value.words[2] >> 63U) != 0;
  const Int192 size = negative ? -value : value;
  Wide out = size.words[2];
  for (const std::size_t k : {1U, 0U}) out = (out << 64U) | size.words[k];
  if (negative) out.backend().negate();
  return out;
}

Int192 narrowed(const Wide& value) noexcept {
  Wide rest = abs(value);
  Int192 out;
  for (std::uint64_t& word : out.words) {
    word = static_cast<std::uint64_t>(rest & UINT64_MAX);
    rest >>= 64U;
  }
  CLEAVE_ASSERT(rest == 0 && (out.words[2] >> 63U) == 0);
  return value < 0 ? -out : out;
}

}  // namespace cleave::exact
