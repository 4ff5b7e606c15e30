/// Any bytes as a GoCAD TSurf file: surfaces or an error, never a crash; line ends do not matter.

#include "cleave/io/mesh.hpp"
#include "fuzz_target.hpp"
#include "surfaces_check.hpp"

CLEAVE_FUZZ_TARGET(bytes) { cleave::fuzz::check_reader(bytes, cleave::io::parse_tsurf); }
