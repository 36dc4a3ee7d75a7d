#include <fmt/core.h>
#include <libusb.h>

#include <algorithm>
#include <array>
#include <deque>
#include <vector>

#include "engine/base/error.h"
#include "pipeline/acquire/transport/transport.h"

namespace touchtrace {
namespace {

constexpr int num_transfers = 8, transfer_bytes = 4096;
constexpr unsigned control_timeout_ms = 1000;
constexpr std::uint8_t request_type = 0x21;  // class request to an interface
constexpr std::uint8_t set_line_coding = 0x20, set_control_line_state = 0x22;

using Context = std::unique_ptr<libusb_context, decltype(&libusb_exit)>;
using DeviceHandle = std::unique_ptr<libusb_device_handle, decltype(&libusb_close)>;

struct Interfaces {
  int control = -1, data = -1;
  std::uint8_t in = 0, out = 0;  ///< bulk endpoints
};

Error usb_error(const std::string& what, int result) {
  return data_error(fmt::format("{}: {}", what, libusb_error_name(result)),
                    "check with `lsusb` and `touchtrace doctor`; or give the device's tty");
}

void require(int result, const char* what) {
  if (result < 0) throw usb_error(what, result);
}

Interfaces find_interfaces(libusb_device_handle* device) {
  libusb_config_descriptor* found = nullptr;
  require(libusb_get_active_config_descriptor(libusb_get_device(device), &found),
          "cannot read the USB configuration");
  const std::unique_ptr<libusb_config_descriptor, decltype(&libusb_free_config_descriptor)> config(
      found, &libusb_free_config_descriptor);
  Interfaces interfaces;
  for (const auto& item : std::span(config->interface, config->bNumInterfaces)) {
    if (item.num_altsetting < 1) continue;
    const libusb_interface_descriptor& setting = item.altsetting[0];
    if (setting.bInterfaceClass == LIBUSB_CLASS_COMM) interfaces.control = setting.bInterfaceNumber;
    if (setting.bInterfaceClass != LIBUSB_CLASS_DATA) continue;
    interfaces.data = setting.bInterfaceNumber;
    for (const auto& endpoint : std::span(setting.endpoint, setting.bNumEndpoints))
      (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_IN ? interfaces.in : interfaces.out) =
          endpoint.bEndpointAddress;
  }
  if (interfaces.data < 0 || interfaces.in == 0)
    throw data_error("the USB device is not a CDC-ACM serial port",
                     "bridges such as CH340, CP210x or FTDI are read through their tty");
  return interfaces;
}

/// Bytes that arrived together.
struct Piece {
  std::vector<std::uint8_t> bytes;
  double time_s;
};

class UsbSerial : public Transport {
 public:
  UsbSerial(std::uint16_t vendor, std::uint16_t product, const SerialLine& line)
      : context_(new_context()),
        device_(libusb_open_device_with_vid_pid(context_.get(), vendor, product), &libusb_close) {
    if (!device_)
      throw data_error(fmt::format("cannot open the USB device {:04x}:{:04x}", vendor, product),
                       "check with `lsusb` that it is connected, and with `touchtrace doctor` that "
                       "you may open it");
    libusb_set_auto_detach_kernel_driver(device_.get(), 1);
    interfaces_ = find_interfaces(device_.get());
    if (interfaces_.control >= 0)
      require(libusb_claim_interface(device_.get(), interfaces_.control),
              "cannot claim the USB device");
    require(libusb_claim_interface(device_.get(), interfaces_.data), "cannot claim the USB device");
    configure(line);
    for (Transfer& transfer : transfers_) start(transfer);
  }

  ~UsbSerial() override {
    is_closing_ = true;
    for (Transfer& transfer : transfers_)
      if (transfer.is_in_flight) libusb_cancel_transfer(transfer.handle.get());
    while (std::ranges::any_of(transfers_, &Transfer::is_in_flight))
      if (handle_events(0.1) != LIBUSB_SUCCESS) break;
    libusb_release_interface(device_.get(), interfaces_.data);
    if (interfaces_.control >= 0) libusb_release_interface(device_.get(), interfaces_.control);
  }

  Reading read(std::span<std::uint8_t> buffer, double timeout_s) override {
    if (pieces_.empty()) handle_events(timeout_s);
    if (std::exchange(is_stalled_, false)) restart();
    if (pieces_.empty())
      return {is_unplugged_ ? Reading::Status::unplugged : Reading::Status::timeout};
    Piece& piece = pieces_.front();
    const std::size_t size = std::min(buffer.size(), piece.bytes.size());
    std::copy_n(piece.bytes.begin(), size, buffer.begin());
    const Reading reading{Reading::Status::data, size, piece.time_s};
    piece.bytes.erase(piece.bytes.begin(), piece.bytes.begin() + static_cast<std::ptrdiff_t>(size));
    if (piece.bytes.empty()) pieces_.pop_front();
    return reading;
  }

