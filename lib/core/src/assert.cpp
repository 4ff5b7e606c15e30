#include "cleave/core/assert.hpp"

#include <cstdio>
#include <cstdlib>

namespace cleave::detail {

void assertion_failed(const char* expression, const char* file, int line) noexcept {
  std::fprintf(stderr,
               "cleave: internal error: '%s' does not hold (%s:%d). This is a bug in cleave; please report it.\n",
               expression, file, line);
  std::abort();
}

}  // namespace cleave::detail
