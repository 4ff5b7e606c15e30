#pragma once

#include <expected>
#include <limits>

#include "cleave/assembly/factors.hpp"

namespace cleave::assembly {

/// Why a certificate was refused.
struct Refused {
  double driving = 0;  ///< what had to be more
  double charge = 0;   ///< than this
};

/// Proof that an assembly does not stay at rest at strengths over `factor`, whatever the law of flow, the initial
/// stress, the stiffness or the order of loading: rates at which the loads do more work than the contacts can take up.
/// Each point of a contact is taken to press with `most` at the utmost. Made by the check alone.
class MotionCertificate final {
 public:
  [[nodiscard]] double factor() const noexcept { return factor_; }
  [[nodiscard]] const Motion& motion() const noexcept { return motion_; }
  [[nodiscard]] double driving() const noexcept { return driving_; }  ///< W, rounded down
  [[nodiscard]] double charge() const noexcept { return charge_; }    ///< W, rounded up
  [[nodiscard]] double most() const noexcept { return most_; }        ///< N, where a contact does not state its own

 private:
  friend std::expected<MotionCertificate, Refused> check_motion(const Assembly&, double, const Motion&, double);
  MotionCertificate(double factor, Motion motion, double driving, double charge, double most)
      : factor_{factor}, motion_{std::move(motion)}, driving_{driving}, charge_{charge}, most_{most} {}
  double factor_;
  Motion motion_;
  double driving_, charge_, most_;
};
/// Shares no code with the solver; intervals rounded outwards, normals and points widened by their own rounding.
/// `most`: over the largest load.
[[nodiscard]] std::expected<MotionCertificate, Refused> check_motion(const Assembly& assembly, double factor,
                                                                     const Motion& motion, double most = 1e3);

/// Proof that forces hold an assembly at strengths over `factor`: they lie so far inside what the contacts carry that
/// what they lack of balance can be made up. With `factor` infinite no motion lets the loads do work: the assembly
/// stays under every law of friction. Otherwise it is no proof that it stays.
class RestCertificate final {
 public:
  [[nodiscard]] double factor() const noexcept { return factor_; }
  [[nodiscard]] double margin() const noexcept { return margin_; }  ///< N: least distance to what contacts carry
  [[nodiscard]] double repair() const noexcept { return repair_; }  ///< N: what balance takes at most

 private:
  friend std::expected<RestCertificate, Refused> check_rest(const Assembly&, double, const ContactForces&);
  RestCertificate(double factor, double margin, double repair) : factor_{factor}, margin_{margin}, repair_{repair} {}
  double factor_, margin_, repair_;
};
[[nodiscard]] std::expected<RestCertificate, Refused> check_rest(const Assembly& assembly, double factor,
                                                                 const ContactForces& forces);

}  // namespace cleave::assembly
