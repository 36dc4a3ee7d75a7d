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

/// The last name of `text`.
std::string last_name(std::string_view text) {
  const auto end = text.find_last_of(name_characters);
  if (end == std::string_view::npos) return {};
  const auto before = text.find_last_not_of(name_characters, end);
  return std::string(text.substr(before + 1, end - before));
}

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

/// The function, constant or type that starts (or ends: "} name;") in a line at file scope.
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

/// A part with everything that keeps it apart from the others.
std::string part_source(const ProgramPart& part, int number) {
  std::string text;
  std::set<std::string> own, macros;
  for (const auto& [name, value] : part.defines) {
    text += fmt::format("#define {} {}\n", name, value);
    macros.insert(name);
  }
  for (const auto& file : part.files)
    for_each_line(kernel_sources().at(file), [&](std::string_view line) {
      constexpr std::string_view define = "#define ";
      if (line.starts_with(define)) macros.insert(first_name(line.substr(define.size())));
      if (auto name = name_defined_in(line); !name.empty()) own.insert(std::move(name));
    });
  for (const auto& name : own)
    text += fmt::format("#define {} {}\n", name, name_in_program(name, number));
  for (const auto& file : part.files)
    text += fmt::format("#line 1 \"{}\"\n{}\n", file, kernel_sources().at(file));
  macros.merge(own);
  for (const auto& name : macros) text += fmt::format("#undef {}\n", name);
  return text + "#pragma OPENCL FP_CONTRACT ON\n";
}

}  // namespace

std::string name_in_program(const std::string& kernel, int number) {
  return fmt::format("{}{}{}", kernel, separator, number);
}

std::string name_in_part(const std::string& in_program) {
  return in_program.substr(0, in_program.rfind(separator));
}

std::string joined_source(const std::vector<ProgramPart>& parts) {
  std::string source;
  for (int number = 0; const auto& part : parts) source += part_source(part, number++);
  return source;
}

}  // namespace touchtrace
