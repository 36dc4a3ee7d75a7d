#include "pipeline/web/http_server.h"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t max_request_bytes = 1u << 20;
constexpr std::size_t max_connections = 32;
constexpr auto patience = std::chrono::seconds(10);
constexpr int poll_ms = 100, event_buffer_bytes = 16384;

std::string random_token() {
  std::random_device random;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", random());
  return token;
}

HttpResponse plain(int status, std::string text) { return {status, "text/plain", std::move(text)}; }

/// Value of a header; empty: missing. `head` has lower-case names.
std::string header(const std::string& head, const std::string& name) {
  const auto start = head.find("\r\n" + name + ":");
  if (start == std::string::npos) return {};
  const auto value = head.find_first_not_of(' ', start + name.size() + 3);
  return head.substr(value, head.find("\r\n", value) - value);
}

/// Bytes of the body; nullopt: not a number, or too many.
std::optional<std::size_t> body_size(const std::string& head) {
  const std::string text = header(head, "content-length");
  std::size_t size = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), size);
  if (text.empty()) return 0;
  if (fault != std::errc{} || end != text.data() + text.size() || size > max_request_bytes)
    return std::nullopt;
  return size;
}

/// Request line as it is, names of headers in lower case.
std::string lower_case_names(std::string head) {
  bool is_name = false;
  for (std::size_t i = head.find("\r\n"); i < head.size(); ++i) {
    if (head[i] == '\n') is_name = true;
    if (head[i] == ':') is_name = false;
    if (is_name) head[i] = static_cast<char>(std::tolower(static_cast<unsigned char>(head[i])));
  }
  return head;
}

/// Head and body of an answer.
std::string to_bytes(const HttpResponse& response) {
  const std::string length =
      response.events ? "" : fmt::format("Content-Length: {}\r\n", response.body.size());
  return fmt::format(
             "HTTP/1.1 {} {}\r\nContent-Type: {}\r\n{}"
             "Connection: close\r\nCache-Control: no-store\r\n"
             "X-Content-Type-Options: nosniff\r\n"
             "Referrer-Policy: no-referrer\r\n\r\n",
             response.status, response.status == 200 ? "OK" : "Error", response.type, length) +
         response.body;
}

}  // namespace

/// Client that sends a request, gets the answer, and then events or the end.
struct HttpServer::Connection {
  explicit Connection(int client) : socket(client) {}
  ~Connection() {
    if (events) events->remove_reader();
    if (socket >= 0) close(socket);
  }
  Connection(Connection&& other) noexcept { *this = std::move(other); }
  Connection& operator=(Connection&& other) noexcept {
    std::swap(socket, other.socket), std::swap(received, other.received);
    std::swap(outgoing, other.outgoing), std::swap(sent, other.sent);
    std::swap(events, other.events), std::swap(event_number, other.event_number);
    deadline = other.deadline, is_answered = other.is_answered;
    return *this;
  }

  bool has_sent_all() const { return sent == outgoing.size(); }

  /// Events of poll() that make progress possible.
  short awaited() const {
    if (!is_answered || (events && has_sent_all())) return POLLIN;
    return POLLOUT;
  }

  void start_answer(const HttpResponse& response) {
    is_answered = true;
    deadline = Clock::now() + patience;
    outgoing = to_bytes(response);
    events = response.events;
    if (!events) return;
    events->add_reader();
    event_number = events->number();
    // A large buffer would fill with old events while the client is busy.
    setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &event_buffer_bytes, sizeof event_buffer_bytes);
  }

  /// Prepares the newest event, unless one is still being sent.
  void queue_event() {
    if (!events || !has_sent_all() || events->number() == event_number) return;
    const EventFeed::Event event = events->newest();
    event_number = event.number;
    outgoing = "data: " + event.text + "\n\n";
    sent = 0;
    deadline = Clock::now() + patience;
  }

  /// Discards what a reader of events sends. False: it is gone.
  bool is_open() const {
    std::array<char, 256> ignored;
    const auto n = recv(socket, ignored.data(), ignored.size(), MSG_DONTWAIT);
    return n > 0 || (n < 0 && (errno == EAGAIN || errno == EINTR));
  }

  /// Sends as much as the client takes without waiting. False: it is gone.
  bool send_some() {
    while (!has_sent_all()) {
      const auto n =
          send(socket, outgoing.data() + sent, outgoing.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (n < 0) return errno == EAGAIN || errno == EINTR;
      sent += static_cast<std::size_t>(n);
      deadline = Clock::now() + patience;
    }
    return true;
  }

  int socket = -1;
  Clock::time_point deadline = Clock::now() + patience;
  std::string received, outgoing;
  std::size_t sent = 0;  ///< bytes of `outgoing`
  bool is_answered = false;
  EventFeed* events = nullptr;
  std::uint64_t event_number = 0;  ///< of the last event that was prepared or is too old
};

