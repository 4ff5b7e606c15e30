#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cleave/core/progress.hpp"
#include "cleave/motion/world.hpp"
#include "cleave/realize/run.hpp"

namespace cleave::scene {

/// Bodies of a world and the blocks they are.
struct MotionCast {
  motion::SceneSpec scene;
  std::vector<topology::BlockId> moving;  ///< the first bodies
  std::vector<std::uint32_t> wave;
  std::size_t walls = 0;
  std::size_t left_out = 0;              ///< slivers that would be let go
  std::vector<std::uint32_t> body = {};  ///< by block; a number beyond all: none

  /// Of `scene.ties`: the bolt, by its number in the result of the support, and the metres from its collar where it
  /// leaves the one block and where it is held in the other. By bolt.
  struct Tie {
    std::uint32_t bolt = 0;
    double leaves = 0, anchored = 0;
  };
  std::vector<Tie> ties = {};
  bool loaded = false;               ///< loads of the scene act
  bool supported = false;            ///< the bolts of the scene act
  std::size_t late_bolts = 0;        ///< through blocks that leave before they are put in
  std::size_t unsure_pulls = 0;      ///< left out, as their angle law does not say what they bear
  std::size_t bolts_with_shear = 0;  ///< that act, but not across their axes
};

/// ": block 3, block 57", by the numbers that results have; empty: of none.
[[nodiscard]] std::string blocks_of(const MotionCast& cast, const std::vector<std::uint32_t>& bodies);

/// Where a run has come to, beside its world and its result.
struct MotionPlace {
  std::uint32_t released = 0;        ///< the last wave that was let go
  std::uint32_t quiet = 0;           ///< steps in a row that nothing moved in, or got faster
  double quiet_from = 0;             ///< s, the end of the first of them
  std::vector<double> slowest = {};  ///< m/s, by block, in those steps
};

/// One run of a world, written down at equal times.
class MotionRecorder final {
 public:
  MotionRecorder(const Scene& scene, const topology::BlockComplex& complex, const MotionCast& cast,
                 motion::World world);

  /// s, from one written state to the next.
  [[nodiscard]] static double between_frames(const MotionSettings& settings);
  /// Takes an earlier run up. Where it is none of this scene, nothing changes.
  [[nodiscard]] std::optional<Problem> go_on_from(const SavedRun& saved);
  /// To the end of the run, or until `stop` says so.
  void follow(const std::function<bool()>& stop);
  /// All so far as bytes: what a later run goes on from. Before `close`, which writes what only an end has.
  [[nodiscard]] std::string state() const;
  [[nodiscard]] MotionResult close();

 private:
  bool release();
  void look_at(const motion::StepReport& report);
  void look_at_fronts(std::size_t k);
  void look_for_rest(const motion::StepReport& report);
  void look_at_bolts();
  void count_bolts();
  void look_at_tips();
  void record(double time);
  void stop_because(std::string why);
  [[nodiscard]] std::string identity() const;
  [[nodiscard]] bool is_sound(const MotionResult& read, const MotionPlace& place) const;

  const Scene& scene_;
  const MotionSettings& settings_;
  const topology::BlockComplex& complex_;
  const MotionCast& cast_;
  motion::World world_;
  std::uint32_t waves_ = 0;  ///< number of the last
  double frame_ = 0, lowest_ = 0;
  geometry::Vec3 low_, high_;
  MotionPlace place_;
  std::vector<std::uint8_t> cut_;       ///< by tie: its block left
  std::vector<std::uint32_t> bolt_of_;  ///< by tie: place in `result_.bolts`
  MotionResult result_;
};

}  // namespace cleave::scene
