#pragma once

#include <string>
#include <vector>

#include "diminish/export.h"
#include "diminish/scene.h"

namespace diminish {

/// For a scene whose objects are what a detector finds without settings, such as "difference".
/// source: what chose it, for messages, such as "--detector". Throws Error on unknown detectors and
/// on those that need settings.
DIMINISH_EXPORT std::vector<OccluderSpec> objects_of_detector(const std::string& detector,
                                                              const std::string& source);

}  // namespace diminish
