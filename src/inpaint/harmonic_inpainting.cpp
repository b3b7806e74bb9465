#include "diminish/inpainter.h"
#include "diminish/membrane.h"
#include "membrane/part_view.h"

namespace diminish {
namespace {

/// The smoothest filling: Laplace's equation with the known neighbours as Dirichlet boundary. It
/// has the least squared gradient of all fillings; it invents no edges.
class HarmonicInpainting : public Inpainter {
 public:
  bool inpaint(const Holes& holes, const Options&, Image<Bgr>& picture) override {
    const Rect whole = picture.bounds();
    if (membrane_.fill(view_of(holes.missing, whole), view_of(picture, whole))) return true;
    picture.fill({});
    return false;
  }

 private:
  Membrane membrane_;
};

const bool harmonic_inpainting_registered =
    Registry<Inpainter>::add("harmonic", [] { return std::make_unique<HarmonicInpainting>(); });

}  // namespace
}  // namespace diminish
