#include "score/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>

namespace diminish::html {
namespace {

constexpr const char* style = R"(<style>
body { font: 15px/1.5 system-ui, sans-serif; margin: 2em auto; max-width: 1000px; padding: 0 1em; color: #222 }
table { border-collapse: collapse } td, th { padding: .2em .8em; text-align: right; border-bottom: 1px solid #ddd }
td:first-child, th:first-child { text-align: left }
.plots { display: flex; flex-wrap: wrap; gap: 1em } figure { margin: 0; width: 300px }
figcaption span { color: #888; float: right } svg { width: 100%; background: #f6f6f6 }
polyline { fill: none; stroke: #06c; stroke-width: 1.5 } circle { fill: #06c }
.slider { position: relative; line-height: 0 } .slider img { width: 100% }
.slider img + img { position: absolute; left: 0; top: 0; clip-path: inset(0 0 0 50%) }
input[type=range] { width: 100% } .bar { display: flex; height: 1.6em; color: #fff; text-align: center }
</style>
)";

/// The pictures are in the page once; sliders show them by their names.
constexpr const char* script = R"(<script>
document.querySelectorAll('.compare').forEach(c => {
  const shown = c.querySelectorAll('.slider img');
  c.querySelector('input').oninput = e =>
    shown[1].style.clipPath = `inset(0 0 0 ${e.target.value}%)`;
  c.querySelectorAll('select').forEach((s, i) => {
    s.onchange = () => shown[i].src = c.querySelector(`[data-name=${s.value}]`).src;
    s.onchange();
  });
});
</script>
)";

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

std::string page(const std::string& title, const std::string& body) {
  return fmt::format(
             "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\">"
             "<meta name=\"viewport\" content=\"width=device-width\">\n<title>{}</title>\n",
             escaped(title)) +
         style + body + script;
}

std::string slider(const std::vector<NamedPicture>& pictures, std::string_view left,
                   std::string_view right) {
  std::string text = "<div class=compare><div class=slider><img alt=''><img alt=''></div>";
  text += "<input type=range value=50 aria-label='from one picture to the other'>";
  for (const std::string_view selected : {left, right}) {
    text += "<select>";
    for (const auto& [name, picture] : pictures) {
      text += fmt::format("<option{}>{}</option>", name == selected ? " selected" : "", name);
    }
    text += "</select> ";
  }
  for (const auto& [name, picture] : pictures) {
    text += fmt::format("<img hidden alt='' data-name={} src='{}'>", name, data_uri(picture));
  }
  return text + "</div>\n";
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
