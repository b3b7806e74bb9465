#include "core/tasks.h"
#include "detect/silhouette/disc_dilation.h"
#include "detect/silhouette/mask_drawer.h"
#include "detect/silhouette/polygon_filler.h"

namespace diminish {
namespace {

class CpuMaskDrawer : public MaskDrawer {
 public:
  void draw(std::span<MaskDrawing> drawings) override {
    tools_.resize(drawings.size());
    for_tasks(drawings.size(), [&](std::size_t i) {
      MaskDrawing& drawing = drawings[i];
      tools_[i].filler.fill(*drawing.polygons, *drawing.mask, drawing.covers);
      if (drawing.margin_px == 0) return;
      tools_[i].dilation.dilate(*drawing.mask, drawing.part, drawing.margin_px);
    });
  }

 private:
  struct Tools {
    PolygonFiller filler;
    DiscDilation dilation;
  };

  std::vector<Tools> tools_;  ///< one per image
};

const bool cpu_mask_drawer_registered =
    Registry<MaskDrawer>::add("cpu", [] { return std::make_unique<CpuMaskDrawer>(); });

}  // namespace
}  // namespace diminish
