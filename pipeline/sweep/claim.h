#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>

namespace touchtrace::sweep {

/// Exclusive right to run a cell: a file "claim.N" that names host and process, released by the
/// destructor.
class Claim {
 public:
  explicit Claim(std::filesystem::path file) : file_(std::move(file)) {}
  ~Claim();
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;

  /// Renews the modification time, which shows other processes that this one is alive.
  void renew() const;

 private:
  std::filesystem::path file_;
};

/// Claims cells in a folder that processes of several machines share.
///
/// A claim is abandoned if its process on this machine has ended, or if it has not been renewed for
/// `abandoned_s`, measured by this machine's clock alone. Whoever creates "claim.N+1" first takes
/// an abandoned "claim.N" over.
class Claims {
 public:
  using Time = std::chrono::steady_clock::time_point;

  explicit Claims(double abandoned_s = 60.0,
                  std::function<Time()> now = std::chrono::steady_clock::now)
      : abandoned_s_(abandoned_s), now_(std::move(now)) {}

  /// Claims the cell in `folder`, which is created; null if another process has it.
  std::unique_ptr<Claim> take(const std::filesystem::path& folder);

 private:
  struct Sighting {
    std::filesystem::file_time_type renewed;
    Time since;
  };
  bool is_abandoned(const std::filesystem::path& file);

  double abandoned_s_;
  std::function<Time()> now_;
  std::map<std::string, Sighting> sightings_;
};

}  // namespace touchtrace::sweep
