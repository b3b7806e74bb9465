#pragma once

#include <cstdint>
#include <vector>

#include "blend/blend_row.h"
#include "blend/camera_place.h"
#include "blend/confidence_grid.h"
#include "core/rows.h"
#include "diminish/intrinsics.h"
#include "diminish/reconstruction.h"
#include "diminish/tiled_region.h"

namespace diminish {

/// Blends the views of several RGB-D cameras by the rules of layers.h. Does what blend_layers does,
/// on vectors of pixels and with the rows in bands.
class CameraBlender {
 public:
  /// One camera's surface in the region.
  struct Surface {
    std::uint8_t source = 0;  ///< the camera's name in Reconstruction::source
    CameraPlace place;
    std::vector<SurfaceBuffer*> rows;  ///< which buffer holds each row of the region
    /// By cell, of a surface without texture (RemoteLayer); null: found from the texture.
    const Image<float>* resolution = nullptr;
  };

  /// Removes slivers from the surfaces and finds out how far each camera is trusted. `surfaces`, at
  /// most blending::most_cameras, must stay valid until the region's rows are done.
  void begin(std::vector<Surface>& surfaces, const TiledRegion& region, const Intrinsics& color,
             float agreement_m);

  /// Memory for one row.
  struct Scratch {
    std::vector<BlendedRow> rows;
    std::vector<float> nodes, confidences;
    std::vector<std::uint8_t> bytes;
  };
  /// Chooses the cameras for the pixels of row y. Returns the cameras' rows.
  const std::vector<BlendedRow>& choose(int y, const TwoSources& out, Scratch& scratch) const;

 private:
  struct Sliver {
    std::size_t camera;
    int x, y;
  };

  template <class Visit>
  void for_each_run(int y, const Visit& visit) const;
  void gather(int x, int y, std::vector<BlendedRow>& rows) const;
  void look_at_row(int y, Scratch& scratch, std::vector<Sliver>& slivers);
  bool is_sliver(const Surface& surface, int x, int y, float tolerance_m) const;
  void remove(const Sliver& sliver);
  void measure_cells(int cell_row, Scratch& scratch);

  std::vector<Surface>* surfaces_ = nullptr;
  TiledRegion region_;
  Intrinsics color_;
  float agreement_m_ = 0;
  Image<std::uint8_t> seen_;  ///< which cameras see the nearest surface, one bit each
  ConfidenceGrid grid_;
  Scratch scratch_[most_bands];
  std::vector<Sliver> slivers_[most_bands];
};

}  // namespace diminish
