#pragma once
#include <chrono>
#include <string>

namespace apps {

/// Tells how far long work is, on standard error: one line rewritten on a terminal, a line now and
/// then elsewhere. With `for_parent`, lines "progress FRACTION TEXT" on standard output instead.
class Progress {
public:
  Progress(std::string name, bool quiet, bool for_parent);

  /// \param fraction  of the work done, 0 to 1
  void update(double fraction, const std::string& text);

  /// Ends the line on a terminal.
  void finish();

  double seconds() const;

private:
  std::string name_;
  bool quiet_, for_parent_, terminal_;
  bool line_open_ = false;
  std::chrono::steady_clock::time_point start_, last_;
  double first_fraction_ = -1;
};

/// "2 min 5 s"
std::string duration_text(double seconds);

} // namespace apps
