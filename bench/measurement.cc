#include "bench/measurement.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <thread>

#include <sys/resource.h>
#include <unistd.h>

namespace bench {

namespace {

/// Processor seconds that all programs have used so far; negative if not known.
double busy_seconds()
{
  std::ifstream file("/proc/stat");
  std::string name;
  double user = -1, nice = 0, system = 0, idle = 0, wait = 0, hard = 0, soft = 0;
  file >> name >> user >> nice >> system >> idle >> wait >> hard >> soft;
  return (user + nice + system + hard + soft) / double(sysconf(_SC_CLK_TCK));
}

double own_seconds()
{
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return double(time.tv_sec) + 1e-6 * double(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

} // namespace

OtherPrograms::OtherPrograms() : busy_(busy_seconds()), own_(own_seconds()) {}

double OtherPrograms::processors() const
{
  const double busy = busy_seconds() - busy_, own = own_seconds() - own_;
  return busy_ < 0 ? -1 : std::max(0.0, busy - own) / watch_.seconds();
}

Summary summary(std::vector<double> values)
{
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return {0.5 * (values[(n - 1) / 2] + values[n / 2]), values.front(), values.back()};
}

std::string machine()
{
  std::map<std::string, std::string> processor;
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line) && !line.empty();) {
    const std::size_t colon = line.find(':');
    if (colon + 2 <= line.size())
      processor[line.substr(0, line.find_last_not_of("\t :", colon) + 1)] = line.substr(colon + 2);
  }
  return fmt::format("{}, family {} model {}, {} visible", processor["model name"],
                     processor["cpu family"], processor["model"],
                     std::thread::hardware_concurrency());
}

} // namespace bench
