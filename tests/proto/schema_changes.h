// tests/proto/schema_changes.h
//
// Whether programs that were built with a released schema still work with today's.
// In:   two schemas as descriptors.
// Out:  what breaks them; proto/README.md has the rule.
#pragma once

#include <google/protobuf/descriptor.pb.h>

#include <string>
#include <vector>

namespace lightfit::testing {

// A sentence for each change that breaks old programs, on the wire or when they are compiled anew:
// whatever of `released` is gone or is not what it was. Empty when all of it is there; additions
// are no changes.
std::vector<std::string> BreakingChanges(const google::protobuf::FileDescriptorSet& released,
                                         const google::protobuf::FileDescriptorSet& now);

}  // namespace lightfit::testing
