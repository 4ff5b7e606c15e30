#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cleave/survey/analyse.hpp"

namespace cleave::survey::detail {

/// The estimate and its interval times a factor, under another name.
[[nodiscard]] Estimate scaled(Estimate e, std::string name, double factor, std::string method);

/// Laws of the trace lengths and of the sizes of the joints that leave them; `mean` trace length, for want of a law.
void fit_laws(SetResult& set, const std::vector<SeenLength>& lengths, const Meeting& meeting,
              const std::optional<double>& mean, double confidence);

}  // namespace cleave::survey::detail
