#include "cleave/survey/orientation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "cleave/core/special.hpp"
#include "cleave/geometry/predicates.hpp"

namespace cleave::survey {

using geometry::Vec3;

namespace {

constexpr double pi = std::numbers::pi;

Vec3 upward(Vec3 n) { return n.z < 0 || (n.z == 0 && (n.y < 0 || (n.y == 0 && n.x < 0))) ? -n : n; }

using Matrix = std::array<std::array<double, 3>, 3>;

/// Eigenvalues and vectors of a symmetric matrix by Jacobi rotations.
OrientationTensor eigen(Matrix a) {
  Matrix v{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (int sweep = 0; sweep < 50; ++sweep) {
    double off = 0;
    for (std::size_t p = 0; p < 3; ++p) {
      for (std::size_t q = p + 1; q < 3; ++q) {
        off += a[p][q] * a[p][q];
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (std::size_t k = 0; k < 3; ++k) {
          const double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq;
          a[k][q] = s * kp + c * kq;
        }
        for (std::size_t k = 0; k < 3; ++k) {
          const double pk = a[p][k], qk = a[q][k];
          a[p][k] = c * pk - s * qk;
          a[q][k] = s * pk + c * qk;
          const double vp = v[k][p], vq = v[k][q];
          v[k][p] = c * vp - s * vq;
          v[k][q] = s * vp + c * vq;
        }
      }
    }
    if (off < 1e-30) break;
  }
  std::array<std::size_t, 3> order{0, 1, 2};
  std::ranges::sort(order, [&](std::size_t i, std::size_t j) { return a[i][i] > a[j][j]; });
  OrientationTensor result{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = order[i];
    result.values[i] = a[k][k];
    result.vectors[i] = upward({v[0][k], v[1][k], v[2][k]});
  }
  return result;
}

/// Stephens (1974): K-S of exponential data with fitted mean; the 5 % point of the modified statistic is 1.094.
double stephens(std::vector<double> x) {
  const auto n = static_cast<double>(x.size());
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / n;
  if (!(mean > 0)) return 0;
  std::ranges::sort(x);
  double d = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double f = -std::expm1(-x[i] / mean), k = static_cast<double>(i);
    d = std::max({d, f - k / n, (k + 1) / n - f});
  }
  return (d - 0.2 / n) * (std::sqrt(n) + 0.26 + 0.5 / std::sqrt(n));
}

/// Mean of g(n) over a Fisher law (a uniform one for kappa 0) by an additive recurrence (Roberts 2018).
template <class G>
double fisher_mean(Vec3 mean, double kappa, G&& g) {
  if (std::isinf(kappa)) return g(mean);
  const Vec3 some = std::abs(mean.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 e1 = normalized(cross(mean, some)), e2 = cross(mean, e1);
  constexpr int points = 1 << 14;
  double sum = 0;
  for (int i = 0; i < points; ++i) {
    const double u = std::fmod(0.5 + 0.7548776662466927 * i, 1.0), v = std::fmod(0.5 + 0.5698402909980532 * i, 1.0);
    const double versine = kappa > 0 ? -std::log1p(u * std::expm1(-2 * kappa)) / kappa : 2 * u;
    const double sine = std::sqrt(std::max(0.0, versine * (2 - versine)));
    sum += g((1 - versine) * mean + sine * (std::cos(2 * pi * v) * e1 + std::sin(2 * pi * v) * e2));
  }
  return sum / points;
}

/// Square c of the radius with P(a z1^2 + b z2^2 <= c) = confidence, z normal; a >= b >= 0.
double radius_squared(double a, double b, double confidence) {
  constexpr int points = 64;
  const auto outside = [&](double c) {
    double sum = 0;
    for (int i = 0; i < points; ++i) {
      const double angle = pi * (i + 0.5) / points,
                   v = a * std::pow(std::cos(angle), 2) + b * std::pow(std::sin(angle), 2);
      sum += v > 0 ? std::exp(-c / (2 * v)) : 0;
    }
    return sum / points;
  };
  double low = 0, high = -2 * a * std::log1p(-confidence);
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (outside(middle) > 1 - confidence ? low : high) = middle;
  }
  return high;
}

/// Half angle of a cone that holds a plane normal vector of this covariance; `equal`: as many equal joints take the
/// place of N in Fisher's widening for few.
double cone_of(double xx, double xy, double yy, double equal, double confidence) {
  const double middle = (xx + yy) / 2, apart = std::hypot((xx - yy) / 2, xy), level = 1 / (1 - confidence);
  const double wider = (std::pow(level, 1 / (equal - 1)) - 1) * (equal - 1) / std::log(level);
  const double square = wider * radius_squared(middle + apart, std::max(0.0, middle - apart), confidence);
  return std::atan(std::sqrt(square)) * 180 / pi;
}

/// Half angle of the cone of a weighted mean: each joint left out in turn moves it (jackknife); as many equal joints as
/// carry the scatter take the place of N in Fisher's widening for few.
double weighted_cone(std::span<const Vec3> normals, std::span<const double> weights, Vec3 mean, double effective,
                     double confidence) {
  const Vec3 some = std::abs(mean.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 e1 = normalized(cross(mean, some)), e2 = cross(mean, e1);
  const auto turned = [&](std::size_t i) {
    return (dot(normals[i], mean) < 0 ? -weights[i] : weights[i]) * normals[i];
  };
  const auto n = static_cast<double>(normals.size());
  Vec3 sum{0, 0, 0};
  for (std::size_t i = 0; i < normals.size(); ++i) sum += turned(i);
  double x1 = 0, y1 = 0, xx = 0, yy = 0, xy = 0, parts = 0, squares = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vec3 rest = sum - turned(i);
    const double length = norm(rest);
    if (!(length > 0)) return 90;
    const double x = dot(rest, e1) / length, y = dot(rest, e2) / length, c = dot(normals[i], mean);
    x1 += x / n;
    y1 += y / n;
    xx += x * x;
    yy += y * y;
    xy += x * y;
    const double part = weights[i] * weights[i] * std::max(0.0, 1 - c * c);
    parts += part;
    squares += part * part;
  }
  const double share = (n - 1) / n;
  const double equal = std::max(3.0, squares > 0 ? std::min(effective, 2 * parts * parts / squares) : effective);
  return cone_of(share * (xx - n * x1 * x1), share * (xy - n * x1 * y1), share * (yy - n * y1 * y1), equal, confidence);
}

/// The same from the scatter that joints of the fitted law have where they are met so, and the number of equal joints
/// that they weigh as much as.
std::pair<double, double> cone_of_law(const FisherFit& fit, std::span<const Sampling> met, double cap,
                                      double confidence) {
  const Vec3 some = std::abs(fit.mean.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 e1 = normalized(cross(fit.mean, some)), e2 = cross(fit.mean, e1);
  constexpr double no_cap = 1e9;
  double weights = 0, squares = 0, along = 0, xx = 0, xy = 0, yy = 0;
  for (const Sampling& way : met) {
    double chance = 0, w1 = 0, w2 = 0, c1 = 0, x2 = 0, mixed = 0, y2 = 0;
    static_cast<void>(fisher_mean(fit.mean, fit.kappa, [&](Vec3 n) {
      const double a = 1 / way.weight(n, no_cap), w = way.weight(n, cap);
      const double x = dot(n, e1), y = dot(n, e2), square = a * w * w;
      chance += a;
      w1 += a * w;
      w2 += square;
      c1 += a * w * std::abs(dot(n, fit.mean));
      x2 += square * x * x;
      mixed += square * x * y;
      y2 += square * y * y;
      return 0.0;
    }));
    const double share = static_cast<double>(way.joints) / chance;
    weights += share * w1;
    squares += share * w2;
    along += share * c1;
    xx += share * x2;
    xy += share * mixed;
    yy += share * y2;
  }
  const double expected = weights * weights / squares, scale = 1 / (along * along);
  return {cone_of(scale * xx, scale * xy, scale * yy, std::max(3.0, expected), confidence), expected};
}

}  // namespace

double terzaghi_weight(Vec3 normal, Vec3 line, double cap) {
  const double cosine = std::abs(dot(normal, line));
  return cosine * cap > 1 ? 1 / cosine : cap;
}

double window_weight(Vec3 normal, Vec3 window_normal, double d, double area, double b, double cap) {
  const double cosine = std::abs(dot(normal, window_normal));
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const double inverse = sine * cap > 1 ? 1 / sine : cap;
  return d > 0 ? inverse / (1 + pi / 4 * d * b / area) : inverse;
}

OrientationTensor orientation_tensor(std::span<const Vec3> normals, std::span<const double> weights) {
  Matrix a{};
  double sum = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const std::array<double, 3> n{normals[i].x, normals[i].y, normals[i].z};
    for (std::size_t p = 0; p < 3; ++p) {
      for (std::size_t q = 0; q < 3; ++q) a[p][q] += weights[i] * n[p] * n[q];
    }
    sum += weights[i];
  }
  for (auto& row : a) {
    for (double& v : row) v /= sum;
  }
  return eigen(a);
}

FisherFit fit_fisher(std::span<const Vec3> normals, std::span<const double> weights, double confidence, double cap,
                     std::span<const Sampling> met) {
  FisherFit fit;
  fit.count = normals.size();
  const OrientationTensor tensor = orientation_tensor(normals, weights);
  Vec3 centre = tensor.vectors[0];
  double sum = 0, squares = 0, resultant = 0;
  for (const double w : weights) {
    sum += w;
    squares += w * w;
    fit.capped += w >= cap ? 1U : 0U;
  }
  for (int round = 0; round < 100; ++round) {
    Vec3 r{0, 0, 0};
    for (std::size_t i = 0; i < normals.size(); ++i) {
      r += (dot(normals[i], centre) < 0 ? -weights[i] : weights[i]) * normals[i];
    }
    resultant = norm(r);
    const Vec3 next = resultant > 0 ? r / resultant : centre;
    const bool same = norm(next - centre) < 1e-14;
    centre = next;
    if (same) break;
  }
  fit.mean = upward(centre);
  const double n = sum * sum / squares, r = resultant / sum * n;
  fit.effective_count = fit.expected_count = n;
  const double gap = n - r;
  if (normals.size() < 2 || gap < 1e-12 * n) {
    fit.kappa = fit.kappa_low = fit.kappa_high = INFINITY;
    return fit;
  }
  // 2 kappa (N - R) is about chi-squared with 2 (N - 1) degrees of freedom.
  const double a = (1 - confidence) / 2, degrees = 2 * (n - 1);
  fit.kappa = (n - 1) / gap;
  fit.kappa_low = special::chi_squared_quantile(a, degrees) / (2 * gap);
  fit.kappa_high = special::chi_squared_quantile(1 - a, degrees) / (2 * gap);
  const double cosine = 1 - gap / r * (std::pow(1 / (1 - confidence), 1 / (n - 1)) - 1);
  const bool equal = std::ranges::adjacent_find(weights, std::ranges::not_equal_to{}) == weights.end();
  const double own_cone = equal || normals.size() < 3 ? std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / pi
                                                      : weighted_cone(normals, weights, fit.mean, n, confidence);
  fit.cone_degrees = own_cone;
  if (normals.size() >= 5) {
    std::vector<double> versines;
    for (const Vec3 normal : normals) versines.push_back(1 - std::abs(dot(normal, fit.mean)));
    fit.statistic = stephens(std::move(versines));
    // Var of (n.v)^2 about each of the two smaller axes gives the standard error of their difference.
    double m = 0, m2 = 0;
    for (std::size_t i = 0; i < normals.size(); ++i) {
      const double p = dot(normals[i], tensor.vectors[1]), q = dot(normals[i], tensor.vectors[2]);
      const double d = p * p - q * q, w = weights[i] / sum;
      m += w * d;
      m2 += w * d * d;
    }
    // Choosing the axes makes the difference positive: its mean is about 1.25 standard errors under symmetry.
    const double error = std::sqrt(std::max(0.0, m2 - m * m) / n);
    fit.fisher = *fit.statistic < 1.094 && m < 3.25 * error;
  }
  if (equal || normals.size() < 3 || met.empty()) return fit;
  const auto [cone, expected] = cone_of_law(fit, met, cap, confidence);
  fit.cone_degrees = fit.fisher ? cone : std::max(cone, own_cone);
  fit.expected_count = expected;
  return fit;
}

namespace {

/// Sine squared of the angle between two normals.
double apart(Vec3 a, Vec3 b) { return std::max(0.0, 1 - dot(a, b) * dot(a, b)); }

/// Where sets begin: the densest joint, with the most others within 15 degrees (of at most 4,000 looked at); then each
/// time the one farthest from those there are.
std::vector<Vec3> first_centres(std::span<const Vec3> normals, std::size_t sets) {
  const std::size_t n = normals.size(), stride = std::max<std::size_t>(1, n / 4000);
  const double near = std::pow(std::sin(15 * pi / 180), 2);
  std::size_t densest = 0, most = 0;
  for (std::size_t i = 0; i < n; i += stride) {
    std::size_t count = 0;
    for (std::size_t j = 0; j < n; j += stride) count += apart(normals[i], normals[j]) < near ? 1U : 0U;
    if (count > most) {
      most = count;
      densest = i;
    }
  }
  std::vector<Vec3> centres{normals[densest]};
  while (centres.size() < sets) {
    std::size_t farthest = 0;
    double best = -1;
    for (std::size_t i = 0; i < n; ++i) {
      double d = 2;
      for (const Vec3 c : centres) d = std::min(d, apart(normals[i], c));
      if (d > best) {
        best = d;
        farthest = i;
      }
    }
    centres.push_back(normals[farthest]);
  }
  return centres;
}

/// Own set against the nearest other one; mean over at most 2,000 joints, each of which has a set.
double silhouette_of(std::span<const Vec3> normals, const std::vector<std::optional<std::size_t>>& set,
                     std::size_t sets) {
  const std::size_t n = normals.size(), look = std::max<std::size_t>(1, n / 2000);
  double total = 0;
  std::size_t looked = 0;
  for (std::size_t i = 0; i < n; i += look) {
    std::vector<double> sum(sets, 0);
    std::vector<std::size_t> count(sets, 0);
    for (std::size_t j = 0; j < n; j += look) {
      if (i == j) continue;
      sum[*set[j]] += apart(normals[i], normals[j]);
      ++count[*set[j]];
    }
    double inside = 0, outside = 2;
    for (std::size_t k = 0; k < sets; ++k) {
      if (count[k] == 0) continue;
      const double mean = sum[k] / static_cast<double>(count[k]);
      (k == set[i] ? inside : outside) = k == set[i] ? mean : std::min(outside, mean);
    }
    if (std::max(inside, outside) > 0) total += (outside - inside) / std::max(inside, outside);
    ++looked;
  }
  return total / static_cast<double>(looked);
}

struct Members {
  std::vector<Vec3> normals;
  std::vector<double> weights;
};
Members members_of(std::size_t set, const Clustering& found, std::span<const Vec3> normals,
                   std::span<const double> weights) {
  Members members;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (found.set[i] != set) continue;
    members.normals.push_back(normals[i]);
    members.weights.push_back(weights[i]);
  }
  return members;
}

/// Beyond the 1e-3 tail of a set's Fisher law: of no set.
void mark_beyond(Clustering& found, std::size_t sets, std::span<const Vec3> normals, std::span<const double> weights) {
  for (std::size_t k = 0; k < sets; ++k) {
    const Members members = members_of(k, found, normals, weights);
    if (members.normals.size() < 5) continue;
    const FisherFit fit = fit_fisher(members.normals, members.weights);
    if (std::isinf(fit.kappa)) continue;
    const double versine = -std::log(1e-3) / fit.kappa;
    for (std::size_t i = 0; i < normals.size(); ++i) {
      if (found.set[i] == k && 1 - std::abs(dot(normals[i], fit.mean)) > versine) found.set[i].reset();
    }
  }
}

}  // namespace

