#include <algorithm>
#include <cmath>

#include "world_impl.hpp"

namespace cleave::dbem {

void WorldState::place(const State& at, std::size_t body, std::vector<Vec2>& all) const {
  const Shape& shape = shapes[body];
  const double c = std::cos(at.angle[body]);
  const double s = std::sin(at.angle[body]);
  const std::size_t modes = shape.modes;
  for (std::size_t k = 0; k < shape.corners.size(); ++k) {
    Vec2 p = shape.corners[k];
    if (modes > 0) {
      const std::vector<double>& table = bodies[body].modes->shapes;
      for (std::size_t m = 0; m < modes; ++m) {
        const double e = at.e[first_mode[body] + m];
        p.x += table[2 * k * modes + m] * e;
        p.y += table[(2 * k + 1) * modes + m] * e;
      }
    }
    all[first_corner[body] + k] = at.x[body] + Vec2{c * p.x - s * p.y, s * p.x + c * p.y};
  }
}

void WorldState::place_all(const State& at, std::vector<Vec2>& all, std::vector<Box2>& box) const {
  all.resize(first_corner.back());
  box.resize(size());
  for (std::size_t b = 0; b < size(); ++b) {
    place(at, b, all);
    box[b] = box_of(corners_of(all, b));
  }
}

bool WorldState::still(std::size_t b) const {
  return idle(b) && state.v[b] == Vec2{} && state.spin[b] == 0 && !bodies[b].moves;
}

double WorldState::speed_bound(const State& at, std::size_t body) const {
  double speed = norm(at.v[body]) + std::abs(at.spin[body]) * shapes[body].radius;
  if (bodies[body].moves) speed = std::max(speed, norm(bodies[body].moves(time + next_step)));
  const std::size_t modes = shapes[body].modes;
  if (modes > 0) {
    const std::vector<double>& table = bodies[body].modes->shapes;
    double most = 0;
    for (std::size_t k = 0; k < corner_count(body); ++k) {
      Vec2 v{};
      for (std::size_t m = 0; m < modes; ++m) {
        const double de = at.de[first_mode[body] + m];
        v.x += table[2 * k * modes + m] * de;
        v.y += table[(2 * k + 1) * modes + m] * de;
      }
      most = std::max(most, norm(v));
    }
    speed += most;
  }
  return speed;
}

Drift ContactSearch::drift(const State& at, const ContactKey& pair, double step) const {
  const auto speed = [&](std::uint32_t b) {
    const Shape& shape = shapes[b];
    const Vec2 fall{shape.inverse_x > 0 ? step * options.gravity.x : 0,
                    shape.inverse_y > 0 ? step * options.gravity.y : 0};
    return at.v[b] + fall - at.spin[b] * turned_left(at.x[b]);
  };
  const Vec2 vi = speed(pair.i), vj = speed(pair.j);
  return {step * (vi - vj), step * (at.spin[pair.i] - at.spin[pair.j])};
}

void ContactSearch::rebuild_pairs(const State& at, const std::vector<Box2>& box, double step) {
  fat.resize(size());
  std::vector<std::uint8_t> lazy(size());
  for (std::size_t b = 0; b < size(); ++b) {
    const Vec2 extent = box[b].high - box[b].low;
    const double more = 0.05 * std::min(std::max(extent.x, extent.y), 20 * shapes[b].feature) +
                        (idle(b) ? 0.0 : 3 * step * (speed_bound(at, b) + 2 * step * norm(options.gravity))) +
                        ride_between(b, b);
    fat[b] = {box[b].low - Vec2{more, more}, box[b].high + Vec2{more, more}};
    lazy[b] = idle(b) ? 1 : 0;
  }
  pairs = overlapping_pairs(fat, lazy);
}

/// Corners that met are pressed past each other by springs: up to this share of the smaller feature they are one place.
constexpr double met_by_springs = 0.05;

void ContactSearch::find(const State& at, const std::vector<Vec2>& all, const std::vector<Box2>& box, double step,
                         std::vector<ContactCandidate>& out, std::vector<CornerChoice>& undecided, double& longest) {
  out.clear();
  undecided.clear();
  longest = std::numeric_limits<double>::infinity();
  const double fall = norm(options.gravity) * step;
  bool rebuild = fat.size() != size();
  std::vector<double> speed(size());
  for (std::size_t b = 0; b < size(); ++b) {
    if (asleep[b] != 0) continue;
    speed[b] = speed_bound(at, b);
    if (rebuild || (shapes[b].fixed && speed[b] == 0)) continue;
    const double reach = step * (speed[b] + fall);
    rebuild = box[b].low.x - reach < fat[b].low.x || box[b].low.y - reach < fat[b].low.y ||
              box[b].high.x + reach > fat[b].high.x || box[b].high.y + reach > fat[b].high.y;
  }
  if (rebuild) rebuild_pairs(at, box, step);
  const bool soft = laws.otherwise.normal_stiffness || std::ranges::any_of(laws.pairs, [](const PairLaw& p) {
                      return p.law.normal_stiffness.has_value();
                    });
  for (const auto [a, b] : pairs) {
    if (idle(a) && idle(b)) continue;
    const Vec2 apart = {std::max({0.0, box[a].low.x - box[b].high.x, box[b].low.x - box[a].high.x}),
                        std::max({0.0, box[a].low.y - box[b].high.y, box[b].low.y - box[a].high.y})};
    const double feature = std::min(shapes[a].feature, shapes[b].feature);
    // Rate at which any two points of the two can approach: spins about the own centre count fully.
    const double common = norm(at.v[a] - at.v[b]);
    const double rate = common + (speed[a] - norm(at.v[a])) + (speed[b] - norm(at.v[b])) + fall;
    const double distance = std::max(apart.x, apart.y);
    if (rate > 0) longest = std::min(longest, std::max(distance, 0.25 * feature) / rate);
    const double margin = rate * step + 1e-6 * feature;
    const double ridden = ride_between(a, b);
    if (distance > margin + ridden) continue;
    const double near = 1e-5 * feature;
    const std::size_t before = out.size();
    find_candidates(
        placed(all, box, a), placed(all, box, b),
        {.margin = margin + ridden,
         .depth = std::max(margin, 0.3 * feature),
         .near = near,
         .corner = std::clamp(soft ? std::max(margin, met_by_springs * feature) : margin, near, 0.3 * feature),
         .touching = 2 * contact_depth * feature},
        drift(at, {a, 0, b, 0}, step), out, undecided);
    for (std::size_t k = before; k < out.size(); ++k) ride(out[k], at);
  }
}

void ContactSearch::look(double step) {
  find(state, corners, boxes, step, touches, choices, limit);
  settle_choices();
}

void ContactSearch::settle_choices() {
  std::erase_if(choices, [&](const CornerChoice& choice) {
    for (const ContactCandidate* line : {&choice.first, &choice.last}) {
      const auto at = std::ranges::lower_bound(memory, key_of(*line), {}, &CachedContact::key);
      if (at == memory.end() || at->key != key_of(*line) || at->force.x <= 0) continue;
      touches.push_back(*line);
      ride(touches.back(), state);
      return true;
    }
    return false;
  });
}

}  // namespace cleave::dbem
