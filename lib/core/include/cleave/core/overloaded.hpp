#pragma once

namespace cleave {

/// Visitor made of lambdas, one an alternative: `std::visit(overloaded{[](A) {...}, [](B) {...}}, v)`.
template <class... Ts>
struct overloaded : Ts... {
  using Ts::operator()...;
};

}  // namespace cleave
