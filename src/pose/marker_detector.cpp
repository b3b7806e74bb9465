#include "diminish/marker_detector.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "core/shrink.h"
#include "core/tasks.h"
#include "pose/aruco.h"
#include "pose/corner_refinement.h"
#include "pose/dark_regions.h"
#include "pose/marker_code.h"
#include "pose/quad_candidates.h"

namespace diminish {
namespace {

/// Of two finds of the same marker.
constexpr double same_place_px = 6;

/// Removes every marker whose id occurs in more than one place. `markers` is sorted by id.
void remove_ambiguous(std::vector<Marker>& markers) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < markers.size();) {
    std::size_t next = i + 1;
    bool one_place = true;
    while (next < markers.size() && markers[next].id == markers[i].id) {
      one_place =
          one_place && (markers[next].corners[0] - markers[i].corners[0]).norm() < same_place_px;
      ++next;
    }
    if (one_place) markers[kept++] = markers[i];
    i = next;
  }
  markers.resize(kept);
}

}  // namespace

struct MarkerDetector::Implementation {
  explicit Implementation(const std::string& dictionary) : code(find_dictionary(dictionary)) {}

  MarkerCode code;
  std::optional<Marker> read(ImageView<Bgr> image, const Lens& lens, Quad quad) const {
    const int modules = code.modules();
    if (!refine_corners(image, lens, modules, coarse_pass, quad) ||
        !refine_corners(image, lens, modules, middle_pass, quad)) {
      return std::nullopt;
    }
    const auto reading = code.read(image, quad);
    if (!reading) return std::nullopt;
    refine_corners(image, lens, modules, fine_pass, quad);
    std::rotate(quad.begin(), quad.begin() + reading->top_left, quad.end());
    return Marker{reading->id, quad};
  }

  Image<std::uint8_t> small;
  DarkRegions dark_regions;
  QuadCandidates candidates;
  std::vector<std::optional<Marker>> found;  ///< by candidate
};

MarkerDetector::MarkerDetector(const std::string& dictionary)
    : implementation_(std::make_unique<Implementation>(dictionary)) {}
MarkerDetector::~MarkerDetector() = default;
MarkerDetector::MarkerDetector(MarkerDetector&&) noexcept = default;
MarkerDetector& MarkerDetector::operator=(MarkerDetector&&) noexcept = default;

void MarkerDetector::detect(ImageView<Bgr> image, const Lens& lens, std::vector<Marker>& markers) {
  Implementation& self = *implementation_;
  markers.clear();
  shrink_green(image, self.small);
  const std::vector<Quad>& candidates = self.candidates.find(self.dark_regions.find(self.small));
  self.found.resize(candidates.size());
  for_tasks(candidates.size(),
            [&](std::size_t i) { self.found[i] = self.read(image, lens, candidates[i]); });
  for (const std::optional<Marker>& marker : self.found) {
    if (!marker) continue;
    const auto by_id = [](int id, const Marker& other) { return id < other.id; };
    markers.insert(std::upper_bound(markers.begin(), markers.end(), marker->id, by_id), *marker);
  }
  remove_ambiguous(markers);
}

}  // namespace diminish
