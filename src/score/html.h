#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace diminish::html {

/// Text that may hold any character.
std::string escaped(std::string_view text);

/// The picture as a data URI, JPEG.
std::string data_uri(const cv::Mat& picture);

/// A line plot (SVG). Values that are absent leave gaps; nothing is drawn if all are.
std::string plot(const std::string& title, const std::vector<std::optional<double>>& values);

}  // namespace diminish::html