Clustering cluster(std::span<const Vec3> normals, std::span<const double> weights, std::size_t sets,
                   bool mark_outliers) {
  Clustering result;
  const std::size_t n = normals.size();
  result.set.assign(n, 0);
  sets = std::min(sets, n);
  if (sets == 0) return result;
  result.centres = first_centres(normals, sets);
  for (int round = 0; round < 200; ++round) {
    bool changed = round == 0;
    for (std::size_t i = 0; i < n; ++i) {
      std::size_t best = 0;
      for (std::size_t k = 1; k < sets; ++k) {
        if (apart(normals[i], result.centres[k]) < apart(normals[i], result.centres[best])) best = k;
      }
      changed = changed || best != result.set[i];
      result.set[i] = best;
    }
    if (!changed) break;
    for (std::size_t k = 0; k < sets; ++k) {
      const Members members = members_of(k, result, normals, weights);
      if (!members.normals.empty()) {
        result.centres[k] = orientation_tensor(members.normals, members.weights).vectors[0];
      }
    }
  }
  if (sets > 1) result.silhouette = silhouette_of(normals, result.set, sets);
  for (Vec3& centre : result.centres) centre = upward(centre);
  if (mark_outliers) mark_beyond(result, sets, normals, weights);
  return result;
}

bool pole_inside(Vec3 normal, std::span<const Vec3> polygon) {
  constexpr double level = 1e-6;
  const auto flat = [](Vec3 v) { return Vec2{v.x / (1 - v.z), v.y / (1 - v.z)}; };
  // Corners on the rim are taken beyond it: what lies on the rim between two of them is inside, not cut off by a chord.
  const auto corner = [&](Vec3 v) {
    if (std::abs(v.z) < level) return Vec2{2 * v.x, 2 * v.y};
    return flat(v.z > 0 ? -v : v);
  };
  std::vector<Vec2> outline;
  for (const Vec3 v : polygon) outline.push_back(corner(v));
  const auto holds = [&](Vec2 p) { return geometry::encloses(outline, p); };
  // A level pole has two ends on the rim.
  if (std::abs(normal.z) < level) return holds({normal.x, normal.y}) || holds({-normal.x, -normal.y});
  return holds(flat(normal.z > 0 ? -normal : normal));
}

double mean_line_cosine(Vec3 mean, double kappa, Vec3 line) {
  return fisher_mean(mean, kappa, [&](Vec3 n) { return std::abs(dot(n, line)); });
}

double mean_plane_sine(Vec3 mean, double kappa, Vec3 plane_normal) {
  return fisher_mean(mean, kappa, [&](Vec3 n) {
    const double c = dot(n, plane_normal);
    return std::sqrt(std::max(0.0, 1 - c * c));
  });
}

}  // namespace cleave::survey
