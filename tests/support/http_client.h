#pragma once

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>

namespace touchtrace::testing {

/// Client of a port of this machine. Reading gives up after 5 s.
class HttpClient {
 public:
  /// Connects and sends `bytes`.
  HttpClient(int port, const std::string& bytes) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval limit{5, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    EXPECT_EQ(connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
  }
  ~HttpClient() { close(socket_); }
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;

  /// Reads until the end, or until `text` has come. Returns all that has been received.
  const std::string& read(const std::string& text = "") {
    char buffer[4096];
    while (text.empty() || received_.find(text) == std::string::npos) {
      const ssize_t n = recv(socket_, buffer, sizeof buffer, 0);
      if (n <= 0) break;
      received_.append(buffer, static_cast<std::size_t>(n));
    }
    return received_;
  }

 private:
  int socket_;
  std::string received_;
};

/// Parts of an address "http://127.0.0.1:8000/token/".
struct PageAddress {
  explicit PageAddress(const std::string& url)
      : host(url.substr(7, url.find('/', 7) - 7)),
        root(url.substr(url.find('/', 7))),
        port(std::stoi(host.substr(host.find(':') + 1))) {}

  /// Request of a path below the page's.
  std::string get(const std::string& path) const {
    return "GET " + root + path + " HTTP/1.1\r\nHost: " + host + "\r\n\r\n";
  }

  std::string host, root;
  int port;
};

}  // namespace touchtrace::testing
