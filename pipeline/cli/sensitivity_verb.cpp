#include <fmt/core.h>

#include "pipeline/cli/usable_device.h"
#include "pipeline/cli/verbs.h"
#include "pipeline/study/sensitivity.h"

namespace touchtrace::cli {
namespace {

ExitCode run(const study::SensitivityOptions& options, const Invocation& invocation) {
  Runtime runtime(usable_device(invocation.device));
  Provenance provenance = start_provenance("touchtrace/sensitivity/1", "sensitivity");
  provenance.options = invocation.options;
  const auto document =
      study::measure_sensitivity(runtime, options, std::move(provenance), invocation.overwrite);
  if (invocation.json)
    fmt::print("{}\n", document.dump(2));
  else
    fmt::print("{}", study::sensitivity_table(document));
  return ExitCode::done;
}

}  // namespace

Verb sensitivity_verb() {
  return make_verb<study::SensitivityOptions>(
      "sensitivity", "halve and double what the scene assumes, and see what it does to L1@50",
      {"touchtrace sensitivity --output wave.json --only glove-gain glove-cross-talk",
       "touchtrace sensitivity --output throw.json --activity throw --resume"},
      run);
}

}  // namespace touchtrace::cli
