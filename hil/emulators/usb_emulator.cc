#include "emulators/usb_emulator.h"

#include <fmt/format.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <umockdev.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace touchstone::hil {

// Shared with the handler, which umockdev calls from its own thread.
struct UsbEmulator::Testbed {
  struct Pending {
    UMockdevIoctlData* urb;  // the host's struct usbdevfs_urb
    gulong address;          // of that struct in the host, by which it is discarded
    bool done = false;
    int status = 0;
    std::vector<unsigned char> data;  // for the host
  };

  UMockdevTestbed* testbed = nullptr;
  UMockdevIoctlBase* handler = nullptr;
  UsbFaults* faults = nullptr;
  EmulatedUsbModel* model = nullptr;
  Identity identity;
  std::deque<Pending> pending;
  bool claimed = false;
  std::string node = "/dev/bus/usb/001/003";
  std::string syspath, description;
  bool plugged = false;

  void add();
  bool handle(UMockdevIoctlClient* client);
  bool submit(UMockdevIoctlClient* client, UMockdevIoctlData* arg);
  bool reap(UMockdevIoctlClient* client, UMockdevIoctlData* arg);
  void control(const usbdevfs_urb& urb, const std::vector<unsigned char>& buffer, Pending& p);
  std::vector<unsigned char> string_descriptor(unsigned index) const;
};

namespace {

template <class T>
std::optional<T> value_at(UMockdevIoctlData* arg) {
  GError* error = nullptr;
  g_autoptr(UMockdevIoctlData) data = umockdev_ioctl_data_resolve(arg, 0, sizeof(T), &error);
  g_clear_error(&error);
  if (data == nullptr || data->data_len < static_cast<gint>(sizeof(T))) return std::nullopt;
  T value;
  std::memcpy(&value, data->data, sizeof value);
  return value;
}

bool complete(UMockdevIoctlClient* client, long result, int error = 0) {
  umockdev_ioctl_client_complete(client, result, error);
  return true;
}

struct Handler {
  UMockdevIoctlBase parent;
  void* testbed;
};
struct HandlerClass {
  UMockdevIoctlBaseClass parent;
};

}  // namespace

std::vector<unsigned char> UsbEmulator::Testbed::string_descriptor(unsigned index) const {
  if (index == 0) return {4, 3, 0x09, 0x04};
  const std::string text = index == 1 ? "Emulated" : index == 2 ? identity.product_name : identity.serial;
  std::vector<unsigned char> bytes{static_cast<unsigned char>(2 + 2 * text.size()), 3};
  for (const char c : text) bytes.push_back(static_cast<unsigned char>(c)), bytes.push_back(0);
  return bytes;
}

void UsbEmulator::Testbed::control(const usbdevfs_urb& urb, const std::vector<unsigned char>& buffer, Pending& p) {
  p.done = true;
  if (buffer.size() < 8) {
    p.status = -EPIPE;
    return;
  }
  const unsigned type = buffer[0], request = buffer[1], value = buffer[2] | static_cast<unsigned>(buffer[3]) << 8U;
  if (type == 0x80 && request == 6 && value >> 8U == 3) {
    p.data = string_descriptor(value & 0xffU);
    p.data.resize(std::min<std::size_t>(p.data.size(), static_cast<std::size_t>(urb.buffer_length - 8)));
  } else if ((type & 0x60U) == 0x40U) {
    if (faults->stall) {
      p.status = -EPIPE;
    } else {
      model->control(request, value);
    }
  }
}

bool UsbEmulator::Testbed::submit(UMockdevIoctlClient* client, UMockdevIoctlData* arg) {
  GError* error = nullptr;
  UMockdevIoctlData* const urb_data = umockdev_ioctl_data_resolve(arg, 0, sizeof(usbdevfs_urb), &error);
  g_clear_error(&error);
  if (urb_data == nullptr) return complete(client, -1, EFAULT);
  usbdevfs_urb urb{};
  std::memcpy(&urb, urb_data->data, sizeof urb);
  std::vector<unsigned char> buffer;
  if (urb.buffer_length > 0) {
    g_autoptr(UMockdevIoctlData) data = umockdev_ioctl_data_resolve(urb_data, offsetof(usbdevfs_urb, buffer),
                                                                    static_cast<gsize>(urb.buffer_length), &error);
    g_clear_error(&error);
    if (data == nullptr) {
      g_object_unref(urb_data);
      return complete(client, -1, EFAULT);
    }
    buffer.assign(data->data, data->data + data->data_len);
  }
  Pending p{urb_data, urb_data->client_addr, false, 0, {}};
  if (urb.type == USBDEVFS_URB_TYPE_CONTROL) {
    control(urb, buffer, p);
  } else if (urb.type == USBDEVFS_URB_TYPE_BULK && faults->stall) {
    p.done = true;
    p.status = -EPIPE;
  } else if (urb.type == USBDEVFS_URB_TYPE_BULK && (urb.endpoint & 0x80) == 0) {
    p.done = true;
    model->received(buffer);
  }
  pending.push_back(std::move(p));
  return complete(client, 0);
}

