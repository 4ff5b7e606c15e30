#include "cleave/dfn/joint_set.hpp"
