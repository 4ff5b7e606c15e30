#include "gauss.hpp"

namespace cleave::bem {
namespace {

GaussRule make_log_rule() {
  GaussRule rule = gauss(32);
  for (std::size_t i = 0; i < rule.s.size(); ++i) {
    const double t = (rule.s[i] + 1) / 2;
    const double t5 = t * t * t * t * t;
    rule.s[i] = t5 * t;
    rule.w[i] *= 3 * t5;
  }
  return rule;
}

}  // namespace

const GaussRule& log_rule() {
  static const GaussRule rule = make_log_rule();
  return rule;
}

}  // namespace cleave::bem
