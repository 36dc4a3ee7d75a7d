#include "pipeline/live/live_page.h"

#include <fmt/core.h>

#include <cmath>
#include <cstdint>
#include <exception>
#include <vector>

#include "engine/base/base64.h"
#include "engine/base/progress.h"
#include "pipeline/live/live_files.h"

namespace touchtrace {

std::string frame_event(nlohmann::json row, std::span<const float> pressure, int rows, int cols) {
  std::vector<std::uint8_t> image;
  for (const float value : pressure)
    image.push_back(static_cast<std::uint8_t>(std::lround(255.0f * value)));
  row["image"] = {{"rows", rows}, {"cols", cols}, {"data", base64(image)}};
  return row.dump();
}

LivePage::LivePage(int port)
    : server_(port), thread_([this](const std::stop_token& stop) { serve(stop); }) {}

void LivePage::serve(const std::stop_token& stop) {
  const auto handle = [this](const HttpRequest& request) -> HttpResponse {
    if (request.method != "GET") return {404, "text/plain", "not found"};
    if (request.path.empty())
      return {200, "text/html; charset=utf-8", std::string(live_files().at("live.html"))};
    if (request.path == "events") return {200, "text/event-stream", "", &feed_};
    return {404, "text/plain", "not found"};
  };
  try {
    server_.run(handle, [&] { return stop.stop_requested(); });
  } catch (const std::exception& error) {
    Progress::report(fmt::format("the page has ended: {}", error.what()));
  }
}

}  // namespace touchtrace
