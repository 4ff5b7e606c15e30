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
  const auto& backend = value.backend();
  static_assert(sizeof(*backend.limbs()) == sizeof(std::uint64_t));
  CLEAVE_ASSERT(backend.size() <= 3);
  Int192 out;
  for (unsigned k = 0; k < backend.size(); ++k) out.words[k] = backend.limbs()[k];
  CLEAVE_ASSERT((out.words[2] >> 63U) == 0);
  return value < 0 ? -out : out;
}

}  // namespace cleave::exact
