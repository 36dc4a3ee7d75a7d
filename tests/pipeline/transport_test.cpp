#include "pipeline/acquire/transport/transport.h"

#include <gtest/gtest.h>

#include "engine/base/error.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/pseudo_terminal.h"

namespace touchtrace {
namespace {

using testing::PseudoTerminal;
using testing::TemporaryFolder;
using Status = Reading::Status;

/// Reads until the transport ends, is unplugged or has nothing for `timeout_s`.
std::string read_all(Transport& transport, double timeout_s, Status& last) {
  std::string bytes;
  std::vector<std::uint8_t> buffer(1000);
  for (;;) {
    const Reading reading = transport.read(buffer, timeout_s);
    last = reading.status;
    if (last != Status::data) return bytes;
    bytes.append(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(reading.bytes));
  }
}

/// Every byte value, so that a port which is not raw fails.
std::string all_bytes() {
  std::string bytes;
  for (int i = 0; i < 1024; ++i) bytes += static_cast<char>(i);
  return bytes;
}

TEST(Transport, TtyPassesAllBytesInBothDirections) {
  const PseudoTerminal device;
  for (const int baud : {250'000, 921'600, 1'000'000, 2'000'000}) {
    const auto port = open_tty(device.path(), {baud, true});
    ASSERT_TRUE(device.send(all_bytes()));
    Status last{};
    EXPECT_EQ(read_all(*port, 0.1, last), all_bytes());
    EXPECT_EQ(last, Status::timeout);
    port->write("a");
    EXPECT_EQ(device.receive(), "a");
  }
}

TEST(Transport, TtyStampsBytesWithTheTimeOfArrival) {
  const PseudoTerminal device;
  const auto port = open_tty(device.path(), {});
  const double before_s = monotonic_s();
  ASSERT_TRUE(device.send("x"));
  std::vector<std::uint8_t> buffer(10);
  const Reading reading = port->read(buffer, 1.0);
  EXPECT_GE(reading.time_s, before_s);
  EXPECT_LE(reading.time_s, monotonic_s());
}

TEST(Transport, TtyNoticesThatTheDeviceIsUnplugged) {
  PseudoTerminal device;
  const auto port = open_tty(device.path(), {});
  device.unplug();
  Status last{};
  EXPECT_EQ(read_all(*port, 0.1, last), "");
  EXPECT_EQ(last, Status::unplugged);
  EXPECT_THROW(open_tty(device.path(), {}), Error);
}

TEST(Transport, TtyRefusesAFileThatIsNotATerminal) {
  EXPECT_THROW(open_tty("/dev/null", {}), Error);
}

TEST(Transport, ReplayPassesOnAllBytesAndEnds) {
  const TemporaryFolder folder;
  testing::put(folder / "glove.bin", all_bytes());
  const auto port = open_port((folder / "glove.bin").string(), {});
  Status last{};
  EXPECT_EQ(read_all(*port, 0.1, last), all_bytes());
  EXPECT_EQ(last, Status::ended);
}

TEST(Transport, UsbPortsNeedTwoHexadecimalNumbers) {
  for (const char* port : {"usb:", "usb:2341", "usb:2341:xyz", "usb:2341:0043:1"})
    EXPECT_THROW(open_port(port, {}), Error) << port;
}

TEST(Transport, UsbDeviceThatIsNotConnectedIsAnError) {
  EXPECT_THROW(open_port("usb:ffff:fffe", {}), Error);
}

}  // namespace
}  // namespace touchtrace
