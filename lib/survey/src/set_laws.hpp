#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cleave/survey/analyse.hpp"

namespace cleave::survey::detail {

/// The estimate and its interval times a factor, under another name.
[[nodiscard]] Estimate scaled(Estimate e, std::string name, double factor, std::string method);

/// A mean over Fisher's law with the interval that the errors of its mean and kappa give it (value = low = high where
/// it was not fitted to three joints or more).
[[nodiscard]] Estimate over_orientations(const FisherFit& fit,
                                         const std::function<double(geometry::Vec3, double)>& figure,
                                         double confidence);

/// Mean length of an exponential law from traces on lines, S/m; empty when no end was seen.
[[nodiscard]] std::optional<Estimate> length_per_end(const std::vector<SeenLength>& lengths, double confidence);

/// A line that meets a set: its length times E|n.l|, and the length below which no trace was recorded.
struct RecordedOn {
  double length, truncation;
};
/// Laws of the trace lengths and of the sizes of the joints that leave them; `mean` trace length, for want of a law.
/// `lines`: where they were met on lines of which any has a truncation.
void fit_laws(SetResult& set, const std::vector<SeenLength>& lengths, const Meeting& meeting,
              const std::optional<Estimate>& mean, double confidence, const std::vector<RecordedOn>& lines = {});

}  // namespace cleave::survey::detail
