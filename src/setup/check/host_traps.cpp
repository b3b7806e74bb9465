#include "setup/check/host_traps.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <optional>
#include <system_error>

#include "core/text.h"
#include "diminish/camera_source.h"
#include "source/find_camera.h"

namespace diminish {
namespace {

using Severity = Finding::Severity;

/// What a USB bus carries of its nominal rate, isochronous transfers at most.
constexpr double usable_share = 0.8;

/// The first word of a file; nothing if there is none.
std::optional<std::string> word_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string word;
  if (!(stream >> word)) return std::nullopt;
  return word;
}
std::optional<double> number_of(const std::filesystem::path& file) {
  const auto word = word_of(file);
  return word ? parse_number(*word) : std::nullopt;
}

/// The largest image that a ROS 2 camera of the rig sends as it is, bytes; 0 if it compresses them,
/// as a `diminish camera-node` does. uri: "ros2:..."
double largest_raw_image(const Rig& rig, const std::string& name, const CameraUri& uri) {
  const auto bytes = [&](const char* stream, const Intrinsics& sensor, double bytes_a_pixel) {
    const std::string topic = "/" + uri.text_of(stream, "");
    const bool is_raw =
        topic != "/" && !topic.ends_with("/compressed") && !topic.ends_with("/compressedDepth");
    return is_raw ? bytes_a_pixel * sensor.width * sensor.height : 0;
  };
  const RgbdCamera* const camera = find_rgbd_camera(rig, name);
  if (!camera) return bytes("color", rig.color, 3);
  return std::max(bytes("color", camera->color, 3), bytes("depth", camera->depth, 2));
}

void check_udp_buffers(const Rig& rig, const std::vector<LiveCamera>& cameras,
                       const std::filesystem::path& root, std::vector<Finding>& findings) {
  const auto most = number_of(root / "proc/sys/net/core/rmem_max");
  if (!most) return;
  double needed = 0;
  std::string names;
  for (const LiveCamera& camera : cameras) {
    const std::size_t begin = camera.uri.find("ros2:");  // another scheme may stand before it
    if (begin == std::string::npos) continue;
    const CameraUri uri = parse_camera_uri(camera.uri.substr(begin));
    const double image = largest_raw_image(rig, camera.name, uri);
    if (!uri.has("interface") || image <= *most) continue;
    needed = std::max(needed, image);
    names += (names.empty() ? "" : ", ") + camera.name;
  }
  if (needed == 0) return;
  findings.push_back(
      {Severity::warning, "udp-buffer",
       "the kernel's buffers hold less than an image that is not compressed (" + names +
           "): images get lost on the way",
       fmt::format("net.core.rmem_max is {:.0f} bytes, an image {:.0f}", *most, needed),
       fmt::format("sysctl -w net.core.rmem_max={:.0f}, or let a `diminish "
                   "camera-node` compress the images",
                   4 * needed)});
}

/// Mbit/s that a camera sends if it does not compress: two bytes a pixel. Nothing if the URI does
/// not say its size.
std::optional<double> raw_mbits(const CameraUri& uri) {
  const std::string fourcc = uri.text_of("fourcc", "");
  const std::string size = uri.text_of("size", "");
  const std::size_t cross = size.find('x');
  if (fourcc == "MJPG" || fourcc == "H264" || cross == std::string::npos) return std::nullopt;
  const auto width = parse_number(size.substr(0, cross));
  const auto height = parse_number(size.substr(cross + 1));
  const auto fps = parse_number(uri.text_of("fps", "30"));
  if (!width || !height || !fps) return std::nullopt;
  return *width * *height * *fps * 16 / 1e6;
}

void check_usb(const std::vector<LiveCamera>& cameras, const std::filesystem::path& root,
               std::vector<Finding>& findings) {
  struct Bus {
    double speed = 0, sum = 0;
    std::string names;
  };
  std::map<std::string, Bus> buses;
  for (const LiveCamera& camera : cameras) {
    if (!camera.uri.starts_with("v4l2:")) continue;
    const CameraUri uri = parse_camera_uri(camera.uri);
    const auto mbits = raw_mbits(uri);
    if (!mbits) continue;
    // The device is a USB interface; what carries it is above.
    std::error_code error;
    const auto interface = std::filesystem::canonical(
        root / "sys/class/video4linux" / std::filesystem::path(uri.target).filename() / "device",
        error);
    if (error) continue;
    const auto speed = number_of(interface.parent_path() / "speed");
    const auto number = word_of(interface.parent_path() / "busnum");
    if (!speed || !number) continue;
    Bus& bus = buses[*number];
    bus.speed = bus.speed == 0 ? *speed : std::min(bus.speed, *speed);
    bus.sum += *mbits;
    bus.names += (bus.names.empty() ? "" : ", ") + camera.name;
  }
  for (const auto& [number, bus] : buses) {
    if (bus.sum <= usable_share * bus.speed) continue;
    findings.push_back(
        {Severity::serious, "usb-bandwidth",
         fmt::format("USB bus {} carries less than its cameras send ({})", number, bus.names),
         fmt::format("{:.0f} of {:.0f} Mbit/s", bus.sum, bus.speed),
         "fourcc=MJPG, a smaller size, another bus, or another machine (docs/many-machines.md)"});
  }
}

void check_loopback(const std::filesystem::path& root, std::vector<Finding>& findings) {
  const auto flags = word_of(root / "sys/module/v4l2loopback/parameters/exclusive_caps");
  if (!flags || flags->find('Y') != std::string::npos) return;
  findings.push_back({Severity::warning, "exclusive-caps",
                      "browsers do not offer the virtual camera",
                      "v4l2loopback's exclusive_caps is N",
                      "modprobe -r v4l2loopback; modprobe v4l2loopback exclusive_caps=1"});
}

}  // namespace

std::vector<Finding> host_traps(const Rig& rig, const std::vector<LiveCamera>& cameras,
                                const std::filesystem::path& root) {
  std::vector<Finding> findings;
  check_udp_buffers(rig, cameras, root, findings);
  check_usb(cameras, root, findings);
  check_loopback(root, findings);
  return findings;
}

}  // namespace diminish
