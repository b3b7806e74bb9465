#include "diminish/score.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "diminish/diminished_frame.h"
#include "diminish/error.h"
#include "score/image_quality.h"
#include "score/origins.h"
#include "score/run_folder.h"
#include "score/score_frames.h"
#include "score/viewer_figures.h"

namespace diminish {
namespace {

double ratio(const cv::Mat& part, const cv::Mat& whole) {
  return static_cast<double>(cv::countNonZero(part)) / static_cast<double>(cv::countNonZero(whole));
}

void expect_same_size(const cv::Mat& image, const cv::Mat& other, const std::string& what) {
  if (!image.empty() && image.size() != other.size()) {
    throw Error(
        Error::input,
        fmt::format("{}: its size and that of what it is compared with differ: {}x{}, {}x{}", what,
                    image.cols, image.rows, other.cols, other.rows));
  }
}

std::size_t count_changed_outside(const cv::Mat& input, const cv::Mat& result,
                                  const cv::Mat& mask) {
  cv::Mat difference;
  cv::absdiff(input, result, difference);
  cv::Mat changed;
  cv::inRange(difference, cv::Scalar::all(0), cv::Scalar::all(0), changed);
  return static_cast<std::size_t>(cv::countNonZero(~changed & (mask == 0)));
}

PoseError compare(const std::string& name, const RigidTransform& pose,
                  const RigidTransform& truth) {
  // A camera's place in the world; for one camera from another, its place in that one's frame.
  const bool in_world = name.find("_from_world") != std::string::npos;
  const Eigen::Vector3d place = in_world ? pose.inverse().translation : pose.translation;
  const Eigen::Vector3d true_place = in_world ? truth.inverse().translation : truth.translation;
  return {1000 * (place - true_place).norm(),
          rotation_difference_deg(pose.rotation, truth.rotation)};
}

template <class Value>
std::optional<double> mean_of(const std::vector<FrameScore>& frames, Value&& value) {
  double sum = 0;
  int count = 0;
  for (const FrameScore& frame : frames) {
    if (const std::optional<double> v = value(frame)) {
      sum += *v;
      ++count;
    }
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

std::optional<Quality> mean_quality(const std::vector<FrameScore>& frames,
                                    std::optional<Quality> FrameScore::*member) {
  const auto part = [&](double Quality::*figure) {
    return mean_of(frames, [&](const FrameScore& frame) {
      return frame.*member ? std::optional((*(frame.*member)).*figure) : std::nullopt;
    });
  };
  const auto psnr = part(&Quality::psnr_db);
  return psnr ? std::optional(Quality{*psnr, *part(&Quality::ssim)}) : std::nullopt;
}

FrameScore mean_score(const std::vector<FrameScore>& frames) {
  FrameScore mean;
  mean.name = "mean";
  mean.inside = mean_quality(frames, &FrameScore::inside);
  mean.valid = mean_quality(frames, &FrameScore::valid);
  mean.missing = mean_quality(frames, &FrameScore::missing);
  mean.origins = mean_by_origin(frames);
  mean.coverage = mean_of(frames, [](const FrameScore& frame) { return frame.coverage; });
  mean.mask_iou = mean_of(frames, [](const FrameScore& frame) { return frame.mask_iou; });
  mean.mask_recall = mean_of(frames, [](const FrameScore& frame) { return frame.mask_recall; });
  std::vector<ViewerFigures> viewer;
  for (const FrameScore& frame : frames) {
    if (frame.viewer) viewer.push_back(*frame.viewer);
  }
  mean.viewer = mean_of(viewer);
  for (std::size_t i = 0; i < error_causes.size(); ++i) {
    const auto share = mean_of(frames, [&](const FrameScore& frame) {
      return frame.budget ? std::optional((*frame.budget)[i]) : std::nullopt;
    });
    if (!share) break;
    if (!mean.budget) mean.budget.emplace();
    (*mean.budget)[i] = *share;
  }
  for (const FrameScore& frame : frames) {
    if (frame.changed_outside) {
      mean.changed_outside = mean.changed_outside.value_or(0) + *frame.changed_outside;
    }
    for (const auto& [name, error] : frame.poses) mean.poses[name] = {};
  }
  for (auto& [name, error] : mean.poses) {
    const auto part = [&frames, &name = name](double PoseError::*figure) {
      return *mean_of(frames, [&](const FrameScore& frame) {
        const auto found = frame.poses.find(name);
        return found != frame.poses.end() ? std::optional(found->second.*figure) : std::nullopt;
      });
    };
    error = {part(&PoseError::position_mm), part(&PoseError::rotation_deg)};
  }
  return mean;
}

/// A frame's (result - truth) where its object is, to compare with the next one's.
struct Residual {
  cv::Mat error, region;
};

/// Mean absolute change per pixel and channel.
std::optional<double> change(const Residual& before, const Residual& after) {
  if (before.error.empty() || before.error.size() != after.error.size()) return std::nullopt;
  const cv::Mat both = before.region & after.region;
  const int pixels = cv::countNonZero(both);
  if (pixels == 0) return std::nullopt;
  return cv::norm(before.error, after.error, cv::NORM_L1, both) / (3.0 * pixels);
}

}  // namespace

Score score_run(const std::filesystem::path& recording, const std::filesystem::path& run) {
  return score_frames(recording, run, [](const ScoredFrame&) {});
}

Score score_frames(const std::filesystem::path& recording, const std::filesystem::path& run,
                   const std::function<void(const ScoredFrame&)>& visit) {
  const RunFolder folder(recording, run);
  Score score;
  score.not_written = folder.not_written();
  SquaredError pooled;
  std::vector<double> changes;
  Residual previous;
  for (const std::string& name : folder.frames()) {
    FrameScore frame;
    frame.name = name;
    const cv::Mat result = folder.result(name);
    const cv::Mat truth = folder.truth(name);
    const cv::Mat mask = folder.mask(name);
    if (result.empty() || mask.empty()) {
      score.not_written.push_back(name);
      previous = {};
      continue;
    }
    const std::string what = (run / "result" / (name + ".png")).string();
    if (!truth.empty()) expect_same_size(result, truth, what);
    const cv::Mat provenance = folder.provenance(name);
    expect_same_size(mask, result, (run / "mask" / (name + ".png")).string());
    expect_same_size(provenance, result, (run / "provenance" / (name + ".png")).string());
    const cv::Mat seen = seen_pixels(provenance, mask);
    if (cv::countNonZero(mask) > 0) frame.coverage = ratio(seen & mask, mask);
    const cv::Mat input = folder.input(name);
    if (!input.empty()) {
      expect_same_size(input, result, what);
      frame.changed_outside = count_changed_outside(input, result, mask);
    }
    const cv::Mat true_mask = folder.true_mask(name);
    expect_same_size(true_mask, mask, what);
    if (!true_mask.empty()) {
      const cv::Mat grown = grow(true_mask, folder.mask_margin_px());
      if (cv::countNonZero(grown | mask) > 0) frame.mask_iou = ratio(grown & mask, grown | mask);
      if (cv::countNonZero(true_mask) > 0) frame.mask_recall = ratio(true_mask & mask, true_mask);
    }
    Residual residual;
    if (!truth.empty()) {
      const cv::Mat region = scored_region(true_mask, mask);
      const cv::Mat ssim = ssim_map(result, truth);
      frame.inside = quality(result, truth, ssim, region);
      frame.valid = quality(result, truth, ssim, region & seen);
      frame.missing = quality(result, truth, ssim, region & mask & ~seen);
      frame.origins = score_by_origin(result, truth, ssim, provenance, region);
      frame.viewer =
          viewer_figures({result, truth, ssim, true_mask.empty() ? mask : true_mask, provenance});
      const ErrorCauses causes = find_error_causes({result, truth, region, mask, seen});
      frame.budget = causes.budget;
      visit({name, input, result, truth, mask, provenance, causes});
      const SquaredError error = squared_error(result, truth, region);
      pooled.sum += error.sum;
      pooled.count += error.count;
      cv::subtract(result, truth, residual.error, cv::noArray(), CV_16S);
      residual.region = region;
    }
    if (const auto difference = change(previous, residual)) changes.push_back(*difference);
    previous = residual;
    const auto true_poses = folder.true_poses(name);
    for (const auto& [pose_name, pose] : folder.poses(name)) {
      const auto exact = true_poses.find(pose_name);
      if (exact != true_poses.end()) {
        frame.poses[pose_name] = compare(pose_name, pose, exact->second);
      }
    }
    score.frames.push_back(frame);
  }
  score.mean = mean_score(score.frames);
  if (pooled.count > 0) {
    score.psnr_pooled_db = psnr_db(pooled.sum / static_cast<double>(pooled.count));
  }
  if (!changes.empty()) {
    score.flicker =
        std::accumulate(changes.begin(), changes.end(), 0.0) / static_cast<double>(changes.size());
  }
  std::sort(score.not_written.begin(), score.not_written.end());
  return score;
}

}  // namespace diminish
