#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "camera/test/clock_code.h"
#include "commands.h"
#include "core/mat.h"
#include "diminish/error.h"
#include "diminish/web_server.h"
#include "live_setup.h"
#include "serve/http.h"
#include "serve/picture_stream.h"
#include "sink/distribution.h"

namespace diminish {
namespace {

struct LatencyTestCommand {
  LiveSetup setup;
  double seconds = 10;

  int execute();
};

struct Measured {
  std::vector<double> latencies_ms;
  std::size_t unreadable = 0;
};

/// Looks at the stream as a viewer does, and reads the time in each picture.
Measured look(int port, double seconds) {
  Measured measured;
  PictureStream pictures;
  const double end_s = monotonic_now_s() + seconds;
  httplib::Client client("127.0.0.1", port);
  client.Get("/api/stream.mjpg", [&](const char* data, std::size_t size) {
    pictures.feed(data, size);
    while (const auto streamed = pictures.next()) {
      Image<Bgr> picture;
      copy_from(cv::imdecode(streamed->jpeg, cv::IMREAD_COLOR), picture);
      const std::uint32_t now = clock_ticks(monotonic_now_s());
      if (const auto taken = read_clock_code(picture)) {
        measured.latencies_ms.push_back((now - *taken) / 10.0);
      } else {
        ++measured.unreadable;
      }
    }
    return monotonic_now_s() < end_s && !stop_requested();
  });
  return measured;
}

int LatencyTestCommand::execute() {
  stop_on_signals();
  setup.draw_clock = true;
  const LiveRun run = setup.start();
  if (!run.session->wait_for_frame(0, std::chrono::seconds(30))) {
    throw Error("latency-test: no picture within 30 s");
  }
  const WebServer web(*run.session, {.port = 0});
  const Measured measured = look(web.port(), seconds);
  const LiveStatus status = run.session->status();
  const Distribution seen = distribution_of(measured.latencies_ms);
  fmt::print("From the sensor's timestamp, ms{:>10}{:>10}{:>10}\n", "p50", "p95", "p99");
  fmt::print("  to the finished picture    {:>11.1f}{:>10.1f}{:>10.1f}\n", status.latency_ms.p50,
             status.latency_ms.p95, status.latency_ms.p99);
  fmt::print("  to a viewer, decompressed  {:>11.1f}{:>10.1f}{:>10.1f}\n", seen.p50, seen.p95,
             seen.p99);
  fmt::print("{} pictures seen in {:.0f} s, {} without a readable time; {:.1f} frames/s made\n",
             measured.latencies_ms.size(), seconds, measured.unreadable, status.frames_per_second);
  return measured.latencies_ms.empty() ? 1 : 0;
}

}  // namespace

void add_latency_test(CLI::App& program, int& exit_code) {
  auto command = std::make_shared<LatencyTestCommand>();
  CLI::App* sub = program.add_subcommand(
      "latency-test",
      "Measures the time from sensor to viewer with a clock drawn into the camera's pictures");
  command->setup.add_flags(*sub);
  sub->add_option("--seconds", command->seconds, "Duration")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 1e6))
      ->type_name("S");
  sub->callback([command, &exit_code] { exit_code = command->execute(); });
}

}  // namespace diminish
