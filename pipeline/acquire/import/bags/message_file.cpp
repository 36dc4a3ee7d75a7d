#include "pipeline/acquire/import/bags/message_file.h"

#include <fmt/core.h>

#include <stdexcept>

#include "engine/base/progress.h"

namespace touchtrace {

void read_records(const std::filesystem::path& file, std::uint64_t begin, std::uint64_t end,
                  const std::size_t& num_messages,
                  const std::function<std::uint64_t(std::uint64_t)>& read_record) {
  Progress progress("reading the bag", end);
  std::uint64_t position = begin;
  try {
    while (position < end) {
      const std::uint64_t next = read_record(position);
      progress.advance(next - position);
      position = next;
    }
  } catch (const std::out_of_range&) {
    if (num_messages == 0) throw;
    Progress::warn(fmt::format("{} ends early, at byte {}; the messages before are used",
                               file.string(), position));
  }
}

}  // namespace touchtrace
