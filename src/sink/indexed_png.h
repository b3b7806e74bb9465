#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// Writes an indexed-colour PNG: a picture to look at whose pixels are numbers to read. `palette`
/// must have a colour for every index (1 to 256). Throws Error that names the file.
void write_indexed_png(const std::filesystem::path& file, const Image<std::uint8_t>& indices,
                       const std::vector<Bgr>& palette);

/// The indices of such a picture. Throws Error that names the file.
Image<std::uint8_t> read_indexed_png(const std::filesystem::path& file);

}  // namespace diminish
