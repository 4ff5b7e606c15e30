#include "cleave/assembly/groups.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "balance.hpp"
#include "branch.hpp"
#include "cleave/core/assert.hpp"
#include "cleave/core/fields.hpp"
#include "cleave/core/parallel.hpp"
#include "group_factors.hpp"
#include "settle.hpp"

namespace cleave::assembly {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
/// Certainty is not looked for in larger parts: they are unsafe at least.
constexpr std::size_t most_projected = 400;
/// What moves at strengths over this is in doubt: a start in another order may find the same at strengths as they are.
constexpr double within_reach = 1.05;
/// So is what moves with this share of its cohesion: shear that grows evenly along a joint, from nothing to what it
/// bears, breaks it at half of that on average. Joints that open in part lose it; so often is that looked at.
constexpr double even_share = 0.5;
constexpr int most_rounds = 4;
/// A body rests when its forces lack no more than this share of its load: among few bodies, and among more.
constexpr double still_of_few = 1e-6, still_of_many = 1e-4;
/// Up to so many bodies are looked at in all orders of contacts; among more one other search is made.
constexpr std::size_t most_for_orders = 400;

Motion of_members(const Motion& motion, const std::vector<std::uint32_t>& members) {
  Motion out;
  for (const std::uint32_t b : members) out.push_back(motion[b]);
  return out;
}

/// Bodies that neither move nor were shown to rest: what a search did not settle of, and what its forces do not hold.
std::vector<std::uint8_t> not_at_rest(const Assembly& assembly, const std::vector<std::uint8_t>& moving,
                                      const Ended& ended) {
  std::vector<std::uint8_t> out(assembly.bodies().size(), 0);
  const auto balance = check_balance(assembly, 1, ended.forces);
  const double still = assembly.bodies().size() <= few_bodies ? still_of_few : still_of_many;
  for (std::size_t b = 0; b < out.size(); ++b) {
    const bool unsettled = !ended.unsettled.empty() && ended.unsettled[b] != 0;
    const bool held = balance && balance->lack()[b] <= still;
    out[b] = moving[b] == 0 && (unsettled || !held) ? 1 : 0;
  }
  return out;
}

/// With a share of the cohesion and tension of each contact.
Assembly with_bonds(const Assembly& assembly, const std::vector<double>& share) {
  AssemblySpec spec{assembly.freedom(), assembly.bodies(), assembly.contacts()};
  for (std::size_t c = 0; c < spec.contacts.size(); ++c) {
    for (Bond& bond : spec.contacts[c].bonds) {
      bond.cohesion *= share[c];
      bond.tension *= share[c];
    }
  }
  auto made = Assembly::make(std::move(spec));
  CLEAVE_ASSERT(made.has_value());
  return *std::move(made);
}

/// Of the cohesion of joints that breaks bit by bit; a tie is no joint.
std::vector<double> even_shares(const Assembly& assembly) {
  std::vector<double> out;
  for (const Contact& contact : assembly.contacts()) out.push_back(contact.is_tie() ? 1 : even_share);
  return out;
}

bool apart(double up, double moving) { return !(up <= 1.05 * moving); }

}  // namespace

std::string_view name(Verdict verdict) noexcept { return enum_name(verdict); }

Judged judge(const Assembly& assembly) {
  Judged out;
  out.up = static_factor(assembly);
  out.moving = moving_factor(assembly, out.up.factor);
  const Projection drive = project(assembly, 1);
  if (drive.largest > slow) {
    if (auto proof = check_motion(assembly, 1, drive.motion)) {
      out.verdict = Verdict::certain;
      Start start = start_from_rest(assembly, 1);
      out.motion = start.found == FromRest::moves ? std::move(start.motion) : drive.motion;
      out.moves = std::move(*proof);
      return out;
    }
  }
  const bool one = assembly.bodies().size() == 1 && !turns(assembly.freedom());
  Start start = start_from_rest(assembly, 1);
  for (unsigned order = 1; !one && order <= other_orders && start.found != FromRest::moves; ++order) {
    Ended ended;
    Start other = start_by_sweeps(assembly, 1, order, ended);
    if (other.found == FromRest::moves) start = std::move(other);
  }
  if (start.found == FromRest::moves || out.moving.factor < 1) {
    out.verdict = Verdict::unsafe;
    if (start.found == FromRest::moves) out.motion = start.motion;
    out.moving.factor = std::min(out.moving.factor, 1.0);
    return out;
  }
  if (out.moving.factor == infinite) {
    if (auto proof = check_rest(assembly, infinite, holding_forces(assembly, infinite, 1e-3))) {
      out.verdict = Verdict::stands;
      out.stands = *proof;
      return out;
    }
  }
  const bool settled = start.found == FromRest::rests && out.moving.settled && out.up.settled;
  out.verdict =
      settled && (one || !apart(out.up.factor, out.moving.factor)) ? Verdict::no_motion_found : Verdict::in_doubt;
  return out;
}

