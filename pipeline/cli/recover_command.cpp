#include <fmt/core.h>

#include "pipeline/acquire/record/convert_log.h"
#include "pipeline/cli/commands.h"

namespace touchtrace::cli {
namespace {

struct RecoverOptions {
  std::string log, output;
};

void describe(OptionSet& set, RecoverOptions& o) {
  set.input("log", o.log, "file that an interrupted `record` left, OUTPUT.log");
  set.text("output", o.output, "recording (.h5); default: the log's name without .log")
      .value("FILE");
}

std::string output_of(const RecoverOptions& options) {
  if (!options.output.empty()) return options.output;
  const std::filesystem::path log(options.log);
  if (log.extension() != ".log")
    throw usage_error(fmt::format("{} has no name for the recording", options.log),
                      "give --output FILE.h5");
  return std::filesystem::path(log).replace_extension().string();
}

ExitCode run(const RecoverOptions& options, const Invocation& invocation) {
  const std::string output = output_of(options);
  const LogConversion conversion = convert_log(options.log, output, invocation.overwrite);
  nlohmann::json summary = to_json(conversion);
  summary["output"] = output;
  if (invocation.json)
    fmt::print("{}\n", summary.dump(2));
  else
    fmt::print("{}: {}\n", output, conversion.text());
  return conversion.is_complete() ? ExitCode::done : ExitCode::data;
}

}  // namespace

Command recover_command() {
  return make_command<RecoverOptions>(
      "recover", "finish a recording that was interrupted",
      {"touchtrace recover my.h5.log", "touchtrace recover my.h5.log --output other_disk/my.h5"},
      run, {.overwrite = true, .quiet = true});
}

}  // namespace touchtrace::cli
