// The live page: its server, and its scripts in a headless Chromium where that is installed.
#include "pipeline/live/live_page.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <iostream>
#include <optional>
#include <thread>
#include <vector>

#include "engine/base/files.h"
#include "pipeline/live/live_files.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/browser.h"

namespace touchtrace {
namespace {

using nlohmann::json;
using testing::TemporaryFolder;

constexpr int num_frames = 40;

json body(double x) {
  json each;
  for (const auto& [name, offset] :
       {std::pair("position_m", 0.0), {"position_m_low", -0.05}, {"position_m_high", 0.05}})
    each[name] = {x + offset, 0.1 + offset, 0.8 + offset};
  return each;
}

/// Frame of 2 x 3 taxels, of which the first is not touched and the last is pressed fully.
std::string event_of(int frame) {
  const std::vector<float> pressure{0.0f, 0.2f, 0.4f, 0.6f, 0.8f, 1.0f};
  const double now_s =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  return frame_event({{"step", frame + 1},
                      {"start", "prior"},
                      {"embedding", "segment"},
                      {"sequence", 2 * frame},
                      {"object", body(0.01 * frame)},
                      {"hand", body(-0.01 * frame)},
                      {"touch", {{"mean", 0.5}, {"max", 1.0}, {"contact_taxels", 5}}},
                      {"latency_s", 0.0012},
                      {"arrival_unix_s", now_s},
                      {"glove",
                       {{"rate_hz", 15.0},
                        {"frames", frame + 1},
                        {"dropped", 7},
                        {"torn", 8},
                        {"repeated", 9},
                        {"connected", true}}}},
                     pressure, 2, 3);
}

TEST(LivePage, FrameEventHasTheImage) {
  const json event = json::parse(event_of(3));
  EXPECT_EQ(event["image"]["rows"], 2);
  EXPECT_EQ(event["image"]["cols"], 3);
  EXPECT_EQ(event["image"]["data"], "ADNmmcz/") << "0, 51, 102, 153, 204, 255";
  EXPECT_EQ(event["step"], 4);
}

TEST(LivePage, UsesNothingOfOtherServers) {
  const std::string html(live_files().at("live.html"));
  EXPECT_EQ(html.find("http:"), std::string::npos);
  EXPECT_EQ(html.find("https:"), std::string::npos);
  EXPECT_EQ(html.find("src="), std::string::npos);
}

TEST(LivePage, ServesUntilItIsDestroyed) {
  const LivePage page(0);
  EXPECT_EQ(page.url().rfind("http://127.0.0.1:", 0), 0u);
  EXPECT_FALSE(page.has_viewers());
}

/// The page with a script that tells, once the program has ended, what the canvases show.
std::string page_with_probe() {
  std::string html(live_files().at("live.html"));
  const std::string probe = R"(<script>
    let told = false;
    events.addEventListener("error", () => requestAnimationFrame(() => {
      if (told) return;
      told = true;
      const pixels = (id) => {
        const canvas = get(id);
        return [...canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data];
      };
      const red = pixels("touch").filter((_, i) => i % 4 === 0);
      const painted = ["front", "top"].map((id) => pixels(id).some((value) => value > 0));
      document.body.append(`red ${red[0]} ${red.at(-1)} of ${red.length}, painted ${painted};`);
    }));
  </script></body>)";
  return html.replace(html.find("</body>"), 7, probe);
}

TEST(LivePage, DrawsFramesInABrowser) {
  if (testing::find_browser().empty()) GTEST_SKIP() << "no Chromium; the scripts are not run";
  const TemporaryFolder folder;
  EventFeed feed;
  std::optional<HttpServer> server(0);
  const std::string url = server->url();
  std::atomic<bool> is_done = false;
  const auto answer = [&](const HttpRequest& request) -> HttpResponse {
    if (request.path == "events") return {200, "text/event-stream", "", &feed};
    return {200, "text/html; charset=utf-8", page_with_probe()};
  };
  std::jthread publisher([&](const std::stop_token& stop) {
    while (!feed.has_readers() && !stop.stop_requested())
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    for (int i = 0; i < num_frames; ++i) {
      feed.publish(event_of(i));
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    is_done = true;
  });
  std::jthread serving([&] {
    server->run(answer, [&] { return is_done.load(); });
    server.reset();  // so that the browser's next connection fails
  });
  const auto page = testing::load_page(url, folder.path(), "--virtual-time-budget=4000");
  for (const char* part :
       {"red 0 255 of 6, painted true,true;", "the program has ended", ">15.00 Hz, 40 frames<",
        ">7, 8, 9<", ">1.20 ms<", ">5 taxels, mean pressure 0.500<",
        ">step 40 from the prior, object: segment<"})
    EXPECT_NE(page.dom.find(part), std::string::npos) << part << "\n" << page.dom;
  EXPECT_EQ(page.console.find("Uncaught"), std::string::npos) << page.console;
}

/// Time from the arrival of the glove's last byte until the frame is drawn, as the page shows it.
TEST(LivePage, ShowsAFrameWithin50Milliseconds) {
  if (testing::find_browser().empty()) GTEST_SKIP() << "no Chromium; the page is not run";
  constexpr int frames = 60, period_ms = 67;
  const TemporaryFolder folder;
  EventFeed feed;
  HttpServer server(0);
  std::vector<double> picture_ms;
  std::atomic<bool> is_done = false;
  const auto answer = [&](const HttpRequest& request) -> HttpResponse {
    if (request.path == "events") return {200, "text/event-stream", "", &feed};
    if (request.path == "shown") {
      for (const auto& value : json::parse(request.body)) picture_ms.push_back(value);
      is_done = true;
    }
    return {200, "text/html; charset=utf-8",
            testing::replaced(std::string(live_files().at("live.html")), "</body>", R"(<script>
      setInterval(() => {
        if (pictureMs.length >= 50) fetch("shown", {method: "POST", body: JSON.stringify(pictureMs)});
      }, 100);
    </script></body>)")};
  };
  std::jthread publisher([&](const std::stop_token& stop) {
    for (int waited = 0; !feed.has_readers() && !stop.stop_requested() && waited < 60'000; ++waited)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    for (int i = 0; i < frames && !stop.stop_requested(); ++i) {
      feed.publish(event_of(i));
      std::this_thread::sleep_for(std::chrono::milliseconds(period_ms));
    }
    std::this_thread::sleep_for(std::chrono::seconds(1));
    is_done = true;
  });
  const testing::OpenBrowser browser(server.url(), folder.path());
  server.run(answer, [&] { return is_done.load(); });
  ASSERT_GE(picture_ms.size(), 50u);
  std::ranges::sort(picture_ms);
  std::cout << "byte to picture: median " << picture_ms[picture_ms.size() / 2] << " ms, 95 % "
            << picture_ms[picture_ms.size() * 95 / 100] << " ms\n";
  EXPECT_LE(picture_ms[picture_ms.size() / 2], 50.0);
}

}  // namespace
}  // namespace touchtrace
