#pragma once

#include <string>
#include <vector>

namespace touchtrace {

/// Faults of what a user gave, such as a file or a command line, reported in one error.
class FaultList {
 public:
  /// `hint`: what to do about this fault.
  void add(std::string fault, std::string hint);
  /// Throws usage_error if there are faults. `source`: prefix of the message, such as a file's
  /// name; may be empty. A single fault is reported with its hint, several as a list with
  /// `hint_for_all`.
  void throw_if_any(const std::string& source, const std::string& hint_for_all) const;

 private:
  struct Fault {
    std::string text, hint;
  };
  std::vector<Fault> faults_;
};

}  // namespace touchtrace
