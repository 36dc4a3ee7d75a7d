#include "pipeline/mark/mark_server.h"

#include <fmt/core.h>

#include <cstdio>
#include <cstdlib>

#include "engine/base/error.h"
#include "engine/base/interrupt.h"
#include "engine/base/json_number.h"
#include "pipeline/mark/mark_page.h"
#include "pipeline/web/http_server.h"

namespace touchtrace {
namespace {

using nlohmann::json;

constexpr std::int64_t max_pixels = 100'000;

PixelBox box_of(const json& value) {
  if (value.is_null()) return {};
  const auto pixels = [&](std::size_t i) {
    return static_cast<int>(whole_number(value.at(i), "box", -max_pixels, max_pixels));
  };
  return {pixels(0), pixels(1), pixels(2), pixels(3)};
}

std::vector<ClipBoxes> boxes_of(const json& request) {
  std::vector<ClipBoxes> boxes;
  for (const json& clip : request.at("clips"))
    boxes.push_back(
        {static_cast<std::size_t>(whole_number(clip.at("clip"), "clip", 0, INT32_MAX)),
         static_cast<std::size_t>(whole_number(clip.at("frame"), "frame", 0, INT32_MAX)),
         box_of(clip.at("hand")), box_of(clip.at("object"))});
  return boxes;
}

HttpResponse answer(MarkSession& session, const HttpRequest& request, bool& is_done) {
  const bool is_get = request.method == "GET";
  if (is_get && request.path.empty())
    return {200, "text/html; charset=utf-8", std::string(mark_page().at("mark.html"))};
  if (is_get && request.path == "clips") return {200, "application/json", session.state().dump()};
  if (is_get && request.path == "frame")
    return {200, "image/jpeg", session.jpeg(std::strtoul(request.query.c_str(), nullptr, 10))};
  if (request.method == "POST" && request.path == "save") {
    const auto boxes = boxes_of(json::parse(request.body));
    session.save(boxes);
    return {200, "application/json", json{{"saved", boxes.size()}}.dump()};
  }
  if (request.method == "POST" && request.path == "end") {
    is_done = true;
    return {200, "application/json", "{}"};
  }
  return {404, "text/plain", "not found"};
}

HttpResponse fault(const std::string& text) {
  return {400, "application/json",
          json{{"error", text}}.dump(-1, ' ', false, json::error_handler_t::replace)};
}

}  // namespace

void serve_mark_page(MarkSession& session, int port) {
  HttpServer server(port);
  fmt::print(stderr, "draw the boxes at {} (Ctrl-C ends)\n", server.url());
  bool is_done = false;
  const auto handle = [&](const HttpRequest& request) -> HttpResponse {
    try {
      return answer(session, request, is_done);
    } catch (const Error& error) {
      if (error.code() == ExitCode::interrupted) throw;
      return fault(fmt::format("{}; {}", error.what(), error.hint()));
    } catch (const std::exception& error) {
      return fault(error.what());
    }
  };
  server.run(handle, [&] {
    throw_if_interrupted();
    return is_done;
  });
}

}  // namespace touchtrace
