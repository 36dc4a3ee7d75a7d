#pragma once

namespace touchtrace {

/// From now on Ctrl-C and SIGTERM set a flag; a second one ends the process at once.
void catch_interrupts();
/// True once the user asked to stop.
bool interrupted() noexcept;
/// Throws Error(ExitCode::interrupted) once the user asked to stop. Long loops call it each turn.
void throw_if_interrupted();

}  // namespace touchtrace
