// server/service.h
//
// lightfit.v1.LightFit: each method handed to its kind of call, which parses its messages itself.
// In:   calls, from gRPC's threads.
// Out:  reactors, at once: nothing here blocks or computes.
#pragma once

#include "lightfit/v1/service.grpc.pb.h"
#include "server/call.h"

namespace lightfit {

// All methods in bytes.
using LightFitInBytes = v1::LightFit::WithRawCallbackMethod_Fit<
    v1::LightFit::WithRawCallbackMethod_FitStream<v1::LightFit::WithRawCallbackMethod_Track<
        v1::LightFit::WithRawCallbackMethod_FitSummary<v1::LightFit::WithRawCallbackMethod_Evaluate<
            v1::LightFit::WithRawCallbackMethod_Allocate<
                v1::LightFit::WithRawCallbackMethod_Summarize<
                    v1::LightFit::WithRawCallbackMethod_Compare<v1::LightFit::Service>>>>>>>>;

class LightFitService final : public LightFitInBytes {
 public:
  // `parts` outlive the server that this is registered with.
  explicit LightFitService(ServerParts* parts) : parts_(parts) {}

  grpc::ServerUnaryReactor* Fit(grpc::CallbackServerContext* context,
                                const grpc::ByteBuffer* request,
                                grpc::ByteBuffer* result) override;
  grpc::ServerReadReactor<grpc::ByteBuffer>* FitStream(grpc::CallbackServerContext* context,
                                                       grpc::ByteBuffer* result) override;
  grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* Track(
      grpc::CallbackServerContext* context) override;
  grpc::ServerUnaryReactor* FitSummary(grpc::CallbackServerContext* context,
                                       const grpc::ByteBuffer* request,
                                       grpc::ByteBuffer* result) override;
  grpc::ServerUnaryReactor* Evaluate(grpc::CallbackServerContext* context,
                                     const grpc::ByteBuffer* request,
                                     grpc::ByteBuffer* result) override;
  grpc::ServerUnaryReactor* Allocate(grpc::CallbackServerContext* context,
                                     const grpc::ByteBuffer* request,
                                     grpc::ByteBuffer* result) override;

  grpc::ServerUnaryReactor* Summarize(grpc::CallbackServerContext* context,
                                      const grpc::ByteBuffer* request,
                                      grpc::ByteBuffer* result) override;
  grpc::ServerUnaryReactor* Compare(grpc::CallbackServerContext* context,
                                    const grpc::ByteBuffer* request,
                                    grpc::ByteBuffer* result) override;

 private:
  ServerParts* parts_;
};

}  // namespace lightfit
