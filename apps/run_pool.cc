#include "apps/run_pool.h"

#include "apps/files.h"
#include "apps/interrupt.h"
#include "apps/text.h"

#include <fmt/format.h>

#include <cstdio>

namespace apps {

RunPool::RunPool(std::filesystem::path folder, std::size_t n_runs, const RunOptions& options,
                 bool brief)
    : folder_(std::move(folder)), n_runs_(n_runs), brief_(brief),
      progress_(folder_.filename().string(), options.quiet, options.for_parent)
{
}

void RunPool::start(const StudyRun& run, const std::vector<std::string>& command)
{
  active_.push_back({run, {start_child(command), "", 0, "", ""}});
}

void RunPool::count_as_finished(const StudyRun& run, int exit_code)
{
  exit_codes_[run.name] = exit_code;
}

void RunPool::wait_for_room(std::size_t most)
{
  while (active_.size() > most) {
    std::vector<const ChildRun*> children;
    for (const Active& each : active_)
      children.push_back(&each.child);
    const std::vector<bool> ready = wait_for_output(children, 500);
    if (interrupted() && !told_children_) {
      for (const Active& each : active_)
        stop(each.child);
      told_children_ = true;
    }
    for (std::size_t k = active_.size(); k-- > 0;)
      if (ready[k] && !listen(active_[k].child))
        finish(k);
    tell();
  }
}

void RunPool::finish(std::size_t k)
{
  Active& active = active_[k];
  exit_codes_[active.run.name] = wait_for(active.child.child);
  progress_.finish();
  const std::string& log = active.child.log;
  fmt::print("{}", brief_ ? fmt::format("{}: {}\n", active.run.name, last_statement(log)) : log);
  std::fflush(stdout);
  write_text_file(folder_ / active.run.name / "run.log", log);
  active_.erase(active_.begin() + std::ptrdiff_t(k));
}

void RunPool::tell()
{
  if (active_.empty())
    return;
  double done = double(exit_codes_.size());
  std::string states;
  for (const Active& each : active_) {
    done += each.child.fraction;
    states += fmt::format("{}{}: {}", states.empty() ? "" : "; ", each.run.name,
                          each.child.state.empty() ? "begins" : each.child.state);
  }
  progress_.update(done / double(n_runs_), states);
}

std::string last_statement(const std::string& log)
{
  std::string statement, last;
  for (const std::string& line : split(log, '\n')) {
    if (line.starts_with("ended at") || line.starts_with("error: ") ||
        line.find(": interrupted at ") != std::string::npos)
      statement = line;
    if (!line.empty())
      last = line;
  }
  return statement.empty() ? last : statement;
}

} // namespace apps
