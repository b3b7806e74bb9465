#include "detect/color_blob/color_blob_finder.h"

#include <algorithm>
#include <iterator>
#include <span>

#include "core/extremum_filters.h"
#include "core/shrink.h"

namespace diminish {
namespace {

// How far the colours of highlights and shadows on the object may deviate, in spreads.
constexpr double round_factors[] = {1.0, 1.5, 2.0, 3.0, 4.0};
constexpr double any_factors[] = {2.0};
constexpr double smallest_core = 1.0 / 5;  // of a region's pixels

std::span<const double> factors(bool round) {
  return round ? std::span<const double>(round_factors) : std::span<const double>(any_factors);
}

/// The pixels that are set in both masks.
int count_both(const Mask& a, const Mask& b) {
  int count = 0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) count += (a(x, y) & b(x, y)) != 0 ? 1 : 0;
  }
  return count;
}

}  // namespace

bool ColorBlobFinder::find(ImageView<Bgr> image, double spread, Mask& mask) {
  find_windows(image, spread);
  bool found = false;
  double best_score = 0;
  Rect best_window;
  for (const Rect& window : windows_) {
    segmentation_.segment(image, window);
    find_levels(spread);
    if (round_) {
      const double score = find_round_region(best_score);
      if (score <= best_score) continue;
      best_score = score;
      best_window = window;
    } else if (find_any_region()) {
      refine(image, window, mask);
      found = true;
    }
  }
  if (best_score == 0) return found;
  refine(image, best_window, mask);
  return true;
}

/// The parts of the picture that may show the object: around the connected regions of pixels of its
/// colour, generously. Dividing the rest into blobs would be in vain.
void ColorBlobFinder::find_windows(ImageView<Bgr> image, double spread) {
  constexpr double smallest_area = 1.0 / 16;  // of the smallest object in the training images
  constexpr double generously = 1.5;
  constexpr int sample = 2;  // segment pixels wide and high
  // What looks like the object beside it is told from it by the blobs' mean colours, for which they
  // must be seen for the most part. A round object is told from it by its shape, too.
  constexpr int margin = 4;  // samples
  const double margin_part = round_ ? 0 : 0.25;
  const int scale = BlobSegmentation::scale(image);
  const Rect picture = shrunk_bounds(image, scale);
  fewest_pixels_ =
      std::max(16.0, smallest_area * model_.smallest_area * picture.width * picture.height);
  const auto entries = [&](double factor) {
    return static_cast<int>(generously * factor * spread * ColorTable::per_deviation);
  };
  const CandidateWindows::Limits limits{entries(1), entries(factors(round_).back()),
                                        smallest_core / 4 * fewest_pixels_ / (sample * sample),
                                        margin, margin_part};
  windows_.clear();
  for (const Rect& window : candidates_.find(image, table_, sample * scale, limits)) {
    const Rect pixels{sample * window.x, sample * window.y, sample * window.width,
                      sample * window.height};
    windows_.push_back(intersect(pixels, picture));
  }
}

/// `levels_`: by which of the factors the spread must be multiplied for a pixel's blob to be within
/// it; `core_`: the blobs that are within the spread itself.
void ColorBlobFinder::find_levels(double spread) {
  const auto limits = factors(round_);
  const Image<std::uint32_t>& labels = segmentation_.labels();
  // Blob 0 is the lines between blobs.
  level_of_blob_.assign(static_cast<std::size_t>(segmentation_.blob_count()),
                        static_cast<std::uint8_t>(limits.size()));
  core_of_blob_.assign(level_of_blob_.size(), 0);
  for (int blob = 1; blob < segmentation_.blob_count(); ++blob) {
    const ColorDeviation deviation = model_.deviation(segmentation_.mean_bgr(blob));
    // Shading changes the brightness most.
    const double neighbor = std::max(deviation.tint, deviation.value / 2);
    const auto level = std::find_if(limits.begin(), limits.end(),
                                    [&](double factor) { return neighbor <= factor * spread; });
    level_of_blob_[blob] = static_cast<std::uint8_t>(level - limits.begin());
    core_of_blob_[blob] = std::max(deviation.tint, deviation.value) <= spread ? 255 : 0;
  }
  levels_.resize(labels.width(), labels.height());
  selected_.resize(labels.width(), labels.height());
  const auto look_up = [&](const std::vector<std::uint8_t>& of_blob, Image<std::uint8_t>& to) {
    std::transform(labels.begin(), labels.end(), to.begin(),
                   [by_blob = of_blob.data()](std::uint32_t blob) { return by_blob[blob]; });
  };
  look_up(level_of_blob_, levels_);
  look_up(core_of_blob_, selected_);
  dilate(selected_, {1, 1}, scratch_, closed_);
  erode(closed_, {1, 1}, scratch_, core_);
}

