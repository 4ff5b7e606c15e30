#include "cleave/dfn/sample.hpp"
