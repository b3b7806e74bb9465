#pragma once

#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "diminish/frame_set.h"
#include "live/camera_inbox.h"

namespace diminish {

/// Assembles frames from the cameras' inboxes: a colour image and the RGB-D images nearest in time.
///
/// A colour image waits a little for its RGB-D images, which often come later. Meanwhile newer
/// colour images may arrive; the newest complete one is taken. One that waited too long is used
/// without them.
class FrameAssembler {
 public:
  struct Settings {
    double sync_tolerance_s = 0;  ///< 0: half the colour camera's frame period
    double sync_wait_s = 0;       ///< 0: a little longer than the last RGB-D images took
  };

  /// color: the inbox of the user's camera; rgbd: one for each RGB-D camera. They must outlive
  /// this.
  FrameAssembler(CameraInbox& color, std::vector<CameraInbox*> rgbd);

  /// The images that a frame views.
  using Pixels = std::vector<std::shared_ptr<const void>>;

  /// Fills `frame` with the next frame, if there is one at this time. Its images are views, of
  /// memory that `pixels` keeps. Returns the number of colour images that were skipped for it;
  /// nothing if there is no new frame yet.
  /// is_expected: whether an RGB-D camera's images are worth waiting for.
  std::optional<std::size_t> assemble(const Settings& settings, double now_s,
                                      const std::function<bool(std::size_t)>& is_expected,
                                      FrameSet& frame, Pixels& pixels);

  /// When a waiting colour image will have waited long enough; nothing if none waits.
  std::optional<double> next_deadline_s(const Settings& settings);

  double sync_tolerance_s(const Settings& settings);
  double sync_wait_s(const Settings& settings);

 private:
  struct Arrival {
    double stamp_s, arrival_s;
  };
  using Arrivals = std::array<Arrival, ImageHistory<Bgr>::capacity>;

  /// Finds the colour images later than `after_s`, the newest first. Returns their number.
  std::size_t find_arrivals(double after_s, Arrivals& arrivals);
  bool is_complete(double stamp_s, double tolerance_s,
                   const std::function<bool(std::size_t)>& is_expected);
  void fill_rgbd(std::size_t camera, double tolerance_s, FrameSet& frame, Pixels& pixels);

  CameraInbox& color_;
  std::vector<CameraInbox*> rgbd_;
  double last_stamp_s_;
  std::size_t next_index_ = 0;
};

}  // namespace diminish
