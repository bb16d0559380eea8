#pragma once
#include "dem/network_solver.h"

#include <string>

namespace apps {

/// How the equations of a network were solved: by a factor or by iteration, and what it took.
std::string equations_text(const dem::ElasticNetwork& network,
                           const dem::NetworkSolver::Statistics& statistics);

} // namespace apps
