#pragma once
#include "apps/process.h"

#include <string>
#include <vector>

namespace apps {

/// A run of the program as a child, and what it has said so far.
struct ChildRun {
  Child child;
  std::string log;     ///< its lines, without those about progress
  double fraction = 0; ///< of the work done
  std::string state;   ///< "t = 12 s, ..."
  std::string unread;  ///< the beginning of a line
};

/// The command "mastic run --report --threads N".
std::vector<std::string> run_command(int n_threads);

/// Takes in what a child has written. \return false when it has ended
bool listen(ChildRun& run);

/// Waits up to a time for output of one of the runs.
/// \return for each, whether there is some, or its end
std::vector<bool> wait_for_output(const std::vector<const ChildRun*>& runs, int milliseconds);

/// Asks a child to stop.
void stop(const ChildRun& run);

/// Ends a child at once.
void kill(const ChildRun& run);

} // namespace apps
