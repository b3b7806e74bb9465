#pragma once

#include <memory>
#include <span>
#include <vector>

#include "diminish/diminished_frame.h"
#include "memory/light_ratio.h"
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
/// 4. What only the RGB-D cameras show, beside what is witnessed, is brought to the same light.
/// 5. What is remembered in specks amid what is unknown is left out: it says nothing, and what is
///    invented around it would go by it.
class RecallMerge {
 public:
  explicit RecallMerge(const Intrinsics& color);

  /// recollections: the best first. color_maps: of the RGB-D cameras. witnessed_only: leave out the
  /// rest.
  void merge(const RecallInputs& inputs, std::span<const Recollection> recollections,
             ColorMapsBySource color_maps, bool witnessed_only, Reconstruction& reconstruction);

  /// How many remembered pixels each recollection of the last `merge` shows.
  std::vector<std::size_t> count_remembered(std::size_t recollections,
                                            const Reconstruction& reconstruction) const;

 private:
  static bool explains_surroundings(const RecallInputs& inputs, const Recollection& recollection,
                                    ColorMapsBySource color_maps, const Reconstruction& live);
  /// Pixels [first, last) of a row of the picture.
  struct Run {
    int first, last, y;
  };
  /// Of the pixels of a run.
  struct Scratch {
    std::vector<float> looked_m;
    std::vector<std::int32_t> places;
    std::vector<Verdict> verdicts;  ///< on what is seen now
    /// Of the band's rows: what both an RGB-D camera and a recollection show.
    std::vector<LightRatio::Pair> pairs;
  };
  void layer_row(std::span<const Recollection> recollections, int y);
  void find_verdicts(const Run& run, const RecallInputs& inputs,
                     std::span<const Recollection> recollections, const Reconstruction& live,
                     Scratch& scratch) const;
  /// Returns whether anything in it is remembered.
  bool merge_run(const Run& run, const RecallInputs& inputs,
                 std::span<const Recollection> recollections, ColorMapsBySource color_maps,
                 bool witnessed_only, Scratch& scratch, Reconstruction& reconstruction) const;
  /// Of all that show the same surface. x, y: in the picture.
  Bgr mean_color(std::span<const Recollection> recollections, int x, int y) const;
  void drop_specks(const RecallInputs& inputs, Reconstruction& reconstruction);
  bool is_nearer(float z_m, int x, int y, float tolerance_m) const;

  Intrinsics color_;
  std::shared_ptr<const RayTable> rays_;  ///< found when they are needed
  std::vector<FloatTransform> depth_from_color_;
  std::vector<double> depth_from_color_m_;
  std::vector<std::uint8_t> usable_;  ///< of each recollection
  std::vector<double> baselines_m_;   ///< likewise
  TiledRegion part_;                  ///< where any of them is drawn
  // Of its box: what is remembered. 0: nothing, else 1 + the recollection's index.
  Image<std::uint8_t> layer_;
  Image<float> depth_m_;  ///< where there is something
  Mask known_;            ///< and around it; 1: seen or remembered, or no object
  std::vector<std::uint8_t> column_sums_[most_bands];
  TiledRegion specks_part_;
  LightRatio light_;
  Scratch scratch_[most_bands];
};

}  // namespace diminish
