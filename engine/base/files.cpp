#include "engine/base/files.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <openssl/evp.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <tuple>
#include <utility>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

Error io_failure(const std::string& what, const fs::path& path) {
  return failure(fmt::format("{} {}: {}", what, path.string(), std::strerror(errno)),
                 "check that the disk is not full and the folder is writable");
}

void sync_to_disk(const fs::path& path, int flags) {
  const int descriptor = open(path.c_str(), flags | O_CLOEXEC);
  if (descriptor < 0) throw io_failure("cannot open", path);
  const int result = fsync(descriptor);
  close(descriptor);
  if (result != 0) throw io_failure("cannot flush", path);
}

using Digest = std::array<unsigned char, 32>;

std::string hexadecimal(const Digest& digest) {
  std::string text;
  for (unsigned char byte : digest) text += fmt::format("{:02x}", byte);
  return text;
}

std::string computed_sha256(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw data_error(fmt::format("cannot read {}", path.string()), "check the path");
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(),
                                                                        &EVP_MD_CTX_free);
  EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr);
  std::array<char, 1 << 16> buffer;
  while (stream.read(buffer.data(), buffer.size()) || stream.gcount() > 0)
    EVP_DigestUpdate(context.get(), buffer.data(), static_cast<std::size_t>(stream.gcount()));
  Digest digest;
  EVP_DigestFinal_ex(context.get(), digest.data(), nullptr);
  return hexadecimal(digest);
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Start of the names of temporary files for `path` on this machine; the process id and ".tmp"
/// follow.
std::string temporary_prefix(const fs::path& path) {
  return fmt::format(".{}.{}-", path.filename().string(), host_name());
}

/// Removes temporary files for `path` whose process does not exist any more.
void remove_abandoned(const fs::path& path) {
  const auto prefix = temporary_prefix(path);
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder_of(path), ignored)) {
    const auto name = entry.path().filename().string();
    pid_t process = 0;
    if (!name.starts_with(prefix) || !name.ends_with(".tmp") ||
        std::from_chars(name.data() + prefix.size(), name.data() + name.size(), process).ec !=
            std::errc())
      continue;
    if (kill(process, 0) != 0 && errno == ESRCH) fs::remove(entry.path(), ignored);
  }
}

}  // namespace

std::string host_name() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

OutputFile::OutputFile(fs::path path, bool overwrite) : path_(std::move(path)) {
  if (!overwrite && fs::exists(path_))
    throw usage_error(fmt::format("{} already exists", path_.string()),
                      "choose another output or pass --overwrite");
  std::error_code error;
  created_folder_ = fs::create_directories(folder_of(path_), error);
  if (error)
    throw failure(
        fmt::format("cannot create the folder of {}: {}", path_.string(), error.message()),
        "choose an output in a writable folder");
  remove_abandoned(path_);
  temporary_ = folder_of(path_) / fmt::format("{}{}.tmp", temporary_prefix(path_), getpid());
}

OutputFile::~OutputFile() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove(temporary_, ignored);
  if (created_folder_) fs::remove(folder_of(path_), ignored);  // fails if not empty
}

void OutputFile::commit() {
  sync_to_disk(temporary_, O_RDWR);
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0)
    throw io_failure("cannot rename to", path_);
  committed_ = true;
  sync_to_disk(folder_of(path_), O_RDONLY | O_DIRECTORY);
}

void write_file(const fs::path& path, std::string_view bytes, bool overwrite) {
  OutputFile output(path, overwrite);
  std::ofstream stream(output.temporary(), std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) throw io_failure("cannot write", output.temporary());
  output.commit();
}

std::string read_file(const fs::path& path, std::uintmax_t max_bytes) {
  std::error_code error;
  const auto size = fs::file_size(path, error);
  if (error)
    throw data_error(fmt::format("cannot read {}: {}", path.string(), error.message()),
                     "check the path");
  if (size > max_bytes)
    throw data_error(
        fmt::format("{} has {} bytes, more than the limit of {}", path.string(), size, max_bytes),
        "check that this is the intended file");
  std::string bytes(size, '\0');
  std::ifstream stream(path, std::ios::binary);
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(size)))
    throw data_error(fmt::format("cannot read {}", path.string()), "check its permissions");
  return bytes;
}

std::string sha256_of_file(const fs::path& path) {
  static std::mutex mutex;
  static std::map<std::tuple<std::string, std::uintmax_t, fs::file_time_type>, std::string> known;
  std::error_code ignored;  // computed_sha256() reports it
  const auto key = std::tuple(fs::absolute(path).string(), fs::file_size(path, ignored),
                              fs::last_write_time(path, ignored));
  const std::lock_guard lock(mutex);
  auto& hash = known[key];
  if (hash.empty()) hash = computed_sha256(path);
  return hash;
}

std::string sha256_of(std::string_view text) {
  Digest digest;
  EVP_Digest(text.data(), text.size(), digest.data(), nullptr, EVP_sha256(), nullptr);
  return hexadecimal(digest);
}

}  // namespace touchtrace
