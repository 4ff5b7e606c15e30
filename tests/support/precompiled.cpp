// Only so that `precompiled.hpp` belongs to a target that others take it from.
