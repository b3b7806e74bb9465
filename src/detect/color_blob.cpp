#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "core/mat.h"
#include "detect/blob_segmentation.h"
#include "detect/color_model.h"
#include "detect/color_table.h"
#include "detect/round_shape.h"
#include "diminish/occluder_detector.h"

namespace diminish {
namespace {

using Outline = std::vector<cv::Point>;

/// A connected region of blobs, holes filled.
struct Component {
  Outline outline;
  cv::Mat region;  ///< 255 inside; of the segmentation's window
  int area = 0;
};

/// Finds an object by its colour in one camera's pictures: section 3.2 of Meerits & Saito 2015.
class ColorBlobFinder {
 public:
  ColorBlobFinder(const ColorModel& model, bool round)
      : model_(model), table_(model), round_(round) {}

  /// Sets the object's pixels in `mask` to 255 and returns whether there are any.
  bool find(const Image<Bgr>& image, double spread, Mask& mask) {
    segmentation_.shrink(image);
    const Rect window = find_window(spread);
    if (window.empty()) return false;
    segmentation_.segment(window);
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
  /// How far the colours of highlights and shadows on the object may deviate, in spreads.
  static constexpr double round_factors[] = {1.0, 1.5, 2.0, 3.0, 4.0};
  static constexpr double any_factor = 2;
  static constexpr double smallest_core = 1.0 / 5;  ///< of a region's pixels

  double fewest_pixels() const {
    constexpr double smallest_area = 1.0 / 16;  // of the smallest object in the training images
    const auto total = static_cast<double>(segmentation_.small_picture().size());
    return std::max(16.0, smallest_area * model_.smallest_area * total);
  }

  /// The part of the small picture that may show the object: around the connected regions of
  /// pixels of its colour, generously. Dividing the rest into blobs would be in vain.
  Rect find_window(double spread) {
    constexpr double generously = 1.5;
    const auto entries = [&](double factor) {
      return static_cast<int>(generously * factor * spread * ColorTable::per_deviation);
    };
    const int core_limit = entries(1);
    const int neighbor_limit = entries(round_ ? *std::rbegin(round_factors) : any_factor);
    const Image<Bgr>& picture = segmentation_.small_picture();
    candidates_.resize(picture.width(), picture.height());
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) {
        candidates_(x, y) = table_(picture(x, y)).neighbor <= neighbor_limit ? 255 : 0;
      }
    }
    const int count = cv::connectedComponentsWithStats(as_mat(candidates_), candidate_labels_,
                                                       candidate_boxes_, candidate_centers_, 8);
    core_pixels_.assign(static_cast<std::size_t>(count), 0);
    for (int y = 0; y < picture.height(); ++y) {
      const int* const label = candidate_labels_.ptr<int>(y);
      for (int x = 0; x < picture.width(); ++x) {
        if (label[x] != 0 && table_(picture(x, y)).core <= core_limit) ++core_pixels_[label[x]];
      }
    }
    cv::Rect box;
    for (int i = 1; i < count; ++i) {
      if (core_pixels_[i] < smallest_core / 4 * fewest_pixels()) continue;
      const auto* const stats = candidate_boxes_.ptr<int>(i);
      box |= cv::Rect(stats[cv::CC_STAT_LEFT], stats[cv::CC_STAT_TOP], stats[cv::CC_STAT_WIDTH],
                      stats[cv::CC_STAT_HEIGHT]);
    }
    const int margin = 8 + std::max(box.width, box.height) / 4;
    return intersect(grow({box.x, box.y, box.width, box.height}, margin), picture.bounds());
  }

  /// The blobs that deviate at most `limit`, joined across the lines between them.
  void select_blobs(const std::vector<double>& deviations, double limit, cv::Mat& selected) const {
    const cv::Mat& labels = segmentation_.labels();
    selected.create(labels.size(), CV_8U);
    for (int y = 0; y < labels.rows; ++y) {
      const int* const label = labels.ptr<int>(y);
      auto* const row = selected.ptr<std::uint8_t>(y);
      for (int x = 0; x < labels.cols; ++x) row[x] = deviations[label[x]] <= limit ? 255 : 0;
    }
    cv::morphologyEx(selected, selected, cv::MORPH_CLOSE,
                     cv::getStructuringElement(cv::MORPH_RECT, {3, 3}));
  }

