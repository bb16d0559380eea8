#include "apps/interrupt.h"

#include <csignal>

namespace apps {

namespace {

// A signal handler reaches nothing but a variable of this kind.
volatile std::sig_atomic_t stop_requested = 0;

extern "C" void request_stop(int signal)
{
  stop_requested = 1;
  std::signal(signal, SIG_DFL);
}

} // namespace

void catch_interrupts()
{
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
}

bool interrupted()
{
  return stop_requested != 0;
}

} // namespace apps
