#include "apps/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace apps {

namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point time)
{
  return std::chrono::duration<double>(Clock::now() - time).count();
}

} // namespace

std::string duration_text(double seconds)
{
  if (seconds < 10)
    return fmt::format("{:.1f} s", seconds);
  if (seconds < 120)
    return fmt::format("{:.0f} s", seconds);
  if (seconds < 7200)
    return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

Progress::Progress(std::string name, bool quiet, bool for_parent)
    : name_(std::move(name)), quiet_(quiet), for_parent_(for_parent),
      terminal_(isatty(STDERR_FILENO) != 0), start_(Clock::now()), last_(start_)
{
}

void Progress::update(double fraction, const std::string& text)
{
  const double pause = for_parent_ || terminal_ ? 0.5 : 10;
  if (first_fraction_ < 0)
    first_fraction_ = fraction; // a resumed run does not begin at 0
  if (quiet_ || since(last_) < pause)
    return;
  last_ = Clock::now();
  if (for_parent_) {
    fmt::print("progress {:.4f} {}\n", fraction, text);
    std::fflush(stdout);
    return;
  }
  const double done = fraction - first_fraction_;
  const std::string left =
      done > 0.01 ? fmt::format(", about {} left", duration_text(seconds() * (1 - fraction) / done))
                  : "";
  const std::string line = fmt::format("{}: {:3.0f} %, {}{}", name_, 100 * fraction, text, left);
  if (terminal_)
    fmt::print(stderr, "\r\033[K{}", line);
  else
    fmt::print(stderr, "{}\n", line);
  std::fflush(stderr);
  line_open_ = terminal_;
}

void Progress::finish()
{
  if (line_open_)
    fmt::print(stderr, "\r\033[K");
  line_open_ = false;
}

double Progress::seconds() const
{
  return since(start_);
}

} // namespace apps
