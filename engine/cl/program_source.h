#pragma once

#include <map>
#include <string>
#include <vector>

namespace touchtrace {

/// Values of the -D of a part of a program, by name.
using Defines = std::map<std::string, std::string>;

/// Files of kernels/, one after the other, and their -D.
struct ProgramPart {
  std::vector<std::string> files;
  Defines defines;
};

/// What a kernel of part `number` is called in the program that joined_source() makes.
std::string name_in_program(const std::string& kernel, int number);
/// The kernel's own name again.
std::string name_in_part(const std::string& in_program);

/// Parts as one source, since a driver takes far longer for a program than for what it holds.
/// OpenCL C has no namespaces: what a part defines at file scope gets the part's number behind its
/// name, and its macros end with it.
std::string joined_source(const std::vector<ProgramPart>& parts);

}  // namespace touchtrace
