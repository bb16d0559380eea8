#pragma once
#include <string>

namespace apps {

/// The processor's name as the system knows it: timings mean nothing without it.
std::string machine_name();

/// Programs that wanted to compute in the last minute, on average; 0 if the system does not say.
double load_average();

/// Processors that this program may use.
int n_processors();

} // namespace apps
