#include "pipeline/recording/h5_handle.h"

#include <fmt/core.h>

#include <mutex>
#include <string_view>
#include <utility>

namespace touchtrace::h5 {
namespace {

std::mutex library_mutex;
thread_local int locks_held = 0;

herr_t store_innermost(unsigned depth, const H5E_error2_t* error, void* text) {
  if (depth == 0 && error->desc != nullptr) *static_cast<std::string*>(text) = error->desc;
  return 0;
}

std::string library_message() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, store_innermost, &text);
  // A failed system call: only its reason, without addresses and sizes.
  constexpr std::string_view reason = "error message = '";
  if (const auto at = text.find(reason); at != std::string::npos) {
    const auto begin = at + reason.size();
    text = text.substr(begin, text.find('\'', begin) - begin);
  }
  return text.empty() ? "unknown reason" : text;
}

}  // namespace

LibraryLock::LibraryLock() {
  if (locks_held++ == 0) library_mutex.lock();
  // Handles close all files. One that cannot be written, because the disk is full, remains open,
  // and the library's exit handler crashes on it.
  [[maybe_unused]] static const herr_t no_exit_handler = H5dont_atexit();
  // No messages on stderr; errors become exceptions. Per thread in a thread-safe build.
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

LibraryLock::~LibraryLock() {
  if (--locks_held == 0) library_mutex.unlock();
}

hid_t check_id(hid_t result, const std::string& what) {
  if (result < 0) throw H5Error(fmt::format("{}: {}", what, library_message()));
  return result;
}

void check(herr_t result, const std::string& what) { check_id(result, what); }

Handle::~Handle() {
  if (id_ < 0) return;
  const LibraryLock lock;
  closer_(id_);
}

Handle::Handle(Handle&& other) noexcept
    : id_(std::exchange(other.id_, H5I_INVALID_HID)), closer_(other.closer_) {}

Handle& Handle::operator=(Handle&& other) noexcept {
  std::swap(id_, other.id_);
  std::swap(closer_, other.closer_);
  return *this;
}

void Handle::close(const std::string& what) {
  if (id_ >= 0) check(closer_(std::exchange(id_, H5I_INVALID_HID)), what);
}

}  // namespace touchtrace::h5
