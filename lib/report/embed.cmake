# cmake -DNAME=three -DINPUT=three.min.js -DOUTPUT=three.cpp -P embed.cmake
# Writes INPUT as a C++ source with raw string literals of at most 15,000 characters each (limits of the language: 65,536).
# Pieces end at a line end or an ASCII character, so no UTF-8 sequence is cut.
file(READ "${INPUT}" text)
string(LENGTH "${text}" length)
set(pieces "")
set(from 0)
set(count 0)
while(from LESS length)
  string(SUBSTRING "${text}" ${from} 15000 piece)
  string(LENGTH "${piece}" size)
  math(EXPR from "${from} + ${size}")
  string(APPEND pieces "    R\"CLEAVE(${piece})CLEAVE\"sv,\n")
  math(EXPR count "${count} + 1")
endwhile()
file(WRITE "${OUTPUT}" "// Made from ${NAME} by embed.cmake.
#include \"assets.hpp\"

#include <array>

namespace cleave::report::assets {
namespace {
using std::string_view_literals::operator\"\"sv;
constexpr std::array<std::string_view, ${count}> pieces{
${pieces}};
}  // namespace

std::span<const std::string_view> ${NAME}() { return pieces; }

}  // namespace cleave::report::assets
")
