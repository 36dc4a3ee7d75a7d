#include "pipeline/acquire/text_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/progress.h"
#include "engine/base/text.h"
#include "pipeline/acquire/table_heading.h"
#include "pipeline/acquire/table_units.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_quoted_bytes = 40;
constexpr std::string_view blanks = " \t\r\v\f";
constexpr std::size_t min_wide_columns = 6;    // of tables that may follow other lines
constexpr std::size_t max_heading_lines = 12;  // .trc has 5, Motive 7

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string_view without_quotes(std::string_view field) {
  field = trimmed(field);
  if (field.size() < 2 || field.front() != '"' || field.back() != '"') return field;
  return trimmed(field.substr(1, field.size() - 2));
}

char separator_of(std::string_view line) {
  for (char separator : {';', '\t', '|', ','})
    if (line.find(separator) != std::string_view::npos) return separator;
  return ' ';
}

std::vector<std::string_view> split_at_blanks(std::string_view line) {
  std::vector<std::string_view> fields;
  for (line = trimmed(line); !line.empty();) {
    const auto end = std::min(line.find_first_of(blanks), line.size());
    fields.push_back(without_quotes(line.substr(0, end)));
    line = trimmed(line.substr(end));
  }
  return fields;
}

/// Separators inside double quotes do not count.
std::vector<std::string_view> split(std::string_view line, char separator) {
  if (separator == ' ') return split_at_blanks(line);
  std::vector<std::string_view> fields;
  std::size_t start = 0;
  bool is_quoted = false;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') is_quoted = !is_quoted;
    if (i < line.size() && (line[i] != separator || is_quoted)) continue;
    fields.push_back(without_quotes(line.substr(start, i - start)));
    start = i + 1;
  }
  return fields;
}

/// Number of columns of the last line that is neither blank nor a comment; 0 for narrow tables.
std::size_t wide_columns(std::string_view text) {
  for (std::size_t end = text.size(); end > 0;) {
    const std::size_t start = text.find_last_of('\n', end - 1) + 1;
    const auto line = trimmed(text.substr(start, end - start));
    end = start > 0 ? start - 1 : 0;
    if (line.empty() || line.starts_with('#')) continue;
    if (line.size() > TextTable::max_line_bytes) break;
    const std::size_t columns = split(line, separator_of(line)).size();
    return columns < min_wide_columns ? 0 : columns;
  }
  return 0;
}

std::vector<std::string> column_names(const std::vector<std::string_view>& fields) {
  std::vector<std::string> names;
  for (const auto field : fields) names.push_back(column_name(field));
  return names;
}

bool is_number(std::string_view field) {
  return parse_number<double>(field, false) || parse_number<double>(field, true);
}

constexpr std::size_t min_counted_columns = 10;

/// Numbers of columns: 0, 1, 2, ... or 1, 2, 3, ..., perhaps behind that of an index without a
/// name.
bool counts_columns(std::span<const std::string_view> fields) {
  if (!fields.empty() && fields.front().empty()) fields = fields.subspan(1);
  if (fields.size() < min_counted_columns) return false;
  const std::size_t first = fields.front() == "1" ? 1 : 0;
  for (std::size_t i = 0; i < fields.size(); ++i)
    if (fields[i] != std::to_string(first + i)) return false;
  return true;
}

bool is_missing(std::string_view field) {
  constexpr std::array<std::string_view, 7> words{"", "nan", "-nan", "+nan", "na", "null", "none"};
  return field.size() <= 4 && std::ranges::find(words, lower_case(field)) != words.end();
}

}  // namespace

std::string column_name(std::string_view field) {
  constexpr std::string_view micro_sign = "\xC2\xB5", greek_mu = "\xCE\xBC";
  const std::string text = lower_case(field);
  std::string name;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto two = std::string_view(text).substr(i, 2);
    if (two == micro_sign || two == greek_mu)
      name += 'u', ++i;
    else if (std::isalnum(static_cast<unsigned char>(text[i])))
      name += text[i];
    else if (!name.empty() && name.back() != '_')
      name += '_';
  }
  if (name.ends_with('_')) name.pop_back();
  return name;
}

TextTable::TextTable(std::filesystem::path file)
    : file_(std::move(file)), text_(read_file(file_, max_bytes)) {
  if (text_.find('\0') != std::string::npos)
    throw data_error(fmt::format("{} is not a text file in UTF-8 or ASCII", file_.string()),
                     "save or export it as CSV");
  if (text_.starts_with("\xEF\xBB\xBF")) next_ = 3;  // byte order mark
  if (!read_heading()) read_header();
  rewind();
}

bool TextTable::read_heading() {
  const std::size_t start = next_;
  std::vector<TableLine> lines;
  while (lines.size() < max_heading_lines && next_line()) {
    if (is_comment()) continue;
    separator_ = separator_of(content_);
    lines.push_back(split(content_, separator_));
    if (!names_axes_only(lines.back())) continue;
    names_ = names_of_heading(lines);
    num_columns_ = names_.size();
    read_units();
    if (next_fields()) num_columns_ = std::max(num_columns_, fields_.size());
    names_.resize(num_columns_);
    return true;
  }
  next_ = start, line_ = 0;
  return false;
}

