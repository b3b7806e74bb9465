#pragma once

#include <cstdint>
#include <vector>

#include "memory/surroundings.h"
#include "memory/testimony.h"

namespace diminish {

/// Whether another testimony of the same camera confirms what one saw.
enum class Verdict : std::uint8_t {
  unknown,    ///< the other does not see the place
  same,       ///< it sees the same surface
  absent,     ///< it looks through the place
  recolored,  ///< it sees the surface, in other colours
  gone,       ///< it looks through the place beyond doubt
};
inline bool is_changed(Verdict verdict) {
  return verdict >= Verdict::absent;
}
using Verdicts = Image<Verdict>;  ///< on a testimony's grid

/// Compares two testimonies of a camera. Both have the same errors of calibration, so that small
/// changes show.
class TestimonyComparison {
 public:
  explicit TestimonyComparison(const TestimonyGrid& grid) : grid_(grid) {}

  /// What each says of the other, in a part of each; unknown elsewhere. The two parts show the same
  /// part of the scene. A camera that stands still is compared pixel by pixel, whatever its poses
  /// say. Cost: 20 ns per place.
  struct Side {
    const Testimony& testimony;
    Rect part;
    Verdicts& verdicts;
  };
  void compare(const Side& a, const Side& b);

 private:
  struct Tolerance {
    float depth = 2;   ///< times the sensor's usual noise
    float color = 20;  ///< levels
    int reach = 1;     ///< neighbours that may be meant instead; the camera moves if more than 1
  };
  /// How many of some samples are the same. Sets the tolerance by the noise that these show.
  int count_same(const Testimony& a, const Testimony& b, const FloatTransform& b_from_a,
                 Tolerance& tolerance);
  struct Place {
    const Testimony& testimony;
    int x, y;
    float z_m;  ///< of a point
  };
  /// On a point at a place of one testimony, which is at a place of the other for that camera.
  Verdict verdict_of(const Place& own, const Place& there, const Tolerance& tolerance) const;
  /// For a camera that stands still: whether places of a row are surely the same, which most are.
  /// Others are asked for one by one.
  void find_sure(const Testimony& own, const Rect& row, const Tolerance& tolerance);
  void judge(const Side& side, const Side& other, const FloatTransform& other_from_side,
             const Tolerance& tolerance);
  /// Leaves out changes that are no wider than the errors at the edges of things.
  void keep_wide_changes(const Rect& part, int reach, Verdicts& verdicts);

  TestimonyGrid grid_;
  Surroundings around_;
  Padded<std::uint8_t> across_, changed_, core_, count_, kept_;
  std::vector<std::uint8_t> sure_, colors_sure_;  ///< of a row: 1: the same
  std::vector<float> depth_differences_, color_differences_;
};

}  // namespace diminish
