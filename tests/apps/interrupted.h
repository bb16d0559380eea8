#pragma once
#include "tests/apps/networks.h"

#include <signal.h>

#include <chrono>
#include <stdexcept>
#include <thread>

/// Runs that are stopped on the way.
namespace interrupted {

/// A checkpoint after each bit of work: so slow that there is time for an interruption.
inline const std::string slow = "Output/Checkpoint interval = 1e-9 s";

/// The usual pause between checkpoints, for a run that began slow.
inline const std::string quick = "Output/Checkpoint interval = 60 s";

/// A load that changes 600 times while bonds break.
inline std::string many_steps()
{
  std::string history;
  for (int k = 0; k <= 600; ++k)
    history += fmt::format("{}{} s: {} kPa", k ? ", " : "", 0.25 * k, k % 2 ? 690 : 700);
  return history;
}

/// Writes a lattice whose scene takes a solver some hundred bits of work. The default tolerance of
/// `quasistatic` decides whether its last avalanche ends in rupture: here it must not.
inline void write_long_scene(const command::Folder& folder, const std::string& solver)
{
  networks::write_lattice(folder);
  folder.write("long-0.5.scene",
               networks::scene + "set Solver = " + solver +
                   "\nsubsection Loading\n  set Test = stress history\n"
                   "  set Stress history = " +
                   many_steps() +
                   "\nend\nsubsection Quasistatic\n  set Residual tolerance = 1e-7\n"
                   "end\nsubsection Dynamic\n  set Viscosity scaling = 1e-4\n"
                   "  set Audit = false\nend\n");
}

/// Waits until something holds; gives up after half a minute.
template <typename Condition>
void wait_until(Condition&& holds)
{
  for (int k = 0; k < 6000; ++k) {
    if (holds())
      return;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  throw std::runtime_error("the test waited in vain");
}

/// Starts the program, lets it write some checkpoints, and sends it a signal.
inline apps::Finished stopped(const command::Folder& folder,
                              const std::vector<std::string>& arguments,
                              const std::string& checkpoint, int n_checkpoints, int signal)
{
  const apps::Child child = apps::start_child(command::line(folder, arguments));
  const auto written = [&] {
    std::error_code none;
    return std::filesystem::last_write_time(folder / checkpoint, none);
  };
  auto last = written();
  for (int k = 0; k < n_checkpoints; ++k) {
    wait_until([&] { return folder.has(checkpoint) && written() != last; });
    last = written();
  }
  ::kill(child.pid, signal);
  return apps::read_to_end(child);
}

} // namespace interrupted
