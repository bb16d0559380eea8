#pragma once

namespace apps {

/// Makes SIGINT and SIGTERM ask for a stop instead of killing; a second one kills.
void catch_interrupts();

/// True after such a signal.
bool interrupted();

} // namespace apps
