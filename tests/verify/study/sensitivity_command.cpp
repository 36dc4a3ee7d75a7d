#include "tests/verify/study/sensitivity_command.h"

#include <fmt/core.h>

#include "pipeline/cli/usable_device.h"
#include "tests/verify/study/sensitivity.h"

namespace touchtrace::study {
namespace {

ExitCode run(const SensitivityOptions& options, const cli::Invocation& invocation) {
  Runtime runtime(cli::usable_device(invocation.device));
  Provenance provenance = start_provenance("touchtrace/sensitivity/1", "sensitivity");
  provenance.options = invocation.options;
  const auto document =
      measure_sensitivity(runtime, options, std::move(provenance), invocation.overwrite);
  if (invocation.json)
    fmt::print("{}\n", document.dump(2));
  else
    fmt::print("{}", sensitivity_table(document));
  return ExitCode::done;
}

}  // namespace

cli::Command sensitivity_command() {
  return cli::make_command<SensitivityOptions>(
      "sensitivity", "halve and double the scene's parameters and measure the effect on L1@50",
      {"touchtrace-verify sensitivity --output wave.json --only glove-gain glove-cross-talk",
       "touchtrace-verify sensitivity --output throw.json --activity throw --resume"},
      run, {.device = true, .overwrite = true, .quiet = true});
}

}  // namespace touchtrace::study
