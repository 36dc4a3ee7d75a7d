#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "pipeline/acquire/glove/protocol.h"
#include "pipeline/acquire/record/source.h"
#include "pipeline/acquire/transport/transport.h"

namespace touchtrace {

struct GloveStatus {
  ParserCounts counts;
  bool is_connected = true;
  std::uint64_t reconnections = 0;  ///< with restarts, and pauses of a glove without frame numbers
  int saturated_taxels = 0;         ///< in the last frame
  double rate_hz = 0.0;             ///< of the device's frames since the last reconnection
  double last_frame_s = 0.0;        ///< arrival, on the clock of monotonic_s(); 0: none
};

/// Glove on a port. A glove that is unplugged is opened again as soon as it is there.
class GloveSource : public RecordSource {
 public:
  struct Options {
    std::string port;
    int baud = 0;               ///< 0: the protocol's
    double replay_speed = 1.0;  ///< of a file, relative to the nominal rate; 0: without pauses
  };

  /// Opens the port. `start_s`: time of monotonic_s() that is 0 in the recording.
  GloveSource(const GloveProtocol& protocol, const GloveInfo& info, const Options& options,
              double start_s);

  bool step(const RecordSink& sink) override;
  /// May be called from another thread.
  GloveStatus status() const;

 private:
  void open();
  bool try_open();
  double request();
  double replayed_s(std::uint64_t number);
  void pass_on(const GloveFrame& arrived);
  void begin_segment(const GloveFrame& frame);

  const GloveProtocol& protocol_;
  GloveInfo info_;
  Options options_;
  double start_s_;
  std::unique_ptr<Transport> port_;
  std::unique_ptr<GloveParser> parser_;
  std::vector<std::uint8_t> buffer_ = std::vector<std::uint8_t>(1 << 16);
  const RecordSink* sink_ = nullptr;  ///< during step()
  double requested_s_ = 0.0;          ///< time of the last request
  bool is_answered_ = true;

  double opened_s_ = 0.0;
  bool is_replay_ = false;
  std::optional<std::uint64_t> replayed_number_;  ///< of the first frame of a file

  bool is_started_ = false, is_gap_ = false;  ///< is_gap_: the next frame follows a reconnection
  std::uint64_t offset_ = 0;                  ///< from the parser's sequence to the recording's
  std::uint64_t restarts_ = 0;                ///< of the current parser
  GloveFrame first_{}, last_{};               ///< of the segment; without counts
  ParserCounts earlier_counts_;               ///< of earlier connections
  mutable std::mutex mutex_;
  GloveStatus status_;
};

}  // namespace touchtrace
