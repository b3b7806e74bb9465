#pragma once

#include <optional>
#include <vector>

#include "depth/depth_stage.h"
#include "diminish/frame_set.h"
#include "diminish/remote_images.h"
#include "diminish/rig.h"
#include "render/camera_mesh.h"

namespace diminish {

/// Draws one RGB-D camera's images from the user's viewpoint, by the same code as where all cameras
/// are plugged into the user's machine: DepthStage, then CameraMesh.
class LayerDrawer {
 public:
  /// color: the user's colour camera.
  LayerDrawer(const RgbdCamera& camera, const Intrinsics& color);

  /// images: of this camera's size, as the masks are. `layer`'s memory is used again.
  void draw(const RgbdFrame& images, const RemoteDrawing& drawing, RemoteLayer& layer);

 private:
  void write_rows(ImageView<Bgr> texture, Rows rows, RemoteLayer& layer);
  void measure_cells(RemoteLayer& layer) const;

  /// Memory for one row.
  struct Scratch {
    std::vector<std::uint8_t> source;
    std::vector<float> depth_m;
    std::vector<Bgra> colors;
  };

  CameraDepth depth_;
  CameraMesh mesh_;
  Image<std::uint16_t> cleaned_;
  Intrinsics color_;
  Scratch scratch_[most_bands];
};

}  // namespace diminish
