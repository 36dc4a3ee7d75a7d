#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <thread>
#include <utility>

#include "pipeline/web/http_server.h"

namespace touchtrace {

/// JSON text of one frame for the page. `row`: a row of live_prediction.h, or some of its members;
/// "glove": {"rate_hz", "frames", "dropped", "torn", "repeated", "connected"}; "arrival_unix_s" of
/// its last byte. `pressure`: [rows, cols], 0..1.
std::string frame_event(nlohmann::json row, std::span<const float> pressure, int rows, int cols);

/// Page on 127.0.0.1 that shows a glove and, if there are any, predictions. A thread serves it.
/// A browser that is slow skips frames; show() never waits for one.
class LivePage {
 public:
  /// `port` 0: any free port. Throws failure if the port cannot be used.
  explicit LivePage(int port);

  std::string url() const { return server_.url(); }
  /// True if a browser shows the page: frames without viewers need not be made.
  bool has_viewers() const { return feed_.has_readers(); }

  /// Shows the frame of a frame_event().
  void show(std::string event) { feed_.publish(std::move(event)); }

 private:
  void serve(const std::stop_token& stop);

  EventFeed feed_;
  HttpServer server_;
  std::jthread thread_;  ///< last, so that it ends first
};

}  // namespace touchtrace
