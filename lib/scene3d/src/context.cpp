#include "context.hpp"

namespace cleave::scene {

SetId Context::set_named(const std::string& name) {
  for (const SetId id : sets.ids()) {
    if (sets[id].name == name) return id;
  }
  return sets.push_back(NamedSet{.name = name, .properties = {}});
}

}  // namespace cleave::scene
