#include "pipeline/sweep/summary_table.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace touchtrace::sweep {
namespace {

using nlohmann::ordered_json;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

bool is_key(const std::vector<Row>& rows, const std::string& column) {
  if (is_seed(column)) return false;
  return std::ranges::any_of(rows, [&](const Row& row) {
    if (row.axes.contains(column)) return true;
    const auto value = row.fields.value(column, ordered_json());
    return value.is_boolean() ||
           (value.is_string() && value.get<std::string>().find('/') == std::string::npos);
  });
}

bool is_metric(const std::vector<Row>& rows, const std::string& column) {
  return !is_key(rows, column) && std::ranges::any_of(rows, [&](const Row& row) {
    return row.fields.value(column, ordered_json()).is_number();
  });
}

Statistic statistic_of(const std::vector<double>& values) {
  if (values.empty()) return {nan, nan};
  double sum = 0.0, squares = 0.0;
  const auto count = static_cast<double>(values.size());
  for (const double value : values) sum += value;
  for (const double value : values) squares += std::pow(value - sum / count, 2);
  return {sum / count, values.size() > 1 ? std::sqrt(squares / (count - 1.0)) : nan};
}

std::vector<std::string> keys_of(const Row& row, const std::vector<std::string>& columns) {
  std::vector<std::string> texts;
  for (const auto& column : columns)
    texts.push_back(text_of(row.axes.contains(column) ? row.axes[column]
                                                      : row.fields.value(column, ordered_json())));
  return texts;
}

/// Number of trainings in a row: its "runs", which pools seeds, or one.
std::size_t count_of(const Row& row) {
  const auto runs = row.fields.value("runs", ordered_json());
  return runs.is_number_unsigned() ? std::max<std::size_t>(1, runs.get<std::size_t>()) : 1;
}

Summary::Group group_of(const std::vector<const Row*>& rows, const Summary& summary) {
  Summary::Group group{keys_of(*rows.front(), summary.keys), {}, 0};
  for (const Row* row : rows) group.count += count_of(*row);
  for (const auto& metric : summary.metrics) {
    std::vector<double> values;
    for (const Row* row : rows)
      if (const auto value = row->fields.value(metric, ordered_json()); value.is_number())
        values.push_back(value);
    group.metrics.push_back(statistic_of(values));
  }
  return group;
}

std::string text_of(const Statistic& statistic, const char* plus_minus) {
  if (std::isnan(statistic.mean)) return "-";
  const auto mean = fmt::format("{:.4g}", statistic.mean);
  return std::isnan(statistic.std) ? mean
                                   : fmt::format("{} {} {:.4g}", mean, plus_minus, statistic.std);
}

std::string latex(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\')
      escaped += "\\textbackslash{}";
    else if (c == '~' || c == '^')
      escaped += std::string("\\") + c + "{}";
    else
      escaped += (std::string_view("_&%#${}").find(c) == std::string_view::npos ? "" : "\\") +
                 std::string(1, c);
  }
  return escaped;
}

std::string markdown(const std::string& text) {
  std::string escaped;
  for (const char c : text) escaped += (c == '|' ? "\\" : "") + std::string(1, c);
  return escaped;
}

std::vector<std::string> header_of(const Summary& summary) {
  auto header = summary.keys;
  header.insert(header.end(), summary.metrics.begin(), summary.metrics.end());
  header.emplace_back("n");
  return header;
}

std::vector<std::string> latex_cells(const Summary::Group& group) {
  std::vector<std::string> cells;
  for (const auto& key : group.keys) cells.push_back(latex(key));
  for (const auto& metric : group.metrics) cells.push_back("$" + text_of(metric, "\\pm") + "$");
  cells.push_back(std::to_string(group.count));
  return cells;
}

}  // namespace

Summary summarize(const std::vector<Row>& rows, const std::vector<std::string>& metrics) {
  Summary summary;
  std::vector<std::string> numbers;
  for (const auto& column : columns_of(rows)) {
    if (is_key(rows, column)) summary.keys.push_back(column);
    if (is_metric(rows, column)) numbers.push_back(column);
  }
  for (const auto& metric : metrics)
    if (std::ranges::find(numbers, metric) == numbers.end())
      throw usage_error(fmt::format("unknown metric '{}'", metric), suggestion(metric, numbers));
  summary.metrics = metrics.empty() ? numbers : metrics;
  std::map<std::vector<std::string>, std::vector<const Row*>> groups;
  for (const Row& row : rows) groups[keys_of(row, summary.keys)].push_back(&row);
  std::set<std::vector<std::string>> seen;
  for (const Row& row : rows)
    if (const auto keys = keys_of(row, summary.keys); seen.insert(keys).second)
      summary.groups.push_back(group_of(groups.at(keys), summary));
  return summary;
}

std::string markdown_of(const Summary& summary) {
  const auto header = header_of(summary);
  std::string text = fmt::format("| {} |\n|", fmt::join(header, " | "));
  for (std::size_t i = 0; i < header.size(); ++i) text += "---|";
  for (const auto& group : summary.groups) {
    std::vector<std::string> cells;
    for (const auto& key : group.keys) cells.push_back(markdown(key));
    for (const auto& metric : group.metrics) cells.push_back(text_of(metric, "+-"));
    text += fmt::format("\n| {} | {} |", fmt::join(cells, " | "), group.count);
  }
  return text + "\n";
}

std::string latex_of(const Summary& summary) {
  std::vector<std::string> header;
  for (const auto& name : header_of(summary)) header.push_back(latex(name));
  std::string text =
      fmt::format("\\begin{{tabular}}{{{}{}}}\n\\hline\n{} \\\\\n\\hline\n",
                  std::string(summary.keys.size(), 'l'),
                  std::string(summary.metrics.size() + 1, 'r'), fmt::join(header, " & "));
  for (const auto& group : summary.groups)
    text += fmt::format("{} \\\\\n", fmt::join(latex_cells(group), " & "));
  return text + "\\hline\n\\end{tabular}\n";
}

}  // namespace touchtrace::sweep
