#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "diminish/image.h"

namespace diminish {

/// Writes an indexed-colour PNG, a picture whose pixels are also numbers, completely or not at all.
/// `palette` must have a colour for every index (1 to 256). Throws Error that names the file.
void write_indexed_png(const std::filesystem::path& file, const Image<std::uint8_t>& indices,
                       const std::vector<Bgr>& palette);

/// Reads the indices of such a picture. Throws Error that names the file.
Image<std::uint8_t> read_indexed_png(const std::filesystem::path& file);

}  // namespace diminish
