#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/program.h"
#include "tests/support/scratch.h"

namespace {

using touchtrace::testing::run_program;

void expect_failure(const std::string& arguments, int exit_code, const std::string& says) {
  const auto result = run_program(arguments);
  EXPECT_EQ(result.exit_code, exit_code) << arguments << "\n" << result.output;
  EXPECT_NE(result.output.find(says), std::string::npos) << arguments << "\n" << result.output;
  EXPECT_NE(result.output.find("hint:"), std::string::npos) << arguments << "\n" << result.output;
}

/// The commands as --help lists them.
std::vector<std::string> verb_names() {
  std::istringstream help(run_program("--help").output);
  std::vector<std::string> names;
  bool listing = false;
  for (std::string line; std::getline(help, line);) {
    if (line.starts_with("Subcommands:"))
      listing = true;
    else if (listing && line.starts_with("  ") && line.size() > 2 && line[2] != ' ')
      names.push_back(line.substr(2, line.find(' ', 2) - 2));
    else if (listing && !line.starts_with("  "))
      listing = false;
  }
  return names;
}

TEST(CommandLine, EveryVerbHasHelpWithExamplesAndExitCodes) {
  const auto names = verb_names();
  for (const char* needed : {"doctor", "devices", "plan", "simulate", "check", "calibrate", "label",
                             "train", "evaluate", "report"})
    EXPECT_NE(std::ranges::find(names, needed), names.end()) << needed;
  for (const auto& name : names) {
    const auto help = run_program(name + " --help");
    EXPECT_EQ(help.exit_code, 0) << help.output;
    EXPECT_NE(help.output.find("Examples:\n  touchtrace " + name), std::string::npos)
        << help.output;
    EXPECT_NE(help.output.find("Exit codes: 0 done"), std::string::npos) << help.output;
  }
}

TEST(CommandLine, UnknownNamesAreErrorsThatSuggest) {
  expect_failure("simulat", 2, "there is no command 'simulat'");
  EXPECT_NE(run_program("simulat").output.find("did you mean 'simulate'"), std::string::npos);
  expect_failure("simulate --activty wave x.h5", 2, "did you mean 'activity'");
  expect_failure("simulate --activity wav out.h5", 2, "did you mean 'wave'");
  expect_failure("simulate --object bal out.h5", 2, "did you mean 'ball'");
  expect_failure("devices --device no-such-device", 4, "no OpenCL device matches");
}

TEST(CommandLine, ConfigurationFileIsChecked) {
  const auto path = touchtrace::testing::scratch_folder().string() + ".toml";
  const auto write = [&](const char* text) { std::ofstream(path) << text; };
  write("[simulate]\nactvity = \"wave\"\n");
  expect_failure("simulate out.h5 --config " + path, 2, "has no key 'actvity'");
  write("[simulate]\nminutes = \"three\"\n");
  expect_failure("simulate out.h5 --config " + path, 2, "wrong type");
  write("[simulate\n");
  expect_failure("simulate out.h5 --config " + path, 2, path + ":1");
  std::filesystem::remove(path);
}

TEST(CommandLine, MissingFilesAreDataErrors) {
  for (const char* arguments :
       {"check /no/such/file.h5", "calibrate /no/such/file.h5 --output /tmp/touchtrace_none",
        "label /no/such/file.h5 --calibration /no/such --output /tmp/touchtrace_none.h5"})
    EXPECT_EQ(run_program(arguments).exit_code, 3) << arguments << "\n"
                                                   << run_program(arguments).output;
}

TEST(CommandLine, DevicesAsJson) {
  const auto result = run_program("devices --json 2>/dev/null");
  ASSERT_EQ(result.exit_code, 0);
  const auto json = nlohmann::json::parse(result.output);
  EXPECT_GE(json.at("devices").size(), 1u);
}

}  // namespace
