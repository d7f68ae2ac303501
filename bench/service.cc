// bench/service.cc : what the service adds to the library.
//
// In:   boxes on a floor, 180x180 pixels, 8 lights; a server in this process, over loopback.
// Out:  for Fit and FitSummary at 1, 8 and 64 calls at a time, calls per second and milliseconds of
//       a call, median and 99 %, of
//         echo      a call of the same bytes both ways on the same server, that computes nothing
//         library   the functions of the library alone, on as many threads as the server has
//         service   the call
//       and the time that a call takes of the machine (one over calls per second) over that of echo
//       and library together: what validating, translating, queueing and logging add. Medians of
//       rounds in which the three take turns.
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/table.h"
#include "bench/echo.grpc.pb.h"
#include "bench/inputs.h"
#include "lightfit/v1/service.grpc.pb.h"
#include "optimizer/energy/summary_total.h"
#include "optimizer/fit.h"
#include "server/server.h"
#include "server/work_pool.h"
#include "wire/camera_proto.h"
#include "wire/light_proto.h"
#include "wire/summary_proto.h"

namespace lightfit {
namespace {

using Clock = std::chrono::steady_clock;

constexpr MapSize kMap = {1024, 1024};
constexpr int kChannels = 8;

struct Arguments {
  int size_px = 180;
  int num_lights = 8;
  int num_rounds = 5;
  double round_s = 1.0;
  uint64_t seed = 7;
};

class EchoService final : public bench::Echo::CallbackService {
 public:
  grpc::ServerUnaryReactor* Echo(grpc::CallbackServerContext* context,
                                 const bench::EchoRequest* request,
                                 bench::EchoReply* reply) override {
    reply->set_payload(std::string(request->reply_bytes(), 'x'));
    grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
    reactor->Finish(grpc::Status::OK);
    return reactor;
  }
};

// Calls by so many clients, each of which makes the next when it has the answer.
struct Measured {
  double calls_per_s = 0.0;
  double median_ms = 0.0;
  double p99_ms = 0.0;

  double ms_per_call() const { return 1e3 / calls_per_s; }
};

using Client = std::function<void(int client)>;  // one call, answered on return

Measured Measure(int num_clients, double duration_s, const Client& call) {
  std::vector<std::vector<double>> times_ms(num_clients);
  const Clock::time_point begin = Clock::now();
  const auto end = begin + std::chrono::duration_cast<Clock::duration>(
                               std::chrono::duration<double>(duration_s));
  std::vector<std::thread> clients;
  clients.reserve(num_clients);
  for (int i = 0; i < num_clients; ++i) {
    clients.emplace_back([&, i] {
      do {
        const Clock::time_point start = Clock::now();
        call(i);
        times_ms[i].push_back(
            std::chrono::duration<double, std::milli>(Clock::now() - start).count());
      } while (Clock::now() < end);
    });
  }
  for (std::thread& client : clients) client.join();
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  std::vector<double> all_ms;
  for (const std::vector<double>& times : times_ms) {
    all_ms.insert(all_ms.end(), times.begin(), times.end());
  }
  std::sort(all_ms.begin(), all_ms.end());
  const auto quantile = [&](double share) {
    return all_ms[static_cast<size_t>(share * static_cast<double>(all_ms.size() - 1))];
  };
  return {static_cast<double>(all_ms.size()) / seconds, quantile(0.5), quantile(0.99)};
}

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

Measured MedianOf(const std::vector<Measured>& rounds) {
  const auto median = [&](double Measured::*figure) {
    std::vector<double> values;
    values.reserve(rounds.size());
    for (const Measured& round : rounds) values.push_back(round.*figure);
    return Median(std::move(values));
  };
  return {median(&Measured::calls_per_s), median(&Measured::median_ms), median(&Measured::p99_ms)};
}

// One method: three ways of doing it, of which each returns when it is done.
struct Contest {
  std::string name;
  int64_t request_bytes = 0, reply_bytes = 0;
  Client echo, library, service;
};

// Ends the program from whatever thread it is; what was printed so far is not lost.
[[noreturn]] void Fail(const std::string& message) {
  std::fflush(nullptr);
  std::fprintf(stderr, "bench_service: %s\n", message.c_str());
  std::quick_exit(1);
}

void Check(const grpc::Status& status) {
  if (!status.ok()) Fail(status.error_message());
}

std::string Bytes(const auto& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0])};
}

