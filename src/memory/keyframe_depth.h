#pragma once

#include <memory>
#include <span>
#include <vector>

#include "diminish/reconstruction.h"
#include "diminish/scene_samples.h"
#include "diminish/surfaces.h"
#include "estimate/plane_depth.h"
#include "memory/carried_depth.h"
#include "memory/color_edges.h"
#include "memory/keyframe.h"
#include "memory/measured_depth.h"
#include "scene/background_planes.h"

namespace diminish {

/// Finds depth for the whole picture of the user's camera, by drawing what the RGB-D cameras see.
/// Where they saw something earlier that looks the same, it is still there. The rest is completed
/// from what is around it: the same surface goes on if it is seen on both sides; else the
/// background's plane, or what is further away, goes on behind the nearer. That is a guess, and
/// doubtful; less so where the picture looks like the plane.
class KeyframeDepth {
 public:
  /// is_users: the camera is the user's. Else it is beside a depth sensor: a gap in a surface is
  /// something that the sensor does not see, and that may stand in front of it.
  KeyframeDepth(const Rig& rig, const KeyframeGrid& grid, bool is_users = true);

  /// Two steps, between which other frames may come. First what the RGB-D cameras see is drawn.
  /// poses and samples: after refinement. Cost: MeasuredDepth's, and 1 ms.
  /// planes: of a rig without RGB-D cameras, in the user's camera's frame.
  void draw(const FrameSet& frame, const Poses& poses, const OcclusionMasks& masks,
            const SceneSamples& samples, std::span<const InversePlane> planes,
            const Options& options);
  /// Then it is completed. objects: to remove, in the picture. keyframe: of that frame, with its
  /// pose and picture; fills `depth` and `doubt`. Cost: 5 ms.
  void complete(const Mask& objects, Keyframe& keyframe);
  void forget() { carried_.forget(); }

 private:
  /// The nearest known places on both sides along a row or column: 1 / z, or 0 if there is none.
  struct Ends {
    float first = 0, last = 0;
    int to_first = 0, to_last = 0;
  };
  struct Guess {
    float inverse_z = 0;
    int span = 0;          ///< how far apart what it is made of is
    bool is_same = false;  ///< a single surface on both sides
    float doubt = 0;       ///< how much of the depth it may be wrong by
  };
  Guess between(const Ends& ends) const;

  void label(const SceneSamples& samples);
  void find_columns();
  /// Of a place in its column.
  Ends column_ends(int x, int y) const {
    return {above_(x, y), below_(x, y), to_above_(x, y), to_below_(x, y)};
  }
  void fill_gaps(const Keyframe& keyframe, const Mask& objects);
  /// What was found out about the place before.
  struct LastPlace {
    int x = -1;
    std::uint8_t label = 0;  ///< of its plane
    bool continues = false;
  };
  Guess guess(int x, int y, const Ends& row, LastPlace& last) const;
  /// A seen place, the nearest in one direction; inverse_z is 0 if there is none.
  struct End {
    float inverse_z;
    int x, y;
  };
  /// Whether a place looks like that end, which is on the plane.
  bool continues(const BackgroundPlane& plane, int x, int y, const End& end) const;

  KeyframeGrid grid_;
  float gap_doubt_;  ///< between two places of one surface
  MeasuredDepth measured_;
  BackgroundPlanes planes_;
  CarriedDepth carried_;
  ColorEdges edges_;
  std::vector<SceneSample> samples_;
  Reconstruction drawn_;
  Surfaces surfaces_;
  Image<float> seen_, completed_;  ///< 1 / z; 0: unknown
  Mask doubt_;
  Image<Bgr> colors_;
  // Along columns, like Ends.
  Image<float> above_, below_;
  Image<std::int32_t> to_above_, to_below_;
};

}  // namespace diminish
