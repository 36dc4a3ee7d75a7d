#include "tests/usb/emulated_serial.h"

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <umockdev.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <stdexcept>

namespace touchtrace::testing {
namespace {

constexpr const char* node = "/dev/bus/usb/001/002";
constexpr std::uint8_t bulk_in = 0x82;

/// Device, configuration, control interface with its interrupt endpoint, data interface with its
/// bulk endpoints.
constexpr const char* description =
    "P: /devices/usb1\n"
    "N: bus/usb/001/002\n"
    "E: BUSNUM=001\n"
    "E: DEVNAME=/dev/bus/usb/001/002\n"
    "E: DEVNUM=002\n"
    "E: DEVTYPE=usb_device\n"
    "E: DRIVER=usb\n"
    "E: MAJOR=189\n"
    "E: MINOR=1\n"
    "E: PRODUCT=2341/43/1\n"
    "E: SUBSYSTEM=usb\n"
    "A: bConfigurationValue=1\\n\n"
    "A: busnum=1\\n\n"
    "A: devnum=2\\n\n"
    "A: speed=12\\n\n"
    "H: descriptors="
    "120100020200004041234300010000000001"
    "090230000201008032"
    "0904000001020201000705810308000a"
    "09040100020a00000007058202400000"
    "07050302400000\n";

gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, void* device) {
  return static_cast<EmulatedSerial*>(device)->handle(client);
}

UMockdevIoctlData* resolve(UMockdevIoctlData* data, std::size_t offset, std::size_t size) {
  return umockdev_ioctl_data_resolve(data, offset, size, nullptr);
}

const usbdevfs_urb& contents(UMockdevIoctlData* urb) {
  return *reinterpret_cast<const usbdevfs_urb*>(urb->data);
}

template <class Value>
void update(UMockdevIoctlData* data, std::size_t offset, Value value) {
  umockdev_ioctl_data_update(data, offset, reinterpret_cast<guint8*>(&value), sizeof value);
}

/// Buffer of a transfer; nullptr if it is empty.
UMockdevIoctlData* buffer_of(UMockdevIoctlData* urb) {
  const int size = contents(urb).buffer_length;
  return size > 0 ? resolve(urb, offsetof(usbdevfs_urb, buffer), static_cast<std::size_t>(size))
                  : nullptr;
}

}  // namespace

EmulatedSerial::EmulatedSerial()
    : testbed_(umockdev_testbed_new()),
      handler_(UMOCKDEV_IOCTL_BASE(g_object_new(UMOCKDEV_TYPE_IOCTL_BASE, nullptr))) {
  g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(on_ioctl), this);
  GError* error = nullptr;
  if (!umockdev_testbed_add_from_string(testbed_, description, &error) ||
      !umockdev_testbed_attach_ioctl(testbed_, node, handler_, &error))
    throw std::runtime_error(error->message);
}

EmulatedSerial::~EmulatedSerial() {
  umockdev_testbed_detach_ioctl(testbed_, node, nullptr);
  g_object_unref(handler_);
  g_object_unref(testbed_);
}

bool EmulatedSerial::handle(UMockdevIoctlClient* client) {
  const std::lock_guard lock(mutex_);
  UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
  switch (umockdev_ioctl_client_get_request(client)) {
    case USBDEVFS_GET_CAPABILITIES:
      update(resolve(argument, 0, sizeof(std::uint32_t)), 0, std::uint32_t{0});
      break;
    case USBDEVFS_SUBMITURB:
      submit(client);
      return true;
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY:
      reap(client);
      return true;
    case USBDEVFS_DISCARDURB:
      discard(client);
      return true;
    case USBDEVFS_GETDRIVER:
      umockdev_ioctl_client_complete(client, -1, ENODATA);
      return true;
    case USBDEVFS_CLEAR_HALT:
      ++cleared_stalls_;
      break;
    default:
      break;
  }
  umockdev_ioctl_client_complete(client, 0, 0);
  return true;
}

