#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include "diminish/export.h"
#include "diminish/live.h"

namespace diminish {

struct WebServerOptions {
  /// The address to listen on. Any address but loopback needs a token.
  std::string address = "127.0.0.1";
  /// 0: any free port.
  int port = 8080;
  /// The token that requests must carry, as "Authorization: Bearer TOKEN", "?token=TOKEN" or the
  /// cookie that the page gets. Letters, digits and "-._~". Empty: none.
  std::string token;
  /// The folder for recordings, each in a folder of its own. Empty: recording is not allowed.
  std::filesystem::path recordings;
  /// The set-up's files, which recordings copy.
  std::filesystem::path rig_file, scene_file;
  /// The most viewers of streams at a time. Further ones are told to come back later.
  std::size_t most_viewers = 16;
  /// Quality of streamed pictures, 1 to 100.
  int jpeg_quality = 85;
};

/// A live session on a web page, with an HTTP API behind it (docs/http-api.md). Has its own
/// threads. Each picture is compressed once for all viewers; slow viewers get fewer.
class DIMINISH_EXPORT WebServer {
 public:
  /// Starts. Throws Error if the address cannot be used, or needs a token and there is none.
  WebServer(LiveSession& session, const WebServerOptions& options);
  /// Stops, and ends the recording.
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  int port() const;
  /// "http://127.0.0.1:8080/"
  std::string url() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace diminish
