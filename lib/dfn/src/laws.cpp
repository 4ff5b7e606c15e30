#include "cleave/dfn/joint_set.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "cleave/core/assert.hpp"
#include "cleave/core/expected.hpp"
#include "cleave/core/overloaded.hpp"
#include "cleave/core/rng.hpp"
#include "cleave/core/special.hpp"

namespace cleave::dfn {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double longest = 1e9;        // m: nothing on earth is larger, and squares stay finite
constexpr double least_share = 1e-12;  // of a law between its limits

/// Probability between a and b > a, from the tail where both are small.
double normal_between(double a, double b) {
  return a > 0 ? special::normal_cdf(-a) - special::normal_cdf(-b) : special::normal_cdf(b) - special::normal_cdf(a);
}
/// z times the density, 0 at infinity.
double density_moment(double z) { return std::isinf(z) ? 0 : z * special::normal_density(z); }

std::expected<double, SizeError> positive(const std::optional<Length>& value, const char* key) {
  if (!value) return std::unexpected(MissingParameter{key});
  const double v = value->si();
  if (!(v > 0) || v > longest) {
    return std::unexpected(BadParameter{key, v, "give a length above 0 m and at most 1e9 m"});
  }
  return v;
}

std::expected<double, SizeError> not_negative(const std::optional<Length>& value, const char* key) {
  if (!value) return std::unexpected(MissingParameter{key});
  const double v = value->si();
  if (!(v >= 0) || v > longest) return std::unexpected(BadParameter{key, v, "give a length of 0 m to 1e9 m"});
  return v;
}

}  // namespace

SizeLaw SizeLaw::constant(Length size) {
  CLEAVE_ASSERT(size.si() > 0 && std::isfinite(size.si()));
  SizeLaw law;
  law.a_ = law.min_ = law.max_ = size.si();
  return law;
}

std::expected<SizeLaw, SizeError> SizeLaw::make(const SizeSpec& spec) {
  SizeLaw law;
  law.distribution_ = spec.distribution;
  law.max_ = infinity;
  if (spec.min) {
    CLEAVE_TRY(law.min_, not_negative(spec.min, "min"));
  }
  if (spec.max) {
    CLEAVE_TRY(law.max_, positive(spec.max, "max"));
  }
  const auto empty = [&] { return std::unexpected(EmptyRange{metres(law.min_), metres(law.max_)}); };
  const auto as_constant = [&](double value) -> std::expected<SizeLaw, SizeError> {
    if (value < law.min_ || value > law.max_) return empty();
    return constant(metres(value));
  };
  if (law.min_ > law.max_) return empty();
  if (law.min_ == law.max_) return constant(metres(law.min_));

  const auto truncate_normal = [&](double a, double b) {
    law.below_ = special::normal_cdf(a);
    law.above_ = special::normal_cdf(-b);
    law.mass_ = normal_between(a, b);
  };
  switch (spec.distribution) {
    case SizeDistribution::constant: {
      CLEAVE_TRY(const double mean, positive(spec.mean, "mean"));
      return as_constant(mean);
    }
    case SizeDistribution::normal: {
      CLEAVE_TRY(law.a_, positive(spec.mean, "mean"));
      CLEAVE_TRY(law.b_, not_negative(spec.std, "std"));
      if (law.b_ == 0) return as_constant(law.a_);
      law.min_ = std::fmax(law.min_, 1e-6 * law.a_);
      if (law.min_ >= law.max_) return empty();
      truncate_normal((law.min_ - law.a_) / law.b_, (law.max_ - law.a_) / law.b_);
      break;
    }
    case SizeDistribution::exponential: {
      CLEAVE_TRY(law.a_, positive(spec.mean, "mean"));
      law.mass_ = std::exp(-law.min_ / law.a_) * -std::expm1(-(law.max_ - law.min_) / law.a_);
      break;
    }
    case SizeDistribution::lognormal: {
      CLEAVE_TRY(const double mean, positive(spec.mean, "mean"));
      CLEAVE_TRY(const double std, not_negative(spec.std, "std"));
      if (std == 0) return as_constant(mean);
      const double variance = std::log1p(std * std / (mean * mean));
      law.a_ = std::log(mean) - variance / 2;
      law.b_ = std::sqrt(variance);
      truncate_normal((std::log(law.min_) - law.a_) / law.b_, (std::log(law.max_) - law.a_) / law.b_);
      break;
    }
    case SizeDistribution::gamma: {
      CLEAVE_TRY(const double mean, positive(spec.mean, "mean"));
      CLEAVE_TRY(const double std, not_negative(spec.std, "std"));
      if (std < 1e-6 * mean) return as_constant(mean);
      law.a_ = mean * mean / (std * std);
      law.b_ = std * std / mean;
      law.below_ = special::gamma_below(law.a_, law.min_ / law.b_);
      law.above_ = std::isinf(law.max_) ? 0 : special::gamma_above(law.a_, law.max_ / law.b_);
      law.mass_ = law.below_ < 0.5 ? (1 - law.below_) - law.above_
                                   : special::gamma_above(law.a_, law.min_ / law.b_) - law.above_;
      break;
    }
    case SizeDistribution::power: {
      if (!spec.exponent) return std::unexpected(MissingParameter{"exponent"});
      law.a_ = *spec.exponent;
      if (!(law.a_ > 0) || law.a_ > 1e3) {
        return std::unexpected(BadParameter{"exponent", law.a_, "give a number above 0 and at most 1000"});
      }
      CLEAVE_TRY(law.min_, positive(spec.min, "min"));
      if (law.a_ <= 2 && !spec.max) return std::unexpected(MissingParameter{"max"});
      break;
    }
    case SizeDistribution::uniform: {
      CLEAVE_TRY(law.min_, positive(spec.min, "min"));
      CLEAVE_TRY(law.max_, positive(spec.max, "max"));
      break;
    }
  }
  if (law.mass_ < least_share) return empty();
  if (spec.clamp) {
    if (!spec.min && spec.distribution == SizeDistribution::normal) return std::unexpected(MissingParameter{"min"});
    if (!spec.min && !spec.max) return std::unexpected(MissingParameter{"max"});
    law.clamp();
  }
  return law;
}

