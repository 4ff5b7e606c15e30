#pragma once

#include <string>

#include "cleave/realize/run_result.hpp"

/// Tables of blocks, bolts and load cases. Their columns stand in tables.hpp, with what each says.
namespace cleave::report {

/// key_blocks.csv: one row for every removable block that would move without friction, in order of the block's number.
/// `result.analysis` is there. LF line ends.
[[nodiscard]] std::string key_blocks_csv(const topology::BlockComplex& complex, const scene::RunResult& result);
/// load_cases.csv: the rows of key_blocks.csv (fewer columns) of every load case, the base case first.
[[nodiscard]] std::string load_cases_csv(const topology::BlockComplex& complex, const scene::RunResult& result);
/// border_blocks.csv: blocks that only a side of the domain holds, under every load case, the base case first.
[[nodiscard]] std::string border_blocks_csv(const topology::BlockComplex& complex, const scene::RunResult& result);
/// bolts.csv: one row a bolt, in the order of the scene, then spot bolts. `result.support` is there.
[[nodiscard]] std::string bolts_csv(const scene::RunResult& result);
/// support_blocks.csv: every block that needs support under a load case, and what holds it.
[[nodiscard]] std::string support_blocks_csv(const scene::RunResult& result);
/// combined_blocks.csv: the bodies that bolts stitch together, under every load case.
[[nodiscard]] std::string combined_blocks_csv(const scene::RunResult& result);
/// maximum_blocks.csv: largest key blocks of block theory.
[[nodiscard]] std::string maximum_blocks_csv(const scene::RunResult& result);

/// The tables of columns in docs/results.md: a heading and what each column says, for every file above.
[[nodiscard]] std::string columns_of_tables();

}  // namespace cleave::report
