#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/error.h"
#include "pipeline/acquire/table_columns.h"
#include "pipeline/acquire/track_file.h"

namespace touchtrace {
namespace {

constexpr const char* hint =
    "a row has release and landing time, as in 'release_s,landing_s'; flights are in order and do "
    "not overlap";

std::array<TableColumn, 2> columns_of_flights(const TextTable& table) {
  if (table.names().empty() && table.num_columns() == 2)
    return {TableColumn{0, 1.0, "release"}, TableColumn{1, 1.0, "landing"}};
  const auto release = find_column(table, table.names(), {"release"}, time_units()),
             landing = find_column(table, table.names(), {"landing"}, time_units());
  if (!release || !landing)
    throw data_error(
        fmt::format("{} has no columns release_s and landing_s", table.file().string()), hint);
  return {*release, *landing};
}

double time_on_track(const TextTable& table, const TableColumn& column, std::int64_t origin_s) {
  const auto time_s = value_of<long double>(table, column);
  if (std::isnan(time_s)) throw LineFault{column.label + " is missing"};
  return static_cast<double>(time_s - static_cast<long double>(origin_s));
}

/// Throws LineFault unless the flight is after `previous` and during the track.
void require_valid(const Flight& flight, const std::vector<Flight>& previous,
                   const TrackFile& track) {
  const auto text = [&](double time_s) { return time_text(track.origin_s, time_s); };
  if (!(flight.landing_s > flight.release_s)) throw LineFault{"landing is not after release"};
  if (!previous.empty() && flight.release_s < previous.back().landing_s)
    throw LineFault{fmt::format("release at {} s is before the previous landing at {} s",
                                text(flight.release_s), text(previous.back().landing_s))};
  const double first_s = track.track.front().time_s, last_s = track.track.back().time_s;
  if (flight.release_s >= last_s || flight.landing_s <= first_s)
    throw LineFault{fmt::format("flight from {} to {} s is outside the track, {} to {} s",
                                text(flight.release_s), text(flight.landing_s), text(first_s),
                                text(last_s))};
}

}  // namespace

std::vector<Flight> read_flights(const std::filesystem::path& file, const TrackFile& track) {
  TextTable table(file);
  const auto [release, landing] = columns_of_flights(table);
  std::vector<Flight> flights;
  for_each_row(table, TrackFile::max_rows, hint, [&, release = release, landing = landing] {
    const Flight flight{time_on_track(table, release, track.origin_s),
                        time_on_track(table, landing, track.origin_s)};
    require_valid(flight, flights, track);
    flights.push_back(flight);
  });
  return flights;
}

}  // namespace touchtrace
