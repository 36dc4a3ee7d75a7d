#include "pipeline/cli/arguments.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <limits>
#include <optional>
#include <set>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace touchtrace::cli {
namespace {

/// "-3.5" is a value, "-o" and "--output" are options, "-" is stdin or stdout.
bool is_option(const std::string& argument) {
  return argument.size() > 1 && argument[0] == '-' &&
         !std::isdigit(static_cast<unsigned char>(argument[1])) && argument[1] != '.';
}

template <class T>
constexpr bool is_vector = false;
template <class T>
constexpr bool is_vector<std::vector<T>> = true;

template <class Value>
void assign_value(const Option& option, const std::string& text, Value& target) {
  if constexpr (std::is_same_v<Value, std::string>)
    target = text;
  else if constexpr (is_vector<Value>)
    assign_value(option, text, target.emplace_back());
  else if constexpr (!std::is_same_v<Value, bool>)
    if (!parse_whole(text, target))
      throw usage_error(
          fmt::format("{} must be {}, not '{}'", option.label(),
                      std::is_floating_point_v<Value> ? "a number" : "a whole number", text),
          option.help);
}

/// Sets the value, or adds one to a list.
void assign(const Option& option, const std::string& text) {
  std::visit([&](auto* target) { assign_value(option, text, *target); }, option.target);
}

void clear_list(const Option& option) {
  std::visit(
      [](auto* target) {
        if constexpr (is_vector<std::remove_pointer_t<decltype(target)>>) target->clear();
      },
      option.target);
}

class Parser {
 public:
  Parser(const std::vector<std::string>& arguments, const std::vector<Option>& options,
         const std::string& usage)
      : arguments_(arguments), options_(options), usage_(usage) {}

  std::vector<std::string> run() {
    bool only_positional = false;
    while (next_ < arguments_.size()) {
      const std::string& argument = arguments_[next_++];
      if (!only_positional && argument == "--")
        only_positional = true;
      else if (!only_positional && is_option(argument))
        take_option(argument);
      else
        take_positional(argument);
    }
    return {given_.begin(), given_.end()};
  }

 private:
  void take_option(const std::string& argument) {
    const auto equals = argument.find('=');
    const std::string flag = argument.substr(0, equals);
    std::optional<std::string> value;
    if (equals != std::string::npos) value = argument.substr(equals + 1);
    const Option& option = find(flag);
    begin(option);
    if (option.is_flag()) {
      if (value) throw usage_error(fmt::format("{} takes no value", flag), usage_);
      *std::get<bool*>(option.target) = true;
    } else if (value) {
      assign(option, *value);
    } else {
      take_values(option);
    }
  }

  void take_values(const Option& option) {
    const auto has_value = [&] {
      return next_ < arguments_.size() && !is_option(arguments_[next_]);
    };
    if (!has_value())
      throw usage_error(fmt::format("{} needs a value: {}", option.label(), option.placeholder),
                        option.help);
    std::size_t count = 0;
    do assign(option, arguments_[next_++]);
    while (option.is_list() && ++count != option.count && has_value());
  }

  void take_positional(const std::string& argument) {
    for (const Option& option : options_)
      if (option.positional && (option.is_list() || !given_.contains(option.name))) {
        begin(option);
        assign(option, argument);
        return;
      }
    throw usage_error(fmt::format("unexpected argument '{}'", argument), usage_);
  }

  const Option& find(const std::string& flag) const {
    const std::string label = flag == "-o" ? "--output" : flag;
    std::vector<std::string> labels;
    for (const Option& option : options_) {
      if (option.positional) continue;
      if (option.label() == label) return option;
      labels.push_back(option.label());
    }
    // A prefix counts without its dashes: "-act" and "--act" both mean "--activity".
    const std::string long_flag = flag.starts_with("--") ? flag : "-" + flag;
    throw usage_error(fmt::format("unknown option '{}'{}", flag, did_you_mean(long_flag, labels)),
                      usage_);
  }

  /// Notes that an option is given, and clears the default of a list.
  void begin(const Option& option) {
    const bool is_first = given_.insert(option.name).second;
    if (option.is_list()) {
      if (is_first) clear_list(option);
    } else if (!is_first && !option.is_flag()) {
      throw usage_error(fmt::format("{} is given twice", option.label()), usage_);
    }
  }

  const std::vector<std::string>& arguments_;
  const std::vector<Option>& options_;
  const std::string& usage_;
  std::set<std::string> given_;
  std::size_t next_ = 0;
};

}  // namespace

std::vector<std::string> parse_arguments(const std::vector<std::string>& arguments,
                                         const std::vector<Option>& options,
                                         const std::string& usage) {
  return Parser(arguments, options, usage).run();
}

}  // namespace touchtrace::cli
