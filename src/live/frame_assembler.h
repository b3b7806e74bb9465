#pragma once

#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "diminish/frame_set.h"
#include "live/camera_inbox.h"

namespace diminish {

/// Makes frames of what the cameras' inboxes hold: for the newest colour image that has them, the
/// RGB-D images nearest in time.
///
/// A colour image waits a little for its RGB-D images, which often come later. Meanwhile the next
/// ones may come: the newest complete one is taken. One that waited in vain is taken without.
class FrameAssembler {
 public:
  struct Settings {
    double sync_tolerance_s = 0;  ///< 0: half the colour camera's frame period
    double sync_wait_s = 0;       ///< 0: as long as the RGB-D cameras' last images made it wait
  };

  /// color: the user's camera's inbox; rgbd: one for each RGB-D camera. They must outlive this.
  FrameAssembler(CameraInbox& color, std::vector<CameraInbox*> rgbd);

  /// Makes `frame` the next frame if there is one at this time. Exchanges its colour image, copies
  /// the others. Returns the number of colour images that were passed over for it; nothing if there
  /// is no new frame yet.
  /// is_expected: whether an RGB-D camera's images are worth waiting for.
  std::optional<std::size_t> assemble(const Settings& settings, double now_s,
                                      const std::function<bool(std::size_t)>& is_expected,
                                      FrameSet& frame);

  /// When a colour image that waits will have waited long enough; nothing if none does.
  std::optional<double> next_deadline_s(const Settings& settings);

  double sync_tolerance_s(const Settings& settings);
  double sync_wait_s(const Settings& settings);

 private:
  struct Arrival {
    double stamp_s, arrival_s;
  };
  using Arrivals = std::array<Arrival, ImageHistory<Bgr>::capacity>;

  /// The colour images later than `after_s`, the newest first; returns their number.
  std::size_t find_arrivals(double after_s, Arrivals& arrivals);
  bool is_complete(double stamp_s, double tolerance_s,
                   const std::function<bool(std::size_t)>& is_expected);
  void fill_rgbd(std::size_t camera, double tolerance_s, FrameSet& frame);

  CameraInbox& color_;
  std::vector<CameraInbox*> rgbd_;
  double last_stamp_s_;
  std::size_t next_index_ = 0;
};

}  // namespace diminish
