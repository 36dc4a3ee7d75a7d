#include "pipeline/web/http_server.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/support/http_client.h"

namespace touchtrace {
namespace {

using testing::HttpClient;
using Clock = std::chrono::steady_clock;

/// Server in a thread, with a feed at "events".
class HttpServerTest : public ::testing::Test {
 protected:
  HttpServerTest() {
    thread_ = std::jthread([this](const std::stop_token& stop) {
      server_.run([this](const HttpRequest& request) { return answer(request); },
                  [&] { return stop.stop_requested(); });
    });
  }

  HttpResponse answer(const HttpRequest& request) {
    if (request.path == "events") return {200, "text/event-stream", "", &feed_};
    if (request.path == "large") return {200, "text/plain", std::string(20'000'000, 'x')};
    return {200, "text/plain", request.method + request.query + request.body};
  }

  std::string head(const std::string& line, const std::string& host) const {
    return line + " HTTP/1.1\r\nHost: " + host + "\r\n";
  }
  std::string ask(const std::string& line, const std::string& host,
                  const std::string& rest = "") const {
    return HttpClient(port_, head(line, host) + rest + "\r\n").read();
  }
  std::string get(const std::string& path) const { return page_.get(path); }
  void wait_for_reader() const {
    while (!feed_.has_readers()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  EventFeed feed_;
  HttpServer server_{0};
  testing::PageAddress page_{server_.url()};
  const std::string &host_ = page_.host, &root_ = page_.root;
  const int port_ = page_.port;
  std::jthread thread_;
};

TEST_F(HttpServerTest, AnswersOnlyItsOwnPage) {
  EXPECT_NE(ask("GET " + root_ + "x?7", host_).find("GET7"), std::string::npos);
  EXPECT_NE(ask("GET /x", host_).find(" 404 "), std::string::npos);
  EXPECT_NE(ask("GET /" + std::string(32, '0') + "/x", host_).find(" 404 "), std::string::npos);
  EXPECT_NE(ask("GET " + root_, "example.org").find(" 403 "), std::string::npos);
  EXPECT_NE(ask("POST " + root_, host_, "Content-Length: 99999999999\r\n").find(" 400 "),
            std::string::npos);
  EXPECT_NE(ask("POST " + root_, host_, "content-length: 2\r\n\r\nok").find("POSTok"),
            std::string::npos);
  EXPECT_NE(HttpClient(port_, "\r\n\r\n").read().find(" 403 "), std::string::npos);
  EXPECT_NE(ask("POST " + root_ + "end", host_).find(" 200 "), std::string::npos);
}

TEST_F(HttpServerTest, AClientThatDoesNotReadDelaysNoOther) {
  HttpClient stuck(port_, get("large"));
  const auto start = Clock::now();
  for (int i = 0; i < 20; ++i)
    EXPECT_NE(HttpClient(port_, get("x")).read().find("GET"), std::string::npos);
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(2));
  EXPECT_GT(stuck.read().size(), 20'000'000u) << "it gets all when it reads";
}

TEST_F(HttpServerTest, EveryReaderGetsTheEvents) {
  EXPECT_FALSE(feed_.has_readers());
  feed_.publish("too early");
  HttpClient first(port_, get("events")), second(port_, get("events"));
  wait_for_reader();
  first.read("\r\n\r\n"), second.read("\r\n\r\n");
  feed_.publish("one");
  EXPECT_NE(first.read("data: one\n\n").find("data: one\n\n"), std::string::npos);
  EXPECT_NE(second.read("data: one\n\n").find("data: one\n\n"), std::string::npos);
  feed_.publish("two");
  EXPECT_NE(first.read("data: two\n\n").find("data: two\n\n"), std::string::npos);
  EXPECT_EQ(first.read("data: two\n\n").find("too early"), std::string::npos);
  EXPECT_NE(first.read("\n").find("Content-Type: text/event-stream"), std::string::npos);
}

// A reader that sleeps neither delays the publisher nor other readers, and skips to the newest
// event when it wakes.
TEST_F(HttpServerTest, ASlowReaderSkipsEvents) {
  constexpr int count = 20'000;
  HttpClient slow(port_, get("events"));
  slow.read("\r\n\r\n");
  const std::string padding(2000, 'p');
  const auto start = Clock::now();
  for (int i = 0; i < count; ++i) {
    feed_.publish(std::to_string(i) + padding);
    if (i % 1000 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(2));
  HttpClient fast(port_, get("events"));
  fast.read("\r\n\r\n");
  feed_.publish("last");
  EXPECT_NE(fast.read("data: last").find("data: last"), std::string::npos);
  const std::string& got = slow.read("data: last");
  EXPECT_NE(got.find("data: last"), std::string::npos);
  EXPECT_LT(got.size(), std::size_t{count} * padding.size() / 2) << "old events are skipped";
}

TEST_F(HttpServerTest, AReaderThatLeavesIsForgotten) {
  {
    HttpClient reader(port_, get("events"));
    wait_for_reader();
  }
  const auto end = Clock::now() + std::chrono::seconds(5);
  while (feed_.has_readers() && Clock::now() < end) std::this_thread::yield();
  EXPECT_FALSE(feed_.has_readers());
}

}  // namespace
}  // namespace touchtrace
