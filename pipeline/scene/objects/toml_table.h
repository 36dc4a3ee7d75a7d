#pragma once

#include <toml++/toml.h>

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

namespace touchtrace::scene {

/// Reads one table of a TOML file that may hold anything. Every value has a range, in which no NaN
/// lies, and every key of the table has to be asked for. Throws data_error that names file and key.
class TomlTable {
 public:
  /// `where` begins every message: the file and the table's name.
  TomlTable(const toml::table& table, std::string where);

  bool has(const std::string& key);
  double number(const std::string& key, double low, double high);
  double number_or(const std::string& key, double low, double high, double otherwise);
  /// `count` numbers.
  std::vector<double> numbers(const std::string& key, std::size_t count, double low, double high);
  Eigen::Vector3d vector(const std::string& key, double low, double high);
  Eigen::Vector3d vector_or(const std::string& key, double low, double high,
                            const Eigen::Vector3d& otherwise);
  std::string text(const std::string& key, std::size_t longest);
  /// The place of the value in `names`.
  std::size_t choice(const std::string& key, const std::vector<std::string>& names);
  /// Reads each table of [[key]], `most` of them at the most; none if the key is not there.
  void each(const std::string& key, std::size_t most, const std::function<void(TomlTable&)>& read);
  /// Reads the table [key] if it is there.
  void table(const std::string& key, const std::function<void(TomlTable&)>& read);

  [[noreturn]] void reject(const std::string& key, const std::string& fault) const;

 private:
  const toml::node& get(const std::string& key);
  double number_of(const std::string& key, const toml::node& node, double low, double high) const;
  void finish() const;

  const toml::table& table_;
  std::string where_;
  std::vector<std::string> known_;

  friend void read_toml(const std::string&, const std::string&,
                        const std::function<void(TomlTable&)>&);
};

/// Parses `text` of the file `where` and reads its root table; refuses keys that `read` leaves.
void read_toml(const std::string& text, const std::string& where,
               const std::function<void(TomlTable&)>& read);

}  // namespace touchtrace::scene