/// Makes `region_` the roundest region, larger ones preferred, if its score is better than the best
/// so far. How far the colours may deviate next to the core
/// is right where the region becomes round: less leaves out highlights, more takes in neighbours.
double ColorBlobFinder::find_round_region(double best_score) {
  constexpr double all_holes = 1;
  known_count_ = 0;
  for (int level = 0; level < static_cast<int>(factors(round_).size()); ++level) {
    if (!select_blobs(level)) continue;
    for (const ConnectedRegions::Region& region : selected_regions_.regions()) {
      if (!find_component(region, all_holes) || is_known_outline()) continue;
      const auto shape = shape_fitter_.fit(outline_, component_, component_.bounds());
      if (!shape || !is_round(*shape)) continue;
      const double score = shape->agreement * shape->agreement * shape->diameter();
      if (score <= best_score) continue;
      best_score = score;
      std::swap(region_, component_);
      draw(shape->ellipse, region_);
    }
  }
  return best_score;
}

bool ColorBlobFinder::find_any_region() {
  constexpr double small_holes = 0.1;
  if (!select_blobs(0)) return false;
  region_.resize(selected_.width(), selected_.height(), 0);
  bool any = false;
  for (const ConnectedRegions::Region& region : selected_regions_.regions()) {
    if (!find_component(region, small_holes)) continue;
    std::transform(component_.begin(), component_.end(), region_.begin(), region_.begin(),
                   [](std::uint8_t a, std::uint8_t b) { return std::max(a, b); });
    any = true;
  }
  return any;
}

/// The blobs up to a level, joined across the lines between them, and their connected regions.
/// Returns false if no blob is of this level: the regions are those of the level before.
bool ColorBlobFinder::select_blobs(int level) {
  if (std::find(levels_.begin(), levels_.end(), level) == levels_.end()) return false;
  std::transform(levels_.begin(), levels_.end(), selected_.begin(),
                 [level](std::uint8_t own) -> std::uint8_t { return own <= level ? 255 : 0; });
  dilate(selected_, {1, 1}, scratch_, closed_);
  erode(closed_, {1, 1}, scratch_, selected_);
  if (round_) {  // no ball has an edge or a pole of its colour behind it for a handle
    open_by_disc();
  }
  selected_regions_.find(selected_, Pixels::set, Connectivity::eight);
  return true;
}

/// Leaves of `selected_` what a disc of 5 pixels' diameter fits in.
void ColorBlobFinder::open_by_disc() {
  // The disc is a rectangle and a column.
  constexpr Reach rectangle{2, 1};
  constexpr Reach column{0, 2};
  const auto combine = [](const Mask& from, auto&& choose, Mask& to) {
    std::transform(from.begin(), from.end(), to.begin(), to.begin(), choose);
  };
  erode(selected_, rectangle, scratch_, opened_);
  erode(selected_, column, scratch_, closed_);
  combine(
      closed_, [](std::uint8_t a, std::uint8_t b) { return std::min(a, b); }, opened_);
  dilate(opened_, rectangle, scratch_, selected_);
  dilate(opened_, column, scratch_, closed_);
  combine(
      closed_, [](std::uint8_t a, std::uint8_t b) { return std::max(a, b); }, selected_);
}

