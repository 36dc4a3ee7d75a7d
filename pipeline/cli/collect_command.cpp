#include <fmt/core.h>

#include "pipeline/cli/commands.h"
#include "pipeline/sweep/collect.h"

namespace touchtrace::cli {
namespace {

struct CollectOptions {
  std::string folder;
  std::vector<std::string> metrics;
};

void describe(OptionSet& set, CollectOptions& o) {
  set.input("folder", o.folder, "--output of `touchtrace sweep`");
  set.texts("metrics", o.metrics,
            "columns of the tables, e.g. l1_at_20 l1_at_50; default: main_metrics of the results, "
            "else all")
      .value("NAME");
}

ExitCode run(const CollectOptions& options, const Invocation& invocation) {
  const auto results = sweep::collect(options.folder, options.metrics);
  if (invocation.json)
    fmt::print("{}\n", results.dump(2));
  else
    fmt::print("{}\n{} rows of {} cells in {}; {} cells are not done\n",
               results["table"].get<std::string>(), results["rows"].get<int>(),
               results["cells"].get<int>(), options.folder, results["missing_cells"].get<int>());
  return ExitCode::done;
}

}  // namespace

Command collect_command() {
  return make_command<CollectOptions>(
      "collect", "write a sweep's results: CSV, JSON, tables for a paper, curves for TensorBoard",
      {"touchtrace collect out/quick",
       "touchtrace collect out/quick --metrics l1_at_20 l1_at_50 hausdorff"},
      run);
}

}  // namespace touchtrace::cli
