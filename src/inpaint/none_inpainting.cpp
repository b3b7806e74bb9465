#include "diminish/inpainter.h"

namespace diminish {
namespace {

/// Leaves unknown pixels black.
class NoInpainting : public Inpainter {
 public:
  Declaration declaration() const override { return {.rule = Declaration::Rule::leaves_unknown}; }

  bool inpaint(const Holes& holes, const Options&, Image<Bgr>& picture) override {
    const Mask& missing = holes.missing;
    for (int y = 0; y < missing.height(); ++y) {
      for (int x = 0; x < missing.width(); ++x) {
        if (missing(x, y) != 0) picture(x, y) = {};
      }
    }
    return false;
  }
};

const bool none_inpainting_registered =
    Registry<Inpainter>::add("none", [] { return std::make_unique<NoInpainting>(); });

}  // namespace
}  // namespace diminish
