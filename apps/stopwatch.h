#pragma once
#include <chrono>

namespace apps {

/// Wall time that `SpecimenRun::work_towards` may take before it comes back [s].
constexpr double work_slice = 0.1;

/// Wall time since it was made.
class Stopwatch {
public:
  double seconds() const
  {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

} // namespace apps
