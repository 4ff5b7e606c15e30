// What a header of core would look like that uses geometry. A test compiles it and expects that this fails.
#include "cleave/core/id.hpp"
#include "cleave/geometry/polygon.hpp"
