#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace diminish::html {

/// Escapes text that may contain any character.
std::string escaped(std::string_view text);

/// The picture as a JPEG data URI.
std::string data_uri(const cv::Mat& picture);

/// A page that needs no other file. body: HTML.
std::string page(const std::string& title, const std::string& body);

struct NamedPicture {
  std::string name;  ///< one word
  cv::Mat picture;
};
/// Pictures of one size, two at a time with a slider between them; at first `left` and `right`.
std::string slider(const std::vector<NamedPicture>& pictures, std::string_view left,
                   std::string_view right);

/// A line plot (SVG). Absent values leave gaps; nothing is drawn if all are absent.
std::string plot(const std::string& title, const std::vector<std::optional<double>>& values);

}  // namespace diminish::html
