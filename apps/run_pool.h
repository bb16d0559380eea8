#pragma once
#include "apps/child_run.h"
#include "apps/progress.h"
#include "apps/run.h"
#include "apps/study_factors.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace apps {

/// Runs of a study in processes of their own, several at a time. Says how far they are, prints
/// what they say as they end, and stores it as run.log in their folders.
class RunPool {
public:
  /// \param brief  print one line of each run instead of all that it says
  RunPool(std::filesystem::path folder, std::size_t n_runs, const RunOptions& options, bool brief);

  void start(const StudyRun& run, const std::vector<std::string>& command);

  /// Notes a run that need not be started.
  void count_as_finished(const StudyRun& run, int exit_code);

  /// Waits until at most so many are going on; passes an interruption on to them.
  void wait_for_room(std::size_t most);

  /// Of the runs that ended, by name.
  const std::map<std::string, int>& exit_codes() const { return exit_codes_; }

private:
  struct Active {
    StudyRun run;
    ChildRun child;
  };

  void finish(std::size_t k);
  void tell();

  std::filesystem::path folder_;
  std::size_t n_runs_;
  bool brief_;
  Progress progress_;
  std::vector<Active> active_;
  std::map<std::string, int> exit_codes_;
  bool told_children_ = false;
};

/// What a run said last of itself: why it failed, or how it ended.
/// \param log  its lines
std::string last_statement(const std::string& log);

} // namespace apps
