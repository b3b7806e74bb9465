#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace httplib {
struct Response;
}  // namespace httplib

namespace diminish {

/// JSON on one line. What is not UTF-8 is replaced.
std::string text_of(const nlohmann::ordered_json& json);

/// Answers with JSON that no browser keeps.
void answer(httplib::Response& response, const nlohmann::ordered_json& json, int status = 200);

/// Answers {"error": why}.
void refuse(httplib::Response& response, int status, const std::string& why);

}  // namespace diminish
