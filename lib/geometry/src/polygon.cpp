#include "cleave/geometry/polygon.hpp"
