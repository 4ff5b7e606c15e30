#include "cleave/survey/traces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "cleave/core/fields.hpp"
namespace cleave::survey {
namespace {
constexpr double pi = std::numbers::pi;
}

double quarter_sine(int k) {
  double j = k % 2 == 0 ? pi / 2 : 1;
  for (int i = k % 2 == 0 ? 2 : 3; i <= k; i += 2) j *= (i - 1.0) / i;
  return j;
}

std::string_view name_of(JointShape shape) noexcept { return enum_name(shape); }

Chords chords_of(const ShapeRule& shape, double trace) noexcept {
  const double beta = (trace - shape.rotation) * pi / 180;
  switch (shape.shape) {
    case JointShape::disc: return {};
    case JointShape::ellipse: {
      const double m = ellipse_factor(shape.aspect, beta);
      return {pi / 4 * m, 2.0 / 3 * m * m, pi / 4 / shape.aspect, m};
    }
    case JointShape::rectangle: {
      // Towards one of the sides the chord along it alone is left; the formulas need an angle.
      constexpr double least = 1e-9;
      const double p = std::max(least, std::abs(std::remainder(beta, pi)));
      const double q = std::max(least, pi / 2 - p);
      const ParallelogramChords c = parallelogram_chords(1, 1 / shape.aspect, p, q);
      const double second = c.longest * c.longest * (c.share_longest + (1 - c.share_longest) / 3);
      return {c.mean, second, 1 / shape.aspect, std::nullopt};
    }
  }
  std::unreachable();
}

SizeMoments size_moments(double mean_length, double second_moment, const Chords& chords) noexcept {
  return {mean_length / chords.first, second_moment / chords.second};
}

std::optional<SizeOfJoints> size_law(Family family, double mean_length, double second_moment, const Chords& chords) {
  const SizeMoments m = size_moments(mean_length, second_moment, chords);
  switch (family) {
    case Family::exponential: return SizeOfJoints{.family = family, .mean = m.m2 / 2, .std = m.m2 / 2};
    case Family::lognormal: {
      if (!(m.ratio() >= 1)) return std::nullopt;
      const double s2 = std::log(m.ratio()), mean = m.m2 * std::exp(-s2);
      return SizeOfJoints{.family = family, .mean = mean, .std = mean * std::sqrt(std::expm1(s2))};
    }
    case Family::gamma: {
      if (!(m.ratio() > 1) || m.ratio() >= 2) return std::nullopt;
      const double shape = (2 - m.ratio()) / (m.ratio() - 1), scale = m.m2 / (shape + 1);
      return SizeOfJoints{.family = family, .mean = shape * scale, .std = std::sqrt(shape) * scale};
    }
    case Family::power:   // its limits are not to be had from two moments
    case Family::normal:  // a law of traces: sizes are never below their traces
    case Family::constant: return std::nullopt;
  }
  std::unreachable();
}

std::optional<SizeOfJoints> power_size(double m2, double min, double max) {
  if (!(min > 0) || !(max > min)) return std::nullopt;
  const auto law = [&](double exponent) {
    Fit fit;
    fit.family = Family::power;
    fit.a = exponent;
    fit.min = min;
    fit.max = max;
    return fit;
  };
  // E L^2/E L falls with the exponent.
  const auto mean = [&](double exponent) {
    const Fit fit = law(exponent);
    return fit.moment(2) / fit.moment(1);
  };
  double low = 0.02, high = 50;
  if (!(mean(low) > m2) || !(mean(high) < m2)) return std::nullopt;
  for (int i = 0; i < 200; ++i) {
    const double middle = (low + high) / 2;
    (mean(middle) > m2 ? low : high) = middle;
  }
  return size_of(law(low));
}

SizeOfJoints size_of(const Fit& sizes) {
  SizeOfJoints law{.family = sizes.family, .mean = sizes.moment(1), .std = std_of(sizes)};
  if (sizes.family == Family::power) {
    law.exponent = sizes.a;
    law.min = sizes.min;
    law.max = sizes.max;
  }
  return law;
}

double size_moment(const SizeOfJoints& law, int k) {
  const double cv2 = law.std * law.std / (law.mean * law.mean);
  switch (law.family) {
    case Family::exponential: return std::tgamma(k + 1.0) * std::pow(law.mean, k);
    case Family::lognormal: return std::pow(law.mean, k) * std::pow(1 + cv2, k * (k - 1) / 2.0);
    case Family::gamma: {
      double m = 1;
      for (int i = 0; i < k; ++i) m *= law.mean * (1 + i * cv2);
      return m;
    }
    case Family::power: {
      Fit fit;
      fit.family = Family::power;
      fit.a = law.exponent;
      fit.min = law.min;
      fit.max = law.max;
      return fit.moment(k);
    }
    case Family::normal: {
      Fit fit;
      fit.family = Family::normal;
      fit.a = law.mean;
      fit.b = law.std;
      return fit.moment(k);
    }
    case Family::constant: return std::pow(law.mean, k);
  }
  std::unreachable();
}

double third_moment(const SizeOfJoints& law) { return quarter_sine(4) * size_moment(law, 4) / size_moment(law, 1); }

double ellipse_factor(double aspect, double beta) {
  const double c = std::cos(beta), s = aspect * std::sin(beta);
  return 1 / std::sqrt(c * c + s * s);
}

ParallelogramChords parallelogram_chords(double p, double q, double angle_p, double angle_q) {
  ParallelogramChords chords;
  const double c1 = p * std::sin(angle_p), c2 = q * std::sin(angle_q);
  chords.longest = std::sin(angle_p + angle_q) * std::min(p / std::sin(angle_q), q / std::sin(angle_p));
  chords.share_longest = std::abs(c1 - c2) / (c1 + c2);
  chords.mean = chords.longest * (chords.share_longest + (1 - chords.share_longest) / 2);
  return chords;
}

namespace {

Estimate by_moments(const Fit& lengths, const Chords& chords, std::string name, double SizeOfJoints::* figure,
                    double confidence) {
  return estimate_of(
      lengths, std::move(name),
      [&chords, figure](const Fit& fit) -> std::optional<double> {
        const auto law = fit.family == Family::power
                             ? power_size(size_moments(fit.moment(1), 1, chords).m2, fit.min, fit.max)
                             : size_law(fit.family, fit.moment(1), fit.moment(2), chords);
        return law ? std::optional{(*law).*figure} : std::nullopt;
      },
      confidence);
}

}  // namespace

Estimate size_mean_by_moments(const Fit& lengths, const Chords& chords, double confidence) {
  return by_moments(lengths, chords, "mean size", &SizeOfJoints::mean, confidence);
}
Estimate size_std_by_moments(const Fit& lengths, const Chords& chords, double confidence) {
  return by_moments(lengths, chords, "standard deviation of the sizes", &SizeOfJoints::std, confidence);
}

}  // namespace cleave::survey
