#include "diminish/inpainter.h"
#include "inpaint/line_painting.h"
#include "inpaint/rim_lines.h"

namespace diminish {
namespace {

/// Fills by surfaces, then continues the straight edges that run into the mask: pipes, shelves,
/// frames. What a viewer misses first is edges, and a smooth filling has none.
class StructureInpainting : public Inpainter {
 public:
  Declaration declaration() const override {
    return {.uses_surfaces = true, .simpler = "surfaces"};
  }

  bool inpaint(const Holes& holes, const Options& options, Image<Bgr>& picture) override {
    const Rect objects = bounding_box(holes.occlusion);
    const std::vector<RimLine>& lines = lines_.find(picture, holes.occlusion, objects);
    if (!surfaces_->inpaint(holes, options, picture)) return false;
    painting_.paint(lines, holes, objects, picture);
    return true;
  }

 private:
  std::unique_ptr<Inpainter> surfaces_ = Registry<Inpainter>::get("surfaces")();
  RimLines lines_;
  LinePainting painting_;
};

const bool registered =
    Registry<Inpainter>::add("structure", [] { return std::make_unique<StructureInpainting>(); });

}  // namespace
}  // namespace diminish
