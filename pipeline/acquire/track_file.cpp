#include "pipeline/acquire/track_file.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/track_columns.h"

namespace touchtrace {
namespace {

constexpr const char* hint =
    "a row has a time, which must not decrease, and a position; pipeline/acquire/README.md "
    "describes the formats";
constexpr long double max_time_s = 1e11L;       // the year 5138, if they count from 1970
constexpr long double max_plain_time_s = 1e6L;  // doubles resolve these to 0.1 ns

/// Units per second of a time since 1970, from 2001 to 2100; 1 if it is none.
double unix_unit_of(long double time) {
  constexpr long double min_unix_s = 1e9L, max_unix_s = 4.1e9L;
  for (const double per_second : {1e3, 1e6, 1e9})
    if (time >= min_unix_s * per_second && time <= max_unix_s * per_second) {
      Progress::report(fmt::format("times are {} per second, since 1970", per_second));
      return per_second;
    }
  return 1.0;
}

class TrackReader {
 public:
  TrackReader(const std::filesystem::path& file, const TrackOptions& options)
      : table_(file), columns_(columns_of(table_, options)), rate_hz_(options.rate_hz) {
    result_.file = file;
    result_.has_sigmas = columns_.sigma.has_value();
  }

  TrackFile read() {
    for_each_row(table_, TrackFile::max_rows, hint, [&] { add_row(); });
    if (result_.track.empty())
      throw data_error(fmt::format("{} has no row with a position", result_.file.string()), hint);
    return std::move(result_);
  }

 private:
  void add_row() {
    const double time_s = next_time();
    const Eigen::Vector3d position = values(columns_.position);
    if (position.hasNaN()) {
      ++result_.num_skipped;
      return;
    }
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    result_.track.push_back(
        {time_s, position, columns_.sigma ? sigma() : Eigen::Vector3d::Constant(nan)});
  }

  /// Time of the row relative to the origin.
  double next_time() {
    if (!columns_.time) return static_cast<double>(num_rows_++) / rate_hz_;
    TableColumn& column = *columns_.time;
    const auto date_s = date_of(table_, column);
    auto time_s =
        date_s ? static_cast<long double>(*date_s) : value_of<long double>(table_, column);
    if (!date_s && !last_time_s_ && !column.has_unit && std::abs(time_s) > max_time_s)
      time_s /= static_cast<long double>(column.per_unit = unix_unit_of(time_s));
    if (std::isnan(time_s)) throw LineFault{column.label + " is missing"};
    if (std::abs(time_s) > max_time_s)
      throw LineFault{
          fmt::format("{} {} is out of range in seconds; name the column time_ms, "
                      "time_us or time_ns for other units",
                      column.label, field(column))};
    const auto previous_s = std::exchange(last_time_s_, time_s);
    if (!previous_s && std::abs(time_s) > max_plain_time_s)
      result_.origin_s = static_cast<std::int64_t>(std::floor(time_s));
    if (previous_s && time_s < *previous_s)
      throw LineFault{
          fmt::format("{} {} is before that of the previous row", column.label, field(column))};
    return static_cast<double>(time_s - static_cast<long double>(result_.origin_s));
  }

  Eigen::Vector3d sigma() const {
    const Eigen::Vector3d sigma_m = values(*columns_.sigma);
    for (std::size_t i = 0; i < 3; ++i)
      if (const auto& column = (*columns_.sigma)[i]; !(sigma_m[Eigen::Index(i)] > 0.0))
        throw LineFault{fmt::format("{} {} is not positive", column.label, field(column))};
    return sigma_m;
  }

  Eigen::Vector3d values(const std::array<TableColumn, 3>& columns) const {
    return {value_of<double>(table_, columns[0]), value_of<double>(table_, columns[1]),
            value_of<double>(table_, columns[2])};
  }

  std::string field(const TableColumn& column) const {
    return quoted_field(table_.fields()[column.index]);
  }

  TextTable table_;
  TrackColumns columns_;
  double rate_hz_;
  std::size_t num_rows_ = 0;
  std::optional<long double> last_time_s_;
  TrackFile result_;
};

}  // namespace

TrackFile read_track(const std::filesystem::path& file, const TrackOptions& options) {
  return TrackReader(file, options).read();
}

std::string time_text(std::int64_t origin_s, double time_s) {
  if (origin_s == 0) return fmt::format("{}", time_s);
  auto text = fmt::format("{:.9f}", static_cast<long double>(origin_s) + time_s);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text += '0';
  return text;
}

}  // namespace touchtrace