void EmulatedSerial::submit(UMockdevIoctlClient* client) {
  UMockdevIoctlData* urb = resolve(umockdev_ioctl_client_get_arg(client), 0, sizeof(usbdevfs_urb));
  if (contents(urb).endpoint == bulk_in) {
    pending_.push_back(urb);
    max_pending_ = std::max(max_pending_, pending_.size());
    match();
  } else {
    UMockdevIoctlData* buffer = buffer_of(urb);
    const auto size = static_cast<std::size_t>(contents(urb).buffer_length);
    const std::string bytes(buffer ? reinterpret_cast<const char*>(buffer->data) : "", size);
    write(bytes, contents(urb).type == USBDEVFS_URB_TYPE_CONTROL);
    done_.push_back({urb, {std::string(size, '\0'), 0}});
  }
  umockdev_ioctl_client_complete(client, 0, 0);
}

/// `bytes` of a control transfer: 8 of the request, then its data.
void EmulatedSerial::write(const std::string& bytes, bool is_control) {
  if (!is_control) {
    received_ += bytes;
    return;
  }
  std::uint32_t baud = 0;
  if (bytes.size() >= 12 && bytes[1] == 0x20) std::memcpy(&baud, &bytes[8], sizeof baud);
  if (baud > 0) baud_ = static_cast<int>(baud);
  if (bytes[1] == 0x22) lines_ = bytes[2];
}

void EmulatedSerial::reap(UMockdevIoctlClient* client) {
  if (done_.empty()) {
    umockdev_ioctl_client_complete(client, -1, EAGAIN);
    return;
  }
  const Transfer transfer = done_.front();
  done_.pop_front();
  update(transfer.urb, offsetof(usbdevfs_urb, status), transfer.answer.status);
  update(transfer.urb, offsetof(usbdevfs_urb, actual_length),
         static_cast<int>(transfer.answer.bytes.size()));
  std::string bytes = transfer.answer.bytes;
  if (contents(transfer.urb).endpoint == bulk_in && !bytes.empty())
    umockdev_ioctl_data_update(buffer_of(transfer.urb), 0, reinterpret_cast<guint8*>(bytes.data()),
                               static_cast<int>(bytes.size()));
  UMockdevIoctlData* result = resolve(umockdev_ioctl_client_get_arg(client), 0, sizeof(void*));
  umockdev_ioctl_data_set_ptr(result, 0, transfer.urb);
  umockdev_ioctl_client_complete(client, 0, 0);
}

void EmulatedSerial::discard(UMockdevIoctlClient* client) {
  UMockdevIoctlData* urb = resolve(umockdev_ioctl_client_get_arg(client), 0, sizeof(usbdevfs_urb));
  const auto found = std::ranges::find(pending_, urb->client_addr, &UMockdevIoctlData::client_addr);
  if (found == pending_.end()) {
    umockdev_ioctl_client_complete(client, -1, EINVAL);
    return;
  }
  done_.push_back({*found, {"", -ENOENT}});
  pending_.erase(found);
  umockdev_ioctl_client_complete(client, 0, 0);
}

void EmulatedSerial::answer(Answer answer) {
  const std::lock_guard lock(mutex_);
  answers_.push_back(std::move(answer));
  match();
}

/// Gives answers to the transfers that wait for them.
void EmulatedSerial::match() {
  for (; !answers_.empty() && !pending_.empty(); answers_.pop_front(), pending_.pop_front())
    done_.push_back({pending_.front(), answers_.front()});
}

std::string EmulatedSerial::received() const {
  const std::lock_guard lock(mutex_);
  return received_;
}
int EmulatedSerial::baud() const {
  const std::lock_guard lock(mutex_);
  return baud_;
}
int EmulatedSerial::lines() const {
  const std::lock_guard lock(mutex_);
  return lines_;
}
int EmulatedSerial::num_cleared_stalls() const {
  const std::lock_guard lock(mutex_);
  return cleared_stalls_;
}
std::size_t EmulatedSerial::num_pending() const {
  const std::lock_guard lock(mutex_);
  return pending_.size();
}
std::size_t EmulatedSerial::max_pending() const {
  const std::lock_guard lock(mutex_);
  return max_pending_;
}

}  // namespace touchtrace::testing
