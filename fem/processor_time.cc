#include "fem/processor_time.h"

#include <ctime>

namespace fem {

double processor_time()
{
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

} // namespace fem
