#include "ros/message_writer.h"

namespace diminish::ros {
namespace {

constexpr std::array<std::uint8_t, 4> cdr_header = {0, 1, 0, 0};  // CDR_LE

}  // namespace

MessageWriter::MessageWriter(std::vector<std::uint8_t>& message, Wire wire)
    : message_(message), wire_(wire) {
  message_.clear();
  if (wire == Wire::cdr) append(cdr_header);
}

void MessageWriter::align(std::size_t size) {
  if (wire_ == Wire::ros1) return;
  const std::size_t past = (message_.size() - cdr_header.size()) % size;
  if (past != 0) message_.resize(message_.size() + size - past);
}

void MessageWriter::text(std::string_view text) {
  count(text.size() + (wire_ == Wire::cdr ? 1 : 0));
  message_.insert(message_.end(), text.begin(), text.end());
  if (wire_ == Wire::cdr) message_.push_back(0);
}

void MessageWriter::bytes(std::span<const std::uint8_t> bytes) {
  count(bytes.size());
  append(bytes);
}

std::span<std::uint8_t> MessageWriter::reserve_bytes(std::size_t length) {
  count(length);
  message_.resize(message_.size() + length);
  return std::span(message_).last(length);
}

}  // namespace diminish::ros
