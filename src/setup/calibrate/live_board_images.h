#pragma once

#include <memory>
#include <string>

#include "diminish/camera_source.h"
#include "setup/calibrate/board_images.h"

namespace diminish {

/// A live camera's newest colour images, as fast as they are looked at.
class LiveBoardImages : public BoardImages {
 public:
  /// Ends after `seconds`, or with the camera. Throws Error that names the URI.
  LiveBoardImages(const std::string& uri, double seconds);

  /// Throws Error when the camera is gone or silent for five seconds.
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