namespace {

/// One island.
class Search final {
 public:
  /// `among`: bodies that are asked for.
  Search(const Assembly& island, std::vector<std::uint8_t> among, Ask ask, ThreadLimit threads)
      : island_{island},
        among_{std::move(among)},
        ask_{ask},
        threads_{threads},
        taken_(island.bodies().size(), 0),
        counts_(island.contacts().size(), 1.0) {}

  /// False when it stands without friction.
  bool run() {
    const bool large = island_.bodies().size() > followed_bodies;
    if (!large) {
      const Projection free = project(island_, infinite);
      if (free.settled && !(free.largest > slow)) return false;
    }
    std::vector<Begun> begun = searched();
    const Start& start = begun.front().start;
    const ContactForces& forces = begun.front().ended.forces;
    weaker_ = std::move(begun.front().weaker.speed);
    weaker_forces_ = std::move(begun.front().weaker_ended.forces);
    std::vector<std::uint8_t> hardly(island_.contacts().size(), 0);
    (void)hardly_pressed(forces, counts_, hardly);
    const std::vector<std::uint8_t> moving = moving_ones(start.speed);
    std::vector<std::uint8_t> open = not_at_rest(island_, moving, begun.front().ended);
    // What rests in a search that begins with motion is not looked at again among many: to fix it only adds support.
    std::vector<std::uint8_t> active(open.size(), 1);
    for (std::size_t b = 0; large && b < open.size(); ++b) active[b] = std::max(moving[b], open[b]);
    find_certain(active);
    take(moving, Verdict::unsafe, start.motion);
    for (std::size_t k = 1; k < begun.size(); ++k) add_moving(begun[k], open);
    look_closer(std::move(open));
    if (ask_ == Ask::motion) return true;
    look_weaker(forces);
    for (Group& group : groups_) {
      if (group.verdict == Verdict::certain) give_motion(group, begun);
    }
    // What is certain counts all cohesion; what may move counts what is pressed.
    const Assembly counting = with_bonds(island_, counts_);
    const std::vector<std::uint8_t> moves = in_groups_that_move();
    parallel_for(groups_.size(), threads_,
                 [&](std::size_t k) { give_factors(groups_[k], island_, counting, moves, ask_); });
    return true;
  }
  [[nodiscard]] std::vector<Group>& groups() noexcept { return groups_; }

 private:
  struct Begun {
    Start start, weaker;
    Ended ended, weaker_ended;
  };
  /// All searches; the first alone where every body that is asked for moves in it.
  [[nodiscard]] std::vector<Begun> searched() const {
    const auto all = [&](std::size_t first, std::size_t count) {
      return parallel_map(count, threads_, [&](std::size_t k) { return begin(static_cast<unsigned>(first + k)); });
    };
    const bool some = std::ranges::find(among_, std::uint8_t{0}) != among_.end();
    if (!some) return all(0, 1 + other_searches());
    std::vector<Begun> out = all(0, 1);
    const std::vector<std::uint8_t> moving = moving_ones(out.front().start.speed);
    for (std::size_t b = 0; b < among_.size(); ++b) {
      if (among_[b] == 0 || moving[b] != 0) continue;
      std::ranges::move(all(1, other_searches()), std::back_inserter(out));
      break;
    }
    return out;
  }

