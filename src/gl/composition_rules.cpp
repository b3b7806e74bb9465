#include "gl/composition_rules.h"

#include "composite/color_smoothing.h"
#include "composite/shadow_lifting.h"
#include "composite/view_mode_rules.h"
#include "diminish/diminished_frame.h"
#include "gl/definitions.h"
#include "gl/frame_block.h"
#include "membrane/soft_membrane.h"
#include "scene/background_planes.h"
#include "scene/cast_shadows.h"
#include "scene/color_map.h"

namespace diminish::gl {
namespace {

std::string define_smoothing() {
  using Smoothing = ColorSmoothing;
  std::string neighbours;
  for (int dy = -Smoothing::reach; dy <= Smoothing::reach; ++dy) {
    for (int dx = -Smoothing::reach; dx <= Smoothing::reach; ++dx) {
      if (!Smoothing::is_neighbour(dx, dy)) continue;
      neighbours += fmt::format("{}ivec2({}, {})", neighbours.empty() ? "" : ", ", dx, dy);
    }
  }
  return define_as("SMOOTHING_NEIGHBOURS", "ivec2[](" + neighbours + ")") +
         define("SMOOTHING_LARGEST_DIFFERENCE", Smoothing::largest_difference) +
         define_as("SMOOTHING_WEIGHT_PART", fmt::format("{}u", Smoothing::weight_part)) +
         define("SMOOTHING_WHOLE_CHANGE", Smoothing::whole_change) +
         define_as("SMOOTHING_ONE", fmt::format("{}u", Smoothing::one));
}

}  // namespace

std::string composition_rules() {
  using Membrane = SoftMembrane;
  constexpr int samples = Membrane::cell / Membrane::step;
  return define("MOST_PLANES", BackgroundPlanes::most_planes) +
         define("MOST_CAMERAS", most_cameras) + define("RAY_STEP", RayGrid::step) +
         define("PLANE_NOISE", BackgroundPlanes::tolerance) + define("DEPTH_NOISE", DepthNoise{}) +
         define("SURFACE_UNKNOWN", surface_label::unknown) +
         define("SURFACE_FIRST_PLANE", surface_label::first_plane) +
         define("SURFACE_FOREGROUND", surface_label::foreground) +
         define("GRID_CELLS", CastShadow::grid_cells) + define("CELL_M", CastShadow::cell_m) +
         define("LIGHT_NODE_PX", CastShadows::node_px) +
         define("LIGHT_NODE_ROWS_PX", CastShadows::node_rows_px) +
         define("INVISIBLE_SHADOW", CastShadow::invisible) +
         define("SHADOW_FADING_HEIGHT", CastShadows::fading_height) +
         define("SHADOW_FADING_PX", ShadowLifting::fading_px) +
         define("LEAST_FIELD", ColorMap::least_field) +
         define("GREATEST_FIELD", ColorMap::greatest_field) + define("NODE_PX", Membrane::cell) +
         define("SAMPLE_STEP", Membrane::step) +
         define("SAMPLE_WEIGHT", Membrane::full_weight / (samples * samples)) +
         define("LARGEST_DEVIATION", Membrane::largest_deviation) +
         define("LARGEST_SPREAD", Membrane::largest_spread) +
         define("LARGEST_MEDIAN", Membrane::largest_median) +
         define("MEMBRANE_FADING", Membrane::fading) + define("MEMBRANE_SWEEPS", Membrane::sweeps) +
         define("PROVENANCE_CAMERA", provenance::camera) +
         define("PROVENANCE_INPAINTED", provenance::inpainted) +
         define("XRAY_FULL_DIFFERENCE", xray::full_difference) +
         define("XRAY_LEAST_STRENGTH", xray::least_strength) +
         define("XRAY_OPACITY", xray::opacity) + define("XRAY_LINE_COLOR", xray::line_color) +
         define("OUTLINE_WIDTH_PX", outline::width_px) +
         define("OUTLINE_LINE_COLOR", outline::line_color) +
         define("PROVENANCE_TINT", provenance_view::tint) +
         define("PROVENANCE_SEEN_COLOR", provenance_view::seen_color) +
         define("PROVENANCE_INVENTED_COLOR", provenance_view::invented_color) +
         define("PROVENANCE_PERIOD_PX", provenance_view::period_px) +
         define("PROVENANCE_LINE_PX", provenance_view::line_px) + define_smoothing();
}

}  // namespace diminish::gl
