#include "engine/cl/program_source.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "engine/cl/kernel_sources.h"

namespace touchtrace {
namespace {

constexpr std::string_view separator = "__";
constexpr std::string_view name_characters =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_";

/// Last identifier in `text`; empty if there is none.
std::string last_name(std::string_view text) {
  const auto end = text.find_last_of(name_characters);
  if (end == std::string_view::npos) return {};
  const auto before = text.find_last_not_of(name_characters, end);
  return std::string(text.substr(before + 1, end - before));
}

/// First identifier in `text`; empty if there is none.
std::string first_name(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_of(name_characters), text.size()));
  return std::string(text.substr(0, text.find_first_not_of(name_characters)));
}

std::string_view without_attributes(std::string_view line) {
  constexpr std::string_view open = "__attribute__((", close = "))";
  const auto begin = line.find(open);
  return begin == std::string_view::npos ? line
                                         : line.substr(line.find(close, begin) + close.size());
}

std::string_view without_comment(std::string_view line) {
  line = line.substr(0, line.find("//"));
  return line.substr(0, line.find_last_not_of(' ') + 1);
}

/// Function, constant or type that is defined in a line at file scope, also by "} name;"; else
/// empty.
std::string name_defined_in(std::string_view line) {
  line = without_comment(line);
  for (const std::string_view start : {"static ", "__kernel ", "__constant "})
    if (line.starts_with(start)) {
      const auto declaration = without_attributes(line);
      return last_name(declaration.substr(0, declaration.find_first_of("([=;")));
    }
  if (line.starts_with("typedef ") || line.starts_with("} "))
    return line.ends_with(';') ? last_name(line.substr(0, line.find("__attribute__")))
                               : std::string();
  return {};
}

template <class Visit>
void for_each_line(std::string_view text, Visit visit) {
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size() - 1);
    visit(text.substr(0, text.find('\n')));
    text.remove_prefix(end + 1);
  }
}

/// Source of one module, with its names made unique and its macros local.
std::string module_source(const ProgramModule& module, int number) {
  std::string text;
  std::set<std::string> names, macros;
  for (const auto& [name, value] : module.defines) {
    text += fmt::format("#define {} {}\n", name, value);
    macros.insert(name);
  }
  for (const auto& file : module.files)
    for_each_line(kernel_sources().at(file), [&](std::string_view line) {
      constexpr std::string_view define = "#define ";
      if (line.starts_with(define)) macros.insert(first_name(line.substr(define.size())));
      if (auto name = name_defined_in(line); !name.empty()) names.insert(std::move(name));
    });
  for (const auto& name : names)
    text += fmt::format("#define {} {}\n", name, mangled_kernel_name(name, number));
  for (const auto& file : module.files)
    text += fmt::format("#line 1 \"{}\"\n{}\n", file, kernel_sources().at(file));
  macros.merge(names);
  for (const auto& name : macros) text += fmt::format("#undef {}\n", name);
  return text + "#pragma OPENCL FP_CONTRACT ON\n";
}

}  // namespace

std::string mangled_kernel_name(const std::string& kernel, int number) {
  return fmt::format("{}{}{}", kernel, separator, number);
}

std::string unmangled_kernel_name(const std::string& mangled) {
  return mangled.substr(0, mangled.rfind(separator));
}

std::string combined_source(const std::vector<ProgramModule>& modules) {
  std::string source;
  for (int number = 0; const auto& module : modules) source += module_source(module, number++);
  return source;
}

}  // namespace touchtrace
