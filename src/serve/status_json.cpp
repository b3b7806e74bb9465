#include "serve/status_json.h"

#include <cmath>

#include "serve/advice.h"

namespace diminish {
namespace {

using Json = nlohmann::ordered_json;

/// Enough digits to read: the status goes over the network several times a second.
double rounded(double value) {
  return std::round(value * 100) / 100;
}

Json camera_json(const CameraStatus& camera) {
  Json json = {{"name", camera.name},
               {"uri", camera.uri},
               {"state", camera_state_names[static_cast<std::size_t>(camera.state)]},
               {"problem", camera.problem},
               {"images_per_second", rounded(camera.images_per_second)},
               {"images", camera.images},
               {"dropped", camera.dropped},
               {"duplicates", camera.duplicates},
               {"out_of_order", camera.out_of_order},
               {"wrong_size", camera.wrong_size},
               {"damaged", camera.damaged},
               {"stalls", camera.stalls},
               {"failures", camera.failures},
               {"reconnects", camera.reconnects}};
  if (camera.clock) {
    json["clock"] = {{"offset_ms", rounded(camera.clock->offset_s * 1e3)},
                     {"drift_ppm", rounded(camera.clock->drift * 1e6)},
                     {"trusted", camera.clock->is_trusted}};
  }
  return json;
}

}  // namespace

Json to_json(const LiveStatus& status, const Options& options) {
  Json json = {{"running", status.running},
               {"ended", status.ended},
               {"frames", status.frames},
               {"skipped", status.skipped},
               {"failed", status.failed},
               {"frames_per_second", rounded(status.frames_per_second)},
               {"latency_ms",
                {{"p50", rounded(status.latency_ms.p50)},
                 {"p95", rounded(status.latency_ms.p95)},
                 {"p99", rounded(status.latency_ms.p99)}}},
               {"frame_ms", rounded(status.frame_ms)},
               {"budget_ms", status.budget_ms},
               {"quality_level", status.quality_level},
               {"quality", status.quality},
               {"mode", options.mode},
               {"mask_share", rounded(status.mask_share)},
               {"seen_share", rounded(status.seen_share)},
               {"witnessed_share", rounded(status.witnessed_share)},
               {"remembered_share", rounded(status.remembered_share)},
               {"estimated_share", rounded(status.estimated_share)},
               {"invented_share", rounded(status.invented_share)},
               {"evidence", status.evidence},
               {"memory",
                {{"keyframes", status.memory.keyframes},
                 {"megabytes", rounded(static_cast<double>(status.memory.bytes) / 1e6)},
                 {"median_age_s", rounded(status.memory.median_age_s)},
                 {"oldest_age_s", rounded(status.memory.oldest_age_s)}}},
               {"problems", status.problems}};
  for (std::size_t i = 0; i < stage_count; ++i) {
    json["stage_ms"][stage_names[i]] = rounded(status.stage_ms[i]);
  }
  json["to_do"] = Json::array();
  for (const std::string& problem : status.problems) json["to_do"].push_back(advice_for(problem));
  json["cameras"] = Json::array();
  for (const CameraStatus& camera : status.cameras) json["cameras"].push_back(camera_json(camera));
  json["posed"] = status.posed;
  json["markers"] = status.markers;
  json["objects"] = Json::array();
  for (const OccluderReport& occluder : status.occluders) {
    json["objects"].push_back({{"name", occluder.name},
                               {"kept", occluder.kept},
                               {"in_color", occluder.in_color},
                               {"message", occluder.message}});
  }
  return json;
}

}  // namespace diminish
