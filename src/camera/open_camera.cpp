#include "diminish/camera_source.h"

namespace diminish {

std::unique_ptr<CameraSource> open_camera(const std::string& uri_text,
                                          const CameraRequest& request) {
  const CameraUri uri = parse_camera_uri(uri_text);
  using Sources = Registry<CameraSource>;
  if (!Sources::contains(uri.scheme)) uri.fail(Sources::unknown(uri.scheme));
  return Sources::get(uri.scheme).open(uri, request);
}

}  // namespace diminish
