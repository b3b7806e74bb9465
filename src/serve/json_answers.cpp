#include "serve/json_answers.h"

#include "serve/http.h"

namespace diminish {

using Json = nlohmann::ordered_json;

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void answer(httplib::Response& response, const Json& json, int status) {
  response.status = status;
  response.set_header("Cache-Control", "no-store");
  response.set_content(text_of(json), "application/json");
}

void refuse(httplib::Response& response, int status, const std::string& why) {
  answer(response, {{"error", why}}, status);
}

}  // namespace diminish
