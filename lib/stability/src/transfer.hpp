#pragma once

#include "cleave/stability/result.hpp"
#include "contacts.hpp"

namespace cleave::stability {

/// Passes the net force of key blocks on to blocks of earlier batches, last batch first (Fu 2014, 4.3), and fills
/// `transferred` of every block of a batch. `model` holds the batches, `analysis` the judgements before transfer.
void transfer_forces(Model& model, Analysis& analysis);

}  // namespace cleave::stability
