/// Loaded before a program: its n-th call of one kind fails, or is its last. What is asked stands in the environment:
/// CLEAVE_FAULT="write:3:ENOSPC" (the third write fails), "malloc:17:ENOMEM+" (all from the 17th on), "rename:2:KILL"
/// (killed instead of the second renaming). CLEAVE_FAULT_COUNT names a file for the number of calls of that kind. Calls
/// before main do not count.

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>

namespace {

enum class Call : std::uint8_t { none, malloc, open, write, fsync, rename, mkdir };
constexpr std::array<std::pair<std::string_view, Call>, 6> calls{{{"malloc", Call::malloc},
                                                                  {"open", Call::open},
                                                                  {"write", Call::write},
                                                                  {"fsync", Call::fsync},
                                                                  {"rename", Call::rename},
                                                                  {"mkdir", Call::mkdir}}};
constexpr std::array<std::pair<std::string_view, int>, 5> reasons{
    {{"ENOMEM", ENOMEM}, {"ENOSPC", ENOSPC}, {"EIO", EIO}, {"EDQUOT", EDQUOT}, {"EMFILE", EMFILE}}};

Call asked = Call::none;
long nth = 0;
int reason = 0;  ///< 0: killed
bool onwards = false;
std::atomic<long> seen{0};
std::atomic<bool> armed{false};

void read_what_is_asked() {
  const char* text = std::getenv("CLEAVE_FAULT");
  if (text == nullptr) return;
  const std::string_view all{text};
  const std::size_t first = all.find(':'), second = all.find(':', first + 1);
  if (second == std::string_view::npos) std::abort();
  for (const auto& [name, call] : calls) {
    if (all.substr(0, first) == name) asked = call;
  }
  nth = std::strtol(text + first + 1, nullptr, 10);
  std::string_view why = all.substr(second + 1);
  onwards = why.ends_with('+');
  if (onwards) why.remove_suffix(1);
  for (const auto& [name, number] : reasons) {
    if (why == name) reason = number;
  }
  if (asked == Call::none || (reason == 0 && why != "KILL")) std::abort();
}

/// Whether this call fails; does not come back from the one that kills.
bool fails(Call call) {
  if (call != asked || !armed.load()) return false;
  const long now = ++seen;
  if (now != nth && !(onwards && now > nth)) return false;
  if (reason == 0) ::kill(::getpid(), SIGKILL);
  errno = reason;
  return true;
}

template <typename F>
F* next(const char* name) {
  return reinterpret_cast<F*>(::dlsym(RTLD_NEXT, name));
}

/// Written at the end without the C library's files, which may fail on purpose.
struct Count final {
  ~Count() {
    armed = false;
    const char* path = std::getenv("CLEAVE_FAULT_COUNT");
    if (path == nullptr) return;
    std::array<char, 32> text{};
    const int length = std::snprintf(text.data(), text.size(), "%ld", seen.load());
    const auto file = ::syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::syscall(SYS_write, file, text.data(), static_cast<std::size_t>(length));
    ::syscall(SYS_close, file);
  }
} count;

int (*real_main)(int, char**, char**) = nullptr;
int armed_main(int argc, char** argv, char** environment) {
  armed = true;
  return real_main(argc, argv, environment);
}

}  // namespace

extern "C" {

void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) { return fails(Call::malloc) ? nullptr : __libc_malloc(size); }
void* calloc(std::size_t n, std::size_t size) { return fails(Call::malloc) ? nullptr : __libc_calloc(n, size); }
void* realloc(void* p, std::size_t size) { return fails(Call::malloc) ? nullptr : __libc_realloc(p, size); }
void* aligned_alloc(std::size_t a, std::size_t size) {
  return fails(Call::malloc) ? nullptr : __libc_memalign(a, size);
}
int posix_memalign(void** out, std::size_t a, std::size_t size) {
  if (fails(Call::malloc)) return ENOMEM;
  *out = __libc_memalign(a, size);
  return *out == nullptr ? ENOMEM : 0;
}

ssize_t write(int file, const void* data, std::size_t size) {
  // What a program says of its trouble is not what is to fail.
  if (file > 2 && fails(Call::write)) return -1;
  static auto* const real = next<ssize_t(int, const void*, std::size_t)>("write");
  return real(file, data, size);
}
int fsync(int file) {
  if (fails(Call::fsync)) return -1;
  static auto* const real = next<int(int)>("fsync");
  return real(file);
}
int rename(const char* from, const char* to) {
  if (fails(Call::rename)) return -1;
  static auto* const real = next<int(const char*, const char*)>("rename");
  return real(from, to);
}
int renameat2(int a, const char* from, int b, const char* to, unsigned flags) {
  if (fails(Call::rename)) return -1;
  static auto* const real = next<int(int, const char*, int, const char*, unsigned)>("renameat2");
  return real(a, from, b, to, flags);
}
int mkdir(const char* path, mode_t mode) {
  if (fails(Call::mkdir)) return -1;
  static auto* const real = next<int(const char*, mode_t)>("mkdir");
  return real(path, mode);
}
int open(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  if (fails(Call::open)) return -1;
  static auto* const real = next<int(const char*, int, ...)>("open");
  return real(path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  if (fails(Call::open)) return -1;
  static auto* const real = next<int(const char*, int, ...)>("open64");
  return real(path, flags, mode);
}
FILE* fopen(const char* path, const char* mode) {
  if (fails(Call::open)) return nullptr;
  static auto* const real = next<FILE*(const char*, const char*)>("fopen");
  return real(path, mode);
}
FILE* fopen64(const char* path, const char* mode) {
  if (fails(Call::open)) return nullptr;
  static auto* const real = next<FILE*(const char*, const char*)>("fopen64");
  return real(path, mode);
}

int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(), void (*fini)(),
                      void (*rtld_fini)(), void* stack_end) {
  read_what_is_asked();
  real_main = main;
  using Start = int(int (*)(int, char**, char**), int, char**, void (*)(), void (*)(), void (*)(), void*);
  return next<Start>("__libc_start_main")(&armed_main, argc, argv, init, fini, rtld_fini, stack_end);
}

}  // extern "C"
