#pragma once

#include <string>
#include <vector>

#include "pipeline/sweep/rows.h"

namespace touchtrace::sweep {

/// Mean and standard deviation of a metric over the rows of a group.
struct Statistic {
  double mean = 0.0, std = 0.0;  ///< NaN without values; std: NaN for one value
};

/// Rows that agree in all axes but seeds and in all texts, with statistics of their numbers.
struct Summary {
  std::vector<std::string> keys, metrics;
  struct Group {
    std::vector<std::string> keys;
    std::vector<Statistic> metrics;
    std::size_t count = 0;  ///< rows, or the runs that they pool
  };
  std::vector<Group> groups;
};

/// Summary of the rows. `metrics`: fields to include; empty: all that are numbers. Texts with a
/// slash are taken for paths and skipped. Throws usage_error for an unknown metric.
Summary summarize(const std::vector<Row>& rows, const std::vector<std::string>& metrics);

/// Table with "mean +- std" to four digits and the number of rows or of the runs that they pool.
std::string markdown_of(const Summary& summary);
std::string latex_of(const Summary& summary);

}  // namespace touchtrace::sweep
