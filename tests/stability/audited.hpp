#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "cleave/topology/audit.hpp"
#include "cleave/topology/cut.hpp"

namespace cleave::statics {

/// The blocks of a scene that can be cut, with their certificate.
inline topology::AuditedComplex audited(const topology::CutInput& input) {
  auto cut = topology::cut(input);
  EXPECT_TRUE(cut.has_value()) << (cut ? std::string{} : describe(cut.error()));
  auto result = topology::audit(*std::move(cut));
  EXPECT_TRUE(result.has_value());
  return *std::move(result);
}

}  // namespace cleave::statics