bool UsbEmulator::Testbed::reap(UMockdevIoctlClient* client, UMockdevIoctlData* arg) {
  for (auto it = pending.begin(); it != pending.end(); ++it) {
    usbdevfs_urb urb{};
    std::memcpy(&urb, it->urb->data, sizeof urb);
    const bool in = urb.type == USBDEVFS_URB_TYPE_BULK && (urb.endpoint & 0x80) != 0;
    if (!it->done && in && !faults->silent) {
      if (auto packet = model->packet()) {
        if (faults->short_packets) packet->resize(std::min<std::size_t>(packet->size(), 7));
        it->data = std::move(*packet);
        it->done = true;
      }
    }
    if (!it->done) continue;
    GError* error = nullptr;
    const bool control_urb = urb.type == USBDEVFS_URB_TYPE_CONTROL;
    urb.actual_length = it->status != 0 ? 0 : in || control_urb ? static_cast<int>(it->data.size()) : urb.buffer_length;
    urb.status = it->status;
    if (!it->data.empty()) {
      g_autoptr(UMockdevIoctlData) buffer = umockdev_ioctl_data_resolve(it->urb, offsetof(usbdevfs_urb, buffer),
                                                                        static_cast<gsize>(urb.buffer_length), &error);
      g_clear_error(&error);
      if (buffer != nullptr)
        umockdev_ioctl_data_update(buffer, control_urb ? 8 : 0, it->data.data(), static_cast<gint>(it->data.size()));
    }
    umockdev_ioctl_data_update(it->urb, offsetof(usbdevfs_urb, status), reinterpret_cast<guint8*>(&urb.status),
                               sizeof urb.status);
    umockdev_ioctl_data_update(it->urb, offsetof(usbdevfs_urb, actual_length),
                               reinterpret_cast<guint8*>(&urb.actual_length), sizeof urb.actual_length);
    g_autoptr(UMockdevIoctlData) pointer = umockdev_ioctl_data_resolve(arg, 0, sizeof(void*), &error);
    g_clear_error(&error);
    if (pointer == nullptr) return complete(client, -1, EFAULT);
    umockdev_ioctl_data_set_ptr(pointer, 0, it->urb);
    g_object_unref(it->urb);
    pending.erase(it);
    return complete(client, 0);
  }
  if (faults->gone) return complete(client, -1, ENODEV);
  return complete(client, -1, EAGAIN);
}

bool UsbEmulator::Testbed::handle(UMockdevIoctlClient* client) {
  const gulong request = umockdev_ioctl_client_get_request(client);
  UMockdevIoctlData* const arg = umockdev_ioctl_client_get_arg(client);
  if (faults->gone) {
    for (Pending& p : pending) p.done = true, p.status = -ENODEV, p.data.clear();
    if (request != USBDEVFS_REAPURB && request != USBDEVFS_REAPURBNDELAY && request != USBDEVFS_DISCARDURB)
      return complete(client, -1, ENODEV);
  }
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES: {
      g_autoptr(UMockdevIoctlData) data = umockdev_ioctl_data_resolve(arg, 0, sizeof(guint32), nullptr);
      guint32 capabilities = USBDEVFS_CAP_BULK_CONTINUATION;
      if (data != nullptr)
        umockdev_ioctl_data_update(data, 0, reinterpret_cast<guint8*>(&capabilities), sizeof capabilities);
      return complete(client, data != nullptr ? 0 : -1, data != nullptr ? 0 : EFAULT);
    }
    case USBDEVFS_CLAIMINTERFACE:
    case USBDEVFS_DISCONNECT_CLAIM:
      if (faults->busy) return complete(client, -1, EBUSY);
      claimed = true;
      return complete(client, 0);
    case USBDEVFS_RELEASEINTERFACE:
      claimed = false;
      return complete(client, 0);
    case USBDEVFS_GETDRIVER:
      return complete(client, -1, ENODATA);
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_CLEAR_HALT:
      return complete(client, 0);
    case USBDEVFS_IOCTL:
      return complete(client, -1, ENODATA);
    case USBDEVFS_SUBMITURB:
      return submit(client, arg);
    case USBDEVFS_DISCARDURB: {
      gulong address = 0;
      std::memcpy(&address, arg->data, std::min<std::size_t>(sizeof address, static_cast<std::size_t>(arg->data_len)));
      for (Pending& p : pending) {
        if (p.address == address && !p.done) {
          p.done = true;
          p.status = -ENOENT;
          return complete(client, 0);
        }
      }
      return complete(client, -1, EINVAL);
    }
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY:
      return reap(client, arg);
    default:
      return complete(client, -1, ENOTTY);
  }
}

