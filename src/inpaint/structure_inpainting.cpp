#include "diminish/inpainter.h"
#include "inpaint/line_painting.h"
#include "inpaint/surface_inpainting.h"

namespace diminish {
namespace {

/// Fills by surfaces, then continues the straight edges that run into the mask: pipes, shelves,
/// frames. What a viewer misses first is edges, and a smooth filling has none.
class StructureInpainting : public Inpainter {
 public:
  Declaration declaration() const override {
    return {.uses_surfaces = true, .uses_lines = true, .wants_grain = true, .simpler = "surfaces"};
  }

  bool inpaint(const Holes& holes, const Options& options, Image<Bgr>& picture) override {
    if (!surfaces_->inpaint(holes, options, picture)) return false;
    if (!holes.lines.empty()) {
      painting_.paint(holes, bounding_box(holes.occlusion, holes.part()), picture);
    }
    return true;
  }

 private:
  std::unique_ptr<Inpainter> surfaces_ = make_surface_inpainting(FillFrom::far_side);
  LinePainting painting_;
};

const bool structure_inpainting_registered =
    Registry<Inpainter>::add("structure", [] { return std::make_unique<StructureInpainting>(); });

}  // namespace
}  // namespace diminish
