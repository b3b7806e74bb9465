#include "score/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>

namespace diminish::html {
namespace {

/// RFC 4648.
std::string base64(const std::vector<std::uint8_t>& bytes) {
  static constexpr char digits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < count ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? digits[bits >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '&':
        result += "&amp;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string data_uri(const cv::Mat& picture) {
  constexpr int quality = 88;
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return "data:image/jpeg;base64," + base64(bytes);
}

std::string plot(const std::string& title, const std::vector<std::optional<double>>& values) {
  double least = 0;
  double most = 0;
  bool any = false;
  for (const auto& value : values) {
    if (!value) continue;
    least = any ? std::min(least, *value) : *value;
    most = any ? std::max(most, *value) : *value;
    any = true;
  }
  if (!any) return {};
  constexpr double width = 300;
  constexpr double height = 90;
  const double range = most > least ? most - least : 1;
  const double step = values.size() > 1 ? width / static_cast<double>(values.size() - 1) : 0;
  std::string svg = fmt::format(
      "<figure><figcaption>{} <span>{:.4g} to {:.4g}</span></figcaption>"
      "<svg viewBox='-6 -6 {} {}'>",
      escaped(title), least, most, width + 12, height + 12);
  std::string line;
  const auto end_line = [&] {
    if (!line.empty()) svg += "<polyline points='" + line + "'/>";
    line.clear();
  };
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!values[i]) {
      end_line();
      continue;
    }
    const double x = static_cast<double>(i) * step;
    const double y = height * (1 - (*values[i] - least) / range);
    line += fmt::format("{:.1f},{:.1f} ", x, y);
    svg += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='2'/>", x, y);
  }
  end_line();
  return svg + "</svg></figure>\n";
}

}  // namespace diminish::html