/// What lies beyond the limits, law by law, from the tail itself.
void SizeLaw::clamp() {
  switch (distribution_) {
    case SizeDistribution::constant:
    case SizeDistribution::uniform: return;
    case SizeDistribution::normal:
    case SizeDistribution::lognormal:
    case SizeDistribution::gamma:
      at_min_ = below_;
      at_max_ = above_;
      return;
    case SizeDistribution::exponential:
      at_min_ = -std::expm1(-min_ / a_);
      at_max_ = std::exp(-max_ / a_);
      return;
    case SizeDistribution::power:
      at_max_ = std::pow(min_ / max_, a_);
      mass_ = 1 - at_max_;
      return;
  }
}

Length SizeLaw::quantile(double u) const noexcept {
  if (at_min_ == 0 && at_max_ == 0) return quantile_within(u);
  if (u <= at_min_) return metres(min_);
  if (1 - u <= at_max_) return metres(max_);
  constexpr double least = 0x1p-54;
  return quantile_within(std::fmin(std::fmax((u - at_min_) / mass_, least), 1 - 2 * least));
}

double SizeLaw::moment(int k) const noexcept {
  const double within = moment_within(k);
  if (at_min_ == 0 && at_max_ == 0) return within;
  const double all = at_min_ + mass_ + at_max_, at_max = at_max_ > 0 ? at_max_ * std::pow(max_, k) : 0;
  return (at_min_ * std::pow(min_, k) + mass_ * within + at_max) / all;
}

Length SizeLaw::quantile_within(double u) const noexcept {
  const auto standard = [&] {
    const double low = below_ + u * mass_, high = above_ + (1 - u) * mass_;
    return low < high ? normal_quantile(low) : -normal_quantile(high);
  };
  const auto within = [&](double x) { return metres(std::fmin(std::fmax(x, min_), max_)); };
  switch (distribution_) {
    case SizeDistribution::constant: return metres(a_);
    case SizeDistribution::normal: return within(a_ + b_ * standard());
    case SizeDistribution::exponential: return within(min_ - a_ * std::log1p(u * std::expm1(-(max_ - min_) / a_)));
    case SizeDistribution::lognormal: return within(std::exp(a_ + b_ * standard()));
    case SizeDistribution::gamma: {
      const double low = below_ + u * mass_, high = above_ + (1 - u) * mass_;
      return within(b_ * (low < high ? special::gamma_below_inverse(a_, low) : special::gamma_above_inverse(a_, high)));
    }
    case SizeDistribution::uniform: return within(min_ + u * (max_ - min_));
    case SizeDistribution::power: return within(min_ * std::exp(-std::log1p(u * (std::pow(min_ / max_, a_) - 1)) / a_));
  }
  std::unreachable();
}

