#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace touchtrace {

/// Rows of a text file whose columns are separated by commas, semicolons, tabs, bars or blanks:
/// whichever of these, in the order `;` tab `|` `,` blank, the first row contains. Blank lines and
/// comments (`#...`) are skipped, and so are lines before a table of 10 columns or more that have
/// at most half as many. Rows may end with a separator. Fields may be in double quotes.
///
/// The first row is a header if none of its fields is a number, if it has text where the second row
/// has a number, or if it counts ten columns or more from 0 or 1.
/// A row of text below it has units: those of times and lengths become part of the names, others
/// are skipped. Headings of several lines, as motion capture has them: see names_of_heading().
class TextTable {
 public:
  static constexpr std::uintmax_t max_bytes = 1u << 28;
  static constexpr std::size_t max_line_bytes = 1u << 20;

  /// Reads the file. Throws data_error if it is unreadable, too large, not text or without a row.
  explicit TextTable(std::filesystem::path file);
  TextTable(const TextTable&) = delete;
  TextTable& operator=(const TextTable&) = delete;

  const std::filesystem::path& file() const { return file_; }
  /// Names of the header, as column_name(). Empty without a header.
  const std::vector<std::string>& names() const { return names_; }
  /// Words of the last comment before the first row, in the same form.
  const std::vector<std::string>& comment_names() const { return comment_names_; }
  /// Number of columns of the first row.
  std::size_t num_columns() const { return num_columns_; }
  bool has_decimal_comma() const { return separator_ != ','; }

  /// Advances to the next row. Returns false at the end. Throws data_error for a line that is too
  /// long.
  bool next_row();
  /// Whether the row is the end of a file that does not end with a line feed.
  bool is_cut_off() const { return next_ > text_.size(); }
  /// Returns to the state before the first row.
  void rewind();
  /// Line number of the row, from 1.
  std::size_t line() const { return line_; }
  /// Fields of the row without blanks and quotes around them; valid until the next call of
  /// next_row().
  const std::vector<std::string_view>& fields() const { return fields_; }

 private:
  /// Advances to the next line that is not blank.
  bool next_line();
  bool is_comment() const;
  /// Advances to the next row, whose fields are those of the line.
  bool next_fields();
  /// Reads a heading of several lines; returns false, and stays at the start, if there is none.
  bool read_heading();
  /// Reads the first row or header.
  void read_header();
  /// Advances to the first row or header; returns the number of lines before it.
  std::size_t skip_introduction();
  /// Reads a row of text below the header, if there is one.
  void read_units();
  /// Whether the first row, which is the current one, is a header.
  bool is_header();
  bool has_number(std::span<const std::string_view> fields) const;

  std::filesystem::path file_;
  std::string text_;
  std::string_view content_;  ///< of the current line
  std::size_t next_ = 0, line_ = 0, num_columns_ = 0;
  std::size_t first_next_ = 0, first_line_ = 0;  ///< before the first row
  char separator_ = ' ';
  std::vector<std::string_view> fields_;
  std::vector<std::string> names_, comment_names_;
};

/// A name in lower case; each run of other characters than letters and digits is one underscore, a
/// micro sign is u: "Time [ms]" is "time_ms".
std::string column_name(std::string_view text);

/// Number of a field: NaN for a missing value (empty, `nan`, `na`, `null`, `none`), nullopt for
/// other text. `Number`: double or long double.
template <class Number>
std::optional<Number> parse_number(std::string_view field, bool has_decimal_comma);

/// A field of an untrusted file for messages: in quotes, printable and at most 40 characters long.
std::string quoted_field(std::string_view field);

}  // namespace touchtrace
