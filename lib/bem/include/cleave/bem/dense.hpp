#pragma once

#include <cstddef>
#include <vector>

namespace cleave::bem {

/// A dense matrix by columns, for values that cross the module's border; the arithmetic happens inside.
struct DenseMatrix {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<double> values;

  [[nodiscard]] double operator()(std::size_t row, std::size_t column) const { return values[column * rows + row]; }
};

}  // namespace cleave::bem
