#include "apps/machine.h"

#include "apps/text.h"

#include <sys/utsname.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <thread>

namespace apps {

std::string machine_name()
{
  std::ifstream processors("/proc/cpuinfo");
  for (std::string line; std::getline(processors, line);)
    if (const std::size_t colon = line.find(':');
        colon != std::string::npos && trimmed(line.substr(0, colon)) == "model name")
      return trimmed(line.substr(colon + 1));
  utsname system{};
  return ::uname(&system) == 0 ? system.machine : "unknown";
}

double load_average()
{
  double load = 0;
  return ::getloadavg(&load, 1) == 1 ? load : 0;
}

int n_processors()
{
  return int(std::max(1u, std::thread::hardware_concurrency()));
}

} // namespace apps
