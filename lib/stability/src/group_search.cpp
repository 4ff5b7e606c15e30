#include "group_search.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <optional>
#include <ranges>
#include <unordered_set>
#include <utility>

#include "assembly_of.hpp"
#include "cleave/core/assert.hpp"
#include "contacts.hpp"
#include "domain_held.hpp"
#include "touching.hpp"
#include "verdict.hpp"

namespace cleave::stability {
namespace {

using assembly::Freedom;
using assembly::Verdict;
using geometry::Vec3;
using topology::BlockId;

/// Layers of blocks behind the exposed ones that are looked at; as many more around a group that touches the last.
constexpr std::uint32_t first_layers = 3;
/// A block leans on others when it would move without them at strengths over this and half its cohesion: as what rests
/// is looked at again (`assembly::find_groups`).
constexpr double leans_below = 1.05, share_of_cohesion = 0.5;
/// Share of the square of the domain's extent: surface of a block that is too small to be felt.
constexpr double least_felt = 1e-8;
/// Among more blocks what moving tips push along is not looked for: it is in doubt. So is what would have to be looked
/// at one by one where blocks times looks are more.
constexpr std::size_t most_pushed = 200, most_looks = 6'000;

/// What no other group has taken; it moves with those, but it is they that are proved to move.
assembly::Group without(const assembly::Group& group, const std::vector<std::uint8_t>& taken) {
  assembly::Group out = group;
  out.bodies.clear();
  out.motion.clear();
  for (std::size_t k = 0; k < group.bodies.size(); ++k) {
    if (taken[group.bodies[k]] != 0) continue;
    out.bodies.push_back(group.bodies[k]);
    out.motion.push_back(group.motion[k]);
  }
  if (out.bodies.size() == group.bodies.size()) return out;
  if (group.verdict == Verdict::certain) out.verdict = Verdict::unsafe;
  out.heaviest.reset();
  return out;
}

/// What is found must not hang on the numbers of joints.
assembly::Assembly with_contacts(const assembly::Assembly& assembly, std::vector<assembly::Contact> more) {
  assembly::AssemblySpec spec{assembly.freedom(), assembly.bodies(), assembly.contacts()};
  std::ranges::move(more, std::back_inserter(spec.contacts));
  auto made = assembly::Assembly::make(std::move(spec));
  CLEAVE_ASSERT(made.has_value());
  return made->canonical();
}

class Search final {
 public:
  Search(const topology::BlockComplex& complex, const Settings& settings, const Together& most,
         assembly::Ask ask = assembly::Ask::verdicts)
      : model_{complex, settings}, ask_{ask}, doubted_(complex.blocks().size(), 0), most_{most} {
    Vec3 low, high;
    for (const Vec3 v : complex.vertices()) {
      low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
      high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
    }
    const double extent = norm(high - low);
    for (const BlockId id : complex.blocks().ids()) {
      if (is_needle(id, least_felt * extent * extent)) model_.remove(id, 0);
    }
  }
  /// With ties between blocks. `begin`: the first state is looked at around these alone; what moves without ties is
  /// among them.
  Search(const topology::BlockComplex& complex, const Settings& settings, const Together& most, const Ties& ties,
         std::vector<BlockId> begin, assembly::UntiedSets& untied, const BondShares& bonds)
      : Search{complex, settings, most} {
    model_.keep_bonds(bonds);
    ties_ = &ties;
    untied_ = &untied;
    begin_ = std::move(begin);
  }

