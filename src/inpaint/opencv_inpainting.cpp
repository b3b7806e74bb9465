#include <opencv2/photo.hpp>

#include "core/mat.h"
#include "diminish/inpainter.h"

namespace diminish {
namespace {

/// cv::inpaint: fast marching (Telea 2004) or fluid dynamics (Bertalmio, Bertozzi & Sapiro 2001).
class OpenCvInpainting : public Inpainter {
 public:
  explicit OpenCvInpainting(int method) : method_(method) {}

  Declaration declaration() const override { return {.simpler = "harmonic"}; }

  bool inpaint(const Holes& holes, const Options& options, Image<Bgr>& picture) override {
    const Mask& missing = holes.missing;
    const Rect box = bounding_box(missing);
    if (box.empty()) return true;
    // A hole's pixels depend only on what is within the radius.
    const Rect part = intersect(grow(box, options.inpaint_radius_px + 2), picture.bounds());
    if (count_nonzero(missing, part) == static_cast<std::size_t>(part.width) * part.height) {
      picture.fill(part, {});
      return false;
    }
    cv::Mat window = as_mat(picture)(as_cv(part));
    cv::inpaint(window, as_mat(missing)(as_cv(part)), filled_, options.inpaint_radius_px, method_);
    filled_.copyTo(window, as_mat(missing)(as_cv(part)));
    return true;
  }

 private:
  int method_;
  cv::Mat filled_;
};

const bool telea_registered = Registry<Inpainter>::add(
    "telea", [] { return std::make_unique<OpenCvInpainting>(cv::INPAINT_TELEA); });
const bool ns_registered = Registry<Inpainter>::add(
    "ns", [] { return std::make_unique<OpenCvInpainting>(cv::INPAINT_NS); });

}  // namespace
}  // namespace diminish
