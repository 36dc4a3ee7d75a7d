// The manual page and the shell completions that `touchtrace generate` prints.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "tests/support/program.h"
#include "tests/support/scratch.h"

namespace {

using touchtrace::testing::ProgramResult;
using touchtrace::testing::run_program;

/// Runs a command without single quotes in bash; the program becomes its $0.
ProgramResult run_shell(const std::string& command) {
  return run_program("", "bash -c '" + command + "' ");
}

class Generate : public ::testing::Test {
 protected:
  ~Generate() override { std::filesystem::remove(file_); }

  void write(const std::string& format) const {
    const auto result = run_program("generate " + format);
    ASSERT_EQ(result.exit_code, 0) << result.output;
    std::ofstream(file_) << result.output;
  }
  /// Completions of word `index` of a command line.
  std::string complete(const std::string& words, int index) const {
    const auto result = run_shell(". " + file_ + "; COMP_WORDS=(" + words + "); COMP_CWORD=" +
                                  std::to_string(index) + "; _touchtrace; echo ${COMPREPLY[@]}");
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return result.output;
  }

  std::string file_ = touchtrace::testing::scratch_folder().string();
};

TEST_F(Generate, ManualPageIsValid) {
  write("man");
  const auto page = run_shell("cat " + file_).output;
  for (const char* part :
       {".TH TOUCHTRACE 1", ".SS label", "\\-\\-tracker {csrt", ".SH EXIT STATUS"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  if (run_shell("command -v mandoc").exit_code == 0) {
    // The page has no date, so that builds are reproducible.
    const auto lint = run_shell("mandoc -T lint -W warning " + file_ + " | grep -v missing.date");
    EXPECT_EQ(lint.output, "");
  } else if (run_shell("command -v groff").exit_code == 0) {
    EXPECT_EQ(run_shell("groff -man -ww -z " + file_).output, "");
  }
}

TEST_F(Generate, BashCompletesCommandsOptionsAndChoices) {
  write("bash");
  EXPECT_EQ(run_shell("bash -n " + file_).output, "");
  EXPECT_EQ(complete("touchtrace tr", 1), "train\n");
  EXPECT_EQ(complete("touchtrace help lab", 2), "label\n");
  EXPECT_EQ(complete("touchtrace label --tracker \"\"", 3), "csrt component\n");
  EXPECT_EQ(complete("touchtrace label --tracker co", 3), "component\n");
  EXPECT_EQ(complete("touchtrace train --up", 2), "--updates\n");
  EXPECT_EQ(complete("touchtrace generate b", 2), "bash\n");
}

/// Options that follow "--" after a space or a quote.
std::set<std::string> options_in(const std::string& text) {
  static const std::regex option("[ '*]--([a-z-]+)");
  std::set<std::string> names;
  for (std::sregex_iterator match(text.begin(), text.end(), option), end; match != end; ++match)
    names.insert((*match)[1]);
  return names;
}

TEST_F(Generate, ZshHasTheCommandsAndOptionsOfBash) {
  const auto bash = run_program("generate bash").output, zsh = run_program("generate zsh").output;
  const auto names = options_in(zsh);
  EXPECT_GT(names.size(), 100u);
  for (const auto& name : options_in(bash))
    if (name != "version" && name != "list") {
      EXPECT_TRUE(names.contains(name)) << name;
    }
  std::istringstream commands(run_program("--list").output + "help\n");
  for (std::string line; std::getline(commands, line);) {
    const auto name = line.substr(0, line.find(' '));
    EXPECT_NE(zsh.find("\n  '" + name + ":"), std::string::npos) << name;
    EXPECT_NE(zsh.find("\n  " + name + ")\n"), std::string::npos) << name;
  }
}

TEST_F(Generate, ZshCompletionDescribesEveryOption) {
  write("zsh");
  const auto text = run_shell("cat " + file_).output;
  EXPECT_TRUE(text.starts_with("#compdef touchtrace\n"));
  for (const char* part : {"'label:label hand", "'--tracker[", ":tracker:(csrt component)'"})
    EXPECT_NE(text.find(part), std::string::npos) << part;
  if (run_shell("command -v zsh").exit_code == 0) {
    EXPECT_EQ(run_shell("zsh -n " + file_).output, "");
  }
}

}  // namespace
