#include "sweeps.hpp"

#include <algorithm>
#include <cmath>

namespace cleave::assembly {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Blocks far smaller than the largest are measured against this share of its load.
constexpr double least_load = 1e-6;
/// Sweeps between choices of what is awake.
constexpr int between = 8;

template <int width>
Vector3d relative(const Element& e, const VectorXd& v) {
  Vector3d u =
      e.on_body.template topRows<width>().transpose() * v.template segment<width>(width * static_cast<Index>(e.body));
  if (e.other) {
    u.noalias() += e.on_other.template topRows<width>().transpose() *
                   v.template segment<width>(width * static_cast<Index>(*e.other));
  }
  return u;
}

template <int width>
double opening(const Element& e, const VectorXd& v) {
  double u =
      e.on_body.template topRows<width>().col(0).dot(v.template segment<width>(width * static_cast<Index>(e.body)));
  if (e.other) {
    u += e.on_other.template topRows<width>().col(0).dot(
        v.template segment<width>(width * static_cast<Index>(*e.other)));
  }
  return u;
}

template <int width>
void add(const Element& e, const Vector3d& x, VectorXd& v) {
  v.template segment<width>(width * static_cast<Index>(e.body)).noalias() += e.on_body.template topRows<width>() * x;
  if (e.other) {
    v.template segment<width>(width * static_cast<Index>(*e.other)).noalias() +=
        e.on_other.template topRows<width>() * x;
  }
}

/// What a contact carries of w: no pull, shear within friction times its own pressure.
inline Vector3d carried(const Element& e, const Vector3d& w, double divisor, bool presses) {
  Vector3d x = w;
  double cap = 0;
  if (e.bond) {
    x[0] = std::clamp(w[0], -e.tension / divisor, 0.0);
    cap = presses ? e.cohesion / divisor : 0;
  } else {
    x[0] = std::max(0.0, w[0]);
    cap = e.friction / divisor * x[0];
  }
  const double shear = std::sqrt(w[1] * w[1] + w[2] * w[2]);
  if (shear > cap) x.tail<2>() *= cap / shear;
  return x;
}

bool sticks(const Element& e, const Vector3d& x, double divisor) {
  return x[0] > 0 && std::sqrt(x[1] * x[1] + x[2] * x[2]) <= e.friction / divisor * x[0];
}

}  // namespace

Sweeps::Sweeps(const Elements& elements, double divisor, double asleep)
    : elements_{&elements},
      divisor_{divisor},
      asleep_{asleep},
      state_{elements.load(), std::vector<Vector3d>(elements.all().size(), Vector3d::Zero())},
      before_(state_.x),
      along_(state_.x) {
  weight_.reserve(elements.all().size());
  stiff_.reserve(elements.all().size());
  for (const Element& e : elements.all()) {
    Matrix3d response = e.on_body.transpose() * e.on_body;
    if (e.other) response += e.on_other.transpose() * e.on_other;
    // Largest eigenvalue, from above: the largest sum of a row.
    weight_.push_back(std::max(response.cwiseAbs().rowwise().sum().maxCoeff(), 1e-300));
    bonds_ = bonds_ || e.bond;
    response.diagonal().array() += std::max(1e-9 * response.trace(), 1e-300);
    stiff_.emplace_back(response.inverse());
  }
  const Index w = elements.width();
  for (std::size_t b = 0; b < elements.bodies(); ++b) {
    own_.push_back(std::max(elements.load().segment(w * static_cast<Index>(b), w).norm(), least_load));
  }
}

double Sweeps::speed_over_own(std::size_t body) const {
  const Index w = elements_->width();
  return state_.v.segment(w * static_cast<Index>(body), w).norm() / own_[body];
}

std::vector<std::uint8_t> Sweeps::moving(double still) const {
  std::vector<std::uint8_t> out(elements_->bodies());
  for (std::size_t b = 0; b < out.size(); ++b) out[b] = speed_over_own(b) > still ? 1 : 0;
  return out;
}

void Sweeps::take(const std::vector<Vector3d>& forces) {
  state_.x = forces;
  state_.v = elements_->load();
  for (std::size_t k = 0; k < forces.size(); ++k) elements_->add_force(elements_->all()[k], forces[k], state_.v);
}

void Sweeps::choose() {
  const std::vector<std::uint8_t> awake = moving(asleep_);
  active_.clear();
  for (std::uint32_t k = 0; k < elements_->all().size(); ++k) {
    const Element& e = elements_->all()[k];
    if (awake[e.body] != 0 || (e.other && awake[*e.other] != 0)) {
      active_.push_back(k);
    } else {
      along_[k].setZero();
      before_[k] = state_.x[k];
    }
  }
}

template <int width>
double Sweeps::sweep(bool forwards) {
  double change = 0;
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const std::uint32_t k = active_[forwards ? i : active_.size() - 1 - i];
    const Element& e = elements_->all()[k];
    Vector3d& x = state_.x[k];
    bool presses = true;
    if (e.bond) {
      presses = false;
      const auto [first, last] = elements_->of_contact(e.contact);
      for (std::size_t j = first; j < last; ++j) {
        presses = presses || (!elements_->all()[j].bond && state_.x[j][0] > 1e-9);
      }
    }
    // Most contacts are open, and stay so.
    if (!e.bond && x[0] == 0 && opening<width>(e, state_.v) >= 0) {
      if (x[1] == 0 && x[2] == 0) continue;
    }
    const Vector3d u = relative<width>(e, state_.v);
    // Where it sticks the relative rate vanishes at once; else a step of the largest response.
    Vector3d next = e.bond ? x : Vector3d{x - stiff_[k] * u};
    if (e.bond || !sticks(e, next, divisor_)) next = carried(e, x - u / weight_[k], divisor_, presses);
    const Vector3d step = next - x;
    const double size = step.squaredNorm();
    if (!(size > 0)) continue;
    change += size;
    add<width>(e, step, state_.v);
    x = next;
  }
  return change;
}

template <int width>
void Sweeps::extrapolate(double share) {
  for (const std::uint32_t k : active_) {
    const Vector3d found = state_.x[k] - before_[k];
    if (share > 0) {
      const Vector3d step = share * along_[k];
      if (step.squaredNorm() > 0) {
        add<width>(elements_->all()[k], step, state_.v);
        state_.x[k] += step;
      }
      along_[k] = step + found;
    } else {
      along_[k] = found;
    }
  }
}

namespace {
template <class Call>
auto by_width(Index width, Call&& call) {
  switch (width) {
    case 2: return call.template operator()<2>();
    case 3: return call.template operator()<3>();
    default: return call.template operator()<6>();
  }
}
}  // namespace

void Sweeps::run(int most) {
  for (Vector3d& a : along_) a.setZero();
  choose();
  double last = 0;
  for (int k = 0; k < most; ++k) {
    if (active_.empty()) return;
    for (const std::uint32_t e : active_) before_[e] = state_.x[e];
    double change = 0;
    by_width(elements_->width(), [&]<int width>() {
      // There and back: symmetric, so that directions can be conjugate.
      (void)sweep<width>(true);
      (void)sweep<width>(false);
      for (const std::uint32_t e : active_) change += (state_.x[e] - before_[e]).squaredNorm();
      if (k + 1 == most) return;
      // Before the step, which may lead beyond what a contact carries: what is left alone must not keep that.
      if ((k + 1) % between == 0) choose();
      extrapolate<width>(last > 0 && change <= last ? change / last : 0);
    });
    if (change < 1e-26) return;
    last = change;
  }
}

}  // namespace cleave::assembly
