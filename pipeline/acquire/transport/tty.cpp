#include <asm/termbits.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "engine/base/error.h"
#include "pipeline/acquire/transport/transport.h"

namespace touchtrace {
namespace {

class Tty : public Transport {
 public:
  Tty(const std::string& path, const SerialLine& line)
      : file_(open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
    try {
      require(file_ >= 0, path);
      configure(path, line);
    } catch (...) {
      if (file_ >= 0) close(file_);
      throw;
    }
  }
  ~Tty() override { close(file_); }

  Reading read(std::span<std::uint8_t> buffer, double timeout_s) override {
    pollfd event{file_, POLLIN, 0};
    if (poll(&event, 1, static_cast<int>(1e3 * timeout_s)) <= 0) return {Reading::Status::timeout};
    const ssize_t size = ::read(file_, buffer.data(), buffer.size());
    if (size > 0) return {Reading::Status::data, static_cast<std::size_t>(size), monotonic_s()};
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) return {Reading::Status::timeout};
    return {Reading::Status::unplugged};
  }

  void write(std::string_view bytes) override {
    [[maybe_unused]] const ssize_t written = ::write(file_, bytes.data(), bytes.size());
  }

 private:
  static void require(bool condition, const std::string& path) {
    if (condition) return;
    throw data_error(fmt::format("cannot open the serial port {}: {}", path, std::strerror(errno)),
                     errno == EACCES ? "run `sudo usermod -aG dialout $USER`, then log in again"
                                     : "check the name; `touchtrace doctor` lists serial ports");
  }

  void configure(const std::string& path, const SerialLine& line) const {
    termios2 settings{};
    require(ioctl(file_, TCGETS2, &settings) == 0, path);
    settings.c_iflag = IGNBRK;
    settings.c_oflag = settings.c_lflag = 0;
    settings.c_cflag = CS8 | CREAD | CLOCAL | BOTHER;
    if (!line.holds_lines_low) settings.c_cflag |= HUPCL;
    settings.c_ispeed = settings.c_ospeed = static_cast<unsigned>(line.baud);
    settings.c_cc[VMIN] = settings.c_cc[VTIME] = 0;
    require(ioctl(file_, TCSETS2, &settings) == 0, path);
    const int lines = TIOCM_DTR | TIOCM_RTS;
    if (line.holds_lines_low) ioctl(file_, TIOCMBIC, &lines);  // a pseudo-terminal has no lines
    ioctl(file_, TCFLSH, TCIFLUSH);
  }

  int file_;
};

}  // namespace

std::unique_ptr<Transport> open_tty(const std::string& path, const SerialLine& line) {
  return std::make_unique<Tty>(path, line);
}

}  // namespace touchtrace