v1::FitRequest FitRequestOf(const Input& input) {
  v1::FitRequest request;
  *request.mutable_readback()->mutable_camera() = CameraToProto(input.camera, input.depth_kind);
  request.mutable_readback()->set_depth(Bytes(input.depth));
  request.mutable_readback()->set_shadow_bits(Bytes(input.shadow_bits));
  for (const Light& light : input.lights) *request.add_lights() = LightToProto(light);
  request.mutable_map()->set_width(kMap.width);
  request.mutable_map()->set_height(kMap.height);
  return request;
}

v1::FitSummaryRequest SummaryRequestOf(const SummarySet& set) {
  v1::FitSummaryRequest request;
  *request.add_summaries() = SummarySetToProto(set);
  request.mutable_map()->set_width(kMap.width);
  request.mutable_map()->set_height(kMap.height);
  return request;
}

SummarySet SummariesOf(const Input& input) {
  std::vector<LightSummary> lights;
  for (const Light& light : input.lights) {
    lights.push_back(SummaryOfFrame(light, Summarize(input.View(), light), "frame", {}));
  }
  return MakeSummarySet({}, std::move(lights));
}

// Only lights that can be fitted, so that every way has the same to do.
Input MakeInput(const Arguments& arguments) {
  Input input = BoxInput(arguments.seed, arguments.size_px, arguments.size_px, kMaxLights);
  std::vector<Light> usable;
  for (Light light : input.lights) {
    if (static_cast<int>(usable.size()) == arguments.num_lights) break;
    if (!FitLight(input.View(), light, kMap).ok()) continue;
    // Light number l owns bit l.
    const uint32_t from = uint32_t{1} << light.shadow_bit, to = uint32_t{1} << usable.size();
    for (uint32_t& bits : input.shadow_bits) bits = (bits & from) != 0 ? bits | to : bits & ~to;
    light.shadow_bit = static_cast<int>(usable.size());
    usable.push_back(light);
  }
  input.lights = usable;
  return input;
}

void PrintContest(const Contest& contest, const Arguments& arguments, Table* table) {
  for (const int num_clients : {1, 8, 64}) {
    std::vector<Measured> echo, library, service;
    std::vector<double> added;
    for (int round = 0; round < arguments.num_rounds; ++round) {
      echo.push_back(Measure(num_clients, arguments.round_s, contest.echo));
      library.push_back(Measure(num_clients, arguments.round_s, contest.library));
      service.push_back(Measure(num_clients, arguments.round_s, contest.service));
      added.push_back(service.back().ms_per_call() /
                      (echo.back().ms_per_call() + library.back().ms_per_call()));
    }
    std::vector<std::string> cells = {absl::StrCat(contest.name, ", ", num_clients, " at a time")};
    for (const auto* rounds : {&echo, &library, &service}) {
      const Measured measured = MedianOf(*rounds);
      cells.push_back(absl::StrFormat("%.0f", measured.calls_per_s));
      cells.push_back(absl::StrFormat("%.2f", measured.median_ms));
      cells.push_back(absl::StrFormat("%.2f", measured.p99_ms));
    }
    cells.push_back(absl::StrFormat("%.2f", Median(added)));
    table->AddRow(std::move(cells));
  }
}

