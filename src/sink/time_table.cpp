#include "sink/time_table.h"

namespace diminish {
namespace {

constexpr std::array<TimeRow, time_row_count> rows{{
    {"poses", "Camera poses", ""},
    {"objects", "Objects", ""},
    {"estimation", "Depth estimation", ""},
    {"depth", "Depth cleaning", ""},
    {"samples", "Scene samples", ""},
    {"refinement", "Pose refinement", ""},
    {"background", "Background", ""},
    {"color_maps", "Colour maps", ""},
    {"memory", "Memory", ""},
    {"drawing", "Drawing", ""},
    {"merging", "Merging", ""},
    {"compositing", "Compositing", ""},
    {"colors", "Colours", ""},
    {"inpainting", "Inpainting", ""},
    {"finish", "Finish", ""},
    {"paper_poses", "Poses, detection", "8.2"},
    {"paper_reconstruction", "Reconstruction", "12.8"},
    {"paper_compositing", "Compositing, finish", "1.1"},
    {"paper_color_correction", "Colour correction", "13256"},
    {"paper_inpainting", "Inpainting", "1871"},
    {"total", "Whole frame", "15149"},
}};

/// The row of the paper's that a stage belongs to.
constexpr std::size_t paper_row(Stage stage) {
  switch (stage) {
    case Stage::poses:
    case Stage::objects:
      return stage_count;
    case Stage::estimation:
    case Stage::depth:
    case Stage::samples:
    case Stage::refinement:
    case Stage::background:
    case Stage::color_maps:
    case Stage::memory:
    case Stage::drawing:
    case Stage::merging:
      return stage_count + 1;
    case Stage::compositing:
    case Stage::finish:
      return stage_count + 2;
    case Stage::colors:
      return stage_count + 3;
    case Stage::inpainting:
      return stage_count + 4;
  }
  return whole_frame_row;
}

}  // namespace

std::span<const TimeRow, time_row_count> time_rows() {
  return rows;
}

std::array<double, time_row_count> times_of(const FrameReport& report) {
  std::array<double, time_row_count> times{};
  for (std::size_t i = 0; i < stage_count; ++i) {
    times[i] = report.milliseconds[i];
    times[paper_row(static_cast<Stage>(i))] += report.milliseconds[i];
  }
  times[whole_frame_row] = report.frame_ms;
  return times;
}

}  // namespace diminish