  /// Among more than few bodies the first search begins with less strength, and goes on to full strength. Others take
  /// contacts in one order after the other.
  [[nodiscard]] Begun begin(unsigned search) const {
    Begun out;
    const bool few = island_.bodies().size() <= few_bodies;
    if (search > 0) {
      // Among few the first search took the order given.
      out.start = start_by_sweeps(island_, 1, few ? search : search - 1, out.ended);
    } else if (few) {
      out.start = start_from_rest(island_, 1, out.ended);
    } else {
      Twice twice = start_from_weaker(with_bonds(island_, even_shares(island_)), within_reach, island_);
      out = {std::move(twice.start), std::move(twice.weaker), std::move(twice.ended), std::move(twice.weaker_ended)};
    }
    return out;
  }
  [[nodiscard]] unsigned other_searches() const {
    const std::size_t bodies = island_.bodies().size();
    if (bodies == 1 && !turns(island_.freedom())) return 0;  // its answer is the only one
    if (bodies <= few_bodies) return other_orders;
    return bodies <= most_for_orders ? 1 + other_orders : 1;
  }

  /// Adds what moves in another search. `open`: what no search settled of.
  void add_moving(const Begun& other, std::vector<std::uint8_t>& open) {
    const std::vector<std::uint8_t> moving = moving_ones(other.start.speed);
    const std::vector<std::uint8_t> left = not_at_rest(island_, moving, other.ended);
    for (std::size_t b = 0; b < open.size(); ++b) open[b] = std::min(open[b], left[b]);
    if (island_.bodies().size() > followed_bodies) find_certain(not_taken(moving));
    take(moving, Verdict::unsafe, other.start.motion);
  }

  void find_certain(const std::vector<std::uint8_t>& among) {
    for (const std::vector<std::uint32_t>& part : connected_parts(island_, among)) {
      if (part.size() > most_projected) continue;
      const Assembly own = island_.part(part, Assembly::Others::fixed);
      const Projection drive = project(own, 1);
      for (std::vector<std::uint32_t>& members : connected_parts(own, moving_ones(drive.speed))) {
        Motion motion = of_members(drive.motion, members);
        auto proof = check_motion(own.part(members, Assembly::Others::fixed), 1, motion);
        // What cannot be proved is left to the search from rest.
        if (!proof) continue;
        for (std::uint32_t& b : members) b = part[b];
        add(std::move(members), Verdict::certain, std::move(motion)).proof = std::move(*proof);
      }
    }
  }

  /// The motion of a proof opens joints as it slips: it is no motion of rock, and the group's is that from rest. Of the
  /// first search in which all of its bodies move; else of the group alone; else of the search in which most do. Where
  /// none moves it stays that of the proof.
  void give_motion(Group& group, const std::vector<Begun>& begun) const {
    std::ptrdiff_t most = 0;
    const auto count = [&](const std::vector<std::uint8_t>& moving, const auto& motion_of) {
      const auto here = std::ranges::count(moving, 1);
      if (here > most) {
        most = here;
        group.motion = motion_of();
      }
      return most == std::ssize(group.bodies);
    };
    for (const Begun& search : begun) {
      const std::vector<std::uint8_t> all = moving_ones(search.start.speed);
      std::vector<std::uint8_t> own;
      for (const std::uint32_t b : group.bodies) own.push_back(all[b]);
      if (count(own, [&] { return of_members(search.start.motion, group.bodies); })) return;
    }
    const Start alone = start_from_rest(island_.part(group.bodies, Assembly::Others::fixed), 1);
    (void)count(moving_ones(alone.speed), [&] { return alone.motion; });
  }

  void take(std::vector<std::uint8_t> among, Verdict verdict, const Motion& motion) {
    for (std::vector<std::uint32_t>& members : connected_parts(island_, not_taken(std::move(among)))) {
      Motion own = of_members(motion, members);
      add(std::move(members), verdict, std::move(own));
    }
  }

