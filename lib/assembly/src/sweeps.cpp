#include "sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

namespace cleave::assembly {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Blocks far smaller than the largest are measured against this share of its load.
constexpr double least_load = 1e-6;
/// Sweeps between choices of what is awake.
constexpr int between = 8;
/// Pressure above which a point counts as pressed.
constexpr double pressed = 1e-9;

/// Rates of the two bodies that a unit force moves.
Matrix3d response_of(const Element& e) {
  Matrix3d response = e.on_body.transpose() * e.on_body;
  if (e.other) response += e.on_other.transpose() * e.on_other;
  return response;
}

/// Shear to within a bound.
inline void limit_shear(Vector3d& x, double cap) {
  const double square = x[1] * x[1] + x[2] * x[2];
  if (square <= cap * cap) return;
  const double share = cap / std::sqrt(square);
  x[1] *= share;
  x[2] *= share;
}

std::vector<std::uint32_t> ordered(std::size_t count, unsigned order) {
  std::vector<std::uint32_t> out(count);
  std::iota(out.begin(), out.end(), 0U);
  if (order == 1) std::ranges::reverse(out);
  if (order <= 1) return out;
  std::mt19937_64 draw{order};  // the same everywhere, which std::shuffle does not promise
  for (std::size_t left = count; left > 1; --left) std::swap(out[left - 1], out[draw() % left]);
  return out;
}

}  // namespace

template <class A>
Sweeps::Links<A> Sweeps::links_of(const Elements& elements) {
  Links<A> out;
  out.reserve(elements.all().size());
  const auto rows = [](std::size_t body) { return static_cast<std::uint32_t>(A::rows * body); };
  for (const Element& e : elements.all()) {
    // Largest eigenvalue, from above: the largest sum of a row.
    const double most = response_of(e).cwiseAbs().rowwise().sum().maxCoeff();
    out.push_back({rows(e.body), rows(e.other ? *e.other : elements.bodies()), 1 / std::max(most, 1e-300), e.friction,
                   e.bond, e.contact, A{e}});
  }
  return out;
}

Sweeps::AnyLinks Sweeps::any_links_of(const Elements& elements) {
  switch (elements.freedom()) {
    case Freedom::translation: return links_of<StraightArm>(elements);
    case Freedom::rigid: return links_of<Arm<6>>(elements);
    case Freedom::section_translation: return links_of<Arm<2>>(elements);
    case Freedom::section: return links_of<Arm<3>>(elements);
  }
  std::unreachable();
}

Sweeps::Sweeps(const Elements& elements, double divisor, double asleep, unsigned order)
    : elements_{&elements},
      divisor_{divisor},
      strength_{1 / divisor},
      asleep_{asleep},
      state_{elements.load(), std::vector<Vector3d>(elements.all().size(), Vector3d::Zero())},
      links_{any_links_of(elements)},
      order_{ordered(elements.all().size(), order)},
      before_(state_.x),
      along_(state_.x) {
  const bool straight = std::visit([]<class A>(const Links<A>&) { return !A::turns; }, links_);
  for (std::size_t k = 0; !straight && k < elements.all().size(); ++k) {
    Matrix3d response = response_of(elements.all()[k]);
    response.diagonal().array() += std::max(1e-9 * response.trace(), 1e-300);
    stiff_.emplace_back(response.inverse());
  }
  const Index w = elements.width();
  for (std::size_t b = 0; b < elements.bodies(); ++b) {
    own_.push_back(std::max(elements.load().segment(w * static_cast<Index>(b), w).norm(), least_load));
  }
  bonds_of(elements);
  take(state_.x);
}

void Sweeps::strength_over(double divisor) {
  divisor_ = divisor;
  strength_ = 1 / divisor;
  bonds_of(*elements_);
}

void Sweeps::bonds_of(const Elements& elements) {
  elements_ = &elements;
  bonded_.clear();
  for (const Element& e : elements.all()) bonded_.push_back({e.cohesion / divisor_, e.tension / divisor_});
}

double Sweeps::speed_over_own(std::size_t body) const {
  const auto width = static_cast<std::size_t>(elements_->width());
  double square = 0;
  for (std::size_t row = width * body; row < width * (body + 1); ++row) square += rates_[row] * rates_[row];
  return std::sqrt(square) / own_[body];
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
  rates_.assign(state_.v.begin(), state_.v.end());
  rates_.resize(rates_.size() + static_cast<std::size_t>(elements_->width()), 0);
  count_pressing();
}

void Sweeps::count_pressing() {
  pressing_.clear();
  for (std::size_t k = 0; k < state_.x.size(); ++k) {
    const Element& e = elements_->all()[k];
    if (e.contact >= pressing_.size()) pressing_.resize(e.contact + std::size_t{1}, 0);
    if (!e.bond && state_.x[k][0] > pressed) ++pressing_[e.contact];
  }
}

