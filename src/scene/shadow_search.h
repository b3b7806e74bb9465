#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "diminish/image.h"
#include "diminish/scene_samples.h"
#include "scene/background_planes.h"
#include "scene/cast_shadow.h"
#include "scene/shadow_fit.h"

namespace diminish {

/// Finds the shadow that objects cast on one plane. They hide part of the light from each of 80
/// directions, and the brightness of the samples on the plane tells how much light comes from where
/// (ShadowFit).
class ShadowSearch {
 public:
  /// Of the objects; with fewer points, no shadow is found.
  static constexpr std::size_t fewest_blockers = 15;

  struct Inputs {
    const CastShadow::Ground& ground;
    const std::vector<BackgroundPlane>& planes;  ///< of which the ground is one
    const std::vector<SceneSample>& samples;
    const std::vector<Eigen::Vector3f>& object_points_m;
  };
  /// Finds the light that is left; returns whether there is a shadow. Cost: one to three
  /// milliseconds.
  bool find(const Inputs& inputs);
  /// What was found; the caller may exchange it for an older one, whose memory is used again.
  CastShadow& found() { return found_; }

 private:
  static constexpr std::size_t bits_a_word = 64;
  static constexpr int azimuths = 16;
  static constexpr std::array<float, 5> elevations_deg = {25, 38, 51, 64, 77};
  static constexpr std::size_t directions = azimuths * elevations_deg.size();
  /// A cell has one bit for each direction, in two words.
  static constexpr int words = 2;
  static_assert(directions <= bits_a_word * words);
  using ByDirection = Eigen::Array<float, directions, 1>;

  /// Where light may come from: metres along the plane per metre of height.
  struct Directions {
    ByDirection along_u, along_v;

    /// The same for all searches.
    static const Directions& all();

   private:
    Directions();
  };
  struct Blocker {
    Eigen::Vector2f place;
    float height_m;
  };
  struct Lit {
    Eigen::Vector2f place;
    Eigen::Array3f levels;
  };

  void choose_blockers(const Inputs& inputs);
  void choose_lit(const Inputs& inputs);
  void find_hidden();
  bool fit();
  void keep_beams();
  void draw_light();
  template <class Visit>
  static void for_each_direction(const std::uint64_t* bits, const Visit& visit);

  std::vector<Blocker> blockers_;
  std::vector<Lit> lit_;
  std::vector<std::uint32_t> on_plane_;  ///< samples
  /// Words of cells. The first has a rim of one cell around the grid, plus one cell for
  /// everything beyond.
  Image<std::uint64_t> struck_, struck_in_column_, hidden_;
  std::vector<std::uint8_t> hidden_from_;
  ShadowFit fit_;
  Image<Eigen::Array4f> dark_;
  CastShadow found_;
};

}  // namespace diminish
