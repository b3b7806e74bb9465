#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "core/mat.h"
#include "detect/blob_segmentation.h"
#include "detect/color_model.h"
#include "detect/round_shape.h"
#include "diminish/occluder_detector.h"

namespace diminish {
namespace {

using Outline = std::vector<cv::Point>;

/// A connected region of blobs, holes filled.
struct Component {
  Outline outline;
  cv::Mat region;  ///< 255 inside; the whole segment picture
  int area = 0;
};

/// Finds an object by its colour in one camera's pictures: section 3.2 of Meerits & Saito 2015.
class ColorBlobFinder {
 public:
  ColorBlobFinder(const ColorModel& model, bool round) : model_(model), round_(round) {}

  /// Sets the object's pixels in `mask` to 255 and returns whether there are any.
  bool find(const Image<Bgr>& image, double spread, Mask& mask) {
    segmentation_.segment(image);
    // Label 0 is the lines between blobs.
    constexpr double never = std::numeric_limits<double>::infinity();
    core_deviations_.assign(segmentation_.blob_count(), never);
    neighbor_deviations_.assign(segmentation_.blob_count(), never);
    for (int label = 1; label < segmentation_.blob_count(); ++label) {
      const ColorDeviation deviation = model_.deviation(segmentation_.mean_bgr(label));
      core_deviations_[label] = std::max(deviation.tint, deviation.value);
      // Shading changes the brightness most.
      neighbor_deviations_[label] = std::max(deviation.tint, deviation.value / 2);
    }
    select_blobs(core_deviations_, spread, core_);
    if (cv::countNonZero(core_) == 0) return false;
    const cv::Mat region = round_ ? round_region(spread) : any_region(spread);
    if (region.empty()) return false;
    draw(image, region, mask);
    return true;
  }

 private:
  /// The blobs that deviate at most `limit`, joined across the lines between them.
  void select_blobs(const std::vector<double>& deviations, double limit, cv::Mat& selected) const {
    const cv::Mat& labels = segmentation_.labels();
    selected.create(labels.size(), CV_8U);
    for (int y = 0; y < labels.rows; ++y) {
      for (int x = 0; x < labels.cols; ++x) {
        selected.at<std::uint8_t>(y, x) = deviations[labels.at<int>(y, x)] <= limit ? 255 : 0;
      }
    }
    cv::morphologyEx(selected, selected, cv::MORPH_CLOSE,
                     cv::getStructuringElement(cv::MORPH_RECT, {3, 3}));
  }

