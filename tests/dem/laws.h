#pragma once
#include "dem/creep_law.h"
#include "tests/reference.h"

/// Creep laws that several tests use.
namespace laws {

inline dem::CreepLaw burgers_set(const std::string& name)
{
  const auto set = reference::json("burgers_sets.json").at(name);
  const auto value = [&](const char* key) { return reference::number(set.at(key)); };
  return dem::burgers(value("Km"), value("Cm"), value("Kk"), value("Ck"));
}

/// Three Kelvin branches spread over five decades, with a dashpot.
inline dem::CreepLaw wide()
{
  const std::vector<dem::KelvinBranch> branches{{2e6, 2e5}, {7e5, 2.1e6}, {3e5, 1.2e8}};
  return dem::make_creep_law(1e6, 4e9, branches);
}

} // namespace laws
