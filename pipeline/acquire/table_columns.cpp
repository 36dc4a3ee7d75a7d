#include "pipeline/acquire/table_columns.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/iso_time.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_listed_faults = 5;

/// Faults of the lines of one file.
class LineFaults {
 public:
  void add(std::size_t line, const std::string& fault) {
    if (++count_ <= max_listed_faults) first_.push_back(fmt::format("line {}: {}", line, fault));
  }
  void throw_if_any(const std::filesystem::path& file, const std::string& hint) const {
    if (count_ == 0) return;
    if (count_ == 1) throw data_error(fmt::format("{}, {}", file.string(), first_[0]), hint);
    auto list = fmt::format("\n  {}", fmt::join(first_, "\n  "));
    if (count_ > first_.size()) list += fmt::format("\n  and {} more", count_ - first_.size());
    throw data_error(fmt::format("{}: {} faulty lines{}", file.string(), count_, list), hint);
  }

 private:
  std::vector<std::string> first_;
  std::size_t count_ = 0;
};

bool has_name(const std::string& column, const std::vector<std::string>& names,
              const std::string& suffix) {
  return std::ranges::any_of(names,
                             [&](const std::string& name) { return column == name + suffix; });
}

}  // namespace

std::optional<TableColumn> find_column(const TextTable& table,
                                       const std::vector<std::string>& columns,
                                       const std::vector<std::string>& names,
                                       std::span<const TableUnit> units) {
  std::optional<TableColumn> found;
  for (std::size_t i = 0; i < columns.size(); ++i)
    for (const auto& [suffix, per_unit] : units) {
      if (!has_name(columns[i], names, suffix)) continue;
      if (found)
        throw data_error(fmt::format("{}: both columns '{}' and '{}' could be meant",
                                     table.file().string(), found->label, columns[i]),
                         "rename one of them");
      found = TableColumn{i, per_unit, columns[i], !suffix.empty()};
    }
  return found;
}

template <class Number>
Number value_of(const TextTable& table, const TableColumn& column) {
  const auto field = table.fields()[column.index];
  const auto value = parse_number<Number>(field, table.has_decimal_comma());
  if (!value)
    throw LineFault{fmt::format("{} {} is not a number", column.label, quoted_field(field))};
  if (std::isinf(*value))
    throw LineFault{fmt::format("{} {} is not a finite number", column.label, quoted_field(field))};
  return *value / static_cast<Number>(column.per_unit);
}

template double value_of(const TextTable& table, const TableColumn& column);
template long double value_of(const TextTable& table, const TableColumn& column);

std::optional<double> date_of(const TextTable& table, const TableColumn& column) {
  const auto field = table.fields()[column.index];
  if (parse_number<double>(field, table.has_decimal_comma())) return std::nullopt;
  return parse_iso_time(field);
}

void for_each_row(TextTable& table, std::size_t max_rows, const std::string& hint,
                  const std::function<void()>& add_row) {
  LineFaults faults;
  for (std::size_t count = 0; table.next_row(); ++count) {
    if (count == max_rows)
      throw data_error(
          fmt::format("{} has more rows than the limit of {}", table.file().string(), max_rows),
          "split the file");
    if (table.is_cut_off() && table.fields().size() < table.num_columns()) {
      Progress::warn(
          fmt::format("{}: skipped the last row, which is cut off", table.file().string()));
      break;
    }
    try {
      if (table.fields().size() != table.num_columns())
        throw LineFault{
            fmt::format("{} columns instead of {}", table.fields().size(), table.num_columns())};
      add_row();
    } catch (const LineFault& fault) {
      faults.add(table.line(), fault.text);
    }
  }
  faults.throw_if_any(table.file(), hint);
}

}  // namespace touchtrace
