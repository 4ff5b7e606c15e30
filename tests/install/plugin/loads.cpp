#include <dlfcn.h>

#include <cstdio>

int main() {
  void* const plugin = dlopen(PLUGIN, RTLD_NOW | RTLD_LOCAL);
  if (plugin == nullptr) return std::puts(dlerror()), 1;
  const auto blocks = reinterpret_cast<int (*)()>(dlsym(plugin, "blocks_of_a_cut_cube"));
  if (blocks == nullptr) return std::puts(dlerror()), 1;
  std::printf("%d blocks out of a plug-in\n", blocks());
}
