#pragma once

#include <cstddef>

#include "dds/fast_dds.h"

namespace diminish::dds {

/// All messages' type. A message may be read where its sender writes the next one.
class PayloadType : public BytesType {
 public:
  using BytesType::BytesType;

  /// Room for the largest is kept, so that senders may write where readers read.
  bool is_bounded() const override { return true; }
  bool write(const Bytes& bytes, rtps::SerializedPayload_t& payload) const override;
  /// False if the sender has begun to write its next message there.
  bool read(const rtps::SerializedPayload_t& payload, Bytes& bytes) const override;
  /// Whether a message that was taken from a payload is still in it.
  static bool is_still_there(const Bytes& taken, const rtps::SerializedPayload_t& payload);
};

}  // namespace diminish::dds