  /// What the island as a whole left open: part by part, the others taken to be fixed.
  void look_closer(std::vector<std::uint8_t> among) {
    for (std::vector<std::uint32_t>& members : connected_parts(island_, not_taken(std::move(among)))) {
      const bool whole = members.size() == island_.bodies().size();
      if (whole || members.size() > followed_bodies || !decided_apart(members)) (void)in_doubt(std::move(members));
    }
  }

  /// What rests, but would move with a little less strength and where cohesion breaks bit by bit. Where several
  /// solutions exist the search may have missed the one that comes about.
  void look_weaker(ContactForces forces) {
    if (std::ranges::all_of(taken_, [](std::uint8_t t) { return t != 0; })) return;
    std::vector<double> share = even_shares(island_);
    std::vector<std::uint8_t> hardly(share.size(), 0);
    std::vector<std::uint8_t> moves;
    for (int round = 0; round < most_rounds; ++round) {
      const bool opened = turns(island_.freedom()) && open_in_part(forces, share);
      const bool lighter = hardly_pressed(forces, share, hardly);
      if (round > 0 && !opened && !lighter) break;
      if (!opened && !lighter && !weaker_.empty()) {
        moves = moving_ones(weaker_);
        forces = std::move(weaker_forces_);
        continue;
      }
      Ended ended;
      moves = moving_ones(start_from_rest(with_bonds(island_, share), within_reach, ended).speed);
      forces = std::move(ended.forces);
    }
    for (std::vector<std::uint32_t>& members : connected_parts(island_, not_taken(std::move(moves)))) {
      // Of one block in translation the answer is the only one, but for cohesion that next to nothing presses into use.
      const bool one = members.size() == 1 && !turns(island_.freedom());
      if (!one || leans(members.front(), hardly)) in_doubt(std::move(members)).weaker = true;
    }
  }

  [[nodiscard]] std::vector<std::uint8_t> not_taken(std::vector<std::uint8_t> among) const {
    for (std::size_t b = 0; b < among.size(); ++b) among[b] = among[b] != 0 && taken_[b] == 0 ? 1 : 0;
    return among;
  }

  Group& in_doubt(std::vector<std::uint32_t> members) {
    Motion none(members.size());
    return add(std::move(members), Verdict::in_doubt, std::move(none));
  }

  /// Contacts with cohesion or tension that do not press at all their points lose it; false when none did.
  bool open_in_part(const ContactForces& forces, std::vector<double>& share) const {
    bool more = false;
    for (std::size_t c = 0; c < share.size(); ++c) {
      const Contact& contact = island_.contacts()[c];
      if (!(share[c] > 0) || contact.bonds.empty()) continue;
      const auto presses = [&](geometry::Vec3 force) { return dot(force, contact.normal) > 0; };
      if (std::ranges::all_of(forces.at_points[c], presses)) continue;
      share[c] = 0;
      more = true;
    }
    return more;
  }

  /// Cohesion counts in proportion where next to nothing presses, as for single blocks; false when no share fell.
  /// `hardly` names these contacts.
  bool hardly_pressed(const ContactForces& forces, std::vector<double>& share,
                      std::vector<std::uint8_t>& hardly) const {
    bool more = false;
    for (std::size_t c = 0; c < share.size(); ++c) {
      const Contact& contact = island_.contacts()[c];
      if (!(share[c] > 0) || contact.bonds.empty() || contact.is_tie()) continue;
      const double counts = pressed_cohesion(island_, contact, forces.at_points[c]);
      if (counts < 1) hardly[c] = 1;
      if (!(counts < (1 - 1e-3) * share[c])) continue;
      share[c] = counts;
      more = true;
    }
    return more;
  }

  /// Whether a contact of the body is hardly pressed.
  [[nodiscard]] bool leans(std::uint32_t body, const std::vector<std::uint8_t>& hardly) const {
    for (std::size_t c = 0; c < hardly.size(); ++c) {
      const Contact& contact = island_.contacts()[c];
      if ((contact.body == body || contact.other == body) && hardly[c] != 0) return true;
    }
    return false;
  }

