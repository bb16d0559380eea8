#pragma once
#include <chrono>
#include <string>
#include <vector>

namespace bench {

/// Wall time since it was made.
class Stopwatch {
public:
  double seconds() const
  {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// What other programs took from the machine since it was made: a timing that does not say so
/// cannot be trusted.
class OtherPrograms {
public:
  OtherPrograms();
  double processors() const; ///< busy with other programs, on average; -1 if not known

private:
  Stopwatch watch_;
  double busy_, own_; ///< processor seconds at the start
};

/// Repeated measurements of one number.
struct Summary {
  double median, least, most;
  double spread() const { return (most - least) / median; }
};
Summary summary(std::vector<double> values);

/// Name of the processor and how many of it this program sees.
std::string machine();

} // namespace bench
