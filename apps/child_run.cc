#include "apps/child_run.h"

#include "apps/files.h"

#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>

namespace apps {

std::vector<std::string> run_command(int n_threads)
{
  return {own_executable().string(), "run", "--report", "--threads", std::to_string(n_threads)};
}

bool listen(ChildRun& run)
{
  char buffer[4096];
  const ssize_t n = ::read(run.child.output, buffer, sizeof buffer);
  if (n < 0 && errno == EINTR)
    return true;
  if (n <= 0)
    return false;
  run.unread.append(buffer, std::size_t(n));
  for (std::size_t end; (end = run.unread.find('\n')) != std::string::npos;) {
    const std::string line = run.unread.substr(0, end);
    run.unread.erase(0, end + 1);
    if (line.starts_with("progress ")) {
      run.fraction = std::atof(line.c_str() + 9);
      run.state = line.substr(std::min(line.size(), line.find(' ', 9) + 1));
    } else
      run.log += line + '\n';
  }
  return true;
}

std::vector<bool> wait_for_output(const std::vector<const ChildRun*>& runs, int milliseconds)
{
  std::vector<pollfd> ready;
  for (const ChildRun* run : runs)
    ready.push_back({run->child.output, POLLIN, 0});
  ::poll(ready.data(), ready.size(), milliseconds);
  std::vector<bool> has_output;
  for (const pollfd& each : ready)
    has_output.push_back(each.revents != 0);
  return has_output;
}

void stop(const ChildRun& run)
{
  ::kill(run.child.pid, SIGTERM);
}

void kill(const ChildRun& run)
{
  ::kill(run.child.pid, SIGKILL);
}

} // namespace apps
