#include "setup/convert/tum_format.h"

#include <fmt/format.h>

#include <fstream>

#include "core/number_lines.h"
#include "diminish/error.h"

namespace diminish {

std::string tum_camera_text(const Intrinsics& lens) {
  return fmt::format("# width height fx fy cx cy, without distortion\n{} {} {} {} {} {}\n",
                     lens.width, lens.height, lens.fx, lens.fy, lens.cx, lens.cy);
}

std::optional<Intrinsics> read_tum_camera(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "camera.txt";
  std::ifstream stream(file);
  if (!stream) return std::nullopt;
  std::optional<Intrinsics> lens;
  for_each_number_line(stream, file, [&](const std::vector<double>& v, const FailLine& fail) {
    if (lens || v.size() != 6) fail("expected one line 'width height fx fy cx cy'");
    constexpr double most = 16384;
    if (!(v[0] >= 1 && v[0] <= most && v[1] >= 1 && v[1] <= most)) fail("expected an image's size");
    if (!(v[2] > 0 && v[3] > 0)) fail("expected focal lengths above 0");
    lens = {.width = static_cast<int>(v[0]),
            .height = static_cast<int>(v[1]),
            .fx = v[2],
            .fy = v[3],
            .cx = v[4],
            .cy = v[5]};
  });
  if (!lens)
    throw Error(Error::input, file.string() + ": expected a line 'width height fx fy cx cy'");
  return lens;
}

}  // namespace diminish
