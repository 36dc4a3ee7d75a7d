#pragma once

#include <toml++/toml.h>

#include <functional>
#include <string>
#include <vector>

namespace touchtrace {

/// Validating reader of one table of an untrusted TOML file. Numbers are checked against a range,
/// which NaN never satisfies; keys that were not asked for are rejected. Throws data_error with
/// file and key.
class TomlTable {
 public:
  /// `where` prefixes every message: the file and the table's name. `hint`: where the format is
  /// described.
  TomlTable(const toml::table& table, std::string where, std::string hint);

  bool has(const std::string& key);
  double number(const std::string& key, double min, double max);
  std::vector<double> numbers(const std::string& key, std::size_t count, double min, double max);
  /// Whole number.
  int integer(const std::string& key, int min, int max);
  std::string text(const std::string& key, std::size_t max_bytes);
  /// Returns the index of the value in `names`.
  std::size_t choice(const std::string& key, const std::vector<std::string>& names);
  /// Reads the tables [[key]], `max_tables` at most; none if the key is missing.
  void each(const std::string& key, std::size_t max_tables,
            const std::function<void(TomlTable&)>& read);
  /// Reads the table [key] if it exists.
  void table(const std::string& key, const std::function<void(TomlTable&)>& read);

  [[noreturn]] void reject(const std::string& key, const std::string& fault) const;

 private:
  const toml::node& get(const std::string& key);
  double to_number(const std::string& key, const toml::node& node, double min, double max) const;
  void reject_unknown_keys() const;

  const toml::table& table_;
  std::string where_, hint_;
  std::vector<std::string> known_;

  friend void read_toml(const std::string&, const std::string&, const std::string&,
                        const std::function<void(TomlTable&)>&);
};

/// Parses `text` of the file `where` and reads its root table; rejects keys that `read` did not ask
/// for.
void read_toml(const std::string& text, const std::string& where, const std::string& hint,
               const std::function<void(TomlTable&)>& read);

}  // namespace touchtrace