/// Makes `component_` and `outline_` those of a region of `selected_` and returns whether it is
/// large enough and holds enough of the core: highlights and shadows on the object deviate more
/// than its mean colour does, but are next to it.
bool ColorBlobFinder::find_component(const ConnectedRegions::Region& region, double largest_hole) {
  if (region.box.width * region.box.height < fewest_pixels_) return false;
  trace_outline(selected_, selected_regions_.first_pixel(region), outline_);
  if (polygon_area(outline_) < fewest_pixels_ / 2) return false;
  component_.resize(selected_.width(), selected_.height(), 0);
  selected_regions_.for_each_run(region, [&](const ConnectedRegions::Run& run) {
    std::fill(component_.row(run.y) + run.first, component_.row(run.y) + run.last,
              std::uint8_t{255});
  });
  component_pixels_ = region.pixels;
  fill_holes(largest_hole);
  const int core = count_both(component_, core_);
  return component_pixels_ >= fewest_pixels_ && core >= smallest_core * component_pixels_;
}

/// Fills the holes of `component_`, but for those larger than a part of it, where only blobs stay.
void ColorBlobFinder::fill_holes(double largest_hole) {
  gaps_.find(component_, Pixels::clear, Connectivity::four);
  const Rect inner = grow(component_.bounds(), -1);
  const auto is_hole = [&](const ConnectedRegions::Region& gap) {
    return intersect(gap.box, inner) == gap.box;
  };
  for (const ConnectedRegions::Region& gap : gaps_.regions()) {
    if (is_hole(gap)) component_pixels_ += gap.pixels;
  }
  for (const ConnectedRegions::Run& run : gaps_.runs()) {
    const ConnectedRegions::Region& gap = gaps_.regions()[run.region];
    if (!is_hole(gap)) continue;
    std::uint8_t* const row = component_.row(run.y);
    if (gap.pixels <= largest_hole * component_pixels_) {
      std::fill(row + run.first, row + run.last, std::uint8_t{255});
    } else {
      const std::uint8_t* const blobs = selected_.row(run.y);
      std::copy(blobs + run.first, blobs + run.last, row + run.first);
    }
  }
}

bool ColorBlobFinder::is_known_outline() {
  const auto end = known_outlines_.begin() + static_cast<std::ptrdiff_t>(known_count_);
  if (std::find(known_outlines_.begin(), end, outline_) != end) return true;
  if (known_count_ == known_outlines_.size()) known_outlines_.emplace_back();
  known_outlines_[known_count_++] = outline_;
  return false;
}

void ColorBlobFinder::refine(ImageView<Bgr> image, const Rect& window, Mask& mask) {
  const Rect part =
      refinement_.refine(image, region_, window, BlobSegmentation::scale(image), object_);
  object_regions_.find(object_, Pixels::set, Connectivity::eight);
  for (const ConnectedRegions::Run& run : object_regions_.runs()) {
    std::uint8_t* const row = mask.row(part.y + run.y) + part.x;
    std::fill(row + run.first, row + run.last, std::uint8_t{255});
  }
  if (round_) complete_round_shape(part, mask);
}

/// Fills what is missing of the outline: a part in the shadow, or against a similar colour.
void ColorBlobFinder::complete_round_shape(const Rect& part, Mask& mask) {
  outline_.clear();
  for (const ConnectedRegions::Region& region : object_regions_.regions()) {
    trace_outline(object_, object_regions_.first_pixel(region), other_outline_);
    if (other_outline_.size() > outline_.size()) std::swap(outline_, other_outline_);
  }
  const Rect picture{-part.x, -part.y, mask.width(), mask.height()};
  auto shape = shape_fitter_.fit(outline_, object_, picture);
  if (!shape || !is_round(*shape)) return;
  shape->ellipse.center += Eigen::Vector2d(part.x, part.y);
  draw(shape->ellipse, mask);
}

}  // namespace diminish
