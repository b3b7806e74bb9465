#include "pose/frame_markers.h"

#include "core/tasks.h"
#include "diminish/remote_images.h"

namespace diminish {

FrameMarkers::FrameMarkers(const Rig& rig, const std::string& dictionary, bool wanted) {
  if (!wanted) return;
  cameras_.push_back({Lens(rig.color), MarkerDetector(dictionary)});
  for (const RgbdCamera& camera : rig.rgbd) {
    cameras_.push_back({Lens(camera.color), MarkerDetector(dictionary)});
  }
}

void FrameMarkers::find(const FrameSet& frame, Markers& markers) {
  markers.color.clear();
  markers.rgbd.resize(frame.rgbd.size());
  for (auto& list : markers.rgbd) list.clear();
  for_tasks(cameras_.size(), [&](std::size_t i) {
    auto& [lens, detector] = cameras_[i];
    if (i == 0) {
      detector.detect(frame.color, lens, markers.color);
    } else if (frame.rgbd[i - 1].is_remote()) {
      markers.rgbd[i - 1] = frame.rgbd[i - 1].remote->glance().markers;
    } else if (frame.rgbd[i - 1].has_picture()) {
      detector.detect(frame.rgbd[i - 1].color, lens, markers.rgbd[i - 1]);
    }
  });
}

}  // namespace diminish
