#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>

#include "pipeline/acquire/record/session.h"
#include "pipeline/acquire/record/source.h"

namespace touchtrace {

/// Records of several threads on their way to the log, of limited size. Thread-safe.
class RecordQueue {
 public:
  struct Item {
    RecordKind kind;
    std::vector<std::uint8_t> payload;
  };

  /// Discards the record if the log cannot keep up.
  void push(RecordKind kind, std::vector<std::uint8_t> payload);
  /// All records; waits for the first one.
  std::deque<Item> pop(double timeout_s);
  std::uint64_t discarded() const { return discarded_; }

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Item> items_;
  std::size_t bytes_ = 0;
  std::atomic<std::uint64_t> discarded_ = 0;
};

/// Writes what sources deliver to a log. Each source has a thread; the log is written by step().
class Recorder {
 public:
  /// Creates the log and starts the threads. `sources` must outlive this.
  Recorder(const std::filesystem::path& log, const SessionInfo& session,
           const std::vector<RecordSource*>& sources);
  ~Recorder();

  /// Writes what arrives within 0.1 s, and synchronises the log twice a second. False: all sources
  /// have ended. Throws the error of a source, and failure if the disk is full.
  bool step();
  /// Stops the sources and writes the rest.
  void finish();

  std::uint64_t log_bytes() const { return log_.bytes(); }
  std::uint64_t written_frames() const { return written_frames_; }
  /// Frames that were lost because the disk is too slow.
  std::uint64_t discarded_frames() const { return queue_.discarded(); }

 private:
  void run(RecordSource& source);
  void write_arrived(double timeout_s);
  void stop();

  LogWriter log_;
  RecordQueue queue_;
  std::uint64_t written_frames_ = 0;
  double synced_s_;
  std::atomic<bool> is_stopping_ = false;
  std::atomic<int> num_running_ = 0;
  std::mutex error_mutex_;
  std::exception_ptr error_;
  std::vector<std::thread> threads_;
};

}  // namespace touchtrace