  /// The connected regions of blobs within `limit` standard deviations that are large enough and
  /// hold enough of what is within the spread that was asked for: highlights and shadows on the
  /// object deviate more than its mean colour does, but are next to it.
  std::vector<Component> components(double limit, double largest_hole) {
    constexpr double smallest_area = 1.0 / 16;  // of the smallest object in the training images
    constexpr double smallest_core = 1.0 / 5;
    select_blobs(neighbor_deviations_, limit, selected_);
    if (round_) {  // no ball has an edge or a pole of its colour behind it for a handle
      cv::morphologyEx(selected_, selected_, cv::MORPH_OPEN,
                       cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
    }
    const double fewest_pixels =
        std::max(16.0, smallest_area * model_.smallest_area * static_cast<double>(core_.total()));
    std::vector<Outline> outlines;
    std::vector<cv::Vec4i> hierarchy;
    cv::findContours(selected_, outlines, hierarchy, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
    std::vector<Component> found;
    for (int i = 0; i < static_cast<int>(outlines.size()); ++i) {
      const bool is_hole = hierarchy[i][3] >= 0;
      if (is_hole || cv::contourArea(outlines[i]) < fewest_pixels / 2) continue;
      Component component{outlines[i], cv::Mat::zeros(core_.size(), CV_8U), 0};
      cv::drawContours(component.region, outlines, i, 255, cv::FILLED);
      const int core = cv::countNonZero(component.region & core_);
      component.area = cv::countNonZero(component.region);
      for (int hole = hierarchy[i][2]; hole >= 0; hole = hierarchy[hole][0]) {
        if (cv::contourArea(outlines[hole]) <= largest_hole * component.area) continue;
        cv::Mat open = cv::Mat::zeros(core_.size(), CV_8U);
        cv::drawContours(open, outlines, hole, 255, cv::FILLED);
        component.region.setTo(0, open & ~selected_);
      }
      if (component.area < fewest_pixels || core < smallest_core * component.area) continue;
      found.push_back(std::move(component));
    }
    return found;
  }

  /// The roundest region, larger ones preferred. How far the colours may deviate next to the core
  /// is right where the region becomes round: less leaves out highlights, more takes in neighbours.
  cv::Mat round_region(double spread) {
    constexpr double all_holes = 1;
    cv::Mat best;
    double best_score = 0;
    for (const double factor : {1.0, 1.5, 2.0, 3.0, 4.0}) {
      for (const Component& component : components(factor * spread, all_holes)) {
        const auto shape = fit_round_shape(component.outline, component.region);
        if (!shape || !is_round(*shape)) continue;
        const double score = shape->agreement * shape->agreement * shape->diameter();
        if (score <= best_score) continue;
        best_score = score;
        best = component.region;
        shape->draw(best);
      }
    }
    return best;
  }

  cv::Mat any_region(double spread) {
    constexpr double factor = 2;
    constexpr double small_holes = 0.1;
    cv::Mat region;
    for (const Component& component : components(factor * spread, small_holes)) {
      region = region.empty() ? component.region : region | component.region;
    }
    return region;
  }

  void draw(const Image<Bgr>& image, const cv::Mat& region, Mask& mask) {
    object_.resize(mask.width(), mask.height(), 0);
    refine_region(image, region, segmentation_.scale(), object_);
    cv::Mat object = as_mat(object_);
    if (round_) complete_round_shape(object);
    cv::Mat target = as_mat(mask);
    target |= object;
  }

  /// Fills what is missing of the outline: a part in the shadow, or against a similar colour.
  static void complete_round_shape(cv::Mat& object) {
    std::vector<Outline> outlines;
    cv::findContours(object, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    const auto longest =
        std::max_element(outlines.begin(), outlines.end(),
                         [](const auto& a, const auto& b) { return a.size() < b.size(); });
    if (longest == outlines.end()) return;
    const auto shape = fit_round_shape(*longest, object);
    if (shape && is_round(*shape)) shape->draw(object);
  }

  ColorModel model_;
  bool round_;
  BlobSegmentation segmentation_;
  std::vector<double> core_deviations_, neighbor_deviations_;  ///< by label
  cv::Mat core_, selected_;
  Mask object_;
};

class ColorBlobDetector : public OccluderDetector {
 public:
  ColorBlobDetector(const OccluderSpec& spec, const Rig& rig) : name_(spec.name) {
    spec.config.expect_keys({"name", "detector", "training", "shape"});
    const std::filesystem::path training = spec.config.at("training").path();
    const Config shape = spec.config.find("shape");
    const bool round = shape.exists() && shape.choice({"circle", "any"}) == "circle";
    const auto make = [&](const std::string& camera) {
      return ColorBlobFinder(load_color_model(training_folder(training, camera)), round);
    };
    color_.emplace(make("color"));
    for (const RgbdCamera& camera : rig.rgbd) rgbd_.push_back(make(camera.name));
  }

  OccluderReport detect(const Observation& observation, OcclusionMasks& masks) override {
    const auto& [frame, markers, poses, options] = observation;
    OccluderReport report;
    report.name = name_;
    report.in_color =
        !frame.color.empty() && color_->find(frame.color, options.blob_spread, masks.color);
    bool in_any = report.in_color;
    for (std::size_t k = 0; k < rgbd_.size(); ++k) {
      const RgbdFrame& rgbd = frame.rgbd[k];
      report.in_rgbd.push_back(rgbd.available() &&
                               rgbd_[k].find(rgbd.color, options.blob_spread, masks.rgbd_color[k]));
      in_any = in_any || report.in_rgbd[k];
    }
    if (!in_any) report.message = name_ + ": no blob of its colour and shape in any camera";
    return report;
  }

 private:
  std::string name_;
  std::optional<ColorBlobFinder> color_;
  std::vector<ColorBlobFinder> rgbd_;
};

const bool registered =
    Registry<OccluderDetector>::add("color_blob", [](const OccluderSpec& spec, const Rig& rig) {
      return std::make_unique<ColorBlobDetector>(spec, rig);
    });

}  // namespace
}  // namespace diminish
