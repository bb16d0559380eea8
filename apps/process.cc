#include "apps/process.h"

#include <fmt/format.h>

#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <stdexcept>

extern char** environ;

namespace apps {

Child start_child(const std::vector<std::string>& command, bool own_group)
{
  int ends[2];
  if (::pipe(ends) != 0)
    throw std::runtime_error("no pipe for a child process");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  posix_spawn_file_actions_addclose(&actions, ends[0]);
  posix_spawn_file_actions_addclose(&actions, ends[1]);
  std::vector<char*> arguments;
  for (const std::string& word : command)
    arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, own_group ? POSIX_SPAWN_SETPGROUP : 0);
  pid_t pid = 0;
  const int error =
      ::posix_spawn(&pid, arguments[0], &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  ::close(ends[1]);
  if (error != 0) {
    ::close(ends[0]);
    throw std::runtime_error(fmt::format("{} cannot be started", command[0]));
  }
  return {pid, ends[0]};
}

int wait_for(const Child& child)
{
  int status = 0;
  while (::waitpid(child.pid, &status, 0) < 0 && errno == EINTR) {
  }
  ::close(child.output);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

Finished read_to_end(const Child& child)
{
  Finished result;
  char buffer[4096];
  for (;;) {
    const ssize_t n = ::read(child.output, buffer, sizeof buffer);
    if (n > 0)
      result.output.append(buffer, std::size_t(n));
    else if (n == 0 || errno != EINTR)
      break;
  }
  result.exit_code = wait_for(child);
  return result;
}

Finished run_to_end(const std::vector<std::string>& command)
{
  return read_to_end(start_child(command));
}

Finished run_to_end(const std::vector<std::string>& command, double time_limit)
{
  using Clock = std::chrono::steady_clock;
  const Clock::time_point limit = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                                     std::chrono::duration<double>(time_limit));
  const Child child = start_child(command, true);
  Finished result;
  char buffer[4096];
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(limit - Clock::now());
    pollfd ready{child.output, POLLIN, 0};
    const int n_ready = ::poll(&ready, 1, int(std::max<long>(0, left.count())));
    if (n_ready < 0 && errno == EINTR) {
      ::kill(-child.pid, SIGTERM);
      continue;
    }
    if (n_ready <= 0) {
      ::kill(-child.pid, SIGKILL);
      result.timed_out = true;
      break;
    }
    const ssize_t n = ::read(child.output, buffer, sizeof buffer);
    if (n > 0)
      result.output.append(buffer, std::size_t(n));
    else if (n == 0 || errno != EINTR)
      break;
  }
  result.exit_code = wait_for(child);
  return result;
}

} // namespace apps
