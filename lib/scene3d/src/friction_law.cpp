#include <cmath>
#include <expected>
#include <optional>
#include <utility>

#include "cleave/core/rng.hpp"
#include "cleave/core/special.hpp"
#include "cleave/scene3d/scene.hpp"

namespace cleave::scene {
namespace {

using special::normal_cdf;

/// Quantile of a standard normal law cut to [low, high]; by the shorter tail, so that it stays exact far out.
double cut_normal(double low, double high, double u) {
  if (low > 0) return -cut_normal(-high, -low, 1 - u);
  const double from = normal_cdf(low), to = normal_cdf(high);
  return normal_quantile(from + u * (to - from));
}

/// Inverse distribution function of the laws that friction, cohesion and the like share.
template <class Law>
double quantile_of(const Law& law, double u) {
  using Kind = FrictionLaw::Kind;
  const auto& [kind, mean, std, min, max] = law;
  const auto within = [&](double x) { return std::fmin(std::fmax(x, law.min), law.max); };
  switch (kind) {
    case Kind::constant: return mean;
    case Kind::uniform: return within(min + u * (max - min));
    case Kind::normal:
      if (std == 0) return within(mean);
      return within(mean + std * cut_normal((min - mean) / std, (max - mean) / std, u));
    case Kind::lognormal: {
      if (std == 0) return within(mean);
      // Parameters of the logarithm from mean and standard deviation of the law itself.
      const double variance = std::log1p((std / mean) * (std / mean));
      const double mu = std::log(mean) - variance / 2, sigma = std::sqrt(variance);
      const double low = min > 0 ? (std::log(min) - mu) / sigma : -40.0;
      return within(std::exp(mu + sigma * cut_normal(low, (std::log(max) - mu) / sigma, u)));
    }
    case Kind::exponential: {
      const double from = std::exp(-min / mean), to = std::exp(-max / mean);
      return within(-mean * std::log(from - u * (from - to)));
    }
  }
  std::unreachable();
}

}  // namespace

FrictionAngle FrictionLaw::quantile(double u) const { return FrictionAngle::degrees(quantile_of(*this, u)); }
Stress StressLaw::quantile(double u) const { return pascals(quantile_of(*this, u)); }
double NumberLaw::quantile(double u) const { return quantile_of(*this, u); }

std::expected<stability::JointStrength, stability::StrengthError> joint_strength(
    FrictionAngle friction, Stress cohesion, Stress tension, const std::optional<stability::Roughness>& roughness) {
  if (!roughness) return stability::JointStrength::make(friction, cohesion, tension);
  return stability::JointStrength::barton_bandis(friction, roughness->jrc, roughness->jcs, tension);
}

}  // namespace cleave::scene
