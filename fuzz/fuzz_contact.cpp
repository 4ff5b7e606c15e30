/// Random scenes of blocks that touch in the awkward places (tests/support/contact_families.hpp), turned by a quarter,
/// mirrored or listed backwards: whatever is accepted and not stopped shares no space by a clipping of its own, gains
/// no energy, keeps its momentum where nothing holds it, and a closed gas keeps its energy.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "byte_source.hpp"
#include "contact_families.hpp"
#include "fuzz_target.hpp"

namespace {

using namespace cleave::testing;

void require(bool good, const char* what, const ContactOutcome& outcome) {
  if (good) return;
  std::fprintf(stderr, "%s: overlap %g, gain %g, momentum %g, energy left %g after %zu steps\n", what, outcome.overlap,
               outcome.energy_gain, outcome.momentum, outcome.energy_left, outcome.steps);
  std::abort();
}

}  // namespace

CLEAVE_FUZZ_TARGET(input) {
  cleave::support::ByteSource bytes{input};
  const auto family = static_cast<ContactFamily>(bytes.up_to(contact_family_names.size() - 1));
  const std::uint8_t how = bytes.byte();
  ContactScene scene = make_contact_scene(family, bytes.u64() >> 8U);
  if ((how & 1U) != 0) scene = turned_by_a_quarter(std::move(scene));
  if ((how & 2U) != 0) scene = mirrored(std::move(scene));
  if ((how & 4U) != 0) scene = reversed_order(std::move(scene));
  const ContactOutcome outcome = run_contact_scene(scene, 3000);
  if (!outcome.made) return;
  require(outcome.overlap <= 1e-6, "bodies share space", outcome);
  require(outcome.energy_gain <= 1e-4, "energy grows", outcome);
  require(outcome.momentum <= 1e-10, "momentum is lost", outcome);
  require(!scene.closed || outcome.stopped || std::abs(outcome.energy_left - 1) < 0.2, "a gas loses energy", outcome);
}
