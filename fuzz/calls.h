// fuzz/calls.h
//
// What the targets of calls share.
// In:   bytes of a request.
// Out:  the request, and a context in which no answer takes long.
#pragma once

#include <google/protobuf/stubs/logging.h>

#include <algorithm>
#include <cstdint>

#include "calls/call_context.h"
#include "calls/request_options.h"
#include "lightfit/v1/options.pb.h"

namespace lightfit::fuzz {

inline CallContext SmallContext() {
  CallContext context;
  context.limits.max_pixels = 1024;
  context.limits.max_maps = 4;
  context.limits.max_matrices = 8;
  context.limits.max_summaries = 8;
  return context;
}

// Searches that are long because they were asked to be end with the call's deadline. Here they are
// as short as can be; what is refused stays refused.
inline void ShortenSearch(v1::FitOptions* options) {
  const auto is_taken = [](int32_t steps) { return steps > 1 && steps <= kMaxSearchSteps; };
  constexpr int32_t kSteps = 3;
  if (!options->has_reweighting_rounds() || is_taken(options->reweighting_rounds())) {
    options->set_reweighting_rounds(1);
  }
  if (is_taken(options->line_search_rounds())) options->set_line_search_rounds(1);
  if (!options->has_grid_directions() || is_taken(options->grid_directions())) {
    options->set_grid_directions(kSteps);
  }
}

// False when the bytes are no such message. protobuf's reports of strings that are not UTF-8 are
// kept quiet.
template <typename Request>
bool ParseRequest(const uint8_t* data, size_t size, Request* request) {
  const google::protobuf::LogSilencer silencer;
  return request->ParseFromArray(data, static_cast<int>(size));
}

}  // namespace lightfit::fuzz
