#include <fmt/format.h>

#include <iterator>

#include "setup/print/page.h"

namespace diminish {
namespace {

constexpr double points_per_mm = 72 / 25.4;

/// Escapes parentheses and backslashes, which would end the string.
std::string escape(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '(' || c == ')' || c == '\\') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

/// The page's content, in millimetres from its top left corner.
std::string content(const Page& page) {
  std::string text = fmt::format("{:.8f} 0 0 {:.8f} 0 {:.4f} cm\n", points_per_mm, -points_per_mm,
                                 page.height_mm * points_per_mm);
  const auto out = std::back_inserter(text);
  // One path, because viewers show hairlines between paths that touch.
  for (const Page::Rectangle& r : page.black) {
    fmt::format_to(out, "{:.4f} {:.4f} {:.4f} {:.4f} re\n", r.x, r.y, r.width, r.height);
  }
  fmt::format_to(out, "f\n");
  for (const Page::Text& t : page.texts) {
    fmt::format_to(out, "BT /F1 {:.3f} Tf 1 0 0 -1 {:.3f} {:.3f} Tm ({}) Tj ET\n", t.height, t.x,
                   t.y, escape(t.text));
  }
  return text;
}

}  // namespace

// ISO 32000-1: the objects 1 catalog, 2 pages, 3 font, then a page and its content for each.
std::string pages_as_pdf(const std::vector<Page>& pages) {
  std::string pdf = "%PDF-1.4\n";
  std::vector<std::size_t> offsets;
  const auto add_object = [&](const std::string& body) {
    offsets.push_back(pdf.size());
    pdf += fmt::format("{} 0 obj\n{}\nendobj\n", offsets.size(), body);
  };
  std::string kids;
  for (std::size_t i = 0; i < pages.size(); ++i) kids += fmt::format("{} 0 R ", 4 + 2 * i);
  add_object("<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>");
  add_object(fmt::format("<< /Type /Pages /Kids [ {}] /Count {} >>", kids, pages.size()));
  add_object("<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>");
  for (const Page& page : pages) {
    const std::string drawing = content(page);
    add_object(fmt::format(
        "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.4f} {:.4f}] "
        "/Resources << /Font << /F1 3 0 R >> >> /Contents {} 0 R >>",
        page.width_mm * points_per_mm, page.height_mm * points_per_mm, offsets.size() + 2));
    add_object(fmt::format("<< /Length {} >>\nstream\n{}endstream", drawing.size(), drawing));
  }
  const std::size_t table = pdf.size();
  pdf += fmt::format("xref\n0 {}\n0000000000 65535 f \n", offsets.size() + 1);
  for (const std::size_t offset : offsets) pdf += fmt::format("{:010} 00000 n \n", offset);
  pdf += fmt::format("trailer\n<< /Size {} /Root 1 0 R >>\nstartxref\n{}\n%%EOF\n",
                     offsets.size() + 1, table);
  return pdf;
}

}  // namespace diminish
