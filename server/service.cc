#include "server/service.h"

#include "calls/allocate_call.h"
#include "calls/compare/compare_call.h"
#include "calls/evaluate_call.h"
#include "calls/fit_call.h"
#include "calls/summarize_call.h"
#include "calls/summary_call.h"
#include "server/fit_stream_call.h"
#include "server/track_call.h"
#include "server/unary_call.h"

namespace lightfit {

grpc::ServerUnaryReactor* LightFitService::Fit(grpc::CallbackServerContext* context,
                                               const grpc::ByteBuffer* request,
                                               grpc::ByteBuffer* result) {
  return new UnaryCall<v1::FitRequest, v1::FitResult>(
      parts_, "Fit", context, request, result, &AnswerFit);
}

grpc::ServerReadReactor<grpc::ByteBuffer>* LightFitService::FitStream(
    grpc::CallbackServerContext* context, grpc::ByteBuffer* result) {
  return new FitStreamCall(parts_, context, result);
}

grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* LightFitService::Track(
    grpc::CallbackServerContext* context) {
  return new TrackCall(parts_, context);
}

grpc::ServerUnaryReactor* LightFitService::FitSummary(grpc::CallbackServerContext* context,
                                                      const grpc::ByteBuffer* request,
                                                      grpc::ByteBuffer* result) {
  return new UnaryCall<v1::FitSummaryRequest, v1::FitResult>(
      parts_, "FitSummary", context, request, result, &AnswerFitSummary);
}

grpc::ServerUnaryReactor* LightFitService::Evaluate(grpc::CallbackServerContext* context,
                                                    const grpc::ByteBuffer* request,
                                                    grpc::ByteBuffer* result) {
  return new UnaryCall<v1::EvaluateRequest, v1::EvaluateResult>(
      parts_, "Evaluate", context, request, result, &AnswerEvaluate);
}

grpc::ServerUnaryReactor* LightFitService::Allocate(grpc::CallbackServerContext* context,
                                                    const grpc::ByteBuffer* request,
                                                    grpc::ByteBuffer* result) {
  return new UnaryCall<v1::AllocateRequest, v1::Allocation>(
      parts_, "Allocate", context, request, result, &AnswerAllocate);
}

grpc::ServerUnaryReactor* LightFitService::Summarize(grpc::CallbackServerContext* context,
                                                     const grpc::ByteBuffer* request,
                                                     grpc::ByteBuffer* result) {
  return new UnaryCall<v1::SummarizeRequest, v1::SummarizeResult>(
      parts_, "Summarize", context, request, result, &AnswerSummarize);
}

grpc::ServerUnaryReactor* LightFitService::Compare(grpc::CallbackServerContext* context,
                                                   const grpc::ByteBuffer* request,
                                                   grpc::ByteBuffer* result) {
  return new UnaryCall<v1::CompareRequest, v1::Comparison>(
      parts_, "Compare", context, request, result, &AnswerCompare);
}

}  // namespace lightfit
