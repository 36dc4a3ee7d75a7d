#include "pipeline/web/event_feed.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <utility>

#include "engine/base/error.h"

namespace touchtrace {

EventFeed::EventFeed() : descriptor_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (descriptor_ < 0)
    throw failure("cannot create an event descriptor",
                  "close other programs, or raise `ulimit -n`");
}

EventFeed::~EventFeed() { close(descriptor_); }

void EventFeed::publish(std::string event) {
  {
    const std::lock_guard lock(mutex_);
    event_ = std::move(event);
    ++number_;
  }
  eventfd_write(descriptor_, 1);
}

EventFeed::Event EventFeed::newest() const {
  const std::lock_guard lock(mutex_);
  return {number_, event_};
}

void EventFeed::acknowledge() const {
  eventfd_t ignored = 0;
  eventfd_read(descriptor_, &ignored);
}

}  // namespace touchtrace
