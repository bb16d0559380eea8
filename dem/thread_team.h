#pragma once
#include <atomic>
#include <functional>
#include <thread>
#include <vector>

namespace dem {

/// Where threads wait for each other, some thousand times a second.
///
/// They spin for some microseconds, which is all it takes on a quiet machine, then sleep: where
/// processors are scarce a spinning thread would keep the one it waits for from running.
class MeetingPoint {
public:
  explicit MeetingPoint(int n_threads) : n_threads_(n_threads) {}

  /// Returns when all threads have come; what each did before, all see after.
  void wait()
  {
    const int round = round_.load(std::memory_order_relaxed);
    if (arrived_.fetch_add(1, std::memory_order_acq_rel) + 1 == n_threads_) {
      arrived_.store(0, std::memory_order_relaxed);
      round_.store(round + 1, std::memory_order_release);
      round_.notify_all();
      return;
    }
    for (int spins = 0; spins < most_spins; ++spins) {
      if (round_.load(std::memory_order_acquire) != round)
        return;
      pause();
    }
    round_.wait(round, std::memory_order_acquire);
  }

private:
  static void pause()
  {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }

  static constexpr int most_spins = 2000;

  int n_threads_;
  std::atomic<int> arrived_{0};
  std::atomic<int> round_{0};
};

/// Calls work(0) here and work(1) ... work(n - 1) on threads of their own, once all of them are
/// there; returns when all are done. The work must not throw.
/// \throws std::system_error if the threads cannot be had; no work is done then
inline void run_on_threads(int n_threads, const std::function<void(int)>& work)
{
  enum Gate { closed, open, cancelled };
  std::atomic<int> gate{closed};
  const auto let = [&](Gate now) {
    gate.store(now);
    gate.notify_all();
  };
  std::vector<std::jthread> others;
  try {
    for (int k = 1; k < n_threads; ++k)
      others.emplace_back([&, k] {
        gate.wait(closed);
        if (gate.load() == open)
          work(k);
      });
  } catch (...) {
    let(cancelled);
    throw;
  }
  let(open);
  work(0);
}

/// Share of [0, n) that a thread works on.
struct Share {
  int begin, end;
};
inline Share share_of(int n, int thread, int n_threads)
{
  return {int(long(n) * thread / n_threads), int(long(n) * (thread + 1) / n_threads)};
}

} // namespace dem
