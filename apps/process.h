#pragma once
#include <string>
#include <vector>

#include <sys/types.h>

namespace apps {

/// A child process whose standard output and error arrive in one pipe.
struct Child {
  pid_t pid;
  int output; ///< file descriptor to read from
};

/// Starts a program with arguments (the first is the program's path).
/// \throws std::runtime_error if it cannot be started
/// \param own_group  whether it leads a group of processes, which signals can reach together
Child start_child(const std::vector<std::string>& command, bool own_group = false);

/// Waits for the end. \return the exit code, 128 + signal if it was killed
int wait_for(const Child& child);

/// Everything a child writes until it ends, then its exit code.
struct Finished {
  std::string output;
  int exit_code;
  bool timed_out = false; ///< it was killed because its time was over
};
Finished read_to_end(const Child& child);
Finished run_to_end(const std::vector<std::string>& command);

/// The same, but a child that takes longer is killed with all that it has started, and told to stop
/// when this program is interrupted.
/// \param time_limit  [s]
Finished run_to_end(const std::vector<std::string>& command, double time_limit);

} // namespace apps
