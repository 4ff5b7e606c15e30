#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "cleave/core/sha256.hpp"
#include "cleave/topology/block_complex.hpp"

namespace cleave::topology {

/// A figure stored with a block or a face that is not that of its corners.
struct Misfit {
  enum class Of : std::uint8_t {
    corners,    ///< the face has none, or they leave its plane
    normal,     ///< the face looks the wrong way
    neighbour,  ///< a patch has a neighbour against the face's role, or none, or its own block
    area,       ///< of the face or of its patches
    volume,     ///< of the block
    flags,      ///< fixed, free or truncated
    owner,      ///< the face is not among those of the block that it names
  };
  Of of;
  BlockId block;
  std::optional<FaceId> face;  ///< none: of the block as a whole
  friend bool operator==(const Misfit&, const Misfit&) = default;
};
[[nodiscard]] std::string_view name_of(Misfit::Of of) noexcept;

/// The proof that comes with every block system; recomputed from the complex alone, not taken from the cutter.
struct Certificate {
  bool passed = false;
  std::uint64_t euler_violations = 0;  ///< blocks with an odd or negative genus, or (B1) broken
  std::uint64_t open_shells = 0;       ///< shells with an edge not used once in each direction
  std::uint64_t unpaired_patches = 0;  ///< joint patches whose area is not matched by the neighbour's
  std::uint64_t misfits = 0;
  std::vector<Misfit> first_misfits = {};  ///< by block and face, at most 20
  double face_vector_max_relative = 0;     ///< max over blocks of |sum A_f| / sum |A_f|
  double volume_relative_error = 0;        ///< |sum of blocks - rock volume| / rock volume
  Volume volume;                           ///< sum of blocks
  /// Blocks with any of these, those on both sides of a contact that is not matched among them; at most 20.
  std::vector<BlockId> offenders;
};

/// What a certificate that did not pass found, and in which blocks; in one line.
[[nodiscard]] std::string describe(const Certificate& certificate);

/// A block system whose certificate passed. Has no constructor but `audit`: key-block code cannot be handed an
/// unchecked cut.
class AuditedComplex final {
 public:
  [[nodiscard]] const BlockComplex& complex() const noexcept { return complex_; }
  [[nodiscard]] const Certificate& certificate() const noexcept { return certificate_; }

 private:
  friend std::expected<AuditedComplex, Certificate> audit(BlockComplex complex, unsigned threads);
  AuditedComplex(BlockComplex complex, Certificate certificate)
      : complex_{std::move(complex)}, certificate_{std::move(certificate)} {}
  BlockComplex complex_;
  Certificate certificate_;
};

/// Checks closed shells, Euler-Poincare (B1), face-vector sums, paired patches, that every face fits its plane, and the
/// volume balance. The error is the certificate that did not pass. It does not depend on
/// the number of threads.
[[nodiscard]] std::expected<AuditedComplex, Certificate> audit(BlockComplex complex, unsigned threads = 1);

/// Order-independent hash of the block system (counts and positions rounded exactly on a coarse grid): equal for every
/// thread count, compiler and optimisation level, and for every order of the joints.
[[nodiscard]] std::string canonical_hash(const BlockComplex& complex, unsigned threads = 1);
/// The same of some of its blocks: equal for a block found in a window and in the whole scene.
[[nodiscard]] std::string canonical_hash(const BlockComplex& complex, std::span<const BlockId> blocks,
                                         unsigned threads = 1);

/// A block system as bytes: all that the complex holds, to the last bit, behind a line that says what they are and
/// their SHA-256. The same complex gives the same bytes on every machine.
[[nodiscard]] std::string saved(const AuditedComplex& blocks);

/// Why bytes are no block system.
using cleave::SavedFault;
using LoadError = std::variant<SavedFault, Certificate>;  ///< Certificate: the audit does not pass it
[[nodiscard]] std::string describe(const LoadError& error);

/// What `saved` wrote, audited anew: bytes of any content give an error, not a wrong system.
[[nodiscard]] std::expected<AuditedComplex, LoadError> load_saved(std::string_view bytes, unsigned threads = 1);

}  // namespace cleave::topology