namespace {

gboolean handle_ioctl(UMockdevIoctlBase* self, UMockdevIoctlClient* client) {
  return static_cast<UsbEmulator::Testbed*>(reinterpret_cast<Handler*>(self)->testbed)->handle(client) ? TRUE : FALSE;
}

void initialise_class(gpointer type_class, gpointer) {
  reinterpret_cast<HandlerClass*>(type_class)->parent.handle_ioctl = handle_ioctl;
}

GType handler_type() {
  static const GType type =
      g_type_register_static_simple(UMOCKDEV_TYPE_IOCTL_BASE, "TouchstoneUsbHandler", sizeof(HandlerClass),
                                    initialise_class, sizeof(Handler), nullptr, static_cast<GTypeFlags>(0));
  return type;
}

std::string hex(const std::vector<unsigned char>& bytes) {
  std::string text;
  for (const unsigned char b : bytes) text += fmt::format("{:02X}", b);
  return text;
}

}  // namespace

bool UsbEmulator::preloaded() {
  const char* const libraries = std::getenv("LD_PRELOAD");
  return libraries != nullptr && std::strstr(libraries, "libumockdev-preload") != nullptr;
}

UsbEmulator::UsbEmulator(const Identity& identity, EmulatedUsbModel& model) : testbed_(std::make_unique<Testbed>()) {
  Testbed& t = *testbed_;
  t.faults = &faults;
  t.model = &model;
  t.identity = identity;
  t.testbed = umockdev_testbed_new();
  t.handler = static_cast<UMockdevIoctlBase*>(g_object_new(handler_type(), nullptr));
  reinterpret_cast<Handler*>(t.handler)->testbed = &t;
  GError* error = nullptr;
  if (umockdev_testbed_attach_ioctl(t.testbed, t.node.c_str(), t.handler, &error) == FALSE)
    throw std::runtime_error("umockdev: the handler was not attached");
  const auto low = [](unsigned v) { return static_cast<unsigned char>(v & 0xffU); };
  const auto high = [](unsigned v) { return static_cast<unsigned char>(v >> 8U); };
  // Device; configuration; interface 0 of the vendor's class; bulk IN 0x81; bulk OUT 0x02.
  const std::vector<unsigned char> descriptors{18,
                                               1,
                                               0x00,
                                               0x02,
                                               0,
                                               0,
                                               0,
                                               8,
                                               low(identity.vendor),
                                               high(identity.vendor),
                                               low(identity.product),
                                               high(identity.product),
                                               0x00,
                                               0x04,
                                               1,
                                               2,
                                               3,
                                               1,
                                               9,
                                               2,
                                               32,
                                               0,
                                               1,
                                               1,
                                               0,
                                               0x80,
                                               45,
                                               9,
                                               4,
                                               0,
                                               0,
                                               2,
                                               0xff,
                                               0xff,
                                               0xff,
                                               2,
                                               7,
                                               5,
                                               0x81,
                                               2,
                                               64,
                                               0,
                                               0,
                                               7,
                                               5,
                                               0x02,
                                               2,
                                               64,
                                               0,
                                               0};
  t.description = fmt::format(
      "P: /devices/pci0000:00/usb1/1-1\nN: bus/usb/001/003={0}\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: "
      "DEVNAME=/dev/bus/usb/001/003\nE: BUSNUM=001\nE: DEVNUM=003\n"
      "E: PRODUCT={1:x}/{2:x}/400\nA: busnum=1\nA: devnum=3\nA: speed=12\nA: bConfigurationValue=1\nA: "
      "idVendor={1:04x}\nA: idProduct={2:04x}\nH: descriptors={0}\n",
      hex(descriptors), identity.vendor, identity.product);
  t.syspath = "/sys/devices/pci0000:00/usb1/1-1";
  t.add();
}

void UsbEmulator::Testbed::add() {
  GError* error = nullptr;
  if (umockdev_testbed_add_from_string(testbed, description.c_str(), &error) == FALSE) {
    throw std::runtime_error(
        fmt::format("umockdev: {}", error != nullptr ? error->message : "the device was not added"));
  }
  plugged = true;
}

void UsbEmulator::plug() {
  Testbed& t = *testbed_;
  if (t.plugged) return;
  faults.gone = false;
  t.add();
  umockdev_testbed_uevent(t.testbed, t.syspath.c_str(), "add");
}

void UsbEmulator::unplug() {
  Testbed& t = *testbed_;
  if (!t.plugged) return;
  faults.gone = true;
  umockdev_testbed_uevent(t.testbed, t.syspath.c_str(), "remove");
  umockdev_testbed_remove_device(t.testbed, t.syspath.c_str());
  t.plugged = false;
}

UsbEmulator::~UsbEmulator() {
  Testbed& t = *testbed_;
  umockdev_testbed_detach_ioctl(t.testbed, t.node.c_str(), nullptr);
  g_object_unref(t.testbed);
  for (auto& p : t.pending) g_object_unref(p.urb);
  g_object_unref(t.handler);
}

void UsbEmulator::forbid() {
  g_autofree gchar* root = umockdev_testbed_get_root_dir(testbed_->testbed);
  ::chmod(root, 0755);
  ::chmod((std::string(root) + testbed_->node).c_str(), 0);
}

}  // namespace touchstone::hil
