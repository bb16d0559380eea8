#pragma once

namespace fem {

/// Processor time that the calling thread has taken so far [s]. Other programs on the machine do
/// not count.
double processor_time();

/// Adds the processor time that passes in a block to a sum.
class ProcessorTimer {
public:
  /// \param sum     outlives this object; no other thread adds to it meanwhile [s]
  /// \param weight  of the time
  explicit ProcessorTimer(double& sum, double weight = 1)
      : sum_(sum), weight_(weight), start_(processor_time())
  {
  }
  ~ProcessorTimer() { sum_ += weight_ * (processor_time() - start_); }
  ProcessorTimer(const ProcessorTimer&) = delete;

private:
  double& sum_;
  double weight_, start_;
};

} // namespace fem
