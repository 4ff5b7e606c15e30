#pragma once

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>

#include <concepts>
#include <string>
#include <vector>

#include "program.hpp"

namespace cleave::cli::test {

/// Starts the program in a folder and sends it a signal as soon as `when()` holds, however fast the machine is. The
/// code is as a shell says it: 128 and the number of the signal for what a signal ended.
[[nodiscard]] inline Ended signalled(const fs::path& folder, std::vector<std::string> arguments, int signal,
                                     const std::predicate auto& when) {
  const std::string out = folder.string() + ".out", err = folder.string() + ".err";
  arguments.insert(arguments.begin(), "cleave");
  std::vector<char*> words;
  for (std::string& word : arguments) words.push_back(word.data());
  words.push_back(nullptr);
  posix_spawn_file_actions_t files;
  ::posix_spawn_file_actions_init(&files);
  constexpr int flags = O_WRONLY | O_CREAT | O_TRUNC;
  ::posix_spawn_file_actions_addchdir_np(&files, folder.c_str());
  ::posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, out.c_str(), flags, 0600);
  ::posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err.c_str(), flags, 0600);
  pid_t child = 0;
  EXPECT_EQ(::posix_spawn(&child, CLEAVE_PROGRAM, &files, nullptr, words.data(), environ), 0);
  ::posix_spawn_file_actions_destroy(&files);
  // Asked without taking its end away: a number that another program may have by then gets no signal.
  const auto lives = [&] {
    siginfo_t state{};
    return ::waitid(P_PID, static_cast<id_t>(child), &state, WEXITED | WNOHANG | WNOWAIT) == 0 && state.si_pid == 0;
  };
  while (lives() && !when()) ::sched_yield();
  EXPECT_EQ(::kill(child, signal), 0);
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  Ended ended{WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), text_of(out), text_of(err)};
  fs::remove(out);
  fs::remove(err);
  return ended;
}

}  // namespace cleave::cli::test