HttpServer::HttpServer(int port) : token_(random_token()) {
  socket_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  auto* const any = reinterpret_cast<sockaddr*>(&address);
  if (socket_ < 0 || bind(socket_, any, size) != 0 || listen(socket_, 16) != 0 ||
      getsockname(socket_, any, &size) != 0) {
    const std::string fault = std::strerror(errno);
    if (socket_ >= 0) close(socket_);
    throw failure(fmt::format("cannot listen on port {} of 127.0.0.1: {}", port, fault),
                  "choose another with --port");
  }
  port_ = ntohs(address.sin_port);
}

HttpServer::~HttpServer() { close(socket_); }

std::string HttpServer::url() const {
  return fmt::format("http://127.0.0.1:{}/{}/", port_, token_);
}

HttpResponse HttpServer::answer(const std::string& head, std::string body,
                                const Handler& handle) const {
  const std::string host = header(head, "host");
  if (host != fmt::format("127.0.0.1:{}", port_) && host != fmt::format("localhost:{}", port_))
    return plain(403, "wrong host");
  const auto method_end = head.find(' '), target_end = head.find(' ', method_end + 1);
  const std::string target = head.substr(method_end + 1, target_end - method_end - 1);
  const std::string root = "/" + token_ + "/";
  if (!target.starts_with(root)) return plain(404, "not found");
  const auto question = target.find('?');
  const std::string path = target.substr(root.size(), question - root.size());
  return handle({head.substr(0, method_end), path,
                 question == std::string::npos ? "" : target.substr(question + 1),
                 std::move(body)});
}

bool HttpServer::receive(Connection& connection, const Handler& handle) const {
  std::array<char, 1 << 16> buffer;
  const auto n = recv(connection.socket, buffer.data(), buffer.size(), MSG_DONTWAIT);
  if (n < 0) return errno == EAGAIN || errno == EINTR;
  if (n == 0) return false;
  std::string& received = connection.received;
  received.append(buffer.data(), static_cast<std::size_t>(n));
  const auto end = received.find("\r\n\r\n");
  if (end == std::string::npos) return received.size() < max_request_bytes;
  const std::string head = lower_case_names(received.substr(0, end + 2));
  const auto size = body_size(head);
  if (size && received.size() < end + 4 + *size) return true;
  connection.start_answer(size ? answer(head, received.substr(end + 4, *size), handle)
                               : plain(400, "invalid length"));
  return true;
}

bool HttpServer::serve(Connection& connection, const Handler& handle) const {
  if (!connection.is_answered && !receive(connection, handle)) return false;
  if (connection.events && !connection.is_open()) return false;
  connection.queue_event();
  if (!connection.send_some()) return false;
  if (connection.is_answered && connection.has_sent_all()) return connection.events != nullptr;
  return Clock::now() < connection.deadline;
}

void HttpServer::wait(const std::vector<Connection>& connections) const {
  const bool is_full = connections.size() >= max_connections;
  std::vector<pollfd> polled{{is_full ? -1 : socket_, POLLIN, 0}};
  std::vector<const EventFeed*> feeds;
  for (const Connection& each : connections) {
    polled.push_back({each.socket, each.awaited(), 0});
    if (each.events && std::ranges::count(feeds, each.events) == 0) feeds.push_back(each.events);
  }
  for (const EventFeed* feed : feeds) polled.push_back({feed->descriptor(), POLLIN, 0});
  poll(polled.data(), polled.size(), poll_ms);
  for (const EventFeed* feed : feeds) feed->acknowledge();
}

void HttpServer::accept_client(std::vector<Connection>& connections) const {
  if (connections.size() >= max_connections) return;
  const int client = accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC);
  if (client >= 0) connections.emplace_back(client);
}

void HttpServer::run(const Handler& handle, const std::function<bool()>& is_done) {
  std::vector<Connection> connections;
  while (!is_done()) {
    wait(connections);
    accept_client(connections);
    std::erase_if(connections, [&](Connection& each) { return !serve(each, handle); });
  }
}

}  // namespace touchtrace
