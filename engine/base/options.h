#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

namespace touchtrace {

/// Description of one member of an options struct.
struct Option {
  using Target = std::variant<bool*, int*, std::uint64_t*, double*, std::string*,
                              std::vector<std::string>*, std::vector<double>*>;

  std::string name;         ///< "learning-rate": the flag --learning-rate, the key learning_rate
  Target target;            ///< the member
  std::string help;         ///< one line, with unit
  double minimum, maximum;  ///< of numbers, inclusive
  std::vector<std::string> choices;  ///< allowed strings; empty: any
  bool required = false;
  bool positional = false;  ///< given without its flag, in the order of the descriptions
};

/// Description of an options struct, from which the flags, the keys of the configuration file,
/// --help, the validation and the options in the provenance are derived.
///
///     struct LabelOptions { std::string tracker = "csrt"; };
///     void describe(OptionSet& set, LabelOptions& o) {
///       set.choice("tracker", o.tracker, "tracker of hand and object", {"csrt", "kcf"});
///     }
class OptionSet {
 public:
  void flag(std::string name, bool& target, std::string help);
  void integer(std::string name, int& target, std::string help, int minimum, int maximum);
  void seed(std::string name, std::uint64_t& target, std::string help);
  void number(std::string name, double& target, std::string help, double minimum, double maximum);
  void numbers(std::string name, std::vector<double>& target, std::string help);
  void text(std::string name, std::string& target, std::string help);
  void texts(std::string name, std::vector<std::string>& target, std::string help);
  void choice(std::string name, std::string& target, std::string help,
              std::vector<std::string> choices);
  void path(std::string name, std::string& target, std::string help);
  void paths(std::string name, std::vector<std::string>& target, std::string help);
  void input(std::string name, std::string& target, std::string help);
  void optional_input(std::string name, std::string& target, std::string help);
  void inputs(std::string name, std::vector<std::string>& target, std::string help);

  const std::vector<Option>& options() const { return options_; }
  std::vector<std::string> names() const;

  /// Current values by key: the name with dashes replaced by underscores.
  nlohmann::json values() const;
  /// Throws usage_error if a value is out of range, not finite, not one of the choices, or required
  /// and empty.
  void validate() const;

 private:
  std::vector<Option> options_;
};

}  // namespace touchtrace
