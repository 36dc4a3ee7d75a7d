#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/program.h"
#include "tests/support/scratch.h"

namespace {

using touchtrace::testing::run_program;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Expects an exit code, a message, and a hint after it.
void expect_failure(const std::string& arguments, int exit_code, const std::string& message) {
  const auto result = run_program(arguments);
  EXPECT_EQ(result.exit_code, exit_code) << arguments << "\n" << result.output;
  EXPECT_TRUE(contains(result.output, message)) << arguments << "\n" << result.output;
  EXPECT_TRUE(contains(result.output, "\nhint: ")) << arguments << "\n" << result.output;
}

std::vector<std::string> command_names() {
  std::istringstream list(run_program("--list").output);
  std::vector<std::string> names;
  for (std::string line; std::getline(list, line);) names.push_back(line.substr(0, line.find(' ')));
  return names;
}

TEST(CommandLine, EveryCommandHasHelpWithUsageExamplesAndExitCodes) {
  const auto names = command_names();
  for (const char* needed : {"doctor", "devices", "plan", "simulate", "check", "calibrate",
                             "smooth", "label", "train", "evaluate", "export", "report"})
    EXPECT_NE(std::ranges::find(names, needed), names.end()) << needed;
  for (const auto& name : names) {
    const auto help = run_program(name + " --help");
    EXPECT_EQ(help.exit_code, 0) << help.output;
    EXPECT_TRUE(contains(help.output, "Usage: touchtrace " + name)) << help.output;
    EXPECT_TRUE(contains(help.output, "Examples:\n  ")) << help.output;
    EXPECT_TRUE(contains(help.output, "Exit codes: 0 done")) << help.output;
    EXPECT_EQ(run_program("help " + name).output, help.output);
  }
}

TEST(CommandLine, HelpListsCommandsByGroup) {
  const auto help = run_program("--help");
  EXPECT_EQ(help.exit_code, 0);
  for (const char* part : {"\nSet up:\n  doctor", "\nSimulate:\n  simulate", "\nProcess:\n  record",
                           "\nStudy:\n  plan"})
    EXPECT_TRUE(contains(help.output, part)) << help.output;
  EXPECT_EQ(run_program("help").output, help.output);
}

TEST(CommandLine, NoCommandPrintsHelpAndFails) {
  const auto result = run_program("");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.output, run_program("--help").output);
  EXPECT_EQ(run_program("", "bash -c '$0 2>/dev/null' ").output, "");
}

TEST(CommandLine, HelpNamesValuesChoicesAndRequiredOptions) {
  const auto label = run_program("label --help").output;
  for (const char* part :
       {"touchtrace label RECORDING --output FILE [OPTIONS]", "--tracker {csrt,component}",
        "-o,--output FILE", "(required)", "[csrt]"})
    EXPECT_TRUE(contains(label, part)) << part << "\n" << label;
  const auto smooth = run_program("smooth --help").output;
  for (const char* part : {"touchtrace smooth TRACK... [OPTIONS]", "  TRACK...  ",
                           "--flights {find,none,FILE}", "--gravity X Y Z  ", "[smoothed]"})
    EXPECT_TRUE(contains(smooth, part)) << part << "\n" << smooth;
  const auto train = run_program("train --help").output;
  for (const char* part : {"Optimisation:\n", "--recording FILE...", "--checkpoint-seconds SECONDS",
                           "weight updates [3000]"})
    EXPECT_TRUE(contains(train, part)) << part << "\n" << train;
}

TEST(CommandLine, CommandsListOnlyCommonOptionsThatAffectThem) {
  for (const char* command : {"doctor", "check", "devices", "plan", "self-test", "objects"})
    EXPECT_FALSE(contains(run_program(std::string(command) + " --help").output, "--overwrite"))
        << command;
  for (const char* command :
       {"label", "calibrate", "check", "report", "objects", "send", "doctor", "smooth"})
    expect_failure(std::string(command) + " --device 0", 2, "unknown option '--device'");
  for (const char* command : {"simulate", "train", "evaluate", "devices", "plan"})
    EXPECT_TRUE(contains(run_program(std::string(command) + " --help").output, "--device DEVICE"))
        << command;
}

TEST(CommandLine, UnknownNamesAreErrorsWithSuggestions) {
  expect_failure("simulat", 2, "unknown command 'simulat'; did you mean 'simulate'?");
  expect_failure("help trian", 2, "unknown command 'trian'; did you mean 'train'?");
  expect_failure("--vershun", 2, "unknown option '--vershun'; did you mean '--version'?");
  for (const char* flag : {"--activty", "--act", "-act"})
    expect_failure(std::string("simulate ") + flag + " wave x.h5", 2,
                   std::string("unknown option '") + flag + "'; did you mean '--activity'?");
  expect_failure("simulate --activity wav out.h5", 2, "'wav'; did you mean 'wave'?");
  expect_failure("simulate --object bal out.h5", 2, "did you mean 'ball'");
  expect_failure("generate fish", 2, "FORMAT cannot be 'fish'; did you mean 'bash'?");
  expect_failure("devices --device no-such-device", 4, "no OpenCL device");
}

