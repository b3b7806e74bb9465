#include "paths.h"

namespace diminish::testing {

std::string recordings_dir() {
  return DIMINISH_RECORDINGS_DIR;
}
std::string docs_dir() {
  return DIMINISH_DOCS_DIR;
}
std::string source_test_data() {
  return DIMINISH_SOURCE_TEST_DATA;
}
std::string program() {
  return DIMINISH_PROGRAM;
}

}  // namespace diminish::testing
