#pragma once

#include <cstdlib>
#include <fstream>
#include <string_view>

namespace cleave::support {

/// For fuzz targets that decode bytes: writes what was decoded, as text a person can read and run, to the file that
/// CLEAVE_FUZZ_KEEP names. `./x fuzz` sets it to keep a crash; without it `make_text` is not even called.
template <class MakeText>
void keep_readable(const MakeText& make_text) {
  if (const char* file = std::getenv("CLEAVE_FUZZ_KEEP"); file != nullptr) std::ofstream{file} << make_text();
}

}  // namespace cleave::support
