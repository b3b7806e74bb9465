#pragma once

#include <functional>
#include <memory>

#include "diminish/diminished_frame.h"
#include "diminish/export.h"
#include "diminish/image.h"
#include "diminish/options.h"
#include "diminish/registry.h"

namespace diminish {

/// How the hidden background is shown: people look through objects for different reasons.
/// Registered by name; chosen by the option `mode`.
class DIMINISH_EXPORT ViewMode {
 public:
  static constexpr const char* kind = "view mode";
  using Factory = std::function<std::unique_ptr<ViewMode>()>;

  virtual ~ViewMode() = default;

  /// camera: the colour camera's image, with the object. `result` shows the background in its
  /// place. Changes `result.picture` inside `result.mask`, and nothing else.
  virtual void show(ImageView<Bgr> camera, const Options& options,
                    DiminishedFrame& result) const = 0;
};

}  // namespace diminish
