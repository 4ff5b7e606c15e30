#include "cleave/geometry/solid.hpp"
