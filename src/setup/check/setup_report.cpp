#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "diminish/setup_check.h"

namespace diminish {
namespace {

const char* name_of(Finding::Severity severity) {
  return severity == Finding::Severity::serious ? "serious" : "warning";
}

}  // namespace

std::string setup_report_text(const SetupReport& report) {
  std::string text;
  const auto out = std::back_inserter(text);
  for (const SetupFigure& figure : report.figures) {
    fmt::format_to(out, "{:<66} {:>9.2f} {}\n", figure.name, figure.value, figure.unit);
  }
  for (const Finding& finding : report.findings) {
    fmt::format_to(out, "\n[{}] {}: {}\n  measured: {}\n  to do: {}\n", name_of(finding.severity),
                   finding.code, finding.what, finding.figure, finding.remedy);
  }
  fmt::format_to(out, "\n{} frames: {}\n", report.frames,
                 report.fine() ? "no problems found"
                               : fmt::format("{} {}", report.findings.size(),
                                             report.findings.size() == 1 ? "finding" : "findings"));
  return text;
}

std::string setup_report_json(const SetupReport& report) {
  nlohmann::ordered_json json;
  json["frames"] = report.frames;
  json["findings"] = nlohmann::ordered_json::array();
  for (const Finding& finding : report.findings) {
    json["findings"].push_back({{"severity", name_of(finding.severity)},
                                {"code", finding.code},
                                {"what", finding.what},
                                {"figure", finding.figure},
                                {"remedy", finding.remedy}});
  }
  json["figures"] = nlohmann::ordered_json::array();
  for (const SetupFigure& figure : report.figures) {
    json["figures"].push_back(
        {{"name", figure.name}, {"value", figure.value}, {"unit", figure.unit}});
  }
  return json.dump(2) + "\n";
}

}  // namespace diminish