  KeyGroups run() {
    const std::uint32_t most = model_.settings().max_batches;
    for (std::uint32_t batch = 1;; ++batch) {
      std::vector<KeyGroup> found = state(batch);
      std::vector<BlockId> leaving;
      for (const KeyGroup& group : found) {
        if (group.verdict != Verdict::in_doubt) leaving.insert(leaving.end(), group.blocks.begin(), group.blocks.end());
      }
      if (!leaving.empty() && batch > most) {
        out_.stopped_at_max_batches = true;
        break;
      }
      for (KeyGroup& group : found) {
        // What is in doubt stays: it is said once.
        if (group.verdict == Verdict::in_doubt) {
          const bool known = std::ranges::any_of(group.blocks, [&](BlockId id) { return doubted_[id] != 0; });
          for (const BlockId id : group.blocks) doubted_[id] = 1;
          if (known) continue;
        }
        out_.groups.push_back(std::move(group));
      }
      if (leaving.empty()) break;
      for (const BlockId id : leaving) model_.remove(id, batch);
      left_ = std::move(leaving);
    }
    return std::move(out_);
  }

  KeyGroups first() {
    out_.groups = state(1);
    return std::move(out_);
  }

  /// Of what moves when the blocks of the border may, their sides smooth, and `gone` has left: groups with one of them.
  std::optional<std::vector<BlockId>> held_by_border(const std::vector<BlockId>& gone) {
    for (const BlockId id : gone) model_.remove(id, 0);
    hangs_.emplace(complex().blocks().size(), std::uint8_t{0});
    for (const BlockId id : complex().blocks().ids()) {
      if (!complex().blocks()[id].fixed || stands_on_border(model_, id)) continue;
      (*hangs_)[id] = 1;
      if (may_move(id, 1) && model_.held(id, 1).exposed) begin_.push_back(id);
    }
    std::vector<BlockId> out;
    if (begin_.empty()) return out;
    ask_ = assembly::Ask::motion;
    for (const KeyGroup& group : state(1)) {
      if (group.verdict == Verdict::in_doubt) continue;
      if (std::ranges::any_of(group.blocks, [&](BlockId id) { return complex().blocks()[id].fixed; }))
        out.insert(out.end(), group.blocks.begin(), group.blocks.end());
    }
    if (out_.too_many) return std::nullopt;
    std::ranges::sort(out);
    return out;
  }

 private:
  [[nodiscard]] const topology::BlockComplex& complex() const noexcept { return model_.complex(); }
  [[nodiscard]] double place_of(BlockId id) const { return along_generic(complex().blocks()[id].centroid); }
  /// May be moved: a block that is known in part only is taken to stay.
  [[nodiscard]] bool may_move(BlockId id, std::uint32_t batch) const {
    const topology::Block& block = complex().blocks()[id];
    if (block.fixed && (!hangs_ || (*hangs_)[id] == 0)) return false;
    return !block.truncated && model_.present(id, batch) && block.volume.si() > 0;
  }

  /// So thin and so small that its neighbours do not feel it: fixed it would bar the way of blocks that turn or slide
  /// past its corner, and a factor of its own says nothing.
  [[nodiscard]] bool is_needle(BlockId id, double felt) const {
    const topology::Block& block = complex().blocks()[id];
    if (!block.sliver || block.fixed) return false;
    Area area;
    for (const topology::FaceId face : block.faces) area += complex().faces()[face].area;
    return area.si() < felt;
  }

  template <class Visit>
  void neighbours(BlockId id, Visit&& visit) const {
    for (const topology::FaceId face : complex().blocks()[id].faces) {
      for (const topology::Patch& patch : complex().patches(complex().faces()[face])) {
        if (patch.neighbour) visit(*patch.neighbour);
      }
    }
  }

  /// Blocks with something open, and those within some layers of them.
  [[nodiscard]] std::vector<BlockId> near(std::uint32_t batch) {
    std::vector<BlockId> open = left_.empty() ? begin_ : std::vector<BlockId>{};
    std::erase_if(open, [&](BlockId id) { return !may_move(id, batch); });
    const auto begin = [&](BlockId id) {
      if (may_move(id, batch) && model_.held(id, batch).exposed) open.push_back(id);
    };
    if (left_.empty() && begin_.empty()) {
      for (const BlockId id : complex().blocks().ids()) begin(id);
    }
    // Later states differ beside what has left alone.
    for (const BlockId id : left_) neighbours(id, begin);
    return with_leaning(within(open, first_layers, batch), batch);
  }

