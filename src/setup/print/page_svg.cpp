#include <fmt/format.h>

#include <iterator>

#include "setup/print/page.h"

namespace diminish {

std::string page_as_svg(const Page& page) {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}mm\" height=\"{1}mm\" "
      "viewBox=\"0 0 {0} {1}\">\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
      page.width_mm, page.height_mm);
  const auto out = std::back_inserter(svg);
  // One path, because viewers show hairlines between paths that touch.
  fmt::format_to(out, "<path shape-rendering=\"crispEdges\" d=\"\n");
  for (const Page::Rectangle& r : page.black) {
    fmt::format_to(out, "M{:.4f} {:.4f}h{:.4f}v{:.4f}h{:.4f}z\n", r.x, r.y, r.width, r.height,
                   -r.width);
  }
  fmt::format_to(out, "\"/>\n");
  for (const Page::Text& t : page.texts) {
    fmt::format_to(out,
                   "<text x=\"{:.3f}\" y=\"{:.3f}\" font-family=\"Helvetica, Arial, sans-serif\" "
                   "font-size=\"{:.3f}\">{}</text>\n",
                   t.x, t.y, t.height, t.text);
  }
  svg += "</svg>\n";
  return svg;
}

}  // namespace diminish
