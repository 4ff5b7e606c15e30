#include "cleave/survey/size.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace cleave::survey {
namespace {
constexpr double pi = std::numbers::pi;
}

double quarter_sine(int k) {
  double j = k % 2 == 0 ? pi / 2 : 1;
  for (int i = k % 2 == 0 ? 2 : 3; i <= k; i += 2) j *= (i - 1.0) / i;
  return j;
}

DiscMoments disc_moments(double mean_length, double second_moment) noexcept {
  return {4 * mean_length / pi, 1.5 * second_moment};
}

std::optional<DiscLaw> disc_law(Family family, double mean_length, double second_moment) {
  const DiscMoments m = disc_moments(mean_length, second_moment);
  switch (family) {
    case Family::exponential: return DiscLaw{family, m.m2 / 2, m.m2 / 2};
    case Family::lognormal: {
      if (!(m.ratio() >= 1)) return std::nullopt;
      const double s2 = std::log(m.ratio()), mean = m.m2 * std::exp(-s2);
      return DiscLaw{family, mean, mean * std::sqrt(std::expm1(s2))};
    }
    case Family::gamma: {
      if (!(m.ratio() > 1) || m.ratio() >= 2) return std::nullopt;
      const double shape = (2 - m.ratio()) / (m.ratio() - 1), scale = m.m2 / (shape + 1);
      return DiscLaw{family, shape * scale, std::sqrt(shape) * scale};
    }
    case Family::power: return std::nullopt;  // its limits are not to be had from two moments
  }
  std::unreachable();
}

double diameter_moment(const DiscLaw& law, int k) {
  const double cv2 = law.std * law.std / (law.mean * law.mean);
  switch (law.family) {
    case Family::exponential: return std::tgamma(k + 1.0) * std::pow(law.mean, k);
    case Family::lognormal: return std::pow(law.mean, k) * std::pow(1 + cv2, k * (k - 1) / 2.0);
    case Family::gamma: {
      double m = 1;
      for (int i = 0; i < k; ++i) m *= law.mean * (1 + i * cv2);
      return m;
    }
    case Family::power: break;
  }
  return 0;
}

double third_moment(const DiscLaw& law) { return quarter_sine(4) * diameter_moment(law, 4) / diameter_moment(law, 1); }

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

Estimate of_discs(const Fit& lengths, std::string name, double DiscLaw::* figure, double confidence) {
  return estimate_of(
      lengths, std::move(name),
      [figure](const Fit& fit) -> std::optional<double> {
        const auto law = disc_law(fit.family, fit.moment(1), fit.moment(2));
        return law ? std::optional{(*law).*figure} : std::nullopt;
      },
      confidence);
}

}  // namespace

Estimate disc_mean(const Fit& lengths, double confidence) {
  return of_discs(lengths, "mean diameter", &DiscLaw::mean, confidence);
}
Estimate disc_std(const Fit& lengths, double confidence) {
  return of_discs(lengths, "standard deviation of the diameters", &DiscLaw::std, confidence);
}

}  // namespace cleave::survey
