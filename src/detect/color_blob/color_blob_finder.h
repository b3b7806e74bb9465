#pragma once

#include <cstdint>
#include <vector>

#include "core/connected_regions.h"
#include "detect/color_blob/blob_segmentation.h"
#include "detect/color_blob/candidate_windows.h"
#include "detect/color_blob/color_model.h"
#include "detect/color_blob/color_table.h"
#include "detect/color_blob/outline.h"
#include "detect/color_blob/outline_refinement.h"
#include "detect/color_blob/round_shape.h"
#include "diminish/image.h"

namespace diminish {

/// Finds an object by its colour in one camera's pictures: section 3.2 of Meerits & Saito 2015.
/// Keeps its memory from one picture to the next.
class ColorBlobFinder {
 public:
  /// round: the object looks like a ball; else it has any shape, and may be in several parts.
  ColorBlobFinder(const ColorModel& model, bool round)
      : model_(model), table_(model), round_(round) {}

  /// Sets the object's pixels in `mask` to 255 and returns whether there are any.
  /// spread: how far its mean colour may be from the model's, in standard deviations.
  bool find(ImageView<Bgr> image, double spread, Mask& mask);

 private:
  void find_windows(ImageView<Bgr> image, double spread);
  void find_levels(double spread);
  double find_round_region(double best_score);
  bool find_any_region();
  bool select_blobs(int level);
  bool find_component(const ConnectedRegions::Region& region, double largest_hole);
  void fill_holes(double largest_hole);
  void open_by_disc();
  bool is_known_outline();
  void refine(ImageView<Bgr> image, const Rect& window, Mask& mask);
  void complete_round_shape(const Rect& part, Mask& mask);

  ColorModel model_;
  ColorTable table_;
  bool round_;
  BlobSegmentation segmentation_;

  CandidateWindows candidates_;
  std::vector<Rect> windows_;  ///< in segment pixels
  double fewest_pixels_ = 0;   ///< that an object has, of these

  std::vector<std::uint8_t> level_of_blob_, core_of_blob_;
  Mask levels_, core_, selected_, closed_, opened_, scratch_;
  ConnectedRegions selected_regions_, gaps_;
  Outline outline_;
  Mask component_;  ///< a connected region of blobs, holes filled
  int component_pixels_ = 0;
  std::vector<Outline> known_outlines_;
  std::size_t known_count_ = 0;
  RoundShapeFitter shape_fitter_;

  Mask region_;  ///< the object in the segmentation's window
  OutlineRefinement refinement_;
  Mask object_;  ///< at full resolution
  ConnectedRegions object_regions_;
  Outline other_outline_;
};

}  // namespace diminish
