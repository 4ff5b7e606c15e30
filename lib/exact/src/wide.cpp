#include "cleave/exact/wide.hpp"

#include <cmath>

namespace cleave::exact {

Int512 widened(const Int192& value) noexcept {
  const std::uint64_t sign = value.negative() ? ~std::uint64_t{0} : 0;
  if (value.words[2] == sign && (value.words[1] >> 63U) == (sign & 1U)) {  // nearly always
    return static_cast<Int128>((static_cast<Int192::Word2>(value.words[1]) << 64U) | value.words[0]);
  }
  const bool negative = value.negative();
  const Int192 size = negative ? -value : value;
  Int512 out = size.words[2];
  for (const std::size_t k : {1U, 0U}) out = (out << 64U) | size.words[k];
  if (negative) out.backend().negate();
  return out;
}

double Int192::as_double() const noexcept {
  const Int192 size = negative() ? -*this : *this;
  double value = static_cast<double>(size.words[0]);
  value += std::ldexp(static_cast<double>(size.words[1]), 64);
  value += std::ldexp(static_cast<double>(size.words[2]), 128);
  return negative() ? -value : value;
}

}  // namespace cleave::exact
