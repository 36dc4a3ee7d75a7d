#pragma once

#include <functional>
#include <vector>

#include "pipeline/acquire/record/log.h"

namespace touchtrace {

using RecordSink = std::function<void(RecordKind, std::vector<std::uint8_t> payload)>;

/// Device that is recorded, in a thread of its own.
class RecordSource {
 public:
  RecordSource() = default;
  virtual ~RecordSource() = default;
  RecordSource(const RecordSource&) = delete;
  RecordSource& operator=(const RecordSource&) = delete;

  /// Passes on what arrives within about 0.1 s. False: nothing will follow.
  virtual bool step(const RecordSink& sink) = 0;
};

}  // namespace touchtrace