double SizeLaw::moment_within(int k) const noexcept {
  CLEAVE_ASSERT(k == 1 || k == 2);
  switch (distribution_) {
    case SizeDistribution::constant: return k == 1 ? a_ : a_ * a_;
    case SizeDistribution::normal: {
      const double a = (min_ - a_) / b_, b = (max_ - a_) / b_;
      const double first = (special::normal_density(a) - special::normal_density(b)) / mass_;
      const double second = 1 + (density_moment(a) - density_moment(b)) / mass_;
      return k == 1 ? a_ + b_ * first : a_ * a_ + 2 * a_ * b_ * first + b_ * b_ * second;
    }
    case SizeDistribution::exponential: {
      // x = min + t, t exponential on [0, l]
      const double l = max_ - min_, m = a_;
      double first = l / 2 * (1 - l / (6 * m)), second = l * l / 3 * (1 - l / (4 * m));  // nearly uniform
      if (l > 1e-5 * m) {
        const double tail = std::expm1(l / m);
        first = m - (std::isinf(tail) ? 0 : l / tail);
        second = 2 * m * m - (std::isinf(tail) ? 0 : (l * l + 2 * m * l) / tail);
      }
      return k == 1 ? min_ + first : min_ * min_ + 2 * min_ * first + second;
    }
    case SizeDistribution::lognormal: {
      const double shift = k * b_;
      const double a = (std::log(min_) - a_) / b_, b = (std::log(max_) - a_) / b_;
      return std::exp(k * a_ + shift * shift / 2) * normal_between(a - shift, b - shift) / mass_;
    }
    case SizeDistribution::gamma: {
      const double from = min_ / b_, to = max_ / b_, shape = a_ + k;
      const double between = std::isinf(to) ? special::gamma_above(shape, from)
                             : from > shape ? special::gamma_above(shape, from) - special::gamma_above(shape, to)
                                            : special::gamma_below(shape, to) - special::gamma_below(shape, from);
      return std::pow(b_, k) * (k == 1 ? a_ : a_ * (a_ + 1)) * between / mass_;
    }
    case SizeDistribution::uniform: return k == 1 ? (min_ + max_) / 2 : (min_ * min_ + min_ * max_ + max_ * max_) / 3;
    case SizeDistribution::power: {
      const double ratio = min_ / max_;
      const double scale = std::pow(min_, k) * a_ / (1 - std::pow(ratio, a_));
      const double excess = a_ - k;
      if (std::abs(excess) < 1e-9) return scale * -std::log(ratio);
      return scale * -std::expm1(excess * std::log(ratio)) / excess;
    }
  }
  std::unreachable();
}

double SizeLaw::kept_share() const noexcept { return mass_; }

BootstrapOrientation BootstrapOrientation::make(std::vector<geometry::Vec3> normals, std::vector<double> weights,
                                                std::optional<double> jitter) {
  CLEAVE_ASSERT(!normals.empty() && normals.size() == weights.size());
  double sum = 0;
  for (double& weight : weights) {
    CLEAVE_ASSERT(weight > 0 && std::isfinite(weight));
    sum += weight;
    weight = sum;
  }
  // Mean axis: turned to one side, summed, until no axis changes its side.
  geometry::Vec3 mean = normals.front();
  for (int round = 0; round < 100; ++round) {
    geometry::Vec3 next;
    for (std::size_t i = 0; i < normals.size(); ++i) {
      const double weight = (weights[i] - (i > 0 ? weights[i - 1] : 0)) / sum;
      next += (dot(normals[i], mean) < 0 ? -weight : weight) * normals[i];
    }
    next = norm(next) > 0 ? normalized(next) : mean;
    const bool same = norm(next - mean) < 1e-14;
    mean = next;
    if (same) break;
  }
  if (mean.z < 0) mean = -mean;
  for (double& weight : weights) weight /= sum;
  weights.back() = 1;
  constexpr double degrees = 180 / std::numbers::pi;
  double direction = std::atan2(mean.x, mean.y) * degrees;
  if (direction < 0) direction += 360;
  return {Dip::degrees(std::atan2(std::hypot(mean.x, mean.y), mean.z) * degrees), DipDirection::degrees(direction),
          std::move(normals), std::move(weights), jitter};
}

Length SizeLaw::largest() const noexcept { return std::isinf(max_) ? quantile(1 - 1e-6) : metres(max_); }

std::string describe(const SizeError& error) {
  return std::visit(
      overloaded{
          [](const MissingParameter& e) { return fmt::format("{}: missing; this law needs it", e.key); },
          [](const BadParameter& e) { return fmt::format("{}: {} is out of range; {}", e.key, e.value, e.remedy); },
          [](const EmptyRange& e) {
            if (e.min > e.max) return fmt::format("min = {} m is above max = {} m; swap them", e.min.si(), e.max.si());
            return fmt::format("the law has no sizes between min = {} m and max = {} m; widen the limits", e.min.si(),
                               e.max.si());
          },
      },
      error);
}

}  // namespace cleave::dfn