int Run(const Arguments& arguments) {
  EchoService echo_service;
  ServerOptions options;
  options.listen = "127.0.0.1:0";
  options.log_path = "/dev/null";
  options.limits.num_threads = static_cast<int>(std::thread::hardware_concurrency());
  const auto server = Server::Start(options, {&echo_service});
  if (!server.ok()) {
    std::fprintf(stderr, "bench_service: %s\n", std::string(server.status().message()).c_str());
    return 1;
  }
  std::vector<std::unique_ptr<v1::LightFit::Stub>> stubs;
  std::vector<std::unique_ptr<bench::Echo::Stub>> echo_stubs;
  for (int i = 0; i < kChannels; ++i) {
    grpc::ChannelArguments channel_arguments;
    channel_arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    const auto channel = grpc::CreateCustomChannel(
        (*server)->address(), grpc::InsecureChannelCredentials(), channel_arguments);
    stubs.push_back(v1::LightFit::NewStub(channel));
    echo_stubs.push_back(bench::Echo::NewStub(channel));
  }
  WorkPool pool(options.limits.num_threads, 1 << 20);
  const auto on_pool = [&pool](const std::function<void()>& work) {
    std::promise<void> done;
    pool.Submit([&] {
      work();
      done.set_value();
    });
    done.get_future().wait();
  };
  const auto make_echo = [&](const google::protobuf::Message& request, int64_t reply_bytes) {
    auto echo = std::make_shared<bench::EchoRequest>();
    echo->set_payload(request.SerializeAsString());
    echo->set_reply_bytes(static_cast<int32_t>(reply_bytes));
    return [&echo_stubs, echo](int client) {
      grpc::ClientContext context;
      bench::EchoReply reply;
      Check(echo_stubs[client % kChannels]->Echo(&context, *echo, &reply));
    };
  };

  const Input input = MakeInput(arguments);
  const v1::FitRequest fit = FitRequestOf(input);
  const SummarySet set = SummariesOf(input);
  const v1::FitSummaryRequest fit_summary = SummaryRequestOf(set);

  Contest fits = {"Fit", static_cast<int64_t>(fit.ByteSizeLong())};
  fits.service = [&](int client) {
    grpc::ClientContext context;
    v1::FitResult result;
    Check(stubs[client % kChannels]->Fit(&context, fit, &result));
  };
  fits.library = [&](int) { on_pool([&] { FitLights(input.View(), input.lights, kMap); }); };
  Contest sums = {"FitSummary", static_cast<int64_t>(fit_summary.ByteSizeLong())};
  sums.service = [&](int client) {
    grpc::ClientContext context;
    v1::FitResult result;
    Check(stubs[client % kChannels]->FitSummary(&context, fit_summary, &result));
  };
  sums.library = [&](int) {
    on_pool([&] {
      for (const LightSummary& light : set.lights) {
        const auto summary = SummaryOfTotal(light.total);
        const absl::Status status =
            summary.ok() ? Fit(*summary, light.total.light, kMap).status() : summary.status();
        if (!status.ok()) Fail(std::string(status.message()));
      }
    });
  };
  const auto result_bytes = [](const auto& call) {
    v1::FitResult result;
    grpc::ClientContext context;
    Check(call(&context, &result));
    return static_cast<int64_t>(result.ByteSizeLong());
  };
  fits.reply_bytes = result_bytes(
      [&](auto* context, auto* result) { return stubs[0]->Fit(context, fit, result); });
  sums.reply_bytes = result_bytes([&](auto* context, auto* result) {
    return stubs[0]->FitSummary(context, fit_summary, result);
  });
  fits.echo = make_echo(fit, fits.reply_bytes);
  sums.echo = make_echo(fit_summary, sums.reply_bytes);

  std::printf(
      "%dx%d pixels, %d lights, %d threads that compute, %d rounds of %g s each\n"
      "Fit: %d bytes in, %d out; FitSummary: %d in, %d out\n\n",
      arguments.size_px,
      arguments.size_px,
      static_cast<int>(input.lights.size()),
      options.limits.num_threads,
      arguments.num_rounds,
      arguments.round_s,
      static_cast<int>(fits.request_bytes),
      static_cast<int>(fits.reply_bytes),
      static_cast<int>(sums.request_bytes),
      static_cast<int>(sums.reply_bytes));
  Table table;
  table.AddColumn("", "calls");
  for (const char* way : {"echo", "library", "service"}) {
    table.AddColumn(way, "/ s");
    table.AddColumn(way, "50 % ms");
    table.AddColumn(way, "99 % ms");
  }
  table.AddColumn("time, service /", "(echo + library)");
  PrintContest(fits, arguments, &table);
  PrintContest(sums, arguments, &table);
  std::fputs(table.Text().c_str(), stdout);
  return 0;
}

}  // namespace
}  // namespace lightfit

int main(int argc, char** argv) {
  try {
    lightfit::Arguments arguments;
    CLI::App app("What the service adds to the library.");
    app.add_option("--size", arguments.size_px, "Pixels on each side of the read-back [180]");
    app.add_option("--lights", arguments.num_lights, "Lights, at most 32 [8]");
    app.add_option("--rounds", arguments.num_rounds, "Rounds whose median counts [5]");
    app.add_option("--round-s", arguments.round_s, "Seconds of each way in a round [1]");
    app.add_option("--seed", arguments.seed, "Of the scene [7]");
    CLI11_PARSE(app, argc, argv);
    return lightfit::Run(arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_service: %s\n", error.what());
    return 1;
  }
}
