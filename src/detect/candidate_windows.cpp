#include "detect/candidate_windows.h"

#include <algorithm>
#include <numeric>

#include "detect/extremum_filters.h"

namespace diminish {

const std::vector<Rect>& CandidateWindows::find(const Image<Bgr>& image, const ColorTable& table,
                                                int pitch, const Limits& limits, int margin) {
  take_samples(image, table, pitch, limits);
  // Across a sample that noise or a highlight spoils.
  dilate(candidates_, {1, 1}, scratch_, joined_);
  regions_.find(joined_, 255, Connectivity::four);
  core_samples_.assign(regions_.regions().size(), 0);
  for (const ConnectedRegions::Run& run : regions_.runs()) {
    const std::uint8_t* const row = core_.row(run.y);
    core_samples_[run.region] =
        std::accumulate(row + run.first, row + run.last, core_samples_[run.region]);
  }
  windows_.clear();
  for (std::size_t i = 0; i < core_samples_.size(); ++i) {
    if (core_samples_[i] == 0 || core_samples_[i] < limits.fewest_core) continue;
    windows_.push_back(intersect(grow(regions_.regions()[i].box, margin), candidates_.bounds()));
  }
  join_overlapping();
  return windows_;
}

void CandidateWindows::take_samples(const Image<Bgr>& image, const ColorTable& table, int pitch,
                                    const Limits& limits) {
  candidates_.resize((image.width() + pitch - 1) / pitch, (image.height() + pitch - 1) / pitch);
  core_.resize(candidates_.width(), candidates_.height());
  for (int y = 0; y < candidates_.height(); ++y) {
    const Bgr* const row = image.row(std::min(y * pitch + pitch / 2, image.height() - 1));
    for (int x = 0; x < candidates_.width(); ++x) {
      const int column = std::min(x * pitch + pitch / 2, image.width() - 1);
      const Bgr& left = row[std::max(column - 1, 0)];
      const Bgr& right = row[column];
      const auto mean = [](int a, int b) { return static_cast<std::uint8_t>((a + b) / 2); };
      const ColorTable::Entry& entry =
          table({mean(left.b, right.b), mean(left.g, right.g), mean(left.r, right.r)});
      candidates_(x, y) = entry.neighbor <= limits.neighbor ? 255 : 0;
      core_(x, y) = entry.core <= limits.core ? 1 : 0;
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
