#pragma once

#include <memory>
#include <span>
#include <vector>

#include "diminish/diminished_frame.h"
#include "memory/recollection.h"

namespace diminish {

/// Puts recollections where they are better than what the RGB-D cameras show of this moment.
///
/// 1. A keyframe is left out if around the objects it explains the picture worse than the RGB-D
///    cameras do: it was moved, or its pose is wrong.
/// 2. Inside the objects' mask, what the cameras see now wins where it was not there when the
///    keyframe was taken, or looks different, or, if they did not see the place then, is nearer
///    than anything remembered around. It also wins if the RGB-D camera is nearer to the user's
///    viewpoint than the keyframe is.
/// 3. Elsewhere the keyframe is shown: as witnessed where a camera sees the same surface now, else
///    as remembered. If several show the same surface, the mean of them: each has noise, and
///    objects' shadows, of its own.
/// 4. What is remembered in specks amid what is unknown is left out: it says nothing, and what is
///    invented around it would go by it.
class RecallMerge {
 public:
  explicit RecallMerge(const Intrinsics& color);

  /// recollections: the best first. witnessed_only: leave out the rest.
  void merge(const RecallInputs& inputs, std::span<const Recollection> recollections,
             bool witnessed_only, Reconstruction& reconstruction);

  /// How many remembered pixels each recollection of the last `merge` shows.
  std::vector<std::size_t> count_remembered(std::size_t recollections,
                                            const Reconstruction& reconstruction) const;

 private:
  bool explains_surroundings(const RecallInputs& inputs, const Recollection& recollection,
                             const Reconstruction& live) const;
  void layer_rows(std::span<const Recollection> recollections, Rows rows);
  void merge_row(const RecallInputs& inputs, std::span<const Recollection> recollections,
                 bool witnessed_only, int y, Reconstruction& reconstruction) const;
  /// Of all that show the same surface.
  Bgr mean_color(std::span<const Recollection> recollections, int x, int y) const;
  void drop_specks(const RecallInputs& inputs, Reconstruction& reconstruction);
  bool is_nearer(float z_m, int x, int y, float tolerance_m) const;

  Intrinsics color_;
  std::shared_ptr<const RayTable> rays_;  ///< found when they are needed
  std::vector<FloatTransform> depth_from_color_;
  std::vector<double> depth_from_color_m_;
  std::vector<std::uint8_t> usable_;  ///< of each recollection
  // Of the region: what is remembered. 0: nothing, else 1 + the recollection's index.
  Rect region_;
  Image<std::uint8_t> layer_;
  Image<float> depth_m_;
  Mask known_;  ///< 1: seen or remembered, or no object
  std::vector<std::uint8_t> column_sums_[most_bands];
};

}  // namespace diminish
