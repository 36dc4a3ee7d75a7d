// Rules that every file of kernels/ follows; see kernels/README.md.
#include "engine/cl/kernel_sources.h"

#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <string>

namespace touchtrace {
namespace {

std::string without_comments(std::string_view text) {
  return std::regex_replace(std::string(text), std::regex("//[^\n]*"), "");
}

/// Leading comment of a file.
std::string header_comment(std::string_view text) {
  std::smatch match;
  const std::string source(text);
  std::regex_search(source, match, std::regex("^(?://[^\n]*\n)*"));
  return match.str();
}

std::set<std::string> find_all(const std::string& text, const char* pattern) {
  const std::regex regex(pattern);
  std::set<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), regex), end; match != end; ++match)
    found.insert((*match)[1]);
  return found;
}

/// Macros of all files whose expansion declares local memory.
std::set<std::string> macros_with_local_memory() {
  std::set<std::string> macros;
  for (const auto& [file, text] : kernel_sources())
    macros.merge(find_all(without_comments(text),
                          R"(#define (\w+)\([^)]*\)(?=(?:[^\n]*\\\n)*[^\n]*__local real4 \w+\[))"));
  return macros;
}

/// Kernels by definition: attributes, name, arguments and body.
struct KernelDefinition {
  std::string signature, body;
};

std::vector<KernelDefinition> kernel_definitions(const std::string& source) {
  std::vector<KernelDefinition> kernels;
  for (auto begin = source.find("__kernel"); begin != std::string::npos;) {
    const auto open = source.find('{', begin), end = source.find("\n}\n", open);
    kernels.push_back({source.substr(begin, open - begin), source.substr(open, end - open)});
    begin = source.find("__kernel", end);
  }
  return kernels;
}

TEST(KernelSources, LocalMemoryRequiresAFixedWorkGroupSize) {
  const auto macros = macros_with_local_memory();
  ASSERT_TRUE(macros.contains("INNER_PRODUCT"));
  int num_checked = 0;
  for (const auto& [file, text] : kernel_sources())
    for (const auto& kernel : kernel_definitions(without_comments(text))) {
      bool uses_local = kernel.body.find("__local") != std::string::npos;
      for (const auto& macro : macros)
        uses_local |= kernel.body.find(macro + "(") != std::string::npos;
      if (!uses_local) continue;
      ++num_checked;
      EXPECT_TRUE(std::regex_search(
          kernel.signature, std::regex("reqd_work_group_size|WORK_GROUP_ATTRIBUTE|ONE_WORK_ITEM")))
          << file << ": " << kernel.signature;
    }
  EXPECT_GE(num_checked, 9) << "convolution 3, dense 2, roll-out 2, Winograd 2";
}

TEST(KernelSources, NeedNoExtensionOfOpenCl12) {
  for (const auto& [file, text] : kernel_sources())
    EXPECT_EQ(text.find("overloadable"), std::string_view::npos) << file;
}

TEST(KernelSources, HeaderCommentNamesEveryMacroWithADefault) {
  for (const auto& [file, text] : kernel_sources()) {
    const auto header = header_comment(text);
    EXPECT_FALSE(header.empty()) << file;
    for (const auto& name : find_all(std::string(text), R"(#ifndef (\w+))"))
      EXPECT_TRUE(name == "ANY" || header.find(name) != std::string::npos) << file << ": " << name;
  }
}

}  // namespace
}  // namespace touchtrace
