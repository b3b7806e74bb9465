#pragma once

#include <cstdint>
#include <span>

namespace diminish {

/// What is wrong with an image file that decoders fill up or report on stderr: "the file is
/// cut short", "the file is damaged". Null: nothing; it may still be impossible to decode. Cost:
/// reads a PNG once.
const char* damage_of(std::span<const std::uint8_t> bytes);

}  // namespace diminish
