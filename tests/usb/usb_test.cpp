// The USB transport against a device that umockdev emulates: libusb's own code, without a kernel.
#include <gtest/gtest.h>

#include <cerrno>

#include "engine/base/error.h"
#include "pipeline/acquire/transport/transport.h"
#include "tests/usb/emulated_serial.h"

namespace touchtrace {
namespace {

using testing::EmulatedSerial;
using Status = Reading::Status;

constexpr const char* port_name = "usb:2341:0043";

/// Reads until `size` bytes have arrived, or something else happens; for 2 s at most.
std::string read_bytes(Transport& port, std::size_t size, Status& last) {
  std::string bytes;
  std::vector<std::uint8_t> buffer(100);
  for (const double end_s = monotonic_s() + 2.0; bytes.size() < size && monotonic_s() < end_s;) {
    const Reading reading = port.read(buffer, 0.05);
    last = reading.status;
    if (last == Status::unplugged) break;
    bytes.append(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(reading.bytes));
  }
  return bytes;
}

/// 100 packets of 63 to 219 bytes.
std::vector<std::string> packets() {
  std::vector<std::string> all;
  for (std::size_t i = 0; i < 100; ++i) all.emplace_back(63 + 37 * i % 157, static_cast<char>(i));
  return all;
}

TEST(Usb, ReadsPacketsInOrder) {
  EmulatedSerial device;
  const auto port = open_port(port_name, {921'600});
  std::string sent;
  for (const auto& packet : packets()) device.send(packet), sent += packet;
  Status last{};
  EXPECT_EQ(read_bytes(*port, sent.size(), last), sent);
  EXPECT_GE(device.max_pending(), 4u);
}

TEST(Usb, SetsTheLineAndWrites) {
  EmulatedSerial device;
  const auto port = open_port(port_name, {250'000, true});
  EXPECT_EQ(device.baud(), 250'000);
  EXPECT_EQ(device.lines(), 0);
  port->write("a");
  EXPECT_EQ(device.received(), "a");
}

TEST(Usb, RestartsAfterAStall) {
  EmulatedSerial device;
  const auto port = open_port(port_name, {});
  device.send("before");
  device.fail(-EPIPE);
  device.send("after");
  Status last{};
  EXPECT_EQ(read_bytes(*port, 11, last), "beforeafter");
  std::vector<std::uint8_t> buffer(100);
  for (int i = 0; i < 5; ++i) port->read(buffer, 0.05);
  EXPECT_GE(device.num_cleared_stalls(), 1);
  EXPECT_EQ(device.num_pending(), device.max_pending());
}

TEST(Usb, NoticesThatTheDeviceIsUnplugged) {
  for (const int status : {-ESHUTDOWN, -EPROTO, -ENODEV}) {
    EmulatedSerial device;
    const auto port = open_port(port_name, {});
    device.send("last");
    device.fail(status);
    Status last{};
    EXPECT_EQ(read_bytes(*port, 100, last), "last");
    EXPECT_EQ(last, Status::unplugged) << status;
  }
}

TEST(Usb, CancelsItsTransfersWhenItIsClosed) {
  EmulatedSerial device;
  { const auto port = open_port(port_name, {}); }
  EXPECT_EQ(device.num_pending(), 0u);
  EXPECT_GE(device.max_pending(), 4u);
}

}  // namespace
}  // namespace touchtrace
