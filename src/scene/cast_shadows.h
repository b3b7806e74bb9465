#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "diminish/image.h"
#include "diminish/intrinsics.h"
#include "diminish/reconstruction.h"
#include "diminish/scene_samples.h"
#include "diminish/surfaces.h"
#include "geometry/ray_grid.h"
#include "scene/background_planes.h"
#include "scene/shadow_fit.h"

namespace diminish {

/// The shadows that the objects to remove cast on the background's planes. The objects hide part of
/// the light from each direction, and the brightness of the samples on the plane tells how much
/// light comes from where (ShadowFit). Everything that the visible part of the objects cannot have
/// caused stays: other objects' shadows, texture.
class CastShadows {
 public:
  /// A plane with coordinates on it, in metres from the point below the centre of the objects.
  struct Ground {
    BackgroundPlane plane;
    Eigen::Vector3f origin, along_u, along_v;

    Ground() = default;
    Ground(const BackgroundPlane& plane, const Eigen::Vector3f& middle);
    Eigen::Vector2f coordinates(const Eigen::Vector3f& point_m) const;
    Eigen::Vector3f point_m(const Eigen::Vector2f& place) const;
  };
  /// Light from one direction.
  struct Beam {
    /// Where it comes from; its length along the plane's normal is 1.
    Eigen::Vector3f toward;
    Eigen::Array3f share;  ///< of the plane's light, by channel
    /// By cell: up to which height above the plane an object hides it, in steps.
    Image<std::uint8_t> height;
  };
  /// The light on a plane, in cells around the ground's origin. Cell centres are at whole numbers.
  struct Shadow {
    Ground ground;
    std::uint8_t label = 0;       ///< the plane's, as in Surfaces::label
    Image<Eigen::Array3f> light;  ///< the share that is left, by cell
    float step_m = 1;             ///< of the beams' heights

    /// Those that matter.
    std::span<const Beam> beams() const { return {beams_.data(), beam_count_}; }
    /// Whether an object is between a point, anywhere above the plane, and the light.
    bool is_hidden(const Eigen::Vector3f& point_m, const Beam& beam) const;
    /// The share of the light that is left at a point of the plane, of all channels: that of the
    /// nearest cell; 1 beyond the grid.
    float light_at(const Eigen::Vector3f& point_m) const;

   private:
    friend class CastShadows;
    std::vector<Beam> beams_;  ///< the first beam_count_ are this frame's
    std::size_t beam_count_ = 0;
  };
  static constexpr float cell_m = 0.02F;
  static constexpr int grid_cells = 128;
  /// Light changes little from pixel to pixel, so it is looked up only at every node_px-th pixel of
  /// every node_rows_px-th row.
  static constexpr int node_px = 16;
  static constexpr int node_rows_px = 8;
  /// Below this loss of light there is no shadow.
  static constexpr float invisible = 1.F / 256;
  /// The lowest part of something on a plane is labelled as the plane. So shadows fade between this
  /// and twice this times the depth's error bound.
  static constexpr float fading_height = 0.6F;

  explicit CastShadows(const Intrinsics& color);

  /// Finds the shadows. samples, object_points_m: in the colour camera's frame. Cost: one to three
  /// milliseconds; planes are searched at the same time.
  void find(const std::vector<BackgroundPlane>& planes, const std::vector<SceneSample>& samples,
            const std::vector<Eigen::Vector3f>& object_points_m);
  void clear() { shadow_count_ = 0; }
  /// Whether there are any shadows.
  bool any() const { return shadow_count_ > 0; }
  std::span<const Shadow> shadows() const { return {shadows_.data(), shadow_count_}; }
  /// The box of the shadows in the colour camera's picture.
  Rect bounds() const;
  /// Fills `surfaces.light`; the labels are there. Shadows end where something stands on their
  /// plane.
  void shade(const Reconstruction& reconstruction, Surfaces& surfaces);
  const RayGrid& rays() const { return rays_; }

 private:
  static constexpr std::size_t bits_a_word = 64;
  static constexpr int azimuths = 16;
  static constexpr std::array<float, 5> elevations_deg = {25, 38, 51, 64, 77};
  static constexpr std::size_t directions = azimuths * elevations_deg.size();
  /// A cell has one bit for each direction, in two words.
  static constexpr int words = 2;
  static_assert(directions <= bits_a_word * words);
  using ByDirection = Eigen::Array<float, directions, 1>;

  struct Blocker {
    Eigen::Vector2f place;
    float height_m;
  };
  struct Lit {
    Eigen::Vector2f place;
    Eigen::Array3f levels;
  };
  /// The search for one plane's shadow.
  class Search {
   public:
    void choose_blockers(const Ground& ground, const std::vector<BackgroundPlane>& planes,
                         const std::vector<Eigen::Vector3f>& object_points_m);
    void choose_lit(const Ground& ground, const std::vector<SceneSample>& samples);
    /// Finds the light that is left, with what was chosen; returns whether there is a shadow.
    bool find(const ByDirection& slopes_u, const ByDirection& slopes_v);

    bool is_found = false;
    Shadow found;

   private:
    void find_hidden(const ByDirection& slopes_u, const ByDirection& slopes_v);
    bool fit();
    void keep_beams(const ByDirection& slopes_u, const ByDirection& slopes_v);
    void draw_light();

    std::vector<Blocker> blockers_;
    std::vector<Lit> lit_;
    std::vector<std::uint32_t> on_plane_;  ///< samples
    /// Words of cells. The first has a rim of one cell around the grid, plus one cell for
    /// everything beyond.
    Image<std::uint64_t> struck_, struck_in_column_, hidden_;
    std::vector<std::uint8_t> hidden_from_;
    ShadowFit fit_;
    Image<Eigen::Array4f> dark_;
  };
  template <class Visit>
  static void for_each_direction(const std::uint64_t* bits, const Visit& visit);
  static Eigen::Array3f dark_at(const Shadow& cast, const Eigen::Vector2f& ray);
  void find_nodes(const Rect& region);
  void shade_row(int y, const Image<float>& depth_m, Surfaces& surfaces) const;

  Lens lens_;
  RayGrid rays_;
  ByDirection slopes_u_, slopes_v_;  ///< metres along the plane per metre of height
  std::vector<Search> searches_;     ///< by plane
  std::vector<Shadow> shadows_;      ///< the first shadow_count_ are this frame's
  std::size_t shadow_count_ = 0;
  Rect nodes_box_;  ///< the nodes around the region, counted from the picture's corner
  /// By shadow: dark_at, and the height above the plane per metre of z.
  std::array<Image<Eigen::Array4f>, BackgroundPlanes::most_planes> nodes_;
  Mask is_shaded_;  ///< by block of pixels between four nodes
};

}  // namespace diminish
