#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

// GLib's types, which only emulated_serial.cpp needs.
using UMockdevTestbed = struct _UMockdevTestbed;
using UMockdevIoctlBase = struct _UMockdevIoctlBase;
using UMockdevIoctlClient = struct _UMockdevIoctlClient;
using UMockdevIoctlData = struct _UMockdevIoctlData;

namespace touchtrace::testing {

/// USB device of class CDC-ACM, 2341:0043, emulated by umockdev.
class EmulatedSerial {
 public:
  EmulatedSerial();
  ~EmulatedSerial();
  EmulatedSerial(const EmulatedSerial&) = delete;
  EmulatedSerial& operator=(const EmulatedSerial&) = delete;

  /// Sends one packet to the host.
  void send(const std::string& packet) { answer({packet, 0}); }
  /// Ends the next transfer with an error of the kernel, such as -EPIPE (stall) or -EPROTO.
  void fail(int status) { answer({"", status}); }

  std::string received() const;  ///< bulk data of the host
  int baud() const;              ///< that the host has set; 0: none
  int lines() const;             ///< DTR and RTS that the host has set
  int num_cleared_stalls() const;
  std::size_t num_pending() const;  ///< transfers that wait for data
  std::size_t max_pending() const;

  /// Called by the emulation for each system call.
  bool handle(UMockdevIoctlClient* client);

 private:
  struct Answer {
    std::string bytes;
    int status;
  };
  struct Transfer {
    UMockdevIoctlData* urb;
    Answer answer;
  };

  void answer(Answer answer);
  void submit(UMockdevIoctlClient* client);
  void reap(UMockdevIoctlClient* client);
  void discard(UMockdevIoctlClient* client);
  void write(const std::string& bytes, bool is_control);
  void match();

  UMockdevTestbed* testbed_;
  UMockdevIoctlBase* handler_;
  mutable std::mutex mutex_;
  std::deque<UMockdevIoctlData*> pending_;
  std::deque<Answer> answers_;
  std::deque<Transfer> done_;
  std::string received_;
  int baud_ = 0, lines_ = -1, cleared_stalls_ = 0;
  std::size_t max_pending_ = 0;
};

}  // namespace touchtrace::testing