  /// The connected regions of blobs within `limit` standard deviations that are large enough and
  /// hold enough of what is within the spread that was asked for: highlights and shadows on the
  /// object deviate more than its mean colour does, but are next to it.
  std::vector<Component> components(double limit, double largest_hole) {
    select_blobs(neighbor_deviations_, limit, selected_);
    if (round_) {  // no ball has an edge or a pole of its colour behind it for a handle
      cv::morphologyEx(selected_, selected_, cv::MORPH_OPEN,
                       cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
    }
    const double fewest = fewest_pixels();
    std::vector<Outline> outlines;
    std::vector<cv::Vec4i> hierarchy;
    cv::findContours(selected_, outlines, hierarchy, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
    std::vector<Component> found;
    for (int i = 0; i < static_cast<int>(outlines.size()); ++i) {
      const bool is_hole = hierarchy[i][3] >= 0;
      if (is_hole || cv::contourArea(outlines[i]) < fewest / 2) continue;
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
      if (component.area < fewest || core < smallest_core * component.area) continue;
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
    // Most regions stay as they are from one limit to the next.
    std::vector<Outline> known;
    for (const double factor : round_factors) {
      for (Component& component : components(factor * spread, all_holes)) {
        if (std::find(known.begin(), known.end(), component.outline) != known.end()) continue;
        const auto shape = fit_round_shape(component.outline, component.region);
        known.push_back(std::move(component.outline));
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
    constexpr double small_holes = 0.1;
    cv::Mat region;
    for (const Component& component : components(any_factor * spread, small_holes)) {
      region = region.empty() ? component.region : region | component.region;
    }
    return region;
  }

  void draw(const Image<Bgr>& image, const cv::Mat& region, Mask& mask) {
    const Rect part =
        refine_region(image, region, segmentation_.window(), segmentation_.scale(), refined_);
    // Room for what is missing of a round object.
    const Rect whole = intersect(grow(part, std::max(part.width, part.height) / 2), mask.bounds());
    object_.resize(whole.width, whole.height, 0);
    cv::Mat object = as_mat(object_);
    as_mat(refined_).copyTo(
        object(cv::Rect(part.x - whole.x, part.y - whole.y, part.width, part.height)));
    if (round_) complete_round_shape(object);
    cv::Mat target = as_mat(mask)(cv::Rect(whole.x, whole.y, whole.width, whole.height));
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
  ColorTable table_;
  bool round_;
  BlobSegmentation segmentation_;
  std::vector<double> core_deviations_, neighbor_deviations_;  ///< by label
  cv::Mat core_, selected_;
  Mask candidates_, refined_, object_;
  cv::Mat candidate_labels_, candidate_boxes_, candidate_centers_;
  std::vector<int> core_pixels_;
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
    const FrameSet& frame = observation.frame;
    const Options& options = observation.options;
    OccluderReport report;
    report.name = name_;
    // One image a core. (Not std::vector<bool>: its elements share bytes.)
    std::vector<char> found(rgbd_.size() + 1, 0);
    oneapi::tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t i) {
      if (i == 0) {
        found[i] =
            !frame.color.empty() && color_->find(frame.color, options.blob_spread, masks.color);
      } else if (frame.rgbd[i - 1].available()) {
        found[i] = rgbd_[i - 1].find(frame.rgbd[i - 1].color, options.blob_spread,
                                     masks.rgbd_color[i - 1]);
      }
    });
    report.in_color = found[0] != 0;
    report.in_rgbd.assign(found.begin() + 1, found.end());
    const bool in_any = std::find(found.begin(), found.end(), char{1}) != found.end();
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
