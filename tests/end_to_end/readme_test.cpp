// The documents: examples work as printed, commands and options exist, links lead somewhere.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/scratch.h"

namespace {

namespace fs = std::filesystem;

const fs::path source_dir = TOUCHTRACE_SOURCE_DIR;

std::vector<std::string> lines_of(const fs::path& file) {
  std::vector<std::string> lines;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// All documents of the repository.
std::vector<fs::path> documents() {
  std::vector<fs::path> files{source_dir / "README.md", source_dir / "CONTRIBUTING.md",
                              source_dir / "CHANGELOG.md"};
  for (const char* top : {"engine", "kernels", "calib", "pipeline", "tests"})
    for (const auto& entry : fs::recursive_directory_iterator(source_dir / top))
      if (entry.path().extension() == ".md") files.push_back(entry.path());
  return files;
}

/// The commands of `touchtrace` in a document's code blocks, without their indentation.
std::vector<std::string> examples(const fs::path& file, const std::string& section = "") {
  std::vector<std::string> commands;
  bool inside = section.empty();
  for (const auto& line : lines_of(file)) {
    if (line.starts_with("## ") && !section.empty()) inside = line == "## " + section;
    if (inside && line.starts_with("    touchtrace ")) commands.push_back(line.substr(4));
  }
  return commands;
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

TEST(Documents, QuickstartWorksAsPrinted) {
  const auto folder = touchtrace::testing::scratch_folder();
  fs::remove_all(folder);
  fs::create_directories(folder);
  const auto commands = examples(source_dir / "README.md", "Five minutes to the first report");
  ASSERT_GE(commands.size(), 6u);
  const auto bin = fs::path(TOUCHTRACE_PROGRAM).parent_path().string();
  for (const auto& command : commands) {
    const auto shell =
        "cd " + folder.string() + " && PATH=" + bin + ":$PATH && " + command + " >log.txt 2>&1";
    ASSERT_EQ(std::system(shell.c_str()), 0) << command << "\n"
                                             << std::ifstream(folder / "log.txt").rdbuf();
  }
  EXPECT_GT(fs::file_size(folder / "report.html"), 10000u);
  fs::remove_all(folder);
}

TEST(Documents, ExamplesUseCommandsAndOptionsThatExist) {
  std::map<std::string, touchtrace::testing::ProgramResult> help_of;  // the program starts slowly
  int options = 0;
  for (const auto& file : documents())
    for (const auto& example : examples(file)) {
      const auto words = words_of(example.substr(0, example.find(" #")));
      const auto [entry, is_new] = help_of.try_emplace(words.at(1));
      auto& help = entry->second;
      if (is_new) help = touchtrace::testing::run_program("help " + words[1]);
      const bool flag_only = words[1].starts_with("--") || words[1] == "help";
      EXPECT_TRUE(flag_only || help.exit_code == 0) << file << ": " << example;
      for (const auto& word : words)
        if (word.starts_with("--") && !flag_only) {
          ++options;
          EXPECT_NE(help.output.find(word.substr(0, word.find('='))), std::string::npos)
              << file << ": " << example << ": no option " << word;
        }
    }
  EXPECT_GT(options, 10) << "the examples were not found";
}

TEST(Documents, LinksLeadToFiles) {
  static const std::regex link(R"(\]\(([^)#:]+)(#[^)]*)?\))");
  int links = 0;
  for (const auto& file : documents())
    for (const auto& line : lines_of(file))
      for (std::sregex_iterator match(line.begin(), line.end(), link), end; match != end; ++match) {
        ++links;
        EXPECT_TRUE(fs::exists(file.parent_path() / (*match)[1].str())) << file << ": " << line;
      }
  EXPECT_GT(links, 5) << "the links were not found";
}

}  // namespace
