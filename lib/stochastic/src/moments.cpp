#include "cleave/stochastic/statistics.hpp"

#include <algorithm>
#include <cmath>

namespace cleave::stochastic {

void Moments::add(double x) noexcept {
  const auto before = static_cast<double>(n_);
  ++n_;
  const auto n = static_cast<double>(n_);
  const double delta = x - mean_, step = delta / n, step2 = step * step;
  const double term = delta * step * before;
  mean_ += step;
  m4_ += term * step2 * (n * n - 3 * n + 3) + 6 * step2 * m2_ - 4 * step * m3_;
  m3_ += term * step * (n - 2) - 3 * step * m2_;
  m2_ += term;
  min_ = n_ == 1 ? x : std::min(min_, x);
  max_ = n_ == 1 ? x : std::max(max_, x);
}

double Moments::variance() const noexcept { return n_ < 2 ? 0 : m2_ / static_cast<double>(n_ - 1); }
double Moments::std() const noexcept { return std::sqrt(variance()); }
double Moments::standard_error() const noexcept { return n_ == 0 ? 0 : std() / std::sqrt(static_cast<double>(n_)); }
double Moments::skewness() const noexcept {
  return m2_ > 0 ? std::sqrt(static_cast<double>(n_)) * m3_ / std::pow(m2_, 1.5) : 0;
}
double Moments::excess_kurtosis() const noexcept {
  return m2_ > 0 ? static_cast<double>(n_) * m4_ / (m2_ * m2_) - 3 : 0;
}

void PairMoments::add(double y, double x) noexcept {
  ++n_;
  const auto n = static_cast<double>(n_);
  const double dy = y - mean_y_, dx = x - mean_x_;
  const double share = (n - 1) * (n - 2) / (n * n);
  yyy_ += dy * dy * dy * share - 3 * dy * yy_ / n;
  yyx_ += dy * dy * dx * share - (2 * dy * xy_ + dx * yy_) / n;
  yxx_ += dy * dx * dx * share - (2 * dx * xy_ + dy * xx_) / n;
  xxx_ += dx * dx * dx * share - 3 * dx * xx_ / n;
  mean_y_ += dy / n;
  mean_x_ += dx / n;
  yy_ += dy * (y - mean_y_);
  xx_ += dx * (x - mean_x_);
  xy_ += dy * (x - mean_x_);
}

double PairMoments::ratio() const noexcept { return mean_x_ > 0 ? mean_y_ / mean_x_ : 0; }

double PairMoments::ratio_standard_error() const noexcept {
  if (n_ < 2 || !(mean_x_ > 0)) return 0;
  const double r = ratio(), n = static_cast<double>(n_);
  const double sum = std::max(0.0, yy_ - 2 * r * xy_ + r * r * xx_);
  return std::sqrt(sum / ((n - 1) * n)) / mean_x_;
}

double PairMoments::ratio_skewness() const noexcept {
  if (n_ < 3 || !(mean_x_ > 0)) return 0;
  const double r = ratio(), square = yy_ - 2 * r * xy_ + r * r * xx_;
  const double cube = yyy_ - 3 * r * yyx_ + 3 * r * r * yxx_ - r * r * r * xxx_;
  // What is left of sums that are all but equal is rounding.
  if (!(square > 1e-12 * (yy_ + r * r * xx_))) return 0;
  return std::sqrt(static_cast<double>(n_)) * cube / std::pow(square, 1.5);
}

namespace {
constexpr double bin = 0.02;
}

void Tail::add(double x, double weight) {
  if (!(weight > 0)) return;
  all_ += weight;
  all_squares_ += weight * weight;
  negative_ = negative_ || x < 0;
  if (!(x > 0) || !std::isfinite(x)) return;
  above_ += weight;
  above_squares_ += weight * weight;
  bins_[static_cast<int>(std::floor(std::log(x) / bin))] += weight;
}

double Tail::parts() const noexcept { return above_ > 0 ? above_ * above_ / above_squares_ : 0; }

double Tail::log_variance() const noexcept {
  if (negative_) return 0;
  constexpr double least = 0.01;  // below it means are as of a normal law
  double below = 0, sum = 0;
  int median = 0;
  for (const auto& [at, weight] : bins_) {
    if (2 * below < above_) median = at;
    below += weight;
    if (2 * below >= above_) sum += weight * std::pow(bin * (at - median), 2);
  }
  const double square = above_ > 0 ? sum / (above_ / 2) : 0;
  return square > least ? square : 0;
}

double Tail::log_error_squared() const noexcept {
  const double square = log_variance(), p = all_ > 0 ? above_ / all_ : 0;
  if (!(square > 0)) return 0;
  return (1 - p) / p * all_squares_ / (all_ * all_) + (square + square * square) / parts();
}

bool Tail::long_from_few() const noexcept {
  constexpr double few = 25, long_square = 0.5;  // by `./x study coverage`
  return parts() < few && log_variance() > long_square;
}

double PairMoments::equal_parts() const noexcept {
  const double n = static_cast<double>(n_), squares = xx_ + n * mean_x_ * mean_x_;
  return squares > 0 ? n * mean_x_ * n * mean_x_ / squares : 0;
}

}  // namespace cleave::stochastic
