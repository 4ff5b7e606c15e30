#include "cleave/topology/cut.hpp"
