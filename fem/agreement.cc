#include "fem/agreement.h"

#include <deal.II/base/mpi.h>

#include <fmt/format.h>

#include <string>

namespace fem {

namespace {

enum Outcome { wrong_input, failed, done };

} // namespace

void together(MPI_Comm ranks, const std::function<void()>& work)
{
  Outcome own = done;
  std::string message;
  try {
    work();
  } catch (const std::invalid_argument& error) {
    own = wrong_input;
    message = error.what();
  } catch (const std::bad_alloc&) {
    own = failed;
    message = "the memory does not suffice";
  } catch (const std::exception& error) {
    own = failed;
    message = error.what();
  }
  if (dealii::Utilities::MPI::min(int(own), ranks) == done)
    return;
  const auto outcomes = dealii::Utilities::MPI::all_gather(ranks, int(own));
  std::size_t first = 0;
  while (outcomes[first] == done)
    ++first;
  message = dealii::Utilities::MPI::broadcast(ranks, message, unsigned(first));
  if (outcomes[first] == wrong_input)
    throw std::invalid_argument(message);
  throw RankFailure(first == 0 ? message : fmt::format("on rank {}: {}", first, message));
}

} // namespace fem