void TextTable::read_header() {
  if (const std::size_t skipped = skip_introduction(); skipped > 0)
    Progress::report(fmt::format("{}: skipped {} lines before the table", file_.string(), skipped));
  if (trimmed(content_).empty())
    throw data_error(fmt::format("{} has no rows", file_.string()),
                     "give a table of numbers, a row for each time");
  separator_ = separator_of(content_);
  first_line_ = line_ - 1, first_next_ = static_cast<std::size_t>(content_.data() - text_.data());
  fields_ = split(content_, separator_);
  num_columns_ = fields_.size();
  const bool has_header = is_header();
  rewind();
  next_fields();
  if (num_columns_ > 1 && fields_.back().empty()) fields_.pop_back();
  num_columns_ = fields_.size();
  if (!has_header) return;
  names_ = column_names(fields_);
  read_units();
}

void TextTable::read_units() {
  first_line_ = line_, first_next_ = next_;
  if (!next_fields() || has_number(fields_)) return;
  first_line_ = line_, first_next_ = next_;
  bool has_units = false;
  for (std::size_t i = 0; i < std::min(names_.size(), fields_.size()); ++i)
    if (const std::string unit = "_" + column_name(fields_[i]); is_unit(unit)) {
      if (!names_[i].ends_with(unit)) names_[i] += unit;
      has_units = true;
    }
  Progress::report(fmt::format("{}: {} line {}, which has no number", file_.string(),
                               has_units ? "took units from" : "skipped", line_));
}

std::size_t TextTable::skip_introduction() {
  const std::size_t columns = wide_columns(text_);
  std::size_t skipped = 0;
  while (next_line()) {
    if (is_comment()) {
      const auto comment = trimmed(content_).substr(1);
      comment_names_ = column_names(split(comment, separator_of(comment)));
      continue;
    }
    const auto fields = split(content_, separator_of(content_));
    const auto numbers = static_cast<std::size_t>(std::ranges::count_if(fields, is_number));
    const bool is_cut_row = fields.size() < columns && 2 * numbers >= fields.size();
    if (2 * fields.size() > columns && !is_cut_row) break;
    ++skipped;
  }
  return skipped;
}

bool TextTable::is_header() {
  const auto first = fields_;
  if (!has_number(first) || counts_columns(first)) return true;
  if (!next_fields()) return false;
  for (std::size_t i = 0; i < std::min(first.size(), fields_.size()); ++i)
    if (!parse_number<double>(first[i], has_decimal_comma()) && has_number({&fields_[i], 1}))
      return true;
  return false;
}

bool TextTable::has_number(std::span<const std::string_view> fields) const {
  return std::ranges::any_of(fields, [&](std::string_view field) {
    const auto number = parse_number<double>(field, has_decimal_comma());
    return number && !std::isnan(*number);
  });
}

bool TextTable::is_comment() const { return trimmed(content_).starts_with('#'); }

bool TextTable::next_line() {
  content_ = {};
  while (trimmed(content_).empty() && next_ < text_.size()) {
    const auto end = std::min(text_.find('\n', next_), text_.size());
    ++line_;
    if (end - next_ > max_line_bytes)
      throw data_error(fmt::format("{}, line {}: {} bytes, more than the limit of {}",
                                   file_.string(), line_, end - next_, max_line_bytes),
                       "check that this is the intended file; lines end with a line feed");
    content_ = std::string_view(text_).substr(next_, end - next_);
    next_ = end + 1;
  }
  return !trimmed(content_).empty();
}

bool TextTable::next_row() { return next_fields(); }

bool TextTable::next_fields() {
  do
    if (!next_line()) return false;
  while (is_comment());
  fields_ = split(content_, separator_);
  if (fields_.size() == num_columns_ + 1 && fields_.back().empty()) fields_.pop_back();
  return true;
}

void TextTable::rewind() { next_ = first_next_, line_ = first_line_; }

template <class Number>
std::optional<Number> parse_number(std::string_view field, bool has_decimal_comma) {
  if (is_missing(field)) return std::numeric_limits<Number>::quiet_NaN();
  std::string text(field.substr(field.starts_with('+') ? 1 : 0));
  if (has_decimal_comma) std::ranges::replace(text, ',', '.');
  Number number;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error == std::errc::result_out_of_range && stop == end)
    return std::numeric_limits<Number>::infinity();
  return error == std::errc() && stop == end ? std::optional(number) : std::nullopt;
}

template std::optional<double> parse_number(std::string_view field, bool has_decimal_comma);
template std::optional<long double> parse_number(std::string_view field, bool has_decimal_comma);

std::string quoted_field(std::string_view field) {
  std::string text(field.substr(0, max_quoted_bytes));
  for (char& c : text)
    if (!std::isprint(static_cast<unsigned char>(c))) c = '?';
  return fmt::format("'{}'{}", text, field.size() > max_quoted_bytes ? "..." : "");
}

}  // namespace touchtrace
