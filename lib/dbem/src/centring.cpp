#include "centring.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

namespace cleave::dbem {

namespace {

/// Rounds that are remembered: as many as there may be shares by which different groups of forces come nearer.
constexpr std::size_t most_rounds_kept = 5;

}  // namespace

Creep Centring::creep_at(const std::vector<Vec2>& found) const {
  Creep creep;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Vec2 change = found[k] - problem_.start[k];
    creep.most = std::max({creep.most, viscous_[k].x * std::abs(change.x), viscous_[k].y * std::abs(change.y)});
    // Without what the centre adds: the heavier the forces it keeps, the faster that would be.
    const Vec2 free = problem_.b[k] + Vec2{viscous_[k].x * problem_.start[k].x, viscous_[k].y * problem_.start[k].y};
    creep.speed = std::max({creep.speed, -free.x, std::abs(free.y)});
  }
  return creep;
}

void Centring::move_to(const std::vector<Vec2>& centre) {
  for (std::size_t k = 0; k < centre.size(); ++k) {
    const Vec2 change = centre[k] - problem_.start[k];
    problem_.b[k] += -Vec2{viscous_[k].x * change.x, viscous_[k].y * change.y};
  }
  problem_.start = centre;
}

void Centring::plain(const std::vector<Vec2>& found) {
  rounds_.clear();
  move_to(found);
}

bool Centring::onwards(const std::vector<Vec2>& found) {
  Round round{.found = found, .change = std::vector<Vec2>(found.size())};
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Vec2 change = found[k] - problem_.start[k];
    round.change[k] = {viscous_[k].x * change.x, viscous_[k].y * change.y};
  }
  rounds_.push_back(std::move(round));
  if (rounds_.size() > most_rounds_kept) rounds_.pop_front();
  const bool more = rounds_.size() > 1;
  move_to(more ? extrapolated() : found);
  return more;
}

/// Of all mixtures of the rounds the one whose change is least, and what it led to.
std::vector<Vec2> Centring::extrapolated() const {
  const Round& last = rounds_.back();
  const auto contacts = static_cast<Eigen::Index>(last.found.size());
  const auto many = static_cast<Eigen::Index>(rounds_.size()) - 1;
  Eigen::MatrixXd differences(2 * contacts, many);
  Eigen::VectorXd right(2 * contacts);
  for (Eigen::Index k = 0; k < contacts; ++k) {
    const auto at = static_cast<std::size_t>(k);
    right[2 * k] = last.change[at].x;
    right[2 * k + 1] = last.change[at].y;
    for (Eigen::Index j = 0; j < many; ++j) {
      const Vec2 step = last.change[at] - rounds_[static_cast<std::size_t>(j)].change[at];
      differences(2 * k, j) = step.x;
      differences(2 * k + 1, j) = step.y;
    }
  }
  const Eigen::VectorXd share = differences.colPivHouseholderQr().solve(right);
  std::vector<Vec2> out = last.found;
  if (!share.allFinite()) return out;
  for (std::size_t k = 0; k < out.size(); ++k) {
    for (Eigen::Index j = 0; j < many; ++j) {
      out[k] += -share[j] * (last.found[k] - rounds_[static_cast<std::size_t>(j)].found[k]);
    }
  }
  return out;
}

}  // namespace cleave::dbem
