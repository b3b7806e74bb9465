#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include "diminish/export.h"
#include "diminish/live.h"

namespace diminish {

struct WebServerOptions {
  /// On which of the machine's addresses. Other ones than loopback need a token.
  std::string address = "127.0.0.1";
  /// 0: any that is free.
  int port = 8080;
  /// What requests must carry, as "Authorization: Bearer TOKEN" or "?token=TOKEN". Empty: nothing.
  std::string token;
  /// Where recordings that are asked for go, each into a folder of its own; empty: none can be
  /// made.
  std::filesystem::path recordings;
  /// The set-up's files, for recordings.
  std::filesystem::path rig_file, scene_file;
  /// Pictures are streamed to so many at a time; further ones are told to come back later.
  std::size_t most_viewers = 16;
  /// Of streamed pictures, 1 to 100.
  int jpeg_quality = 85;
};

/// A live session on a web page, and behind it an HTTP API (docs/http-api.md). Has threads of its
/// own. A picture is compressed once for all who look; those who are slow get fewer.
class DIMINISH_EXPORT WebServer {
 public:
  /// Starts. Throws Error if the address cannot be used, or needs a token and has none.
  WebServer(LiveSession& session, const WebServerOptions& options);
  /// Stops; ends the recording.
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
