#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>

namespace touchtrace {

/// The newest event, for any number of readers. A reader that is slow skips events, and publish()
/// never waits for one. Thread-safe.
class EventFeed {
 public:
  /// Throws failure if the system has no free descriptors.
  EventFeed();
  ~EventFeed();
  EventFeed(const EventFeed&) = delete;
  EventFeed& operator=(const EventFeed&) = delete;

  /// Replaces the event. `event` has no line breaks.
  void publish(std::string event);

  struct Event {
    std::uint64_t number = 0;  ///< counts the published events; 0: none yet
    std::string text;
  };
  Event newest() const;
  std::uint64_t number() const { return number_; }

  /// Readable once an event was published since the last acknowledge(), for poll().
  int descriptor() const { return descriptor_; }
  void acknowledge() const;

  void add_reader() { ++readers_; }
  void remove_reader() { --readers_; }
  /// True if a client is connected: events need not be made otherwise.
  bool has_readers() const { return readers_ > 0; }

 private:
  mutable std::mutex mutex_;
  std::string event_;
  std::atomic<std::uint64_t> number_ = 0;
  std::atomic<int> readers_ = 0;
  int descriptor_;
};

}  // namespace touchtrace
