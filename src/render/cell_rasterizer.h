#pragma once

#include "render/sdct.h"
#include "render/surface_buffer.h"
#include "render/vertex_row.h"

namespace diminish {

/// Draws the cells between 16 vertices of two neighbouring rows and the vertices to their right and
/// below (rules 2 to 5 of sdct.h). Edges and planes of neighbouring cells are set up together. Then
/// each cell is drawn as one quadrilateral, a vector of pixels at a time.
void draw_cells(const VertexRow& upper, const VertexRow& lower, int block,
                const sdct::Threshold& threshold, SurfaceBuffer& surface);

}  // namespace diminish
