#include "sink/shares.h"

#include <fmt/format.h>

namespace diminish {

Shares shares_of(std::size_t mask_pixels, std::size_t valid_pixels, std::size_t witnessed_pixels,
                 std::size_t remembered_pixels, std::size_t estimated_pixels) {
  if (mask_pixels == 0) return {};
  const auto share = [&](std::size_t pixels) {
    return static_cast<double>(pixels) / static_cast<double>(mask_pixels);
  };
  return {share(valid_pixels - remembered_pixels - estimated_pixels), share(witnessed_pixels),
          share(remembered_pixels), share(estimated_pixels), share(mask_pixels - valid_pixels)};
}

std::string to_text(const Shares& shares, int digits) {
  const auto percent = [&](const char* what, double share) {
    return fmt::format("{} {:.{}f} %", what, 100 * share, digits);
  };
  std::string text = percent("truly seen", shares.seen);
  if (shares.witnessed > 0) text += " (" + percent("witnessed", shares.witnessed) + ")";
  if (shares.remembered > 0) text += ", " + percent("remembered", shares.remembered);
  if (shares.estimated > 0) text += ", " + percent("seen without depth", shares.estimated);
  return text + ", " + percent("invented", shares.invented);
}

}  // namespace diminish
