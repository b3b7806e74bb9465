#include "dds/key_files.h"
#include "diminish/error.h"

namespace diminish::dds {

KeyFiles::KeyFiles(const std::filesystem::path&) {}

void check(const KeyFiles&) {
  throw Error("keys: this build is without OpenSSL, or its Fast DDS without DDS Security");
}

}  // namespace diminish::dds
