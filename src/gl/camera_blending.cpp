#include "gl/camera_blending.h"

#include <algorithm>

#include "blend/confidence_grid.h"
#include "gl/definitions.h"
#include "gl/result_pixel.h"

namespace diminish::gl {
namespace {

using Grid = ConfidenceGrid;

std::string blending_rules() {
  return define("MOST_CAMERAS", most_cameras) + define("DEPTH_NOISE", DepthNoise{}) +
         define("WINDOW_REACH", blending::window_reach) +
         define("LEAST_PART", blending::least_part) +
         define("LEAST_CONFIDENCE", blending::least_confidence) + define("CELL_PX", Grid::cell_px) +
         define("CELL_REACH", Grid::reach) + define("LEAST_RESOLUTION", Grid::least_resolution) +
         define("MOST_RESOLUTION", Grid::most_resolution) +
         define("NOT_COVERED", Grid::not_covered) + define("LEAST_ANGLE", Grid::least_angle) +
         define("SMOOTHING", Grid::smoothing);
}

Program blending_pass(const std::vector<std::string>& seen_files, const char* last) {
  std::vector<std::string> files = files_before(seen_files);
  files.insert(files.end(), {"blending.glsl", last});
  return compute_program(std::move(files), blending_rules());
}

Program color_pass(const std::vector<std::string>& seen_files) {
  std::vector<std::string> files = files_before(seen_files);
  files.emplace_back("color.comp");
  return compute_program(std::move(files), "#define BLENDED\n");
}

/// blending.glsl's grid_size().
Rect blending_cells(const Rect& region) {
  return {0, 0, std::max(1, region.width / Grid::cell_px),
          std::max(1, region.height / Grid::cell_px)};
}

/// In rows of 64.
void dispatch(const Program& program, const Rect& size, std::size_t depth = 1) {
  program.use();
  glDispatchCompute(static_cast<GLuint>((size.width + 63) / 64), static_cast<GLuint>(size.height),
                    static_cast<GLuint>(depth));
}

}  // namespace

std::vector<std::string> files_before(const std::vector<std::string>& seen_files) {
  std::vector<std::string> files = {"frame.glsl", "sdct.glsl", "texture.glsl", "work.glsl"};
  files.insert(files.end(), seen_files.begin(), seen_files.end());
  files.emplace_back("seen.glsl");
  return files;
}

CameraBlending::CameraBlending(const Rig& rig, const std::vector<std::string>& seen_files)
    : seen_(blending_pass(seen_files, "blend_seen.comp")),
      cells_(blending_pass(seen_files, "blend_cells.comp")),
      trust_(blending_pass(seen_files, "blend_trust.comp")),
      smooth_(blending_pass(seen_files, "blend_smooth.comp")),
      choose_(blending_pass(seen_files, "blend_choose.comp")),
      color_(color_pass(seen_files)) {
  constexpr std::size_t cell_bytes = 4 * sizeof(float);
  const Rect whole = rig.color.bounds();
  seen_by_.reserve(pixels_of(whole) * sizeof(std::uint32_t));
  cell_values_.reserve(blending::most_cameras * pixels_of(blending_cells(whole)) * cell_bytes);
}

void CameraBlending::pack(FrameUpload& upload) {
  auto* const places = reinterpret_cast<CameraPlaceBlock*>(
      upload.add(most_cameras * sizeof(CameraPlaceBlock), places_begin_));
  for (int k = 0; k < upload.cameras(); ++k) {
    places[k] = CameraPlaceBlock(upload.camera(k).color_from_depth);
  }
}

void CameraBlending::run(const FrameUpload& upload, const Rect& region, const Buffer& work,
                         PassTimer& timer) {
  const Rect cells = blending_cells(region);
  const std::size_t most_turns =
      std::min(static_cast<std::size_t>(upload.cameras()), blending::most_cameras);
  const auto finish = [] { glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT); };
  upload.bind_block(2, places_begin_, most_cameras * sizeof(CameraPlaceBlock));
  work.bind(1);
  seen_by_.bind(2);
  cell_values_.bind(3);
  timer.measure("agree", [&] {
    dispatch(seen_, region);
    finish();
  });
  timer.measure("trust", [&] {
    for (int k = 0; k < upload.cameras(); ++k) {
      upload.bind_camera(k);
      dispatch(cells_, cells);
    }
    finish();
    dispatch(trust_, cells, most_turns);
    finish();
    dispatch(smooth_, cells, most_turns);
    finish();
  });
  timer.measure("blend", [&] {
    dispatch(choose_, region);
    finish();
  });
  timer.measure("color", [&] {
    for (int k = 0; k < upload.cameras(); ++k) {
      upload.bind_camera(k);
      dispatch(color_, region);
    }
    finish();
  });
}

}  // namespace diminish::gl
