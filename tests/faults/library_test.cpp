/// Memory that runs out inside the library: what a call had taken is given back, and std::bad_alloc, or a typed error,
/// is all that leaves it. The n-th allocation of a call fails, for many n.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <functional>
#include <new>

#include "cleave/bem/statics.hpp"
#include "cleave/dbem/world.hpp"
#include "cleave/geometry/orientation.hpp"
#include "cleave/stability/analyse.hpp"
#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"

namespace {

// Of this program alone; its calls are on one thread.
long allocations = 0, live = 0, failing = 0;

void* take(std::size_t size, std::size_t alignment) {
  if (++allocations == failing) throw std::bad_alloc{};
  void* const at = alignment == 0 ? std::malloc(size)
                                  : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (at == nullptr) throw std::bad_alloc{};
  ++live;
  return at;
}
void give(void* at) noexcept {
  if (at == nullptr) return;
  --live;
  std::free(at);
}

}  // namespace

void* operator new(std::size_t size) { return take(size, 0); }
void* operator new[](std::size_t size) { return take(size, 0); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return take(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return take(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* at) noexcept { give(at); }
void operator delete[](void* at) noexcept { give(at); }
void operator delete(void* at, std::size_t) noexcept { give(at); }
void operator delete[](void* at, std::size_t) noexcept { give(at); }
void operator delete(void* at, std::align_val_t) noexcept { give(at); }
void operator delete[](void* at, std::align_val_t) noexcept { give(at); }
void operator delete(void* at, std::size_t, std::align_val_t) noexcept { give(at); }
void operator delete[](void* at, std::size_t, std::align_val_t) noexcept { give(at); }

namespace cleave {
namespace {

/// Calls once whole, then with one failing allocation each. `done` says whether the call gave its answer.
void expect_all_given_back(const std::function<bool()>& done) {
  ASSERT_TRUE(done());  // what lives for ever, such as tables made at the first use, is there from here on
  allocations = 0;
  ASSERT_TRUE(done());
  const long count = allocations;
  ASSERT_GT(count, 10);
  constexpr long first = 200, spread = 1500;
  const char* all = std::getenv("CLEAVE_FAULTS");
  const long step = all != nullptr ? 1 : std::max(1L, count / spread);
  long thrown = 0;
  for (long n = 1; n <= count; n += n < first ? 1 : step) {
    const long before = live;
    bool out = false;
    allocations = 0;
    failing = n;
    try {
      (void)done();
    } catch (const std::bad_alloc&) {
      out = true;
    }
    failing = 0;
    ASSERT_EQ(live, before) << "allocation " << n << " of " << count;
    thrown += out ? 1 : 0;
  }
  EXPECT_GT(thrown, 0);
  EXPECT_TRUE(done());
}

TEST(LibraryMemory, OfCutsAndKeyBlocks) {
  const auto joint = [](double dip, double direction) {
    const geometry::Attitude attitude{Dip::degrees(dip), DipDirection::degrees(direction)};
    return topology::PersistentJoint{{0, 0, 0.5}, geometry::upward_normal(attitude)};
  };
  const topology::CutInput rock{.domain = geometry::make_box({-9, -9, -3}, {0, 9, 5}).value(),
                                .joints = {joint(60, 45), joint(60, 135)},
                                .excavations = {},
                                .free_domain_tags = {1, 5}};
  const auto friction = stability::JointStrength::make(FrictionAngle::degrees(30)).value();
  const stability::Settings settings{.rock = stability::RockMass::make(kilograms_per_cubic_metre(2700)).value(),
                                     .strengths = stability::StrengthTable{friction},
                                     .loads = stability::Loads::make({0, 0, -9.81}).value()};
  expect_all_given_back([&] {
    const auto cut = topology::cut(rock);
    if (!cut) return false;
    const auto audited = topology::audit(*cut);
    return audited && !stability::analyse(*audited, settings).judgements.empty();
  });
}

TEST(LibraryMemory, OfElasticBodies) {
  const auto steel = bem::Material::make(pascals(210e9), 0.3, kilograms_per_cubic_metre(7850), bem::PlaneState::stress);
  bem::Loop outline = bem::polygon({{0, 0}, {2, 0}, {2, 1}, {0, 1}}, 0, 2);
  outline[1].condition = 2;
  outline[3].condition = 1;
  const bem::Problem problem{
      .regions = {{.name = "plate",
                   .material = *steel,
                   .loops = {outline},
                   .conditions = {bem::free_surface(), bem::clamped(), bem::traction(bem::Vec2{100e6, 0})}}}};
  expect_all_given_back([&] { return bem::solve(problem, {}).has_value(); });
}

TEST(LibraryMemory, OfContactSteps) {
  const auto rectangle = [](double x, double y, double w, double h) {
    return std::vector<Vec2>{{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}};
  };
  dbem::Body floor{.name = "floor", .outline = rectangle(-5, -1, 10, 1)};
  floor.held = {true, true, true};
  const std::vector<dbem::Body> bodies{floor,
                                       {.name = "low", .outline = rectangle(-0.5, 0, 1, 1), .density = 2600},
                                       {.name = "high", .outline = rectangle(-0.4, 1, 1, 1), .density = 2600}};
  dbem::Laws laws;
  laws.otherwise.friction = 0.5;
  expect_all_given_back([&] {
    auto world = dbem::World::make(bodies, laws, {.step = 1e-3});
    return world.has_value() && world->step(1e-3).has_value();
  });
}

}  // namespace
}  // namespace cleave
