#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <thread>

#include "engine/base/error.h"
#include "pipeline/mark/http_server.h"
#include "pipeline/mark/mark_session.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace {
namespace {

using testing::sample_recording;
using testing::TemporaryFolder;

TEST(Mark, WritesBoxesIntoTheRecording) {
  const TemporaryFolder folder;
  write(sample_recording(), folder / "a.h5");
  MarkSession session(folder / "a.h5", folder / "a.h5", false);
  const std::size_t frame = session.frames_of(session.recording().clips[1]).first + 2;
  session.save({{1, frame, {0, 0, 4, 4}, {3, 2, 5, 4}}});
  session.save({{0, 1, {1, 1, 2, 2}, {4, 4, 2, 2}}});
  const RecordingReader reader(folder / "a.h5");
  const auto& clips = reader.recording().clips;
  EXPECT_EQ(clips[1].box_frame, frame);
  EXPECT_EQ(clips[1].object_box.width, 5);
  EXPECT_EQ(clips[0].hand_box.x, 1);
  EXPECT_EQ(clips[0].object, "ball");
  EXPECT_EQ(reader.read_camera_frame(frame).color, sample_recording().frames[frame].color);
  EXPECT_EQ(session.state()["clips"][1]["object"], nlohmann::json({3, 2, 5, 4}));
}

TEST(Mark, RefusesImplausibleBoxes) {
  const TemporaryFolder folder;
  write(sample_recording(), folder / "a.h5");
  MarkSession session(folder / "a.h5", folder / "b.h5", false);
  const auto expect_rejected = [&](const ClipBoxes& boxes, const std::string& text) {
    try {
      session.save({boxes});
      ADD_FAILURE() << "accepted, instead of " << text;
    } catch (const Error& error) {
      EXPECT_NE((std::string(error.what()) + error.hint()).find(text), std::string::npos)
          << error.what() << "; " << error.hint();
    }
  };
  const PixelBox good{1, 1, 2, 2};
  expect_rejected({0, 0, {5, 1, 4, 2}, good}, "leaves the image of 8 x 6");
  expect_rejected({0, 0, {3, 2, 8, 6}, good}, "did you write corners");
  expect_rejected({0, 0, {1, 1, 2147483647, 2}, good}, "leaves the image");
  expect_rejected({0, 0, good, {-1, 0, 3, 3}}, "leaves the image");
  expect_rejected({0, 0, good, {0, 0, 0, 3}}, "a box is empty");
  expect_rejected({0, 0, good, good}, "are the same");
  expect_rejected({0, 1000, good, {4, 4, 2, 2}}, "box_frame");
  expect_rejected({2, 0, good, {4, 4, 2, 2}}, "clip 2");
  EXPECT_FALSE(std::filesystem::exists(folder / "b.h5"));
  EXPECT_THROW(parse_box("1,2,3"), Error);
  EXPECT_THROW(parse_box("1,2,3,4.5"), Error);
  EXPECT_EQ(parse_box("1,2,3,4").height, 4);
}

/// Sends bytes to a port of this machine. Returns what comes back.
std::string ask_server(int port, const std::string& bytes) {
  const int client = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string answer;
  if (connect(client, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0 &&
      send(client, bytes.data(), bytes.size(), MSG_NOSIGNAL) > 0) {
    char buffer[4096];
    for (ssize_t n; (n = recv(client, buffer, sizeof(buffer), 0)) > 0;)
      answer.append(buffer, static_cast<std::size_t>(n));
  }
  close(client);
  return answer;
}

TEST(HttpServer, AnswersOnlyItsOwnPage) {
  HttpServer server(0);
  const std::string url = server.url(), host = url.substr(7, url.find('/', 7) - 7),
                    root = url.substr(url.find('/', 7));
  const int port = std::stoi(host.substr(host.find(':') + 1));
  bool is_done = false;
  std::thread thread([&] {
    server.run(
        [&](const HttpRequest& request) -> HttpResponse {
          is_done = request.path == "end";
          return {200, "text/plain", request.method + request.query + request.body};
        },
        [&] { return is_done; });
  });
  const auto get = [&](const std::string& line, const std::string& name,
                       const std::string& rest = "") {
    return ask_server(port, line + " HTTP/1.1\r\nHost: " + name + "\r\n" + rest + "\r\n");
  };
  EXPECT_NE(get("GET " + root + "x?7", host).find("GET7"), std::string::npos);
  EXPECT_NE(get("GET /x", host).find(" 404 "), std::string::npos);
  EXPECT_NE(get("GET /" + std::string(32, '0') + "/x", host).find(" 404 "), std::string::npos);
  EXPECT_NE(get("GET " + root, "example.org").find(" 403 "), std::string::npos);
  EXPECT_NE(get("POST " + root, host, "Content-Length: 99999999999\r\n").find(" 400 "),
            std::string::npos);
  EXPECT_NE(get("POST " + root, host, "content-length: 2\r\n\r\nok").find("POSTok"),
            std::string::npos);
  EXPECT_NE(ask_server(port, "\r\n\r\n").find(" 403 "), std::string::npos);
  EXPECT_NE(get("POST " + root + "end", host).find(" 200 "), std::string::npos);
  thread.join();
}

}  // namespace
}  // namespace touchtrace
