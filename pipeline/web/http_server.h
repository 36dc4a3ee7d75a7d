#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pipeline/web/event_feed.h"

namespace touchtrace {

struct HttpRequest {
  std::string method, path;  ///< path: without the token, "clips"
  std::string query;         ///< after the question mark
  std::string body;
};

struct HttpResponse {
  int status = 200;
  std::string type, body;
  /// Server-sent events (text/event-stream) that follow until the client leaves; nullptr: none.
  EventFeed* events = nullptr;
};

/// HTTP/1.1 server for one page on this machine: it listens on 127.0.0.1, and answers only requests
/// whose path begins with a random token and whose Host is this server. One thread serves all
/// clients, of which none waits for another. A client that is slow to read events gets only the
/// newest. Requests are limited to 1 MiB, clients to 32.
class HttpServer {
 public:
  using Handler = std::function<HttpResponse(const HttpRequest&)>;

  /// `port` 0: any free port. Throws failure if the port cannot be used.
  explicit HttpServer(int port);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Address of the page, with the token.
  std::string url() const;
  /// Answers requests until `is_done()`, which is called at least every 100 ms.
  void run(const Handler& handle, const std::function<bool()>& is_done);

 private:
  struct Connection;

  /// Waits until something arrives or can be sent, at most 100 ms.
  void wait(const std::vector<Connection>& connections) const;
  void accept_client(std::vector<Connection>& connections) const;
  /// Answer to a request with the headers `head`.
  HttpResponse answer(const std::string& head, std::string body, const Handler& handle) const;
  /// Reads what has arrived and answers a complete request. Returns whether the connection stays
  /// open.
  bool receive(Connection& connection, const Handler& handle) const;
  bool serve(Connection& connection, const Handler& handle) const;

  int socket_ = -1, port_ = 0;
  std::string token_;
};

}  // namespace touchtrace