  /// Whether a part moves, or rests beside what rests.
  bool decided_apart(const std::vector<std::uint32_t>& members) {
    const Assembly part = island_.part(members, Assembly::Others::fixed);
    Ended ended;
    const Start start = start_from_rest(part, 1, ended);
    const std::vector<std::uint8_t> moves = moving_ones(start.speed);
    const std::vector<std::uint8_t> open = not_at_rest(part, moves, ended);
    if (std::ranges::count(open, 1) > 0) return false;
    if (start.found == FromRest::rests) return !beside_what_moves(members);
    std::vector<std::uint8_t> wide(island_.bodies().size(), 0);
    Motion motion(wide.size());
    for (std::size_t k = 0; k < members.size(); ++k) {
      wide[members[k]] = moves[k];
      motion[members[k]] = start.motion[k];
    }
    take(std::move(wide), Verdict::unsafe, motion);
    return true;
  }

  /// What moves was taken to be fixed: it may have held them.
  [[nodiscard]] bool beside_what_moves(const std::vector<std::uint32_t>& members) const {
    const auto in = [&](std::uint32_t b) { return std::ranges::binary_search(members, b); };
    return std::ranges::any_of(island_.contacts(), [&](const Contact& c) {
      return c.other && ((in(c.body) && taken_[*c.other] != 0) || (in(*c.other) && taken_[c.body] != 0));
    });
  }

  Group& add(std::vector<std::uint32_t> members, Verdict verdict, Motion motion) {
    for (const std::uint32_t b : members) taken_[b] = 1;
    Group& group = groups_.emplace_back();
    group.verdict = verdict;
    group.motion = std::move(motion);
    group.bodies = std::move(members);
    return group;
  }

  [[nodiscard]] std::vector<std::uint8_t> in_groups_that_move() const {
    std::vector<std::uint8_t> out(island_.bodies().size(), 0);
    for (const Group& group : groups_) {
      if (group.verdict == Verdict::in_doubt) continue;
      for (const std::uint32_t b : group.bodies) out[b] = 1;
    }
    return out;
  }

  const Assembly& island_;
  std::vector<std::uint8_t> among_;
  Ask ask_;
  ThreadLimit threads_;
  std::vector<std::uint8_t> taken_;
  std::vector<double> counts_;  ///< by contact: share of its cohesion in factors
  std::vector<double> weaker_;  ///< speeds that the search with less strength found first; empty: there was none
  ContactForces weaker_forces_;
  std::vector<Group> groups_;
};

}  // namespace

double cohesion_share(double sine) {
  constexpr double full = 0.01745240643728351;  // sin 1 degree
  return std::clamp(sine / full, 0.0, 1.0);
}

double pressed_cohesion(const Assembly& assembly, const Contact& contact, std::span<const geometry::Vec3> at_points) {
  double pressed = 0, load = norm(assembly.bodies()[contact.body].force);
  for (const geometry::Vec3 force : at_points) pressed += std::max(0.0, dot(force, contact.normal));
  if (contact.other) load = std::min(load, norm(assembly.bodies()[*contact.other].force));
  return load > 0 ? cohesion_share(pressed / load) : 1;
}

Groups find_groups(const Assembly& assembly, Ask ask, unsigned threads, std::span<const std::uint8_t> among) {
  CLEAVE_ASSERT(among.empty() || among.size() == assembly.bodies().size());
  Groups out;
  const std::vector<std::uint8_t> all(assembly.bodies().size(), 1);
  for (const std::vector<std::uint32_t>& members : connected_parts(assembly, all)) {
    std::vector<std::uint8_t> asked;
    for (const std::uint32_t b : members) asked.push_back(among.empty() ? 1 : among[b]);
    if (std::ranges::find(asked, std::uint8_t{1}) == asked.end()) continue;
    const Assembly island = assembly.part(members, Assembly::Others::fixed);
    Search search{island, std::move(asked), ask, ThreadLimit{threads}};
    if (!search.run()) {
      out.held += members.size();
      continue;
    }
    for (Group& group : search.groups()) {
      for (std::uint32_t& b : group.bodies) b = members[b];
      out.groups.push_back(std::move(group));
    }
  }
  std::ranges::sort(out.groups, {}, [](const Group& g) { return g.bodies.front(); });
  return out;
}

}  // namespace cleave::assembly
