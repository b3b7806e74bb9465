#pragma once

#include <memory>
#include <string>

#include "diminish/camera_source.h"
#include "setup/calibrate/board_images.h"

namespace diminish {

/// The newest colour images of a live camera, as fast as the caller takes them.
class LiveBoardImages : public BoardImages {
 public:
  /// Ends after `seconds` or when the camera ends. Throws Error that names the URI.
  LiveBoardImages(const std::string& uri, double seconds);

  /// Throws Error when the camera is lost or silent for five seconds.
  bool next() override;
  std::string name() const override;
  void read(Image<Bgr>& image) override;

 private:
  std::string uri_;
  double begin_s_, seconds_;
  std::unique_ptr<CameraSource> camera_;
  CameraImage image_;
};

}  // namespace diminish
