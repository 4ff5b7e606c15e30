#include "interior.hpp"

namespace cleave::linear {
template class Interior<motion::Scaled>;
}  // namespace cleave::linear
