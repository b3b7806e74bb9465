#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "composite/texture_example.h"
#include "core/rows.h"
#include "diminish/diminished_frame.h"
#include "diminish/intrinsics.h"
#include "geometry/projection.h"
#include "geometry/ray_table.h"

namespace diminish {

/// Gives what is invented on a plane the grain that the colour camera sees elsewhere on the same
/// plane: wood, plaster, fabric. A filling is smooth; only what is finer than it is added, so that
/// no seams show (texture by example, as in Efros & Freeman 2001, without their search). The plane
/// is tiled like a brick wall. Each brick shows another place of the plane, moved along it, so that
/// scale and direction stay. Which place that is depends on where both are in the world: grain does
/// not swim from frame to frame.
class PlaneTexture {
 public:
  explicit PlaneTexture(const Intrinsics& color) : lens_(Lens(color)), rays_(RayTable::of(color)) {}

  struct Inputs {
    ImageView<Bgr> camera;
    const Mask& occlusion;
    const Rect& objects;  ///< their box in the picture
    const std::vector<BackgroundPlane>& planes;
    const std::vector<SceneSample>& samples;
    const std::optional<RigidTransform>& color_from_world;  ///< none: the camera's own frame
  };
  /// Finds the grain of each plane that has pixels to invent: where `result.provenance` is
  /// inpainted and the label is the plane's. The picture is not looked at, so that it may be filled
  /// meanwhile. Cost: 0.2 ms a plane that has some.
  void find(const Inputs& inputs, const DiminishedFrame& result);
  /// Adds it to `result.picture`, which is filled there. Cost: 5 ns a pixel.
  void add(const Inputs& inputs, DiminishedFrame& result);

 private:
  /// Coordinates on a plane, in bricks: point = origin + size (a u + b v).
  struct Axes {
    BackgroundPlane plane;
    Eigen::Vector3f origin, u, v;
    float size_m = 0;
  };
  /// The one that covers [i - (j odd ? 0.5 : 0), + 1) x [j, + 1).
  struct Brick {
    int i, j;

    bool operator==(const Brick&) const = default;
  };
  /// A place of the example that a brick may show: around a = i, b = j.
  struct Block {
    int i, j;
    float luck;
    Eigen::Array3f mean;
    float area_px;  ///< of a brick there
  };
  /// Pixel p shows the grain at turn p + shift, in the example's part.
  struct Tile {
    bool is_wanted = false, has_block = false;
    Eigen::Matrix2f turn = Eigen::Matrix2f::Zero();
    Eigen::Vector2f shift = Eigen::Vector2f::Zero();
  };

  /// A plane's, with what is to be laid of it.
  struct Grain {
    std::uint8_t label = 0;  ///< the plane's
    Axes axes;
    TextureExample example;
    std::vector<Block> blocks;
    std::vector<Brick> bricks;  ///< those that are wanted
    Brick first{};              ///< of the tiles
    Image<Tile> tiles;
  };

  template <class Visit>
  void for_some_open(const DiminishedFrame& result, std::uint8_t label, const Visit& visit) const;
  std::optional<float> mean_depth_m(const DiminishedFrame& result, const BackgroundPlane& plane,
                                    std::uint8_t label) const;
  static Axes axes_of(const Inputs& inputs, const BackgroundPlane& plane, float size_m);
  std::optional<Eigen::Vector2f> coordinates(const Axes& axes, int x, int y) const;
  std::optional<Eigen::Vector2f> place(const Axes& axes, float a, float b) const;
  std::optional<Eigen::Vector2f> place(const Axes& axes, float a, float b,
                                       Eigen::Matrix2f& sides) const;
  static Brick brick_at(const Eigen::Vector2f& at);
  bool find_grain(const Inputs& inputs, const BackgroundPlane& plane, const DiminishedFrame& result,
                  Grain& grain) const;
  bool lay_bricks(const DiminishedFrame& result, Grain& grain) const;
  void find_blocks(Grain& grain) const;
  void add_block(int i, int j, Grain& grain) const;
  static const Block* choose(const Grain& grain, Brick brick, const Eigen::Array3f& color,
                             float area_px);
  void make_tile(Brick brick, const Image<Bgr>& picture, Grain& grain) const;
  void add_rows(const Grain& grain, Rows rows, DiminishedFrame& result) const;
  void add_run(const Grain& grain, int first, int last, int y, Bgr* colors) const;
  static void add_tile(const Grain& grain, const Tile& tile, int first, int last, int y,
                       Bgr* colors);

  Projection lens_;
  std::shared_ptr<const RayTable> rays_;
  Rect part_;                  ///< of the picture: where something may be invented
  std::vector<Grain> grains_;  ///< the first `found_` are this frame's
  std::size_t found_ = 0;
};

}  // namespace diminish