  void write(std::string_view bytes) override {
    if (interfaces_.out == 0) return;
    std::string copy(bytes);
    libusb_bulk_transfer(device_.get(), interfaces_.out,
                         reinterpret_cast<unsigned char*>(copy.data()),
                         static_cast<int>(copy.size()), nullptr, control_timeout_ms);
  }

 private:
  struct Transfer {
    UsbSerial* owner = nullptr;
    std::unique_ptr<libusb_transfer, decltype(&libusb_free_transfer)> handle{
        libusb_alloc_transfer(0), &libusb_free_transfer};
    std::array<unsigned char, transfer_bytes> buffer;
    bool is_in_flight = false;
  };

  static Context new_context() {
    libusb_context* context = nullptr;
    require(libusb_init(&context), "cannot use USB");
    return {context, &libusb_exit};
  }

  int handle_events(double timeout_s) {
    timeval timeout{0, static_cast<suseconds_t>(1e6 * std::min(timeout_s, 0.9))};
    return libusb_handle_events_timeout_completed(context_.get(), &timeout, nullptr);
  }

  /// Baud rate, 8N1, DTR and RTS. Devices that ignore them refuse the requests.
  void configure(const SerialLine& line) {
    const auto baud = static_cast<std::uint32_t>(line.baud);
    unsigned char coding[7] = {0, 0, 0, 0, 0, 0, 8};
    for (int i = 0; i < 4; ++i) coding[i] = static_cast<unsigned char>(baud >> (8 * i));
    const auto index = static_cast<std::uint16_t>(std::max(0, interfaces_.control));
    libusb_control_transfer(device_.get(), request_type, set_line_coding, 0, index, coding,
                            sizeof coding, control_timeout_ms);
    libusb_control_transfer(device_.get(), request_type, set_control_line_state,
                            line.holds_lines_low ? 0 : 3, index, nullptr, 0, control_timeout_ms);
  }

  void start(Transfer& transfer) {
    transfer.owner = this;
    libusb_fill_bulk_transfer(transfer.handle.get(), device_.get(), interfaces_.in,
                              transfer.buffer.data(), transfer_bytes, &UsbSerial::on_completion,
                              &transfer, 0);
    submit(transfer);
  }

  void submit(Transfer& transfer) {
    transfer.is_in_flight = libusb_submit_transfer(transfer.handle.get()) == LIBUSB_SUCCESS;
    is_unplugged_ |= !transfer.is_in_flight;
  }

  static void LIBUSB_CALL on_completion(libusb_transfer* done) {
    Transfer& transfer = *static_cast<Transfer*>(done->user_data);
    transfer.is_in_flight = false;
    transfer.owner->complete(transfer);
  }

  void complete(Transfer& transfer) {
    const libusb_transfer& done = *transfer.handle;
    if (done.actual_length > 0)
      pieces_.push_back({{done.buffer, done.buffer + done.actual_length}, monotonic_s()});
    if (is_closing_) return;
    if (done.status == LIBUSB_TRANSFER_COMPLETED || done.status == LIBUSB_TRANSFER_TIMED_OUT)
      submit(transfer);
    else if (done.status == LIBUSB_TRANSFER_STALL)
      is_stalled_ = true;
    else
      is_unplugged_ = true;  // LIBUSB_TRANSFER_ERROR, too: most hosts report an unplug so
  }

  /// Clears a stall, which must not happen in a callback, and starts the stopped transfers.
  void restart() {
    if (libusb_clear_halt(device_.get(), interfaces_.in) != LIBUSB_SUCCESS) is_unplugged_ = true;
    for (Transfer& transfer : transfers_)
      if (!transfer.is_in_flight && !is_unplugged_) submit(transfer);
  }

  Context context_;
  DeviceHandle device_;
  Interfaces interfaces_;
  std::deque<Piece> pieces_;
  bool is_unplugged_ = false, is_stalled_ = false, is_closing_ = false;
  std::array<Transfer, num_transfers> transfers_;
};

}  // namespace

std::unique_ptr<Transport> open_usb(std::uint16_t vendor, std::uint16_t product,
                                    const SerialLine& line) {
  return std::make_unique<UsbSerial>(vendor, product, line);
}

}  // namespace touchtrace