/// Keeps count of what presses.
template <class A>
void Sweeps::set_force(const Link<A>& link, Vector3d& x, const Vector3d& to) {
  const bool before = x[0] > pressed, after = to[0] > pressed;
  if (before != after && !link.bond) pressing_[link.contact] += after ? 1U : -1U;
  x = to;
}

/// To the state.
void Sweeps::tell_rates() { std::copy_n(rates_.begin(), state_.v.size(), state_.v.begin()); }

void Sweeps::choose() {
  const std::vector<std::uint8_t> awake = moving(asleep_);
  active_.clear();
  for (const std::uint32_t k : order_) {
    const Element& e = elements_->all()[k];
    if (awake[e.body] != 0 || (e.other && awake[*e.other] != 0)) {
      active_.push_back(k);
    } else {
      along_[k].setZero();
      before_[k] = state_.x[k];
    }
  }
}

Vector3d Sweeps::carried_by_bond(const Bonded& bond, bool presses, Vector3d x) const {
  x[0] = std::clamp(x[0], -bond.tension, 0.0);
  limit_shear(x, presses ? bond.cohesion : 0);
  return x;
}

template <class A>
Vector3d Sweeps::next(const Link<A>& link, std::uint32_t element, const Vector3d& rate) const {
  const Vector3d& x = state_.x[element];
  if (link.bond) return carried_by_bond(bonded_[element], pressing_[link.contact] > 0, x - link.stop * rate);
  const double friction = link.friction * strength_;
  // Where it sticks the relative rate vanishes at once; else a step of the largest response.
  if constexpr (A::turns) {
    const Vector3d stuck = x - stiff_[element] * rate;
    const double cap = friction * stuck[0];
    if (stuck[0] > 0 && stuck[1] * stuck[1] + stuck[2] * stuck[2] <= cap * cap) return stuck;
  }
  // No pull; shear within friction times its own pressure.
  Vector3d out = x - link.stop * rate;
  if (!(out[0] > 0)) return Vector3d::Zero();
  limit_shear(out, friction * out[0]);
  return out;
}

template <class A>
void Sweeps::sweep(const Links<A>& links, std::uint32_t element) {
  const Link<A>& link = links[element];
  Vector3d& x = state_.x[element];
  const auto of_body = rows_of<A>(link.body), of_other = rows_of<A>(link.other);
  // Most contacts are open, and stay so.
  const bool none = x[0] == 0 && x[1] == 0 && x[2] == 0;
  if (none && !link.bond && link.arm.opening(of_body, of_other) >= 0) return;
  // A bond without tension carries nothing where its patch does not press.
  if (none && link.bond && pressing_[link.contact] == 0 && !(bonded_[element].tension > 0)) return;
  const Vector3d found = next(link, element, link.arm.rate(of_body, of_other));
  const Vector3d step = found - x;
  if (step[0] == 0 && step[1] == 0 && step[2] == 0) return;
  link.arm.push(step, of_body, of_other);
  set_force(link, x, found);
}

template <class A>
void Sweeps::extrapolate(const Links<A>& links, double share) {
  for (const std::uint32_t k : active_) {
    const Vector3d step = share * along_[k];
    along_[k] = step + state_.x[k] - before_[k];
    if (step[0] == 0 && step[1] == 0 && step[2] == 0) continue;
    links[k].arm.push(step, rows_of<A>(links[k].body), rows_of<A>(links[k].other));
    set_force(links[k], state_.x[k], state_.x[k] + step);
  }
}

template <class A>
void Sweeps::run(const Links<A>& links, int most) {
  double last = 0;
  for (int k = 0; k < most && !active_.empty(); ++k) {
    for (const std::uint32_t e : active_) before_[e] = state_.x[e];
    // There and back: symmetric, so that directions can be conjugate.
    for (std::size_t i = 0; i < active_.size(); ++i) sweep(links, active_[i]);
    for (std::size_t i = active_.size(); i-- > 0;) sweep(links, active_[i]);
    double change = 0;
    for (const std::uint32_t e : active_) change += (state_.x[e] - before_[e]).squaredNorm();
    if (k + 1 == most) return;
    // Before the step, which may lead beyond what a contact carries: what is left alone must not keep that.
    if ((k + 1) % between == 0) choose();
    extrapolate(links, last > 0 && change <= last ? change / last : 0);
    if (change < 1e-26) return;
    last = change;
  }
}

void Sweeps::run(int most) {
  for (Vector3d& a : along_) a.setZero();
  choose();
  std::visit([&](const auto& links) { run(links, most); }, links_);
  tell_rates();
}

}  // namespace cleave::assembly