  /// These blocks and those farther off that lean on them, directly or on others that do: taken to be fixed they would
  /// press on nothing. Ascending.
  [[nodiscard]] std::vector<BlockId> with_leaning(std::vector<BlockId> blocks, std::uint32_t batch) const {
    std::vector<BlockId> gone = std::move(blocks);
    Model without = model_;
    for (const BlockId id : gone) without.remove(id, batch - 1);
    for (std::size_t k = 0; k < gone.size(); ++k) {
      neighbours(gone[k], [&](BlockId other) {
        if (complex().blocks()[other].fixed || !may_move(other, batch)) return;
        if (!without.present(other, batch) || !moves_in(without, other, batch)) return;
        without.remove(other, batch - 1);
        gone.push_back(other);
      });
    }
    std::ranges::sort(gone);
    return gone;
  }

  /// Alone beside what is there in `without`, or nearly, under the forces that it is under.
  [[nodiscard]] bool moves_in(Model& without, BlockId id, std::uint32_t batch) const {
    Contacts contacts = without.contacts(id, batch);
    if (contacts.cone.dimension() == 0) return false;
    for (Contact& group : contacts.groups) {
      group.cohesion *= share_of_cohesion;
      group.tension *= share_of_cohesion;
    }
    return judge(contacts, model_.applied_forces(id, batch), model_.settings()).factor_of_safety < leans_below;
  }

  /// Blocks within some layers of those given, and these; ascending.
  [[nodiscard]] std::vector<BlockId> within(std::vector<BlockId> layer, std::uint32_t layers,
                                            std::uint32_t batch) const {
    std::ranges::sort(layer);
    layer.erase(std::ranges::unique(layer).begin(), layer.end());
    std::unordered_set<std::uint32_t> taken;
    for (const BlockId id : layer) taken.insert(id.value());
    std::vector<BlockId> all = layer;
    for (std::uint32_t k = 0; k < layers && !layer.empty(); ++k) {
      std::vector<BlockId> next;
      for (const BlockId id : layer) {
        neighbours(id, [&](BlockId other) {
          if (may_move(other, batch) && taken.insert(other.value()).second) next.push_back(other);
        });
      }
      all.insert(all.end(), next.begin(), next.end());
      layer = std::move(next);
    }
    std::ranges::sort(all);
    return all;
  }

  /// Groups of one state. Where one touches what is taken to be fixed and is not, it is looked at again in more rock
  /// around it.
  std::vector<KeyGroup> state(std::uint32_t batch) {
    std::vector<BlockId> blocks = near(batch);
    if (batch == 1) out_.blocks = blocks.size();
    if (blocks.empty()) return {};
    if (blocks.size() > most_.blocks) {
      out_.too_many = true;
      return {};
    }
    std::vector<KeyGroup> found = groups_of(blocks, batch);
    for (std::uint32_t layers = 2 * first_layers;; layers += first_layers) {
      std::vector<KeyGroup> kept = found;
      const std::vector<BlockId> wider = around_touching(kept, blocks, layers, batch);
      if (wider.empty()) break;
      if (wider.size() > most_.blocks) {
        out_.cut_off = true;
        break;
      }
      found = std::move(kept);
      for (KeyGroup& group : groups_of(wider, batch)) found.push_back(std::move(group));
      std::ranges::sort(found, {}, [](const KeyGroup& g) { return g.blocks.front(); });
      std::vector<BlockId> both;
      std::ranges::set_union(blocks, wider, std::back_inserter(both));
      blocks = std::move(both);
    }
    if (!hangs_) add_pushed(found, blocks, batch);
    for (const KeyGroup& group : found) {
      for (const BlockId id : group.blocks) {
        neighbours(id, [&](BlockId other) {
          if (!complex().blocks()[other].truncated) return;
          out_.at_the_edge = true;
          if (group.verdict != Verdict::in_doubt) out_.edge.push_back(other);
        });
      }
    }
    return found;
  }

