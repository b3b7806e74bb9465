#pragma once

#include "diminish/calibration.h"
#include "diminish/image.h"

namespace diminish {

/// Draws the camera's image: cells without a corner dark, and every corner with its residual,
/// `magnification` times as long. Corners of views that were left out are grey.
Image<Bgr> coverage_picture(const ViewCollection& views, const IntrinsicsCalibration& result,
                            double magnification = 100);

}  // namespace diminish
