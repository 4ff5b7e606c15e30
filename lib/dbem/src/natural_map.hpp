#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "cleave/dbem/solver.hpp"
#include "work.hpp"

namespace cleave::dbem {

/// The natural map at some impulses and what it says of each contact. `soft` adds soft * diag(W) (p - centre) to W p.
struct NaturalMap {
  std::vector<Vec2> y;        // b + W p
  std::vector<Vec2> f;        // the map, in impulse units
  std::vector<double> a_n;    // n - g / W_nn
  std::vector<double> a_t;    // t - s / W_tt
  std::vector<double> bound;  // of |t|
  double largest = 0;         // |f|
  double fastest = 0;         // |f| as a velocity: f / r
  double squared = 0;
};

/// With what regularises a problem, or as if it were centred on the impulses that are asked about.
enum class Regularised : std::uint8_t { as_given, about_itself };

class MapEvaluator final {
 public:
  explicit MapEvaluator(const ContactProblem& problem, double soft = 0, std::span<const Vec2> centre = {},
                        Regularised regularised = Regularised::as_given);
  void evaluate(const std::vector<Vec2>& p, NaturalMap& map) const;
  /// |f| over max(|p|, max |b / diag W|), or |f / r| over max |b| where that is more: beside a body 10^6 times heavier
  /// an error of its forces' size would be a fall of the light ones.
  [[nodiscard]] double residual(const NaturalMap& map, const std::vector<Vec2>& p) const;
  [[nodiscard]] double r_n(std::size_t k) const { return r_[k].x; }
  [[nodiscard]] double r_t(std::size_t k) const { return r_[k].y; }
  [[nodiscard]] const ContactProblem& problem() const { return *problem_; }
  [[nodiscard]] double soft() const { return soft_; }

 private:
  const ContactProblem* problem_;
  double soft_;
  std::span<const Vec2> centre_;  // empty: zero
  bool about_itself_;
  double load_ = 0, speed_ = 0;
  std::vector<Vec2> r_;
};

/// What a problem says of impulses: the better of its residuals with its regularisation and about themselves.
struct Judged {
  double residual;
  NaturalMap map;
};
[[nodiscard]] Judged judge(const ContactProblem& problem, const std::vector<Vec2>& impulse);

/// What each contact does in a linear solve: normal row or value, tangential row or t = q n + value.
struct Pattern {
  std::vector<std::uint8_t> closed;  // 1: (b + W p)_n given, else n given
  std::vector<std::uint8_t> stuck;   // 1: (b + W p)_t given, else t = q n + given
  std::vector<double> q;
  friend bool operator==(const Pattern&, const Pattern&) = default;
};

/// Solves W_n x = rhs_n (closed) or n = rhs_n; W_t x = rhs_t (stuck) or t = q n + rhs_t. Unknowns are only the n of
/// closed and the t of stuck contacts; symmetric, and solved as such, when nothing slips under friction.
///
/// Large systems are solved by GMRES (Saad and Schultz 1986) behind a factor of nearly the same matrix: in the freedoms
/// of the bodies where those are rigid, else of the symmetric part in the contacts, kept while few contacts change.
class PatternSolver final {
 public:
  /// Adds to `work` what it does.
  explicit PatternSolver(Work& work);
  ~PatternSolver();
  PatternSolver(const PatternSolver&) = delete;
  PatternSolver& operator=(const PatternSolver&) = delete;
  /// Empty when singular.
  [[nodiscard]] std::optional<std::vector<Vec2>> solve(const ContactProblem& problem, double soft,
                                                       const Pattern& pattern, const std::vector<Vec2>& rhs);
  [[nodiscard]] Work& work() const noexcept { return *work_; }

 private:
  struct FactorCache;
  struct Call;
  void solve_dense(Call& call);
  /// GMRES behind the factor in the freedoms of the bodies; false where that does not do.
  bool solve_by_bodies(Call& call);
  /// GMRES behind the factor in the contacts.
  bool solve_by_contacts(Call& call);

  Work* work_;
  std::unique_ptr<FactorCache> kept_;
  std::unique_ptr<class BodyFactor> bodies_;
};

/// `solve` with the factors of an earlier call on the same contacts, and as much work as that of `linear` may be.
[[nodiscard]] ContactSolution solve_again(const ContactProblem& problem, const SolverOptions& options,
                                          PatternSolver& linear);

/// From the start of the problem, which is nearly an answer, and by what is cheap from there only.
[[nodiscard]] ContactSolution solve_near(const ContactProblem& problem, const SolverOptions& options,
                                         PatternSolver& linear);

/// Interior points on convex programmes, one after the other: shows `enough` the answer of each until it says so, up to
/// `most` factors. Sure and slow; answers are as near as rounding lets a barrier come, a few linear solves short.
void interior_point_solve(const ContactProblem& problem, std::size_t most, Work& work, std::size_t& factors,
                          const std::function<bool(const std::vector<Vec2>&)>& enough);

/// Points along paths that turn until they come to an answer: where the interior-point solver stagnates. Rigid bodies
/// only. Shows `enough` what is near the end of a path until it says so, up to `most` factors.
void turning_path(const ContactProblem& problem, std::size_t most, Work& work, std::size_t& factors,
                  const std::function<bool(const std::vector<Vec2>&)>& enough);

/// Groups whose linear solves are dear.
[[nodiscard]] inline bool is_large(const ContactProblem& problem) { return problem.contacts() > 150; }

/// Groups of rigid bodies with far more forces than freedoms: plain Newton wanders among them.
[[nodiscard]] inline bool wanders(const ContactProblem& problem) { return problem.rigid && problem.contacts() > 20; }

/// Without it the law is one convex programme.
[[nodiscard]] inline bool has_friction(const ContactProblem& problem) {
  const auto positive = [](double x) { return x > 0; };
  return std::ranges::any_of(problem.mu, positive) || std::ranges::any_of(problem.cohesion, positive);
}

/// Pairs of contacts that share a block of W.
[[nodiscard]] std::vector<std::pair<std::uint32_t, std::uint32_t>> links_of_contacts(const BlockMatrix& w);

/// Exact complementary pivoting; empty when it does not end. Counts pivots.
[[nodiscard]] std::vector<Vec2> lemke(const ContactProblem& problem, Work& work, std::size_t& pivots);

/// Operations of one product with W.
[[nodiscard]] inline double product_work(const ContactProblem& problem) {
  return 8 * static_cast<double>(problem.w.values.size());
}

}  // namespace cleave::dbem
