/// Built as a consumer of the library would: without our flags, so without checked containers of the standard library.

#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "cleave/core/id.hpp"

#ifdef _GLIBCXX_ASSERTIONS
#error "this program shows what holds without them"
#endif

/// What the check ends in; the test looks for its message before this.
extern "C" void caught(int) { std::_Exit(0); }

int main() {
  std::signal(SIGABRT, caught);
  using Id = cleave::Id<struct Tag>;
  const cleave::IdVector<Id, int> three{std::vector<int>{1, 2, 3}};
  const int sum = three[Id{0U}] + three[Id{2U}];
  std::printf("inside: %d\n", sum);
  std::fflush(stdout);
  std::printf("outside: %d\n", three[Id{3U}]);
  return 1;
}
