#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diminish/error.h"
#include "diminish/export.h"
#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/registry.h"
#include "diminish/rig.h"
#include "diminish/rigid_transform.h"

namespace diminish {

/// The time on the machine's monotonic clock, seconds. All live timestamps use it.
inline double monotonic_now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// A camera's sensors.
enum class Sensor { color, depth };

/// An image from a camera. `sensor` says whether `color` or `depth` is filled.
struct CameraImage {
  Sensor sensor = Sensor::color;
  /// When it was taken, on the monotonic clock; the driver's timestamp if it has one.
  double stamp_s = 0;
  Image<Bgr> color;
  Image<std::uint16_t> depth;
  /// Why the image cannot be used (torn, damaged); empty if it can.
  std::string fault;
};

/// A camera's URI: "scheme:target?key=value&key".
struct DIMINISH_EXPORT CameraUri {
  std::string text;                               ///< all of it, for messages
  std::string scheme;                             ///< the registered CameraSource
  std::string target;                             ///< a path, a device, a pipeline
  std::map<std::string, std::string> parameters;  ///< without "=": an empty text

  bool has(const std::string& key) const { return parameters.count(key) != 0; }
  /// Throws Error that names the URI and the key if the value is not a number in the range.
  double number(const std::string& key, double fallback, double min, double max) const;
  std::string text_of(const std::string& key, const std::string& fallback) const;
  /// Throws Error if there are parameters that are not in `known`.
  void expect_parameters(const std::vector<std::string>& known) const;
  /// Throws Error with the URI in front of the message.
  [[noreturn]] void fail(const std::string& message,
                         Error::Category category = Error::configuration) const;
};

/// Throws Error if there is no "scheme:" in front.
DIMINISH_EXPORT CameraUri parse_camera_uri(const std::string& text);

/// What a camera is opened for.
struct CameraRequest {
  std::string name;  ///< "color" for the user's view, else an RGB-D camera's name in the rig
  const Rig* rig = nullptr;  ///< null: not known yet; the driver chooses the image sizes
  /// When the live session began. Replayed cameras all start here.
  double epoch_s = 0;
};

/// A device that `diminish devices` lists.
struct CameraDevice {
  std::string uri;
  std::string description;
};

/// How the clock that stamps a camera's images relates to this machine's.
struct CameraClock {
  /// That clock less this machine's (UTC), seconds. Includes the shortest way of an image.
  double offset_s = 0;
  double drift = 0;  ///< seconds that it gains on this machine's in a second
  /// The two are taken for the same: images have the times that their stamps say. Otherwise an
  /// image that came the shortest way is taken to have been made when it arrived.
  bool is_trusted = true;
};

/// A camera, or something that behaves like one. Registered by its URI's scheme, one file each.
/// Used by one thread.
class DIMINISH_EXPORT CameraSource {
 public:
  static constexpr const char* kind = "kind of camera";
  struct Entry {
    /// Opens the camera. Throws Error that names the URI and what was expected.
    std::function<std::unique_ptr<CameraSource>(const CameraUri&, const CameraRequest&)> open;
    /// Lists the connected devices; may be left out.
    std::function<std::vector<CameraDevice>()> list;
    /// An example and its purpose: "v4l2:/dev/video0?size=1280x1024&fps=30  a webcam".
    std::string help;
    /// Whether the URI's target is a text of its own, with any character: such as a pipeline. It
    /// has no parameters then.
    bool free_text = false;
  };
  using Factory = Entry;

  enum class Status { image, nothing, end };

  virtual ~CameraSource() = default;

  /// Waits up to about `timeout` for the next image and reads it into `image`, reusing its memory.
  /// `end`: there will be no more images. Throws Error when the camera is lost; it may then be
  /// opened again.
  virtual Status read(CameraImage& image, std::chrono::milliseconds timeout) = 0;

  /// The number of images that the camera itself has dropped, if it says so.
  virtual std::size_t dropped() const { return 0; }

  /// Factory intrinsics, if the driver knows them.
  virtual std::optional<Intrinsics> intrinsics(Sensor) const { return std::nullopt; }
  /// From the depth sensor to the colour sensor, if the driver knows it.
  virtual std::optional<RigidTransform> color_from_depth() const { return std::nullopt; }

  /// If another machine's clock stamps the images, what is known of it.
  virtual std::optional<CameraClock> clock() const { return std::nullopt; }
};

/// Opens the camera that a URI names. Throws Error that names the URI.
DIMINISH_EXPORT std::unique_ptr<CameraSource> open_camera(const std::string& uri,
                                                          const CameraRequest& request);

}  // namespace diminish
