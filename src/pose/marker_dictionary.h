#pragma once

#include <opencv2/aruco.hpp>
#include <string>
#include <vector>

namespace diminish {

/// A dictionary by OpenCV's name, such as DICT_4X4_50. Throws Error that lists the known names.
cv::Ptr<cv::aruco::Dictionary> find_dictionary(const std::string& name);

/// All dictionaries. Among those with the same cells, smaller ones come first.
const std::vector<std::string>& dictionary_names();

}  // namespace diminish
