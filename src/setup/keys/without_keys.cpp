#include "diminish/error.h"
#include "setup/keys/keys.h"

namespace diminish {

KeysMade make_keys(const std::filesystem::path& folder, const KeysRequest&) {
  throw Error(folder.string() + ": this build is without Fast DDS or OpenSSL, which keys need");
}

}  // namespace diminish
