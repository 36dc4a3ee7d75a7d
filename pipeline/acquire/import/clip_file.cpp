#include "pipeline/acquire/import/clip_file.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/acquire/import/stream_copy.h"
#include "pipeline/acquire/table_columns.h"

namespace touchtrace {
namespace {

constexpr std::size_t max_clips = 100'000;
constexpr const char* hint = "a row has start and end, as in 'start_s,end_s,object'";

struct ClipColumns {
  TableColumn start, end;
  std::size_t object;  ///< beyond the last column: none
};

ClipColumns columns_of_clips(const TextTable& table) {
  const auto& names = table.names();
  if (names.empty()) return {{0, 1.0, "start"}, {1, 1.0, "end"}, 2};
  const auto start = find_column(table, names, {"start"}, time_units()),
             end = find_column(table, names, {"end"}, time_units());
  if (!start || !end)
    throw data_error(fmt::format("{} has no columns start_s and end_s", table.file().string()),
                     hint);
  const auto object = std::ranges::find(names, "object");
  return {*start, *end, static_cast<std::size_t>(object - names.begin())};
}

void require_valid(const Clip& clip, const std::vector<Clip>& previous, const RecordedTime& time) {
  if (!(clip.start_s < clip.end_s)) throw LineFault{"the end is not after the start"};
  if (!previous.empty() && clip.start_s < previous.back().end_s)
    throw LineFault{"the clip starts before the previous one ends"};
  if (clip.end_s <= time.first_s || clip.start_s >= time.last_s)
    throw LineFault{fmt::format(
        "the clip is outside the recording, {:.3f} to {:.3f} s{}", time.first_s, time.last_s,
        time.epoch_s > min_unix_s
            ? fmt::format(", or {:.3f} to {:.3f} s since 1970", time.epoch_s + time.first_s,
                          time.epoch_s + time.last_s)
            : "")};
}

void warn_of_long_clips(const std::vector<Clip>& clips, const RecordedTime& time) {
  constexpr double max_beyond_s = 1.0;
  const auto is_long = [&](const Clip& clip) {
    return clip.start_s < time.first_s - max_beyond_s || clip.end_s > time.last_s + max_beyond_s;
  };
  if (const auto count = std::ranges::count_if(clips, is_long); count > 0)
    Progress::warn(fmt::format("{} of {} clips reach beyond the recording, {:.3f} to {:.3f} s",
                               count, clips.size(), time.first_s, time.last_s));
}

}  // namespace

std::vector<Clip> read_clips(const std::filesystem::path& file, const RecordedTime& time,
                             const std::string& object) {
  TextTable table(file);
  if (table.num_columns() < 2)
    throw data_error(fmt::format("{} has one column", file.string()), hint);
  const ClipColumns columns = columns_of_clips(table);
  const auto seconds = [&](const TableColumn& column) {
    const double value_s = value_of<double>(table, column);
    return value_s > min_unix_s ? value_s - time.epoch_s : value_s;
  };
  std::vector<Clip> clips;
  for_each_row(table, max_clips, hint, [&] {
    Clip clip{seconds(columns.start), seconds(columns.end), object, false, {}, {}};
    if (columns.object < table.num_columns() && !table.fields()[columns.object].empty())
      clip.object = table.fields()[columns.object];
    require_valid(clip, clips, time);
    clips.push_back(std::move(clip));
  });
  if (clips.empty()) throw data_error(file.string() + " has no clips", hint);
  warn_of_long_clips(clips, time);
  return clips;
}

}  // namespace touchtrace
