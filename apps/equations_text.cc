#include "apps/equations_text.h"

#include <fmt/format.h>

namespace apps {

std::string equations_text(const dem::ElasticNetwork& network,
                           const dem::NetworkSolver::Statistics& statistics)
{
  const auto counted = [](long n, const char* what) {
    return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
  };
  if (statistics.iterates)
    return fmt::format("{} unknowns, conjugate gradients with multigrid: {}, {}", network.n_dofs,
                       counted(statistics.n_factorisations, "set-up"),
                       counted(statistics.n_iterations, "iteration"));
  return fmt::format("{} unknowns, {} nonzeros in the factor, {}", network.n_dofs,
                     statistics.n_factor_nonzeros,
                     counted(statistics.n_factorisations, "factorisation"));
}

} // namespace apps
