#include "serve/picture_stream.h"

#include <charconv>
#include <string_view>

#include "diminish/error.h"

namespace diminish {
namespace {

std::size_t number_in(std::string_view head, std::string_view name) {
  const std::size_t at = head.find(name);
  std::size_t number = 0;
  if (at != std::string_view::npos) {
    const char* first = head.data() + at + name.size();
    if (std::from_chars(first, head.data() + head.size(), number).ec == std::errc{}) return number;
  }
  throw Error(Error::input, "picture stream: expected '" + std::string(name) + "' and a number");
}

}  // namespace

std::optional<PictureStream::Picture> PictureStream::next() {
  constexpr std::string_view head_end = "\r\n\r\n";
  constexpr std::string_view part_end = "\r\n";
  const std::size_t head_size = waiting_.find(head_end);
  if (head_size == std::string::npos) return std::nullopt;
  const std::string_view head = std::string_view(waiting_).substr(0, head_size);
  const std::size_t length = number_in(head, "Content-Length: ");
  const std::size_t begin = head_size + head_end.size();
  const std::size_t there = waiting_.size() - begin;
  if (there < part_end.size() || there - part_end.size() < length) return std::nullopt;
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(waiting_.data()) + begin;
  Picture picture{number_in(head, "X-Frame: "), {bytes, bytes + length}};
  waiting_.erase(0, begin + length + part_end.size());
  return picture;
}

}  // namespace diminish
