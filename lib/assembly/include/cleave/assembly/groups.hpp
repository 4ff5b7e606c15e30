#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "cleave/assembly/certificate.hpp"
#include "cleave/assembly/factors.hpp"

namespace cleave::assembly {

enum class Verdict : std::uint8_t {
  certain,          ///< moves whatever the initial stress and the law of flow: a certificate was checked
  unsafe,           ///< may move: only locked-in or wedging forces could hold it
  in_doubt,         ///< the search did not settle, or the two factors lie more than 5 % apart
  no_motion_found,  ///< no solution that moves was found: no proof that it stands
  stands,           ///< stays under every law of friction: a certificate was checked
};
/// "certain", "unsafe", "in_doubt", "no_motion_found", "stands".
[[nodiscard]] std::string_view name(Verdict verdict) noexcept;

/// An assembly at strengths as given, with its factors.
struct Judged {
  Verdict verdict = Verdict::in_doubt;
  StaticFactor up;
  MovingFactor moving;
  Motion motion;  ///< of `certain` and `unsafe`, m/s2 and 1/s2
  std::optional<MotionCertificate> moves;
  std::optional<RestCertificate> stands;
};
[[nodiscard]] Judged judge(const Assembly& assembly);

/// Blocks that move together, others taken to be fixed.
struct Group {
  std::vector<std::uint32_t> bodies;  ///< ascending
  Verdict verdict = Verdict::in_doubt;
  Motion motion;  ///< of `bodies`, one after the other; zero when in doubt
  std::optional<MotionCertificate> proof;
  StaticFactor up;
  MovingFactor moving;
  bool factors = true;  ///< false: the group is too large for them, and they say no more than the verdict
};
struct Groups {
  std::vector<Group> groups;  ///< certain, unsafe and in doubt, by first body
  std::size_t held = 0;       ///< bodies of islands that stand without friction
};
/// All groups of one state.
[[nodiscard]] Groups find_groups(const Assembly& assembly);

}  // namespace cleave::assembly
