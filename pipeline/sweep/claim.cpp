#include "pipeline/sweep/claim.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/text.h"

namespace touchtrace::sweep {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view prefix = "claim.";

/// Host and process namespace: the scope in which a process id is valid.
std::string machine() {
  std::error_code unknown;
  return fmt::format("{}/{}", host_name(), fs::read_symlink("/proc/self/ns/pid", unknown).string());
}

std::optional<int> number_of(const fs::path& file) {
  const auto name = file.filename().string();
  int number = 0;
  if (!name.starts_with(prefix) || !parse_whole(name.substr(prefix.size()), number)) return {};
  return number;
}

/// Number of the newest claim in a folder; -1 if there is none.
int newest_claim(const fs::path& folder) {
  int newest = -1;
  std::error_code vanished;
  for (const auto& entry : fs::directory_iterator(folder, vanished))
    newest = std::max(newest, number_of(entry.path()).value_or(-1));
  return newest;
}

fs::path claim_file(const fs::path& folder, int number) {
  return folder / fmt::format("{}{}", prefix, number);
}

/// Creates the file with its content in one step. Returns false if it exists.
bool create(const fs::path& file) {
  const auto owner = fmt::format("{} {}", machine(), getpid());
  const auto unique = file.parent_path() / (".claim-" + sha256_of(owner).substr(0, 16) + ".tmp");
  std::ofstream stream(unique);
  stream << owner << "\n";
  stream.close();
  const int error = stream && link(unique.c_str(), file.c_str()) == 0 ? 0 : errno;
  std::error_code ignored;
  fs::remove(unique, ignored);
  if (error != 0 && error != EEXIST)
    throw failure(fmt::format("cannot create {}: {}", file.string(), std::strerror(error)),
                  "check that the disk is not full, and that the folder is writable and on a file "
                  "system with hard links");
  return error == 0;
}

/// Whether the file names a process of this machine that has ended.
bool has_dead_owner(const fs::path& file) {
  std::ifstream stream(file);
  std::string owner_machine;
  pid_t process = 0;
  return stream >> owner_machine >> process && owner_machine == machine() && process > 0 &&
         kill(process, 0) != 0 && errno == ESRCH;
}

}  // namespace

Claim::~Claim() {
  std::error_code ignored;
  const int own = number_of(file_).value_or(0);
  for (int number = 0; number <= own; ++number)  // abandoned ones first
    fs::remove(claim_file(file_.parent_path(), number), ignored);
}

void Claim::renew() const {
  std::error_code ignored;  // another process takes over, and the result is the same
  fs::last_write_time(file_, fs::file_time_type::clock::now(), ignored);
}

bool Claims::is_abandoned(const fs::path& file) {
  if (has_dead_owner(file)) return true;
  std::error_code vanished;
  const auto renewed = fs::last_write_time(file, vanished);
  const auto now = now_();
  const auto [sighting, is_new] = sightings_.try_emplace(file.string(), Sighting{renewed, now});
  if (!is_new && sighting->second.renewed != renewed) sighting->second = {renewed, now};
  return std::chrono::duration<double>(now - sighting->second.since).count() >= abandoned_s_;
}

std::unique_ptr<Claim> Claims::take(const fs::path& folder) {
  fs::create_directories(folder);
  const int newest = newest_claim(folder);
  if (newest >= 0 && !is_abandoned(claim_file(folder, newest))) return nullptr;
  const auto file = claim_file(folder, newest + 1);
  if (!create(file)) return nullptr;
  sightings_.erase(claim_file(folder, newest).string());
  return std::make_unique<Claim>(file);
}

}  // namespace touchtrace::sweep
