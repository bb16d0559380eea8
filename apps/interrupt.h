#pragma once

namespace apps {

/// Makes SIGINT and SIGTERM ask for a stop instead of killing.
/// \param second_kills  a second signal kills (not in the runs of a study: they may hear of the
/// same
///                      interruption from the terminal and from the study)
void catch_interrupts(bool second_kills);

/// True after such a signal.
bool interrupted();

} // namespace apps
