/// Programs that must not compile, as concepts that must not hold. Each has a twin that must, so that a typing error
/// in a concept cannot make it pass.

#include <concepts>
#include <cstddef>

#include "cleave/core/id.hpp"
#include "cleave/core/parallel.hpp"
#include "cleave/core/quantity.hpp"
#include "cleave/core/rng.hpp"

namespace cleave {
namespace {

using BlockId = Id<struct BlockTag>;
using FaceId = Id<struct FaceTag>;

template <class Container, class Index>
concept IndexableBy = requires(Container c, Index i) { c[i]; };
static_assert(IndexableBy<IdVector<BlockId, int>, BlockId>);
static_assert(!IndexableBy<IdVector<BlockId, int>, FaceId>);
static_assert(!IndexableBy<IdVector<BlockId, int>, std::size_t>);
static_assert(!IndexableBy<IdVector<BlockId, int>, int>);

template <class A, class B>
concept Comparable = requires(A a, B b) { a == b; };
static_assert(Comparable<BlockId, BlockId>);
static_assert(!Comparable<BlockId, FaceId>);
static_assert(!Comparable<BlockId, std::uint32_t>);
static_assert(!std::constructible_from<BlockId, FaceId>);
static_assert(!std::convertible_to<std::uint32_t, BlockId>);
static_assert(!std::convertible_to<BlockId, std::uint32_t>);
static_assert(!std::default_initializable<BlockId>);  // no null id

template <class A, class B>
concept Addable = requires(A a, B b) { a + b; };
static_assert(Addable<Length, Length>);
static_assert(!Addable<Length, Area>);
static_assert(!Addable<Length, double>);
static_assert(!Addable<BlockId, BlockId>);
static_assert(!Addable<BlockId, int>);

template <class A, class B>
concept Ordered = requires(A a, B b) { a < b; };
static_assert(Ordered<Stress, Stress>);
static_assert(!Ordered<Stress, Force>);
static_assert(!Ordered<Length, double>);

static_assert(!std::convertible_to<double, Length>);
static_assert(!std::convertible_to<Length, double>);
static_assert(!std::constructible_from<Length, double>);

template <class To, class From>
concept Assignable = std::assignable_from<To&, From>;
static_assert(Assignable<Dip, Dip>);
static_assert(!Assignable<Dip, FrictionAngle>);  // both are angles, of different kinds
static_assert(!Assignable<Dip, double>);

static_assert(!std::convertible_to<int, ThreadLimit>);
static_assert(!std::convertible_to<StreamKey, Rng>);
static_assert(!std::convertible_to<int, Rng>);

}  // namespace
}  // namespace cleave