  /// Blocks at rest that the tips of moving ones push along, in doubt: whether they do depends on forces at edges and
  /// corners that have no area yet, all of them together or one by one.
  void add_pushed(std::vector<KeyGroup>& found, const std::vector<BlockId>& blocks, std::uint32_t batch) {
    std::vector<KeyGroup> all = found;
    std::ranges::sort(all, {}, [&](const KeyGroup& group) {
      return std::ranges::min(group.blocks | std::views::transform([&](BlockId id) { return place_of(id); }));
    });
    for (const KeyGroup& group : all) {
      if (group.verdict == Verdict::in_doubt) continue;
      std::vector<BlockId> around;
      std::ranges::set_intersection(within(group.blocks, 2, batch), blocks, std::back_inserter(around));
      std::vector<BlockId> touched;
      for (const assembly::Contact& tip : touching_contacts(model_, group.blocks, group.rates, around)) {
        touched.push_back(around[*tip.other]);
      }
      std::ranges::sort(touched);
      touched.erase(std::ranges::unique(touched).begin(), touched.end());
      if (touched.empty()) continue;
      // Among many what tips touch is in doubt without a look.
      if (group.blocks.size() > most_pushed) {
        doubt(found, touched, batch);
        continue;
      }
      look_pushed(found, group, touched, blocks, batch);
      if (touched.size() == 1) continue;
      std::erase_if(touched, [&](BlockId id) { return in_one_of(found, id); });
      if (touched.size() * group.blocks.size() > most_looks) {
        doubt(found, touched, batch);
        continue;
      }
      std::ranges::sort(touched, {}, [&](BlockId id) { return place_of(id); });
      for (const BlockId id : touched) {
        if (!in_one_of(found, id)) look_pushed(found, group, {id}, blocks, batch);
      }
    }
    std::ranges::sort(found, {}, [](const KeyGroup& g) { return g.blocks.front(); });
  }

  /// Pushes at some blocks at rest; a few layers of others behind them may give way with them.
  void look_pushed(std::vector<KeyGroup>& found, const KeyGroup& group, const std::vector<BlockId>& touched,
                   const std::vector<BlockId>& blocks, std::uint32_t batch) {
    std::vector<BlockId> near, these;
    std::ranges::set_union(within(touched, 2, batch), group.blocks, std::back_inserter(near));
    std::ranges::set_intersection(near, blocks, std::back_inserter(these));
    std::vector<assembly::Contact> tips = touching_contacts(model_, group.blocks, group.rates, these);
    std::erase_if(
        tips, [&](const assembly::Contact& tip) { return !std::ranges::binary_search(touched, these[*tip.other]); });
    doubt_what_moves(found, assembly_with_ties(these, batch), tips, these, batch);
  }

  void doubt_what_moves(std::vector<KeyGroup>& found, const assembly::Assembly& without_tips,
                        const std::vector<assembly::Contact>& tips, const std::vector<BlockId>& blocks,
                        std::uint32_t batch) {
    const assembly::Assembly whole = with_contacts(without_tips, tips);
    for (const bool moments : {false, true}) {
      if (moments && out_.without_moments) continue;
      const assembly::Start start = start_from_rest(moments ? whole : whole.with(Freedom::translation), 1);
      std::vector<BlockId> these;
      if (start.found == assembly::FromRest::unsettled) {
        for (const assembly::Contact& tip : tips) these.push_back(blocks[*tip.other]);
      }
      const double most = start.speed.empty() ? 0 : std::ranges::max(start.speed);
      for (std::size_t b = 0; b < start.speed.size(); ++b) {
        if (start.speed[b] > 1e-6 * most && most > 1e-8) these.push_back(blocks[b]);
      }
      doubt(found, these, batch);
    }
  }

