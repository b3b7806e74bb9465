#include "detect/color_blob/candidate_windows.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/extremum_filters.h"

namespace diminish {

const std::vector<Rect>& CandidateWindows::find(ImageView<Bgr> image, const ColorTable& table,
                                                int pitch, const Limits& limits) {
  take_samples(image, table, pitch, limits);
  // Across a sample that noise or a highlight spoils.
  dilate(candidates_, {1, 1}, scratch_, joined_);
  regions_.find(joined_, Pixels::set, Connectivity::four);
  core_samples_.assign(regions_.regions().size(), 0);
  for (const ConnectedRegions::Run& run : regions_.runs()) {
    const std::uint8_t* const row = core_.row(run.y);
    core_samples_[run.region] =
        std::accumulate(row + run.first, row + run.last, core_samples_[run.region]);
  }
  windows_.clear();
  for (std::size_t i = 0; i < core_samples_.size(); ++i) {
    if (core_samples_[i] == 0 || core_samples_[i] < limits.fewest_core) continue;
    const Rect& box = regions_.regions()[i].box;
    const int more = static_cast<int>(limits.margin_part * std::max(box.width, box.height));
    windows_.push_back(intersect(grow(box, limits.margin + more), candidates_.bounds()));
  }
  join_overlapping();
  return windows_;
}

void CandidateWindows::take_samples(ImageView<Bgr> image, const ColorTable& table, int pitch,
                                    const Limits& limits) {
  candidates_.resize(std::max(1, image.width() / pitch), std::max(1, image.height() / pitch));
  core_.resize(candidates_.width(), candidates_.height());
  const auto mean = [](int a, int b) { return static_cast<std::uint8_t>((a + b) / 2); };
  const int middle = std::min(pitch / 2, image.width() - 1);
  const int beside = std::max(middle - 1, 0);
  for (int y = 0; y < candidates_.height(); ++y) {
    const Bgr* row = image.row(std::min(y * pitch + pitch / 2, image.height() - 1));
    std::uint8_t* const candidate = candidates_.row(y);
    std::uint8_t* const core = core_.row(y);
    // Local copies: a stored byte could alias what they are read from.
    const int width = candidates_.width();
    const auto [most_neighbor, most_core] = std::pair(limits.neighbor, limits.core);
    for (int x = 0; x < width; ++x, row += pitch) {
      const Bgr& a = row[beside];
      const Bgr& b = row[middle];
      const ColorTable::Entry entry = table({mean(a.b, b.b), mean(a.g, b.g), mean(a.r, b.r)});
      candidate[x] = entry.neighbor <= most_neighbor ? 255 : 0;
      core[x] = entry.core <= most_core ? 1 : 0;
    }
  }
}

void CandidateWindows::join_overlapping() {
  for (std::size_t i = 0; i < windows_.size();) {
    const auto other =
        std::find_if(windows_.begin() + static_cast<std::ptrdiff_t>(i) + 1, windows_.end(),
                     [&](const Rect& window) { return !intersect(window, windows_[i]).empty(); });
    if (other == windows_.end()) {
      ++i;
      continue;
    }
    windows_[i] = join(windows_[i], *other);
    windows_.erase(other);
    i = 0;  // it has grown
  }
}

}  // namespace diminish
