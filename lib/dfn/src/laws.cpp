#include "cleave/dfn/laws.hpp"
