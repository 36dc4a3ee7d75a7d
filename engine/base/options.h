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
                              std::vector<double>*, std::vector<std::string>*>;

  std::string name;  ///< "learning-rate": flag --learning-rate, TOML key learning_rate
  Target target;
  std::string help;                  ///< with the unit
  double minimum, maximum;           ///< inclusive range of a number
  std::vector<std::string> choices;  ///< allowed texts; empty: any
  bool required = false;             ///< must not be empty
  bool positional = false;           ///< given without its name, in the order of description
  std::string placeholder = {};      ///< value in the help: FILE, N, X; flags have none
  std::string group = {};            ///< heading in the help
  std::string default_text = {};     ///< target's value when described; empty: none
  std::size_t count = 0;             ///< number of values of a list; 0: any

  bool is_flag() const { return std::holds_alternative<bool*>(target); }
  bool is_list() const {
    return std::holds_alternative<std::vector<double>*>(target) ||
           std::holds_alternative<std::vector<std::string>*>(target);
  }
  /// Number 0 counts as a value; an empty text or list does not.
  bool is_empty() const;
  /// "--learning-rate", or "RECORDING" if positional.
  std::string label() const;
  /// TOML and JSON key, e.g. "learning_rate".
  std::string key() const;
  /// Sets the placeholder.
  Option& value(std::string text);
};

/// Description of an options struct. Flags, TOML keys, --help, the manual page, shell completions,
/// validation and the options in a provenance follow from it.
///
///     struct LabelOptions { std::string tracker = "csrt"; };
///     void describe(OptionSet& set, LabelOptions& o) {
///       set.group("Tracking");
///       set.choice("tracker", o.tracker, "component: faster", {"csrt", "component"});
///     }
///
/// Returned references are valid until the next call.
class OptionSet {
 public:
  /// Starts a group: its heading precedes the options described next.
  void group(std::string heading) { group_ = std::move(heading); }

  Option& flag(std::string name, bool& target, std::string help);
  Option& integer(std::string name, int& target, std::string help, int minimum, int maximum);
  Option& seed(std::string name, std::uint64_t& target, std::string help);
  Option& number(std::string name, double& target, std::string help, double minimum,
                 double maximum);
  /// List of `count` numbers, or empty.
  Option& numbers(std::string name, std::vector<double>& target, std::string help,
                  std::size_t count, double minimum, double maximum);
  Option& text(std::string name, std::string& target, std::string help);
  Option& texts(std::string name, std::vector<std::string>& target, std::string help);
  Option& choice(std::string name, std::string& target, std::string help,
                 std::vector<std::string> choices);
  // Required:
  Option& path(std::string name, std::string& target, std::string help);
  Option& paths(std::string name, std::vector<std::string>& target, std::string help);
  // Positional:
  Option& input(std::string name, std::string& target, std::string help);
  Option& inputs(std::string name, std::vector<std::string>& target, std::string help);
  Option& optional_input(std::string name, std::string& target, std::string help);

  const std::vector<Option>& options() const { return options_; }
  std::vector<std::string> names() const;

  /// Current value of every listed option, by key.
  nlohmann::json values() const;
  /// Throws usage_error with all faults: values that are out of range, not a choice, NaN, or
  /// required and empty, and lists with the wrong number of values.
  void validate() const;

 private:
  Option& add(Option option);

  std::vector<Option> options_;
  std::string group_;
};

}  // namespace touchtrace