TEST(CommandLine, WrongUsageIsExplained) {
  expect_failure("label", 2, "missing RECORDING; usage: touchtrace label RECORDING --output FILE");
  expect_failure("label a.h5", 2, "missing --output FILE; usage: touchtrace label");
  expect_failure("export a.h5 --output a.csv", 2, "missing --format FORMAT");
  expect_failure("import --output a.h5", 2, "nothing to import");
  expect_failure("simulate a.h5 b.h5", 2, "unexpected argument 'b.h5'");
  expect_failure("simulate a.h5 --seed", 2, "--seed needs a value");
  expect_failure("simulate a.h5 --seed --quiet", 2, "--seed needs a value");
  expect_failure("simulate a.h5 --seed 1 --seed 2", 2, "--seed is given twice");
  expect_failure("simulate a.h5 --seed=-1", 2, "--seed must be a whole number, not '-1'");
  expect_failure("simulate a.h5 --minutes 3m", 2, "--minutes must be a number, not '3m'");
  expect_failure("simulate a.h5 --minutes nan", 2, "--minutes must be from 0.01 to");
  expect_failure("simulate a.h5 --width 4", 2, "--width must be from 160 to 1280, not 4");
  expect_failure("simulate a.h5 --quiet=yes", 2, "--quiet takes no value");
  expect_failure("simulate a.h5 --width 4 --minutes nan", 2, "2 faults\n  --");
}

TEST(CommandLine, MovedCommandsNameTheirProgram) {
  expect_failure("verify engine", 2, "'verify' moved to touchtrace-verify");
  expect_failure("sensitivity", 2, "'sensitivity' moved to a study");
}

TEST(CommandLine, ConfigurationFileIsChecked) {
  const auto path = touchtrace::testing::scratch_folder().string() + ".toml";
  const auto expect_refused = [&](const char* text, const std::string& message) {
    std::ofstream(path) << text;
    expect_failure("simulate out.h5 --config " + path, 2, message);
  };
  expect_refused("[simulate]\nactvity = \"wave\"\n",
                 "unknown key 'actvity' in [simulate]; did you mean 'activity'?");
  expect_refused("[simulate]\nminutes = \"three\"\n", "wrong type");
  expect_refused("[simulate\n", path + ":1");
  expect_refused("[simulat]\nminutes = 1\n", "unknown table [simulat]; did you mean 'simulate'?");
  expect_refused("[train]\nupdates = 3\n[trian]\n", "unknown table [trian]; did you mean 'train'?");
  expect_refused("minutes = 1\n[simulate]\n", "key 'minutes' is outside any table");
  expect_refused("minutes = 1\n[simulate]\nseed = \"x\"\nactvity = \"wave\"\n[trian]\n",
                 path +
                     ": 4 faults\n  key 'minutes' is outside any table\n"
                     "  unknown table [trian]; did you mean 'train'?\n"
                     "  unknown key 'actvity' in [simulate]; did you mean 'activity'?\n"
                     "  value of 'seed' in [simulate] has the wrong type\n");
  std::ofstream(path) << "[smooth]\ntrack = [\"/no/such/file.csv\"]\ngravity = [0, 0, -9.81]\n";
  expect_failure("smooth --config " + path, 3, "/no/such/file.csv");
  std::ofstream(path) << "[smooth]\ntrack = [\"a.csv\"]\ngravity = [0, \"y\", 0]\n";
  expect_failure("smooth --config " + path, 2, "wrong type");
  std::filesystem::remove(path);
}

TEST(CommandLine, MissingFilesAreDataErrors) {
  for (const char* arguments :
       {"check /no/such/file.h5", "calibrate /no/such/file.h5 --output /tmp/touchtrace_none",
        "export /no/such/file.h5 --format csv --output /tmp/touchtrace_none.csv",
        "import --glove /no/such/file.h5 --output /tmp/touchtrace_none.h5",
        "label /no/such/file.h5 --calibration /no/such --output /tmp/touchtrace_none.h5"}) {
    const auto result = run_program(arguments);
    EXPECT_EQ(result.exit_code, 3) << arguments << "\n" << result.output;
  }
}

TEST(CommandLine, DevicesAsJson) {
  const auto result = run_program("devices --json 2>/dev/null");
  ASSERT_EQ(result.exit_code, 0);
  const auto json = nlohmann::json::parse(result.output);
  EXPECT_GE(json.at("devices").size(), 1u);
}

TEST(Version, NamesCommitDriversAndLibraries) {
  const auto result = run_program("--version");
  EXPECT_EQ(result.exit_code, 0);
  for (const char* part : {"touchtrace ", "(commit ", "OpenCL   0: ", "; driver ", "Ceres    2.",
                           "OpenCV   4.", "HDF5     1.", "Eigen    3.", "libusb   1."})
    EXPECT_TRUE(contains(result.output, part)) << part << "\n" << result.output;
}

TEST(Version, WorksWithoutDevicesAndWithDriversThatCrash) {
  const auto none = run_program("--version", "OCL_ICD_VENDORS=/no/such/folder ");
  EXPECT_EQ(none.exit_code, 0);
  EXPECT_TRUE(contains(none.output, "OpenCL   no device\n")) << none.output;
  const auto crash =
      run_program("--version", "FAULTY_ICD=unlisted OCL_ICD_VENDORS=" FAULTY_ICD " ");
  EXPECT_EQ(crash.exit_code, 0);
  EXPECT_TRUE(contains(crash.output, "OpenCL   listing the devices ended by signal 6"))
      << crash.output;
}

}  // namespace