  [[nodiscard]] static bool in_one_of(const std::vector<KeyGroup>& groups, BlockId id) {
    return std::ranges::any_of(groups, [&](const KeyGroup& g) { return std::ranges::binary_search(g.blocks, id); });
  }

  /// Those that are in no group yet.
  void doubt(std::vector<KeyGroup>& found, std::vector<BlockId> blocks, std::uint32_t batch) {
    KeyGroup out{.batch = batch, .verdict = Verdict::in_doubt, .moments = false};
    std::ranges::sort(blocks);
    for (const BlockId id : blocks) {
      if (!out.blocks.empty() && out.blocks.back() == id) continue;
      if (in_one_of(found, id)) continue;
      out.blocks.push_back(id);
      out.volume += complex().blocks()[id].volume;
    }
    if (out.blocks.empty()) return;
    out.rates.resize(out.blocks.size());
    out.factor_up = std::numeric_limits<double>::infinity();
    out.factor_move = 1;
    out.factors = false;
    found.push_back(std::move(out));
  }

  /// Whether a group that moves has a block beside one that may move too and was not looked at.
  [[nodiscard]] bool touches(const KeyGroup& group, const std::vector<BlockId>& blocks, std::uint32_t batch) const {
    bool out = false;
    for (const BlockId id : group.blocks) {
      neighbours(id, [&](BlockId other) {
        out = out || (!std::ranges::binary_search(blocks, other) && may_move(other, batch));
      });
    }
    return out && group.verdict != Verdict::in_doubt;
  }

  /// Blocks within some layers of groups that touch what was not looked at, and of the groups among those, which are
  /// all taken out of `found`: the rest stays at rest.
  std::vector<BlockId> around_touching(std::vector<KeyGroup>& found, const std::vector<BlockId>& blocks,
                                       std::uint32_t layers, std::uint32_t batch) {
    std::vector<BlockId> seeds, wide;
    const auto reached = [&](const KeyGroup& group) {
      return wide.empty()
                 ? touches(group, blocks, batch)
                 : std::ranges::any_of(group.blocks, [&](BlockId id) { return std::ranges::binary_search(wide, id); });
    };
    for (;;) {
      const auto out = std::ranges::stable_partition(found, [&](const KeyGroup& g) { return !reached(g); });
      if (out.empty()) return wide;
      for (const KeyGroup& group : out) seeds.insert(seeds.end(), group.blocks.begin(), group.blocks.end());
      found.erase(out.begin(), out.end());
      wide = with_leaning(within(seeds, layers, batch), batch);
    }
  }

  assembly::Assembly assembly_with_ties(const std::vector<BlockId>& blocks, std::uint32_t batch) {
    assembly::Assembly bare = assembly_of(model_, blocks, batch);
    return with_contacts(bare,
                         ties_ == nullptr ? std::vector<assembly::Contact>{} : ties_->among(model_, blocks, batch));
  }

