#include "apps/interrupt.h"

#include <signal.h>

namespace apps {

namespace {

// A signal handler reaches nothing but a variable of this kind.
volatile sig_atomic_t stop_requested = 0;

extern "C" void request_stop(int)
{
  stop_requested = 1;
}

void catch_signal(int signal, bool second_kills)
{
  struct sigaction action = {};
  action.sa_handler = request_stop;
  action.sa_flags = SA_RESTART | (second_kills ? SA_RESETHAND : 0);
  sigaction(signal, &action, nullptr);
}

} // namespace

void catch_interrupts(bool second_kills)
{
  catch_signal(SIGINT, second_kills);
  catch_signal(SIGTERM, second_kills);
}

bool interrupted()
{
  return stop_requested != 0;
}

} // namespace apps
