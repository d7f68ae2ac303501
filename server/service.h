// server/service.h
//
// lightfit.v1.LightFit: each method handed to its kind of call.
// In:   calls, from gRPC's threads.
// Out:  reactors, at once: nothing here blocks or computes.
#pragma once

#include "lightfit/v1/service.grpc.pb.h"
#include "server/call.h"

namespace lightfit {

class LightFitService final : public v1::LightFit::CallbackService {
 public:
  // `parts` outlive the server that this is registered with.
  explicit LightFitService(ServerParts* parts) : parts_(parts) {}

  grpc::ServerUnaryReactor* Fit(grpc::CallbackServerContext* context,
                                const v1::FitRequest* request,
                                v1::FitResult* result) override;
  grpc::ServerReadReactor<v1::FitStreamRequest>* FitStream(grpc::CallbackServerContext* context,
                                                           v1::FitResult* result) override;
  grpc::ServerBidiReactor<v1::TrackRequest, v1::TrackResult>* Track(
      grpc::CallbackServerContext* context) override;
  grpc::ServerUnaryReactor* FitSummary(grpc::CallbackServerContext* context,
                                       const v1::FitSummaryRequest* request,
                                       v1::FitResult* result) override;
  grpc::ServerUnaryReactor* Evaluate(grpc::CallbackServerContext* context,
                                     const v1::EvaluateRequest* request,
                                     v1::EvaluateResult* result) override;
  grpc::ServerUnaryReactor* Allocate(grpc::CallbackServerContext* context,
                                     const v1::AllocateRequest* request,
                                     v1::Allocation* result) override;

 private:
  ServerParts* parts_;
};

}  // namespace lightfit
