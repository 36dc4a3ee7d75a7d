#pragma once

namespace touchtrace {

/// Installs handlers for SIGINT and SIGTERM: the first signal sets a flag, the second one ends the
/// process.
void catch_interrupts();
/// Whether the flag is set.
bool interrupted() noexcept;
/// Throws Error(ExitCode::interrupted) if the flag is set. To be called regularly in long loops.
void throw_if_interrupted();
/// Resets the flag, for a command that the first signal only tells to finish.
void clear_interrupt() noexcept;

}  // namespace touchtrace
