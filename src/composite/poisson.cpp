#include "diminish/color_corrector.h"
#include "diminish/membrane.h"
#include "membrane/part_view.h"

namespace diminish {
namespace {

/// The paper's way: the reconstruction is cloned into the camera's picture (Perez, Gangnet & Blake
/// 2003). Boundary values come only from pixels outside the objects' mask that were also
/// reconstructed. Borders to missing pixels and to the region's edge are free, the seam between two
/// RGB-D cameras is evened out, and parts without any boundary value get the mean correction.
class PoissonCorrection : public ColorCorrector {
 public:
  Declaration declaration() const override { return {.simpler = "affine"}; }

  void correct(const ColorInputs& inputs, Image<Bgr>& picture) override {
    const auto& [camera, occlusion, reconstruction, maps] = inputs;
    const Rect& region = reconstruction.region;
    if (region.empty()) return;
    const Membrane::Cloning cloning{view_of(camera, region), view_of(reconstruction.color, region),
                                    view_of(occlusion, region),
                                    view_of(reconstruction.source, region)};
    membrane_.clone(cloning, view_of(picture, region));
  }

 private:
  Membrane membrane_;
};

const bool poisson_registered =
    Registry<ColorCorrector>::add("poisson", [] { return std::make_unique<PoissonCorrection>(); });

}  // namespace
}  // namespace diminish