  std::vector<KeyGroup> groups_of(const std::vector<BlockId>& blocks, std::uint32_t batch) {
    const assembly::Assembly whole = assembly_with_ties(blocks, batch);
    // At the border only groups with a block of the border are asked for: what moves without has left.
    std::vector<std::uint8_t> among;
    for (const BlockId id : blocks) {
      if (hangs_) among.push_back((*hangs_)[id]);
    }
    std::array<std::vector<assembly::Group>, 2> found{
        assembly::find_groups(whole.with(Freedom::translation), ask_, most_.threads, among).groups, {}};
    if (blocks.size() <= most_.turning) {
      found[1] = assembly::find_groups(whole, ask_, most_.threads, among).groups;
    } else {
      out_.without_moments = true;
    }
    std::vector<std::uint8_t> taken(blocks.size(), 0);
    std::vector<KeyGroup> out;
    const auto add = [&](const std::vector<assembly::Group>& groups, bool doubt, bool moments) {
      for (const assembly::Group& group : groups) {
        if ((group.verdict == Verdict::in_doubt) != doubt) continue;
        const assembly::Group rest = without(group, taken);
        if (rest.bodies.empty()) continue;
        for (const std::uint32_t b : rest.bodies) taken[b] = 1;
        out.push_back(said(rest, blocks, batch, moments));
      }
    };
    // Every block once: as what moves before what is in doubt, and as what translation moves before what turns.
    for (const bool moments : {false, true}) add(found[moments ? 1 : 0], false, moments);
    // What few blocks do alone, whatever holds them together with others.
    std::vector<std::uint8_t> open;
    for (const BlockId id : blocks) open.push_back(model_.held(id, batch).exposed ? 1 : 0);
    for (const bool moments : {false, true}) {
      if (moments && blocks.size() > most_.turning) continue;
      const assembly::Assembly with = moments ? whole : whole.with(Freedom::translation);
      add(assembly::find_small_groups(with, open, taken, ask_, most_.threads, untied_, among), false, moments);
    }
    for (const bool moments : {false, true}) add(found[moments ? 1 : 0], true, moments);
    std::ranges::sort(out, {}, [](const KeyGroup& g) { return g.blocks.front(); });
    return out;
  }

  KeyGroup said(const assembly::Group& group, const std::vector<BlockId>& blocks, std::uint32_t batch, bool moments) {
    KeyGroup out{.batch = batch, .verdict = group.verdict, .moments = moments};
    out.rates = group.motion;
    const bool moves = group.verdict != Verdict::in_doubt;
    if (moves) out.net = newtons(0);
    double largest = 0;
    for (std::size_t k = 0; k < group.bodies.size(); ++k) {
      const BlockId id = blocks[group.bodies[k]];
      const topology::Block& block = complex().blocks()[id];
      out.blocks.push_back(id);
      out.volume += block.volume;
      if (moves) *out.net += out_of_balance(model_.settings(), block, group.motion[k]);
      const Vec3 velocity = group.motion[k].velocity;
      if (block.volume.si() > largest && norm(velocity) > 0) {
        largest = block.volume.si();
        out.direction = normalized(velocity);
      }
    }
    out.factor_up = group.up.factor;
    out.factor_move = group.moving.factor;
    if (group.turning) out.factor_turning = group.turning->factor;
    out.factor_of_largest = group.heaviest;
    out.weaker = group.weaker;
    out.factors = group.factors;
    return out;
  }

  Model model_;
  assembly::Ask ask_;
  const Ties* ties_ = nullptr;
  assembly::UntiedSets* untied_ = nullptr;
  std::vector<BlockId> begin_;               ///< empty: all that have something open
  std::vector<BlockId> left_;                ///< in the batch before
  IdVector<BlockId, std::uint8_t> doubted_;  ///< said to be in doubt
  /// Blocks of the border that may move, where they are asked for.
  std::optional<IdVector<BlockId, std::uint8_t>> hangs_;
  Together most_;
  KeyGroups out_;
};

}  // namespace

KeyGroups search_groups(const topology::BlockComplex& complex, const Settings& settings, const Together& most,
                        assembly::Ask ask) {
  return Search{complex, settings, most, ask}.run();
}

KeyGroups first_groups(const topology::BlockComplex& complex, const Settings& settings, const Together& most) {
  return Search{complex, settings, most}.first();
}

KeyGroups search_groups(const topology::BlockComplex& complex, const Settings& settings, const Together& most,
                        const Ties& ties, std::vector<BlockId> begin, assembly::UntiedSets& untied,
                        const BondShares& bonds) {
  return Search{complex, settings, most, ties, std::move(begin), untied, bonds}.run();
}

std::optional<std::vector<BlockId>> groups_at_border(const topology::BlockComplex& complex, const Settings& settings,
                                                     const Together& most, const std::vector<BlockId>& gone) {
  return Search{complex, settings, most}.held_by_border(gone);
}

}  // namespace cleave::stability
