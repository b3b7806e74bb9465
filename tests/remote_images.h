#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "diminish/frame_set.h"
#include "diminish/pipeline.h"
#include "diminish/rig.h"
#include "diminish/scene.h"
#include "pose/pose_refinement.h"
#include "remote/asked_images.h"
#include "remote/node_worker.h"
#include "scene/sample_grid.h"

namespace diminish::testing {

/// An RGB-D camera whose node is in this process: questions and answers are the bytes that would
/// travel, and there is no wire.
class NodeInProcess {
 public:
  NodeInProcess(const Recording& recording, std::size_t camera, const RemoteSettings& settings,
                int samples = SampleGrid::usual_samples)
      : settings_(settings),
        worker_([this](double, double) { return images_; },
                [this](const std::vector<std::uint8_t>& answer) { answer_ = answer; }) {
    question_.camera = recording.rig.rgbd[camera];
    question_.user = recording.rig.color;
    question_.wishes = {recording.scene.marker_dictionary,
                        PoseRefinement::usual_spacings_px(recording.rig.color), samples,
                        settings.coding.is_exact()};
  }

  /// Takes the images out of the frame; the node keeps them.
  void take_over(RgbdFrame& rgbd) {
    auto images = std::make_shared<RgbdFrame>();
    std::swap(*images, rgbd);
    images_ = images;
    asked_ = std::make_shared<AskedImages>(
        question_.camera.name, NodeHead{NodeTopic::glance, 1, ++frames_}, question_, settings_,
        [this](const std::vector<std::uint8_t>& question) {
          answer_.clear();
          worker_.take(question, 0);
          if (answer_.empty()) return;
          bytes.push_back(answer_.size());
          auto answer = open_answer(answer_);
          asked_->take(answer, 0);
        });
    asked_->ask();
    if (!asked_->wait_for_glance(0)) {
      rgbd.missing = asked_->problem();
      return;
    }
    rgbd.color_stamp_s = asked_->glance().color_stamp_s;
    rgbd.depth_stamp_s = asked_->glance().depth_stamp_s;
    rgbd.depth = ImageView<std::uint16_t>(asked_->glance().depth);
    rgbd.remote = asked_;
  }

  std::vector<std::size_t> bytes;  ///< of each answer
  const NodeCounts& counts() const { return worker_.counts(); }

 private:
  GlanceQuestion question_;
  RemoteSettings settings_;
  NodeWorker::Images images_;
  NodeWorker worker_;
  std::vector<std::uint8_t> answer_;
  std::shared_ptr<AskedImages> asked_;
  std::uint64_t frames_ = 0;
};

}  // namespace diminish::testing
